"""Peers of the examples `server` and `peer`, with pymodbus 3.16 (pip install pymodbus).

pymodbus.py server PORT                   a server with 64 values in each table; then: example `peer`
pymodbus.py client PORT COUNT             random requests to the example `server`
"""

import random
import sys
import time

from pymodbus.client import ModbusTcpClient
from pymodbus.datastore import ModbusDeviceContext, ModbusSequentialDataBlock, ModbusServerContext
from pymodbus.server import StartTcpServer

SIZE = 64


def serve(port):
    tables = [ModbusSequentialDataBlock(1, [0] * SIZE) for _ in range(4)]
    device = ModbusDeviceContext(di=tables[0], co=tables[1], hr=tables[2], ir=tables[3])
    StartTcpServer(ModbusServerContext(devices=device, single=True), address=("127.0.0.1", port))


def ask(port, count):
    client = ModbusTcpClient("127.0.0.1", port=port, timeout=2)
    assert client.connect(), "the example `server` must run"
    dice = random.Random(1)
    coils, holding = [False] * SIZE, [0] * SIZE
    client.write_coils(0, coils)
    client.write_registers(0, holding)
    begun = time.monotonic()
    for number in range(count):
        first = dice.randrange(SIZE)
        size = dice.randint(1, SIZE - first)
        end = first + size
        words = [dice.randrange(65536) for _ in range(size)]
        bits = [word % 2 == 1 for word in words]
        function = number % 9
        if function == 0:
            found, expected = client.read_coils(first, count=size).bits[:size], coils[first:end]
        elif function == 1:
            found = client.read_discrete_inputs(first, count=size).bits[:size]
            expected = [address % 3 == 0 for address in range(first, end)]
        elif function == 2:
            found, expected = client.read_holding_registers(first, count=size).registers, holding[first:end]
        elif function == 3:
            found = client.read_input_registers(first, count=size).registers
            expected = [1000 + address for address in range(first, end)]
        elif function == 4:
            found, expected = client.write_coil(first, bits[0]).isError(), False
            coils[first] = bits[0]
        elif function == 5:
            found, expected = client.write_register(first, words[0]).isError(), False
            holding[first] = words[0]
        elif function == 6:
            found, expected = client.write_coils(first, bits).isError(), False
            coils[first:end] = bits
        elif function == 7:
            found, expected = client.write_registers(first, words).isError(), False
            holding[first:end] = words
        else:
            holding[first:end] = words
            answer = client.readwrite_registers(
                read_address=first, read_count=size, write_address=first, values=words
            )
            found, expected = answer.registers, words
        assert found == expected, f"request {number}: expected {expected}, found {found}"
    refused = client.read_holding_registers(SIZE - 1, count=2)
    assert refused.isError() and refused.exception_code == 2, refused
    each = (time.monotonic() - begun) / count
    print(f"{count} requests answered as expected, {each * 1e6:.0f} µs each")


if sys.argv[1:2] == ["server"] and len(sys.argv) == 3:
    serve(int(sys.argv[2]))
elif sys.argv[1:2] == ["client"] and len(sys.argv) == 4:
    ask(int(sys.argv[2]), int(sys.argv[3]))
else:
    sys.exit(__doc__)

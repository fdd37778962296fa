"""A BK9000 with a watchdog on a server that nobody of this project wrote: pymodbus 3.16 (pip install pymodbus).

pymodbus_bk9000.py PORT        then: the example `coupler controller 127.0.0.1:PORT SECONDS` of crates/executive

Each second it prints the first output, the number of writes, and how often the watchdog has fired. On its standard
input, `cut SECONDS` stops the server for a time, as a program that hangs; `restart` resets outputs and settings.
"""

import sys
import threading
import time

from pymodbus.server import StartTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

INPUTS, OUTPUTS, SIZE = 8, 4, 0x1200
OUT, LENGTHS, TIME, TYPE = 0x800, 0x1010, 0x1120, 0x1122
DELIVERED = {LENGTHS: 16 * OUTPUTS, LENGTHS + 1: 16 * INPUTS, TIME: 1000, TYPE: 1}


class Coupler:
    def __init__(self):
        self.pause = self.writes = self.fallbacks = self.output = 0
        self.until, self.is_restarting = None, True

    async def action(self, function, start, address, count, registers, values):
        if self.pause:
            time.sleep(self.pause)
            self.pause = 0
        now = time.monotonic()
        if self.is_restarting:
            registers[:] = [DELIVERED.get(register, 0) for register in range(SIZE)]
            self.until, self.is_restarting = None, False
        if self.until and now >= self.until:
            self.until = None
            self.fallbacks += 1
            registers[OUT : OUT + OUTPUTS] = [0] * OUTPUTS
        is_write = values is not None and OUT <= address < OUT + OUTPUTS
        if is_write or (self.until and registers[TYPE] == 1):
            self.until = now + registers[TIME] / 1000
        self.writes += is_write
        self.output = values[0] if is_write else registers[OUT]


def control(coupler):
    for line in sys.stdin:
        match line.split():
            case ["cut", seconds]:
                coupler.pause = float(seconds)
            case ["restart"]:
                coupler.is_restarting = True


def show(coupler):
    while True:
        time.sleep(1)
        print(coupler.output, coupler.writes, coupler.fallbacks, flush=True)


coupler = Coupler()
for work in (control, show):
    threading.Thread(target=work, args=[coupler], daemon=True).start()
registers = SimData(0, values=[0] * SIZE, datatype=DataType.REGISTERS)
device = SimDevice(id=1, simdata=[registers], action=coupler.action)
StartTcpServer(device, address=("127.0.0.1", int(sys.argv[1])))

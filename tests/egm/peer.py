"""A small EGM robot, written from egm.proto alone: it shares no code with the project.

Sends EgmRobot to PORT every 4 ms. Moves to each received target without delay, and continues with the speed in
the same message. Checks each message: message type, growing sequence number, unit quaternion, finite numbers, and
no step of more than 25 mm. Ends 3 s after the last answer, or after SECONDS, and prints one line of JSON.

    python3 peer.py PORT SECONDS X Y Z [W QX QY QZ]
"""

import json
import math
import os
import socket
import struct
import sys
import time


def varint(value):
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def integer(number, value):
    return varint(number << 3) + varint(value)


def double(number, value):
    return varint(number << 3 | 1) + struct.pack("<d", value)


def message(number, *fields):
    body = b"".join(fields)
    return varint(number << 3 | 2) + varint(len(body)) + body


def parse(data):
    """Fields of a message: number -> list of values (int, float or bytes)."""
    fields, at = {}, 0

    def read_varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at += 1
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return value

    while at < len(data):
        key = read_varint()
        kind = key & 7
        if kind == 0:
            value = read_varint()
        elif kind == 1:
            (value,) = struct.unpack_from("<d", data, at)
            at += 8
        elif kind == 2:
            length = read_varint()
            value = data[at : at + length]
            assert len(value) == length, "cut off"
            at += length
        else:
            raise AssertionError(f"wire type {kind}")
        fields.setdefault(key >> 3, []).append(value)
    return fields


def robot_message(seqno, milliseconds, pos, quat):
    cartesian = message(
        2,
        message(1, *(double(i + 1, v) for i, v in enumerate(pos))),
        message(2, *(double(i + 1, v) for i, v in enumerate(quat))),
    )
    joints = message(1, *(double(1, 10.0 * i) for i in range(6)))
    return b"".join(
        [
            message(1, integer(1, seqno), integer(2, milliseconds), integer(3, 2)),
            message(2, joints, cartesian),
            message(3, joints, cartesian),
            message(4, integer(1, 1)),
            message(5, integer(1, 3)),
            integer(6, 1),
            message(8, integer(1, 2)),
            double(10, 12.5),
        ]
    )


def target_of(data):
    fields = parse(data)
    header = parse(fields[1][0])
    assert header[3] == [3], f"message type {header.get(3)}"
    cartesian = parse(parse(fields[2][0])[2][0])
    pos, quat = parse(cartesian[1][0]), parse(cartesian[2][0])
    pos = [pos[i][0] for i in (1, 2, 3)]
    quat = [quat[i][0] for i in (1, 2, 3, 4)]
    speed = parse(parse(fields[3][0])[2][0])[1] if 3 in fields else []
    return header[1][0], pos, quat, speed


def main():
    port, seconds = int(sys.argv[1]), float(sys.argv[2])
    pos = [float(v) for v in sys.argv[3:6]]
    quat = [float(v) for v in sys.argv[6:10]] or [1.0, 0.0, 0.0, 0.0]
    try:
        # A robot is punctual whatever else the machine does.
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(50))
    except (AttributeError, OSError):
        pass
    line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    line.settimeout(0.003)
    start = time.monotonic()
    sent = answered = 0
    last, speed, moved, target = None, [], start, pos
    longest = travelled = fastest = 0.0
    heard = math.inf
    while (now := time.monotonic() - start) < min(seconds, heard + 3.0):
        sent += 1
        pos = [p + v * (now + start - moved) for p, v in zip(pos, speed or [0.0] * 3)]
        moved = now + start
        line.sendto(robot_message(2 * sent, int(now * 1000), pos, quat), ("127.0.0.1", port))
        try:
            data, _ = line.recvfrom(4096)
            seqno, new, turned, speed = target_of(data)
            assert last is None or seqno > last, f"sequence number {seqno} after {last}"
            assert all(math.isfinite(v) for v in new + turned + speed)
            assert abs(math.hypot(*turned) - 1.0) < 1e-6, turned
            assert len(speed) in (0, 6), speed
            step = math.dist(pos, new)
            assert step < 25.0, f"a step of {step} mm"
            longest, travelled = max(longest, step), travelled + math.dist(target, new)
            target = new
            fastest = max(fastest, math.hypot(*speed[:3]))
            last, pos, quat, answered, heard = seqno, new, turned, answered + 1, now
            moved = time.monotonic()
        except (TimeoutError, ConnectionRefusedError):
            pass
        time.sleep(max(0.0, start + sent * 0.004 - time.monotonic()))
    print(
        json.dumps(
            {
                "sent": sent,
                "answered": answered,
                "longest_mm": longest,
                "travelled_mm": travelled,
                "fastest_mm_s": fastest,
                "at": pos,
            }
        )
    )


main()

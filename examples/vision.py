#!/usr/bin/env python3
"""A vision system for a running rcs-run, in Python without any library but its own.

    rcs-run linkbar --network unix:/tmp/rcs.sock --outside vision
    examples/vision.py unix:/tmp/rcs.sock
    examples/vision.py unix:/tmp/rcs.sock --taught 0.10 -0.25 71.5

answers every request from the picture of the simulated cell: the part nearest to the optical axis is the one asked for. With
--taught it answers Y, Z (inches) and angle (degrees) of a part that was measured by hand, at every first picture, and (0, 0) at the
second, when the camera is above it. The bytes are those of docs/neighbours.md; with tcp:IP:PORT the directory with the keys follows.
"""

import math
import struct
import sys

from hwsc import Controller, run

REQUEST, RESPONSE, PICTURE = 0xF8000, 0xF8200, 0xF8400
VISION = 4
NOT_READY, READY = 1, 2
FLOOD, PRECISE = 1, 2
IDLE, BUSY, DONE, NOTHING_SEEN = 0, 1, 2, 3
HEAD, PART = struct.Struct("<HHQQ"), struct.Struct("<3d3dd3ddd11s")


class Vision(Controller):
    """A vision system: reads requests and pictures, writes responses."""

    role, name, writes = VISION, "vision", (RESPONSE,)
    picture = request = None

    def take(self, address, data):
        if address == PICTURE:
            number, count, _seed, _cell = HEAD.unpack_from(data)
            self.picture = number, [PART.unpack_from(data, HEAD.size + PART.size * at) for at in range(count)]
        elif address == REQUEST and data:
            _count, *self.request = struct.unpack("<HHHHhHH", data)

    def respond(self, echo, status, y=0.0, z=0.0, angle=0.0, recognised=0):
        """Let the response be read, and the next request be written."""
        hundredths = [round(value * 100) for value in (y, z, angle)]
        self.write(RESPONSE, struct.pack("<HHHHHhhhH", READY, READY, 12, echo, status, *hundredths, recognised))

    def serve(self, taught):
        self.respond(0, IDLE)
        while True:
            self.tick()
            if not self.request or not (taught or self.picture and self.picture[0] == self.request[0]):
                continue
            number, kind, object_id, grip, range_mm, _variation = self.request
            self.request = None
            seen = taught_place(taught, kind) if taught else place(self.picture[1], grip, range_mm)
            if seen is None:
                self.respond(number, NOTHING_SEEN)
            else:
                self.respond(number, DONE, *seen, object_id if kind == PRECISE else 0)
            print(f"request {number}: {seen or 'nothing seen'}", flush=True)


def place(parts, grip, range_mm):
    """Where the part nearest to the optical axis is, as a picture shows it: Y, Z (inches), angle (degrees)."""
    if not parts:
        return None
    x, y, z, *edges, _light, _points = min(parts, key=lambda part: math.hypot(part[1], part[2]))
    scale = range_mm / 25.4 / x
    first, second = edges[:4], edges[4:]
    across = first if (first[3] > second[3]) == (abs(grip) == 1) else second
    angle = math.degrees(math.atan2(across[2], across[1]))
    # An edge has no direction: a roll of less than a quarter turn is wanted.
    return y * scale, z * scale, (angle + 90) % 180 - 90


def taught_place(taught, kind):
    y, z, angle = taught
    return (y, z, 0.0) if kind == FLOOD else (0.0, 0.0, angle)


def main():
    arguments = sys.argv[1:]
    taught = None
    if "--taught" in arguments:
        at = arguments.index("--taught")
        taught = [float(word) for word in arguments[at + 1 : at + 4]]
        del arguments[at : at + 4]
    if len(arguments) not in (1, 2) or not arguments[0].startswith(("unix:", "tcp:")) or taught and len(taught) != 3:
        sys.exit(__doc__)
    if arguments[0].startswith("tcp:") != (len(arguments) == 2):
        sys.exit("a directory with keys was expected behind tcp:IP:PORT, and behind it only")
    Vision(*arguments).serve(taught)


if __name__ == "__main__":
    run(main)

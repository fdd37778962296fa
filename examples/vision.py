#!/usr/bin/env python3
"""A vision system for a running rcs-run.

    pip install ./python
    rcs-run linkbar --network unix:/tmp/rcs.sock --outside vision
    examples/vision.py unix:/tmp/rcs.sock
    examples/vision.py unix:/tmp/rcs.sock --taught 0.10 -0.25 71.5

answers every request from the picture of the simulated cell: the commanded part is the one nearest to the optical axis. With
--taught it answers Y, Z (inches) and angle (degrees) of a part that was measured by hand, at every first picture, and (0, 0) at
the second, when the camera is above it. With
CELL@tls/IP:PORT, the gateway of a cell, the path of a certificate follows without .pem and .key: keys/vision-1.
"""

import argparse
import math
import sys

from rcs_t3 import Answer, RcsError, Vision
from rcs_t3.vision import FLOOD

MM_PER_INCH = 25.4


def nearest(request, parts):
    """The part nearest to the optical axis, as a picture shows it."""
    if not parts:
        return None
    part = min(parts, key=lambda part: math.hypot(*part.position[1:]))
    x, y, z = part.position
    scale = request.range_mm / MM_PER_INCH / x
    first, second = part.edges
    across = first if (first[3] > second[3]) == (abs(request.grip) == 1) else second
    angle = math.degrees(math.atan2(across[2], across[1]))
    # An edge has no direction: a roll of less than a quarter turn is wanted.
    return Answer(y * scale, z * scale, (angle + 90) % 180 - 90)


def taught(y, z, angle):
    """A function that answers the place of a part that was measured by hand."""
    return lambda request, _: Answer(y, z, 0.0) if request.kind == FLOOD else Answer(0.0, 0.0, angle)


def show(request, answer):
    print(f"request {request.number}: {answer or 'nothing seen'}", flush=True)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("address")
    parser.add_argument("keys", nargs="?")
    parser.add_argument("--taught", nargs=3, type=float, metavar=("Y", "Z", "ANGLE"))
    arguments = parser.parse_args()
    locate = taught(*arguments.taught) if arguments.taught else nearest
    with Vision(arguments.address, arguments.keys) as vision:
        vision.serve(locate, needs_picture=not arguments.taught, on_answer=show)


if __name__ == "__main__":
    try:
        main()
    except RcsError as error:
        sys.exit(f"{sys.argv[0]}: {error}")

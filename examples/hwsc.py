#!/usr/bin/env python3
"""A workstation controller (HWSC) for a running rcs-run.

    pip install ./python
    rcs-run --network unix:/tmp/rcs.sock --outside workstation --clock real
    examples/hwsc.py unix:/tmp/rcs.sock

delivers a blank into the tray, has the robot TRANSFER it into the vise, and prints every status until `finished`. With
CELL@tls/IP:PORT, the gateway of a cell, the path of a certificate follows without .pem and .key: keys/hwsc-1.
"""

import sys

from rcs_t3 import Command, RcsError, Workstation

TRANSFER = Command("TRANSFER", "LINKBAR1_BH", 2, "UNIT_1", 4, 2, "PFIXTURE", end_at="HOME", serial="17")


def show(status):
    print(status, flush=True)


def main(address, keys=None):
    with Workstation(address, keys) as workstation:
        workstation.execute(Command("PAUSE"), show)
        workstation.in_cell("tray UNIT_1 4 LINKBAR1_BH")
        workstation.in_cell("vise partial PFIXTURE LINKBAR")
        workstation.execute(TRANSFER, show)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    try:
        main(*sys.argv[1:])
    except RcsError as error:
        sys.exit(f"{sys.argv[0]}: {error}")

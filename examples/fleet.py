#!/usr/bin/env python3
"""A monitor of many cells, through a router or at their gateways.

    pip install ./python[gateway]
    rcs-gateway serve t3 tls/10.0.0.1:7447 --run unix:/run/user/1000/t3.sock --keys keys --allow monitor=mes
    examples/fleet.py keys/mes tls/10.0.0.1:7447 [tls/10.0.0.2:7447 ...]

prints, once a second, a line for each cell that is or was there: its state, tick, command and connected roles. keys/mes is
the path of the monitor's certificate without .pem and .key.
"""

import json
import sys
import threading
import time

import zenoh

from rcs_t3 import RcsError
from rcs_t3.gateway import configuration


class Fleet:
    """What is known of all cells, by name."""

    def __init__(self, session):
        self.cells, self._lock = {}, threading.Lock()
        tokens = session.liveliness()
        self._tokens = tokens.declare_subscriber("rcs/*/alive/*", self._alive, history=True)
        self._states = session.declare_subscriber("rcs/*/status/run", self._status)

    def _cell(self, sample):
        return self.cells.setdefault(str(sample.key_expr).split("/")[1], {"here": False})

    def _alive(self, token):
        with self._lock:
            self._cell(token)["here"] = token.kind == zenoh.SampleKind.PUT

    def _status(self, sample):
        with self._lock:
            self._cell(sample).update(json.loads(sample.payload.to_string()))

    def lines(self):
        """A line for each cell."""
        with self._lock:
            return [describe(name, cell) for name, cell in sorted(self.cells.items())]


def describe(name, cell):
    """A cell in a line."""
    if not cell["here"]:
        return f"{name:12} gone"
    if not cell.get("run"):
        return f"{name:12} no run"
    tick = "-" if cell["tick"] is None else cell["tick"]
    words = [cell["state"] or "-", f"tick {tick}", cell["command"] or "-", cell["reason"] or ""]
    connected = ", ".join(f"{role} {who}" for role, who in cell["connected"].items())
    return f"{name:12} {' '.join(words).rstrip()} ({connected or 'nobody connected'})"


def main(keys, *endpoints):
    with zenoh.open(configuration(endpoints, keys)) as session:
        fleet = Fleet(session)
        while True:
            time.sleep(1)
            print(*fleet.lines(), sep="\n", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    try:
        main(*sys.argv[1:])
    except (RcsError, OSError, zenoh.ZError) as error:
        sys.exit(f"{sys.argv[0]}: {error}")
    except KeyboardInterrupt:
        pass

#!/usr/bin/env python3
"""A workstation controller (HWSC) for a running rcs-run, in Python without any library but its own.

    rcs-run --network unix:/tmp/rcs.sock --outside workstation --clock real
    examples/hwsc.py unix:/tmp/rcs.sock

delivers a blank into the tray, has the robot TRANSFER it into the vise, and prints every status until `finished`. The
bytes are those of docs/neighbours.md; with tcp:IP:PORT a file with the secret follows the address.
"""

import hmac
import os
import socket
import struct
import sys

HWSC_COMMAND, HWSC_STATUS = 0xF6000, 0xF6200  # Table IX.1
CELL_COMMAND, CELL_STATUS = 0xF6400, 0xF6600  # the simulated cell's
PULSE, LAST_WORDS, WELCOME = 0, 1, 2
WORKSTATION = 1
COMMAND = struct.Struct("<4sHH12s16s16s16sh16shh16sh16sh")
STATUS = struct.Struct("<4s16sH12s16s16sHHHHH160s")


def plain(data):
    """Text that came over a line, without what a terminal would obey."""
    return "".join(c if c.isprintable() else "?" for c in data.decode(errors="replace")).rstrip()


def run(main):
    """Whatever goes wrong with files or the line ends in a sentence."""
    try:
        main()
    except (OSError, ValueError, struct.error) as error:
        sys.exit(f"{sys.argv[0]}: {error}")
    except KeyboardInterrupt:
        sys.exit(f"{sys.argv[0]}: interrupted")


class Controller:
    """The mailboxes of a controller, seen by a neighbour: its number, and the mailboxes that it writes."""

    role, writes = WORKSTATION, (HWSC_COMMAND, CELL_COMMAND)

    def __init__(self, address, secret=b""):
        kind, _, place = address.partition(":")
        if kind == "unix":
            self.line = socket.socket(socket.AF_UNIX)
            self.line.connect(place)
        else:
            host, _, port = place.rpartition(":")
            self.line = socket.create_connection((host.strip("[]"), int(port)))
        self.seals, self.verified = None, False if secret else None
        self.greet(secret)
        self.verified = True
        self.mailgrams = dict.fromkeys(self.writes, 0)
        self.status = self.cell = self.pulse = None

    def greet(self, secret):
        """Prove that both know the secret, and agree upon the seals of frames: {out or in: [key, frames so far]}."""
        said = self.receive(40) + struct.pack("<4sHH", b"RCS2", self.role, 0) + os.urandom(32)
        mac = lambda word: hmac.digest(secret, said + word, "sha256") if secret else bytes(32)
        self.line.sendall(said[40:] + mac(b"neighbour"))
        address, proof = self.read_frame()
        if address != WELCOME or not hmac.compare_digest(proof, mac(b"controller")):
            sys.exit("the controller does not know the secret")
        if secret:
            self.seals = {"out": [mac(b"up"), 0], "in": [mac(b"down"), 0]}

    def seal(self, way, frame):
        """What stands behind a frame: who knows the secret has sent it, as the next one."""
        if not self.seals:
            return b""
        self.seals[way][1] += 1
        key, number = self.seals[way]
        return hmac.digest(key, struct.pack("<Q", number) + frame, "sha256")[:16]

    def send_frame(self, frame):
        self.line.sendall(frame + self.seal("out", frame))

    def read_frame(self):
        """Address and data of the next frame."""
        head = self.receive(6)
        address, length = struct.unpack("<IH", head)
        rest = self.receive(length - 2)
        seal = self.seal("in", head + rest)
        if not hmac.compare_digest(self.receive(len(seal)), seal):
            sys.exit("a frame does not come from the controller")
        if address == LAST_WORDS:
            unverified = " (unverified)" if self.verified is False else ""
            sys.exit(f"the controller says: {plain(rest[6:])}{unverified}")
        return address, rest[6:]

    def receive(self, count):
        data = b""
        while len(data) < count:
            piece = self.line.recv(count - len(data))
            if not piece:
                sys.exit("the controller has closed the connection")
            data += piece
        return data

    def write(self, address, data):
        """Write data into a mailbox: its length, mailgram number, two locks, data."""
        self.mailgrams[address] = self.mailgrams[address] % 65535 + 1
        head = struct.pack("<IHHHH", address, 8 + len(data), self.mailgrams[address], 0, 0)
        self.send_frame(head + data)

    def tick(self):
        """Answer the pulse of a tick, which lets the next one begin, and read mailgrams up to the end of that."""
        if self.pulse:
            self.send_frame(self.pulse)
        while True:
            address, data = self.read_frame()
            if address == PULSE:
                self.pulse = struct.pack("<IHHHH", PULSE, 16, 0, 0, 0) + data
                return
            self.take(address, data)

    def take(self, address, data):
        """A mailgram has come."""
        if address == HWSC_STATUS:
            self.status = STATUS.unpack(data)
        elif address == CELL_STATUS:
            self.cell = struct.unpack("<HHH240s", data)

    def command(self, verb, obj="", grip=0, source="", sector=0, to_grip=0, to="", to_sector=0, end_at="", serial=""):
        """Send a command to Task and wait for its end."""
        while self.status is None:
            self.tick()
        number = self.status[6] % 65535 + 1
        text = lambda words, width=16: words.encode().ljust(width)
        self.write(
            HWSC_COMMAND,
            COMMAND.pack(text("", 4), COMMAND.size, number, text("", 12), text(verb), text(obj), text(serial), grip,
                         text(source), sector, to_grip, text(to), to_sector, text(end_at), 0),
        )
        mailgram, said = self.mailgrams[HWSC_COMMAND], None
        while True:
            self.tick()
            _, _, _, _, echo, status, echoed, read, verdict, code, task, reason = self.status
            status, reason = plain(status), plain(reason)
            if read == mailgram and verdict:
                sys.exit(f"{verb} is refused: {reason}")
            if echoed == number and status != said:
                said = status
                print(f"{plain(echo)} {number}: {status} {reason}".rstrip(), flush=True)
                if status == "finished":
                    return
                if status != "executing":
                    sys.exit(f"{verb} failed: {reason}")

    def in_cell(self, line):
        """Let the simulated cell do what a line of a job says, and wait until it has."""
        while self.cell is None:
            self.tick()
        number = self.cell[0] % 65535 + 1
        self.write(CELL_COMMAND, struct.pack("<H240s", number, line.encode().ljust(240)))
        while True:
            self.tick()
            echo, busy, trouble, text = self.cell
            if trouble:
                sys.exit(f"{line}: {plain(text)}")
            if echo == number and not busy:
                return


def main():
    if len(sys.argv) not in (2, 3) or not sys.argv[1].startswith(("unix:", "tcp:")):
        sys.exit(__doc__)
    secret = open(sys.argv[2], "rb").read().rstrip() if len(sys.argv) == 3 else b""
    controller = Controller(sys.argv[1], secret)
    controller.command("PAUSE")
    controller.in_cell("tray UNIT_1 4 LINKBAR1_BH")
    controller.in_cell("vise partial PFIXTURE LINKBAR")
    controller.command("TRANSFER", "LINKBAR1_BH", 2, "UNIT_1", 4, 2, "PFIXTURE", 0, "HOME", serial="17")


if __name__ == "__main__":
    run(main)

#!/usr/bin/env python3
"""A workstation controller (HWSC) for a running rcs-run, in Python without any library but its own.

    rcs-run --network unix:/tmp/rcs.sock --outside workstation --clock real
    examples/hwsc.py unix:/tmp/rcs.sock

delivers a blank into the tray, has the robot TRANSFER it into the vise, and prints every status until `finished`. The
bytes are those of docs/neighbours.md; with tcp:IP:PORT the directory follows that `rcs-neighbour keys` has made.
"""

import contextlib
import os
import socket
import ssl
import struct
import sys

HWSC_COMMAND, HWSC_STATUS = 0xF6000, 0xF6200  # Table IX.1
CELL_COMMAND, CELL_STATUS = 0xF6400, 0xF6600  # the simulated cell's
PULSE, DISCONNECT, WELCOME = 0, 1, 2
HELLO, VERSION = struct.Struct("<4sHH"), 3
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
    """The mailboxes of a controller, seen by a neighbour: its number and name, and the mailboxes that it writes."""

    role, name, writes = WORKSTATION, "workstation", (HWSC_COMMAND, CELL_COMMAND)

    def __init__(self, address, keys=None):
        kind, _, place = address.partition(":")
        if kind == "unix":
            self.line = socket.socket(socket.AF_UNIX)
            self.line.connect(place)
        else:
            self.line = self.connect_tls(place, keys)
        mark, version, _clock = HELLO.unpack(self.receive(HELLO.size))
        if (mark, version) != (b"RCS2", VERSION):
            sys.exit(f"version {VERSION} of the protocol was expected, found {mark} {version}")
        self.line.sendall(HELLO.pack(b"RCS2", VERSION, self.role))
        address, _ = self.read_frame()
        if address != WELCOME:
            sys.exit(f"a welcome was expected, found a frame with the address {address:05X}")
        self.mailgrams = dict.fromkeys(self.writes, 0)
        self.status = self.cell = self.pulse = None

    def connect_tls(self, place, keys):
        """TLS 1.3 with certificates on both sides. The controller's has the same name wherever it is reached."""
        context = ssl.create_default_context(cafile=os.path.join(keys, "ca.pem"))
        context.minimum_version = ssl.TLSVersion.TLSv1_3
        context.verify_flags |= ssl.VERIFY_X509_STRICT
        context.load_cert_chain(os.path.join(keys, self.name + ".pem"), os.path.join(keys, self.name + ".key"))
        host, _, port = place.rpartition(":")
        line = socket.create_connection((host.strip("[]"), int(port)))
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return context.wrap_socket(line, server_hostname="controller.rcs2.internal")

    def send_frame(self, frame):
        self.line.sendall(frame)

    def read_frame(self):
        """Address and data of the next frame."""
        address, length = struct.unpack("<IH", self.receive(6))
        rest = self.receive(length - 2)
        if address == DISCONNECT:
            sys.exit(f"the controller says: {plain(rest[6:])}")
        return address, rest[6:]

    def close(self):
        """End TLS in order, so that the controller can tell the end from a cut."""
        with contextlib.suppress(OSError):  # what the controller has sent meanwhile is not read
            if isinstance(self.line, ssl.SSLSocket):
                self.line.unwrap()
        self.line.close()

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
    if sys.argv[1].startswith("tcp:") != (len(sys.argv) == 3):
        sys.exit("a directory with keys was expected behind tcp:IP:PORT, and behind it only")
    controller = Controller(*sys.argv[1:])
    controller.command("PAUSE")
    controller.in_cell("tray UNIT_1 4 LINKBAR1_BH")
    controller.in_cell("vise partial PFIXTURE LINKBAR")
    controller.command("TRANSFER", "LINKBAR1_BH", 2, "UNIT_1", 4, 2, "PFIXTURE", 0, "HOME", serial="17")
    controller.close()


if __name__ == "__main__":
    run(main)

"""The clients against a controller that sends given bytes."""

import contextlib
import socket
import struct
import tempfile
import threading
import unittest
from pathlib import Path

from rcs_t3 import Command, ConnectionLost, Disconnected, Operator, ProtocolError, RcsError, Refused, Workstation
from rcs_t3.workstation import _COMMAND, _STATUS

HELLO = b"RCS2\x03\x00\x01\x00"


def frame(address, data=b"", mailgram=0):
    return struct.pack("<IHHHH", address, 8 + len(data), mailgram, 0, 0) + data


def status(word, number, mailgram, verdict=0, code=0, reason=""):
    texts = [text.ljust(size) for text, size in ((b"", 4), (b"", 16), (b"", 12), (b"PAUSE", 16), (word, 16))]
    blank, echo, stamp, command, word = texts
    values = number, mailgram, verdict, code, 0, 0, reason.encode().ljust(160)
    return frame(0xF6200, _STATUS.pack(blank, echo, 238, stamp, command, word, *values))


def pulse(tick):
    return frame(0, struct.pack("<Q", tick))


class Controller:
    """A socket whose first client gets `sent`; what the client sends is in `received`."""

    def __init__(self, sent):
        self.directory = tempfile.TemporaryDirectory()
        path = str(Path(self.directory.name) / "s")
        self.address, self.received = "unix:" + path, b""
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(path)
        self.listener.listen()
        self.thread = threading.Thread(target=self.serve, args=(sent,))
        self.thread.start()

    def serve(self, sent):
        line, _ = self.listener.accept()
        with line:
            line.sendall(sent)
            line.shutdown(socket.SHUT_WR)
            with contextlib.suppress(ConnectionResetError):  # the client need not read everything
                while piece := line.recv(4096):
                    self.received += piece

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.thread.join()
        self.listener.close()
        self.directory.cleanup()


class LineTest(unittest.TestCase):
    def assert_fails(self, sent, error, words):
        with Controller(sent) as controller, self.assertRaises(error) as caught:
            Workstation(controller.address)
        self.assertIn(words, str(caught.exception))

    def test_a_wrong_greeting_is_a_protocol_error(self):
        self.assert_fails(b"HTTP/1.1 400", ProtocolError, "version 3 of the protocol was expected")
        self.assert_fails(HELLO + frame(0x40000), ProtocolError, "found a frame with the address 40000")
        self.assert_fails(HELLO + struct.pack("<IH", 2, 0), ProtocolError, "a length of 8 to 4096")

    def test_an_incomplete_greeting_is_a_lost_connection(self):
        for sent in (b"", HELLO[:5], HELLO + frame(2)[:7]):
            self.assert_fails(sent, ConnectionLost, "has closed the connection")

    def test_a_disconnect_reason_is_shown_without_control_characters(self):
        self.assert_fails(HELLO + frame(1, b"\x1b[31mred\x07"), Disconnected, "the controller says: ?[31mred?")

    def test_a_missing_socket_and_a_wrong_address_are_errors(self):
        with self.assertRaises(ConnectionLost):
            Workstation("unix:/no/such/socket")
        for address in ("tcp:1.2.3.4:5", "unix:", "zenoh:x"):
            with self.assertRaises(ConnectionLost):
                Workstation(address)


class WorkstationTest(unittest.TestCase):
    def run_command(self, *frames):
        with Controller(b"".join((HELLO, frame(2), *frames))) as controller:
            with Workstation(controller.address) as workstation:
                seen = []
                try:
                    workstation.execute(Command("PAUSE"), lambda status: seen.append(status.status))
                finally:
                    self.received = controller
        return seen

    def test_a_finished_command_returns(self):
        idle = status(b"idle", 4, 0) + pulse(1)
        end = status(b"executing", 5, 1) + pulse(2) + status(b"finished", 5, 1) + pulse(3)
        self.assertEqual(self.run_command(idle, end), ["executing", "finished"])
        self.assertIn(_COMMAND.pack(b" " * 4, 126, 5, b" " * 12, b"PAUSE".ljust(16), *([b" " * 16] * 2), 0,
                                    b" " * 16, 0, 0, b" " * 16, 0, b" " * 16, 0), self.received.received)

    def test_a_refused_command_raises(self):
        with self.assertRaises(Refused) as caught:
            self.run_command(status(b"idle", 4, 0), pulse(1), status(b"idle", 4, 1, 3, reason="5 comes next"), pulse(2))
        self.assertEqual(caught.exception.reason, "5 comes next")

    def test_a_failed_command_raises_with_its_code(self):
        frames = status(b"idle", 4, 0), pulse(1), status(b"error", 5, 1, code=12, reason="no place"), pulse(2)
        with self.assertRaises(RcsError) as caught:
            self.run_command(*frames)
        self.assertEqual((caught.exception.code, caught.exception.reason), (12, "no place"))

    def test_a_replaced_command_raises(self):
        frames = (status(b"idle", 4, 0), pulse(1), status(b"executing", 5, 1), pulse(2),
                  status(b"executing", 6, 1), pulse(3))
        with self.assertRaises(RcsError) as caught:
            self.run_command(*frames)
        self.assertIn("replaced", str(caught.exception))

    def test_a_name_that_is_too_long_is_an_error(self):
        with self.assertRaises(RcsError):
            Command("PAUSE", object="A" * 17)._pack(1)

    def test_a_command_prints_as_a_line_of_a_job(self):
        command = Command("MOVE", "LINKBAR1_BH", 2, "UNIT_1", 4, 2, "PFIXTURE")
        self.assertEqual(str(command), "MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0")


class OperatorTest(unittest.TestCase):
    def test_answers_and_refusals(self):
        lines = b"rcs-operator 2 linkbar-1 anna-2 @5000\n1 @5040 ok tick 7: done\n2 @5080 refused no\n"
        with Controller(HELLO + frame(2) + lines) as controller:
            with Operator(controller.address, "anna") as operator:
                self.assertEqual((operator.run, operator.name), ("linkbar-1", "anna-2"))
                self.assertEqual(operator.request("stop"), "tick 7: done")
                with self.assertRaises(Refused):
                    operator.request("go")
        hello, stop, go = controller.received.decode().splitlines()[-3:]
        self.assertTrue(hello.endswith("hello anna"), hello)
        self.assertRegex(stop, r"^1 @60\d\d stop$", "a second after the time of the run")
        self.assertRegex(go, r"^2 @60\d\d go$")

    def test_a_refused_session_raises(self):
        with Controller(HELLO + frame(2) + b"0 @5000 refused busy\n") as controller:
            with self.assertRaises(Refused) as caught:
                Operator(controller.address, "anna")
        self.assertEqual(caught.exception.reason, "busy")


if __name__ == "__main__":
    unittest.main()

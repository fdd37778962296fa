"""The connection through a gateway, with a Zenoh that delivers given samples."""

import os
import struct
import sys
import tempfile
import types
import unittest
from unittest import mock

from rcs_t3 import Command, ConnectionLost, Disconnected, Operator, Workstation
from rcs_t3.workstation import _STATUS

ADDRESS = "t3@tls/10.0.0.1:7447"


def frame(address, data=b"", mailgram=0):
    return struct.pack("<IHHHH", address, 8 + len(data), mailgram, 0, 0) + data


def pulse(tick):
    return frame(0, struct.pack("<Q", tick))


def status(word, number, mailgram):
    texts = [text.ljust(size) for text, size in ((b"", 4), (b"", 16), (b"", 12), (b"PAUSE", 16), (word, 16))]
    blank, echo, stamp, command, word = texts
    values = number, mailgram, 0, 0, 0, 0, b"".ljust(160)
    return frame(0xF6200, _STATUS.pack(blank, echo, 238, stamp, command, word, *values))


def answer(ok=None, err=None):
    def part(data):
        return data and types.SimpleNamespace(payload=types.SimpleNamespace(to_bytes=lambda: data))

    return types.SimpleNamespace(ok=part(ok), err=part(err))


class Zenoh(types.ModuleType):
    """The module, and the session that it opens. `answers` are those to a claim; for each sample that the client
    publishes, the next of `samples` is delivered."""

    ZError = type("ZError", (Exception,), {})
    CongestionControl = types.SimpleNamespace(DROP="drop")
    Priority = types.SimpleNamespace(INTERACTIVE_HIGH="high")
    handlers = types.SimpleNamespace(Callback=lambda callback, indirect: callback)
    SampleKind = types.SimpleNamespace(PUT="put", DELETE="delete")

    def __init__(self, answers, samples=()):
        super().__init__("zenoh")
        self.answers, self.samples = answers, list(samples)
        self.configuration, self.published, self.keys, self.closed = {}, [], [], False

    def Config(self):
        return types.SimpleNamespace(insert_json5=self.configuration.__setitem__)

    def open(self, _config):
        return self

    def liveliness(self):
        return self

    def declare_subscriber(self, key, callback, history=False):
        self.keys.append(key)
        if key.endswith("/out"):
            self.deliver = callback
        else:
            self.watch = callback

    def declare_publisher(self, key, **_qos):
        self.keys.append(key)
        return types.SimpleNamespace(put=self.put)

    def declare_token(self, key):
        self.keys.append(key)

    def get(self, key, payload, timeout):
        self.keys.append(key)
        self.put(None)
        return self.answers

    def put(self, sample):
        if sample is not None:
            self.published.append(sample)
        if self.samples:
            data = self.samples.pop(0)
            self.deliver(types.SimpleNamespace(payload=types.SimpleNamespace(to_bytes=lambda: data)))

    def close(self):
        self.closed = True

    def is_closed(self):
        return self.closed


class Gateway(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.keys = os.path.join(directory.name, "hwsc-1")
        with open(self.keys + ".key", "w") as key:
            os.fchmod(key.fileno(), 0o600)

    def use(self, *arguments):
        zenoh = Zenoh(*arguments)
        patch = mock.patch.dict(sys.modules, zenoh=zenoh)
        patch.start()
        self.addCleanup(patch.stop)
        return zenoh

    def test_command_is_one_sample_with_all_mailboxes_and_the_pulse(self):
        samples = [status(b"idle", 0, 0) + pulse(1), status(b"idle", 0, 0) + pulse(2)]
        finished = status(b"finished", 1, 1)
        samples += [finished + pulse(tick) for tick in range(3, 9)]
        zenoh = self.use([answer(ok=b"real")], samples)
        with Workstation(ADDRESS, self.keys) as workstation:
            workstation.execute(Command("PAUSE"))
        command = [sample for sample in zenoh.published if sample.startswith(struct.pack("<I", 0xF6000))]
        self.assertEqual(len(command[0]), 12 + 126, "the command waits for no pulse")
        self.assertTrue(command[1].endswith(pulse(1)), "the answer to a pulse has the command, too")
        self.assertTrue(zenoh.published[-1].endswith(frame(1)), "the end is missing")
        self.assertTrue(zenoh.closed)
        claim = zenoh.keys[0].split("/")[4]
        self.assertEqual(zenoh.keys[0], f"rcs/t3/workstation/hwsc-1/{claim}/out")
        self.assertEqual(zenoh.keys[-1], "rcs/t3/open/workstation/hwsc-1")
        self.assertIn('"verify_name_on_connect": true', zenoh.configuration["transport/link/tls"])
        self.assertIn('"default_permission": "deny"', zenoh.configuration["access_control"])

    def test_refusals_have_the_words_of_the_controller(self):
        for kind, error in ((b"refused ", Disconnected), (b"absent ", ConnectionLost)):
            zenoh = self.use([answer(err=kind + b"workstation is connected already")])
            with self.assertRaisesRegex(error, "workstation is connected already"):
                Workstation(ADDRESS, self.keys)
            self.assertTrue(zenoh.closed)

    def test_denied_client_reads_what_to_check(self):
        self.use([answer(err=b"Timeout")])
        with self.assertRaisesRegex(ConnectionLost, "does its --allow have workstation=hwsc-1"):
            Workstation(ADDRESS, self.keys)

    def test_reason_in_a_sample_ends_the_connection(self):
        self.use([answer(ok=b"real")], [pulse(1) + frame(1, b"the run is over")])
        workstation = Workstation(ADDRESS, self.keys)
        workstation.tick()
        with self.assertRaisesRegex(Disconnected, "the run is over"):
            workstation.tick()

    def test_vanished_gateway_ends_the_connection(self):
        zenoh = self.use([answer(ok=b"fast")])
        workstation = Workstation(ADDRESS, self.keys)
        zenoh.watch(types.SimpleNamespace(kind="delete"))
        with self.assertRaisesRegex(ConnectionLost, "the gateway has gone"):
            workstation.tick()

    def test_repeated_pulse_is_answered_again_and_not_read_twice(self):
        zenoh = self.use([answer(ok=b"fast")], [pulse(1), pulse(1), pulse(2)])
        workstation = Workstation(ADDRESS, self.keys)
        workstation.tick()
        workstation.tick()
        self.assertEqual(zenoh.published, [pulse(1), pulse(1)])

    def test_operator_sends_whole_lines(self):
        zenoh = self.use([answer(ok=b"real")], [b"rcs-operator 2 run anna @5\n", b"1 @6 ok tick 3: stopped\n"])
        zenoh.get = lambda *_arguments, **_options: zenoh.answers
        operator = Operator(ADDRESS, "anna", self.keys)
        self.assertEqual(operator.request("stop"), "tick 3: stopped")
        operator.close()
        self.assertEqual(zenoh.published[0], b"hello anna\n")
        self.assertEqual(zenoh.published[-1], b"")

    def test_key_that_others_can_read_is_refused(self):
        os.chmod(self.keys + ".key", 0o640)
        self.use([answer(ok=b"real")])
        with self.assertRaisesRegex(ConnectionLost, "use chmod 600"):
            Workstation(ADDRESS, self.keys)


if __name__ == "__main__":
    unittest.main()

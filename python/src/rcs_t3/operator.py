"""An operator's session (docs/operator.md "The protocol")."""

from __future__ import annotations

import re
import time
from typing import Optional

from .errors import ProtocolError, Refused
from .line import Line, plain

_ROLE = 5
_GREETING = re.compile(r"rcs-operator 2 (\S+) (\S+) @(\d+)")
_ANSWER = re.compile(r"(\d+) @(\d+) (ok|refused) ?(.*)")
_MAX_TEXT = 224
_MAX_PATIENCE = 10.0


class Operator(Line):
    """An operator's session.

    >>> with Operator("unix:/tmp/rcs.sock", "anna") as operator:
    ...     print(operator.request("status"))

    The run needs ``--clock real --network ADDRESS --operator network``. `name` has 1 to 24 letters, digits, ``-``, ``_``
    and ``.``; :attr:`name` is the name that the run gives, for example ``anna-2``. A session that sends nothing for 10 s
    is disconnected, and one that moves the robot by hand and sends nothing for 0.25 s is stopped: call :meth:`sign` in
    between. The motion ends with the session.
    """

    def __init__(
        self, address: str, name: str, keys: Optional[str] = None, timeout: Optional[float] = 10.0
    ) -> None:
        super().__init__(address, _ROLE, keys, timeout)
        self._buffer = b""
        self._number = 0
        self._send_line(f"hello {name}")
        line = self._read_line()
        greeting = _GREETING.fullmatch(line)
        if greeting is None:
            self.close()
            raise Refused("the session", line.partition(" refused ")[2] or line)
        self.run, self.name = greeting.group(1), greeting.group(2)
        self._hear(greeting.group(3))

    def request(self, text: str, patience: float = 1.0) -> str:
        """Send a request and return its answer, which begins with the tick.

        The run discards a request that it could carry out only after `patience` seconds, 10 at most; a stop is always
        carried out. Raises :class:`Refused` if the run refuses or discards the request.
        """
        if not 0 < patience <= _MAX_PATIENCE:
            raise ValueError(f"a patience of up to {_MAX_PATIENCE:.0f} s was expected, found {patience}")
        if len(text.encode()) > _MAX_TEXT:
            raise ProtocolError(f"a request of at most {_MAX_TEXT} bytes was expected, found {text!r}")
        self._number += 1
        # Clocks of two machines are never compared: the limit is the run's last time, plus what has passed since then.
        limit = self._time + round((time.monotonic() - self._heard + patience) * 1000)
        self._send_line(f"{self._number} @{limit} {text}")
        while True:
            line = self._read_line()
            answer = _ANSWER.fullmatch(line)
            if answer is None:
                raise ProtocolError(f"an answer of a run was expected, found {line}")
            number, at, word, answered = answer.groups()
            self._hear(at)
            if int(number) != self._number:
                continue
            if word == "refused":
                raise Refused(text, answered)
            return answered

    def sign(self) -> None:
        """Show that the operator is still present."""
        self._send_line("")

    def _hear(self, at: str) -> None:
        """Note the time of the run's clock in a line that was just read."""
        self._time, self._heard = int(at), time.monotonic()

    def _send_line(self, line: str) -> None:
        if not line.isprintable():
            raise ProtocolError(f"a line without control characters was expected, found {line!r}")
        self.send(line.encode() + b"\n")

    def _read_line(self) -> str:
        while b"\n" not in self._buffer:
            self._buffer += self.receive_some(4096)
        line, _, self._buffer = self._buffer.partition(b"\n")
        return plain(line)

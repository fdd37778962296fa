"""An operator's session (docs/operator.md "The protocol")."""

from __future__ import annotations

from typing import Optional

from .errors import ProtocolError, Refused
from .line import Line, plain

_ROLE = 5
_GREETING = "rcs-operator 1"
_MAX_LINE = 240


class Operator(Line):
    """An operator's session.

    >>> with Operator("unix:/tmp/rcs.sock", "anna") as operator:
    ...     print(operator.request("status"))

    The run needs ``--clock real --network ADDRESS --operator network``. `name` has 1 to 24 letters, digits, ``-``, ``_``
    and ``.``. A session that sends nothing for 10 s is disconnected: call :meth:`sign` in between.
    """

    def __init__(
        self, address: str, name: str, keys: Optional[str] = None, timeout: Optional[float] = 10.0
    ) -> None:
        super().__init__(address, _ROLE, "operator", keys, timeout)
        self._buffer = b""
        self._number = 0
        self._send_line(f"hello {name}")
        greeting = self._read_line()
        if not greeting.startswith(_GREETING):
            self.close()
            raise Refused("the session", greeting.partition(" refused ")[2] or greeting)
        self.run = greeting[len(_GREETING):].strip()

    def request(self, line: str) -> str:
        """Send a request and return its answer, which begins with the tick.

        Raises :class:`Refused` if the run refuses it.
        """
        self._number += 1
        self._send_line(f"{self._number} {line}")
        while True:
            number, _, answer = self._read_line().partition(" ")
            word, _, text = answer.partition(" ")
            if word not in ("ok", "refused"):
                raise ProtocolError(f"an answer of a run was expected, found {number} {answer}")
            if number != str(self._number):
                continue
            if word == "refused":
                raise Refused(line, text)
            return text

    def sign(self) -> None:
        """Show that the operator is still present."""
        self._send_line("")

    def _send_line(self, line: str) -> None:
        data = line.encode()
        if len(data) > _MAX_LINE or not line.isprintable():
            raise ProtocolError(f"a line of at most {_MAX_LINE} printable bytes was expected, found {line!r}")
        self.send(data + b"\n")

    def _read_line(self) -> str:
        while b"\n" not in self._buffer:
            self._buffer += self.receive_some(4096)
        line, _, self._buffer = self._buffer.partition(b"\n")
        return plain(line)

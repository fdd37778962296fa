"""The mailboxes of a controller, as a neighbour uses them (docs/neighbours.md, chapter IX)."""

from __future__ import annotations

from typing import Iterable, Optional

from .line import PULSE, Line


class Neighbour(Line):
    """A peer system with mailboxes: workstation controller, vision system.

    In the fast clock a tick of the run waits for :meth:`tick`. On the 40 ms grid a neighbour that does not call it for
    10 s is disconnected.
    """

    def __init__(
        self,
        address: str,
        role: int,
        writes: Iterable[int],
        keys: Optional[str] = None,
        timeout: Optional[float] = None,
    ) -> None:
        super().__init__(address, role, keys, timeout)
        self.mailgrams = dict.fromkeys(writes, 0)
        self._pulse: Optional[bytes] = None

    def write(self, address: int, data: bytes) -> None:
        """Write data into a mailbox under the next mailgram number."""
        self.mailgrams[address] = self.mailgrams[address] % 65535 + 1
        self.write_frame(address, self.mailgrams[address], data)

    def tick(self) -> None:
        """Answer the pulse of a tick, which lets the next tick begin, and read mailgrams up to the end of that tick."""
        if self._pulse is not None:
            self.write_frame(PULSE, 0, self._pulse)
        while True:
            address, data = self.read_frame()
            if address == PULSE:
                self._pulse = data
                return
            self.take(address, data)

    def take(self, address: int, data: bytes) -> None:
        """Handle a mailgram. A subclass says what it means."""

"""Errors of the clients."""

from __future__ import annotations


class RcsError(Exception):
    """The base of all errors of this package."""


class ConnectionLost(RcsError):
    """The controller has closed the connection without a reason, or cannot be reached."""


class Disconnected(RcsError):
    """The controller has ended the connection and said why."""

    def __init__(self, reason: str) -> None:
        super().__init__(f"the controller says: {reason}")
        self.reason = reason


class ProtocolError(RcsError):
    """The other side does not follow docs/neighbours.md."""


class Refused(RcsError):
    """A command or a request was refused, and has changed nothing."""

    def __init__(self, what: str, reason: str) -> None:
        super().__init__(f"{what} is refused: {reason}")
        self.what, self.reason = what, reason


class CommandError(RcsError):
    """A command ended in an error. `code` is a code of docs/reasons.md."""

    def __init__(self, command: str, status: str, code: int, reason: str) -> None:
        super().__init__(f"{command} failed: {reason or status}")
        self.command, self.status, self.code, self.reason = command, status, code, reason


class CellError(RcsError):
    """The simulated cell cannot carry out a line."""

    def __init__(self, line: str, reason: str) -> None:
        super().__init__(f"{line}: {reason}")
        self.line, self.reason = line, reason

"""The workstation controller (V.4.2)."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Callable, Optional

from .errors import CellError, CommandError, ProtocolError, RcsError, Refused
from .line import plain
from .mailboxes import Neighbour

_HWSC_COMMAND, _HWSC_STATUS = 0xF6000, 0xF6200  # Table IX.1
_CELL_COMMAND, _CELL_STATUS = 0xF6400, 0xF6600  # of the simulated cell
_ROLE = 1
_COMMAND = struct.Struct("<4sHH12s16s16s16sh16shh16sh16sh")
_STATUS = struct.Struct("<4s16sH12s16s16sHHHHHH160s")
_CELL = struct.Struct("<HHH240s")
_NAME, _LINE = 16, 240
_FINISHED, _EXECUTING = "finished", "executing"


@dataclass(frozen=True)
class Command:
    """A command to Task (V.4.1). Names have at most 16 characters; an empty name and sector 0 mean none."""

    verb: str
    object: str = ""
    grip: int = 0
    source: str = ""
    source_sector: int = 0
    destination_grip: int = 0
    destination: str = ""
    destination_sector: int = 0
    end_at: str = ""
    end_at_sector: int = 0
    serial: str = ""

    def __str__(self) -> str:
        """The command as a line of a job."""
        objectless = self.object or "--"
        source, destination = self.source or "--", self.destination or "--"
        return (
            f"{self.verb} {objectless} {self.grip:+} {source} {self.source_sector} {self.destination_grip:+} "
            f"{destination} {self.destination_sector} {self.end_at or '--'} {self.end_at_sector}"
        )

    def _pack(self, number: int) -> bytes:
        return _COMMAND.pack(
            _text("", 4), _COMMAND.size, number, _text("", 12), _text(self.verb), _text(self.object),
            _text(self.serial), self.grip, _text(self.source), self.source_sector, self.destination_grip,
            _text(self.destination), self.destination_sector, _text(self.end_at), self.end_at_sector,
        )


@dataclass(frozen=True)
class Status:
    """The status of Task (V.4.2). `number` is that of the command which `status` belongs to.

    `unconfirmed` is not 0 if no sensor confirms a part of a finished command: `reason` says which.
    """

    command: str
    status: str
    number: int
    mailgram: int
    verdict: int
    code: int
    task_state: int
    unconfirmed: int
    reason: str

    @property
    def is_finished(self) -> bool:
        """The command is done."""
        return self.status == _FINISHED

    @property
    def is_executing(self) -> bool:
        """The command has not ended."""
        return self.status == _EXECUTING

    def __str__(self) -> str:
        return f"{self.command} {self.number}: {self.status} {self.reason}".rstrip()


class Workstation(Neighbour):
    """A workstation controller that commands Task.

    >>> with Workstation("unix:/tmp/rcs.sock") as workstation:
    ...     workstation.execute(Command("PAUSE"))

    The run needs ``--network ADDRESS --outside workstation``.
    """

    def __init__(self, address: str, keys: Optional[str] = None, timeout: Optional[float] = None) -> None:
        super().__init__(address, _ROLE, (_HWSC_COMMAND, _CELL_COMMAND), keys, timeout)
        self._status: Optional[Status] = None
        self._cell: Optional[tuple[int, int, int, str]] = None

    @property
    def status(self) -> Status:
        """The last status of Task. Waits for the first one."""
        while self._status is None:
            self.tick()
        return self._status

    def start(self, command: Command) -> int:
        """Send a command, which replaces one that is executing, and return its number.

        Raises :class:`Refused` if the controller does not take it. :meth:`wait` waits for its end.
        """
        number = self.status.number % 65535 + 1
        self.write(_HWSC_COMMAND, command._pack(number))
        mailgram = self.mailgrams[_HWSC_COMMAND]
        while self.status.mailgram != mailgram:
            self.tick()
        if self.status.verdict:
            raise Refused(command.verb, self.status.reason)
        return number

    def wait(self, number: int, on_status: Optional[Callable[[Status], None]] = None) -> Status:
        """Wait for the end of the command with this number. `on_status` gets each new status of it.

        Raises :class:`CommandError` if it does not finish, also if another command has replaced it.
        """
        last: Optional[Status] = None
        while True:
            status = self.status
            if status.number == number:
                if on_status is not None and (last is None or (last.status, last.reason) != (status.status, status.reason)):
                    on_status(status)
                last = status
                if status.is_finished:
                    return status
                if not status.is_executing and status.status != "idle":
                    raise CommandError(status.command, status.status, status.code, status.reason)
            elif last is not None:
                raise CommandError(last.command, "replaced", 0, "another command has replaced it")
            self.tick()

    def execute(self, command: Command, on_status: Optional[Callable[[Status], None]] = None) -> Status:
        """Send a command and wait for its end. Errors as :meth:`start` and :meth:`wait`."""
        return self.wait(self.start(command), on_status)

    def in_cell(self, line: str) -> None:
        """Let the simulated cell carry out a line of a job without its ``**``, and wait until it has.

        Raises :class:`CellError` if it cannot.
        """
        while self._cell is None:
            self.tick()
        number = self._cell[0] % 65535 + 1
        self.write(_CELL_COMMAND, struct.pack(f"<H{_LINE}s", number, _text(line, _LINE)))
        while True:
            self.tick()
            echo, is_busy, has_failed, text = self._cell
            if has_failed:
                raise CellError(line, text)
            if echo == number and not is_busy:
                return

    def take(self, address: int, data: bytes) -> None:
        """Read the status of Task, or that of the cell."""
        try:
            if address == _HWSC_STATUS:
                fields = _STATUS.unpack(data)
                echo, status, reason = (plain(fields[at]) for at in (4, 5, 12))
                number, mailgram, verdict, code, task, unconfirmed = fields[6:12]
                self._status = Status(echo, status, number, mailgram, verdict, code, task, unconfirmed, reason)
            elif address == _CELL_STATUS:
                echo, is_busy, has_failed, text = _CELL.unpack(data)
                self._cell = echo, is_busy, has_failed, plain(text)
        except struct.error as error:
            raise ProtocolError(f"the mailbox {address:05X} has another layout: {error}") from error


def _text(words: str, width: int = _NAME) -> bytes:
    """A text with trailing blanks."""
    data = words.encode()
    if len(data) > width:
        raise RcsError(f"a text of at most {width} bytes was expected, found {len(data)}: {words!r}")
    return data.ljust(width)

"""Clients of a running RCS-II/T3 controller.

* :class:`Workstation` sends commands to Task and reads their statuses (V.4.2);
* :class:`Operator` sends the requests of an operator (docs/operator.md);
* :class:`Vision` answers the requests of LOCATE-OBJ (V.2.3).

All of them connect to the address that ``rcs-run --network ADDRESS`` names: ``unix:PATH``. The bytes are those of
docs/neighbours.md. Every error is an :class:`RcsError`.
"""

from .errors import CellError, CommandError, ConnectionLost, Disconnected, ProtocolError, RcsError, Refused
from .operator import Operator
from .vision import Answer, Part, Request, Vision
from .workstation import Command, Status, Workstation

__all__ = [
    "Answer",
    "CellError",
    "Command",
    "CommandError",
    "ConnectionLost",
    "Disconnected",
    "Operator",
    "Part",
    "ProtocolError",
    "RcsError",
    "Refused",
    "Request",
    "Status",
    "Vision",
    "Workstation",
]

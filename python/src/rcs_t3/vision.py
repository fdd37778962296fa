"""The vision system (docs/neighbours.md "The vision system")."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Callable, List, Optional, Tuple

from .errors import ProtocolError
from .mailboxes import Neighbour

_REQUEST, _RESPONSE, _PICTURE = 0xF8000, 0xF8200, 0xF8400
_ROLE = 4
_NOT_READY, _READY = 1, 2
FLOOD, PRECISE = 1, 2
_IDLE, _BUSY, _DONE, _NOTHING_SEEN = 0, 1, 2, 3
_HEAD, _PART = struct.Struct("<HHQQ"), struct.Struct("<3d3dd3ddd11s")
_RESPONSE_DATA = struct.Struct("<HHHHHhhhH")

Edge = Tuple[float, float, float, float]


@dataclass(frozen=True)
class Part:
    """A part in the picture of the simulated cell: position in the camera's frame, inches, and two edges."""

    position: Tuple[float, float, float]
    edges: Tuple[Edge, Edge]


@dataclass(frozen=True)
class Request:
    """A request of LOCATE-OBJ: which picture, of which object, for which grip, at which distance."""

    number: int
    kind: int
    object: int
    grip: int
    range_mm: int
    variation: int


@dataclass(frozen=True)
class Answer:
    """Where the object is: Y and Z of its centroid, inches, and the angle of its grip axis, degrees."""

    y: float
    z: float
    angle: float


class Vision(Neighbour):
    """A vision system that answers each request by a function.

    The run needs ``--network ADDRESS --outside vision``.
    """

    def __init__(self, address: str, keys: Optional[str] = None, timeout: Optional[float] = None) -> None:
        super().__init__(address, _ROLE, (_RESPONSE,), keys, timeout)
        self._request: Optional[Request] = None
        self._picture: Optional[Tuple[int, List[Part]]] = None

    def serve(
        self,
        locate: Callable[[Request, List[Part]], Optional[Answer]],
        needs_picture: bool = True,
        on_answer: Optional[Callable[[Request, Optional[Answer]], None]] = None,
    ) -> None:
        """Answer requests until the controller ends the connection (:class:`Disconnected`).

        `locate` gets the request and the parts in the picture that belongs to it, and returns `None` if it sees nothing.
        A camera of its own sets `needs_picture` to false: it is asked as soon as the request arrives.
        """
        self._respond(0, _IDLE, None, 0)
        while True:
            self.tick()
            request = self._request
            if request is None:
                continue
            has_picture = self._picture is not None and self._picture[0] == request.number
            if needs_picture and not has_picture:
                continue
            self._request = None
            parts = self._picture[1] if self._picture is not None and has_picture else []
            answer = locate(request, parts)
            recognised = request.object if request.kind == PRECISE and answer is not None else 0
            self._respond(request.number, _NOTHING_SEEN if answer is None else _DONE, answer, recognised)
            if on_answer is not None:
                on_answer(request, answer)

    def take(self, address: int, data: bytes) -> None:
        """Read a picture or a request."""
        try:
            if address == _PICTURE:
                number, count, _seed, _cell = _HEAD.unpack_from(data)
                parts = (_PART.unpack_from(data, _HEAD.size + _PART.size * at) for at in range(count))
                self._picture = number, [_part(fields) for fields in parts]
            elif address == _REQUEST and data:
                _count, *fields = struct.unpack("<HHHHhHH", data)
                self._request = Request(*fields)
        except struct.error as error:
            raise ProtocolError(f"the mailbox {address:05X} has another layout: {error}") from error

    def _respond(self, echo: int, status: int, answer: Optional[Answer], recognised: int) -> None:
        """Write a response that can be read, and allow the next request."""
        values = (0.0, 0.0, 0.0) if answer is None else (answer.y, answer.z, answer.angle)
        hundredths = [round(value * 100) for value in values]
        self.write(_RESPONSE, _RESPONSE_DATA.pack(_READY, _READY, 12, echo, status, *hundredths, recognised))


def _part(fields: Tuple[float, ...]) -> Part:
    x, y, z, *edges = fields[:11]
    return Part((x, y, z), (_edge(edges[:4]), _edge(edges[4:])))


def _edge(values: List[float]) -> Edge:
    x, y, z, length = values
    return x, y, z, length

"""The connection to a controller (docs/neighbours.md "On the line")."""

from __future__ import annotations

import socket
import struct
from types import TracebackType
from typing import Optional, Tuple, Type, TypeVar, Union

from .errors import ConnectionLost, Disconnected, ProtocolError
from .gateway import GatewaySocket, is_gateway

PULSE, DISCONNECT, WELCOME = 0, 1, 2
_HELLO, _VERSION = struct.Struct("<4sHH"), 3
_FRAME = struct.Struct("<IHHHH")
_MAX_LENGTH = 4096

_Line = TypeVar("_Line", bound="Line")


def plain(data: bytes) -> str:
    """Text from the line without control characters, which a terminal would obey, and without trailing blanks."""
    return "".join(c if c.isprintable() else "?" for c in data.decode(errors="replace")).rstrip()


class Line:
    """A connection on which both sides have sent their hello, and the controller its welcome.

    `address` is ``unix:PATH``, or ``CELL@tls/IP:PORT`` for the gateway of a cell, with the path `keys` of a certificate
    without ``.pem`` and ``.key``. `timeout` is the longest silence of the controller in seconds; `None` waits without a
    limit, for example for a run that an operator holds.
    """

    def __init__(
        self, address: str, role: int, keys: Optional[str] = None, timeout: Optional[float] = None
    ) -> None:
        try:
            self._socket = _connect(address, role, keys, timeout)
        except (OSError, ValueError) as error:
            raise ConnectionLost(f"{address}: {error}") from error
        try:
            mark, version, clock = _HELLO.unpack(self.receive(_HELLO.size))
            if (mark, version) != (b"RCS2", _VERSION):
                raise ProtocolError(f"version {_VERSION} of the protocol was expected, found {mark!r} {version}")
            self.is_fast = clock == 1
            self.send(_HELLO.pack(b"RCS2", _VERSION, role))
            found, _ = self.read_frame()
            if found != WELCOME:
                raise ProtocolError(f"a welcome was expected, found a frame with the address {found:05X}")
        except BaseException:
            self._socket.close()
            raise

    def send(self, data: bytes) -> None:
        """Send bytes."""
        try:
            self._socket.sendall(data)
        except OSError as error:
            raise self._lost(error) from error

    def receive(self, count: int) -> bytes:
        """Receive exactly `count` bytes."""
        data = b""
        while len(data) < count:
            data += self.receive_some(count - len(data))
        return data

    def receive_some(self, count: int) -> bytes:
        """Receive 1 to `count` bytes."""
        try:
            piece = self._socket.recv(count)
        except OSError as error:
            raise self._lost(error) from error
        if not piece:
            raise ConnectionLost("the controller has closed the connection")
        return piece

    def read_frame(self) -> Tuple[int, bytes]:
        """Address and data of the next frame. Raises :class:`Disconnected` for a disconnect reason."""
        address, length = struct.unpack("<IH", self.receive(6))
        if not 8 <= length <= _MAX_LENGTH:
            raise ProtocolError(f"a length of 8 to {_MAX_LENGTH} was expected in a frame, found {length}")
        data = self.receive(length - 2)[6:]
        if address == DISCONNECT:
            raise Disconnected(plain(data))
        return address, data

    def write_frame(self, address: int, mailgram: int, data: bytes) -> None:
        """Send a frame: address, length, mailgram number, two locks, data."""
        self.send(_FRAME.pack(address, 8 + len(data), mailgram, 0, 0) + data)

    def close(self) -> None:
        """End the connection."""
        self._socket.close()

    def __enter__(self: _Line) -> _Line:
        return self

    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        self.close()

    def _lost(self, error: OSError) -> ConnectionLost:
        if isinstance(error, socket.timeout):
            return ConnectionLost("the controller has not sent anything within the timeout")
        return ConnectionLost(f"the connection to the controller is lost: {error}")


def _connect(
    address: str, role: int, keys: Optional[str], timeout: Optional[float]
) -> Union[socket.socket, GatewaySocket]:
    if is_gateway(address):
        return GatewaySocket(address, role, keys, timeout)
    kind, _, place = address.partition(":")
    if kind != "unix" or not place or keys is not None:
        raise ValueError("unix:PATH was expected, or CELL@tls/IP:PORT with keys (docs/several-machines.md)")
    line = socket.socket(socket.AF_UNIX)
    try:
        line.settimeout(timeout)
        line.connect(place)
    except OSError:
        line.close()
        raise
    return line

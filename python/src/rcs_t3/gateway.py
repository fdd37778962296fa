"""A connection through the gateway of a cell (docs/several-machines.md), on eclipse-zenoh.

:class:`GatewaySocket` has the methods of a socket that :class:`~rcs_t3.line.Line` uses, and the bytes of
docs/neighbours.md "On the line". So every client of this package works through a gateway as it does at a Unix socket.
"""

from __future__ import annotations

import atexit
import json
import os
import re
import secrets
import socket
import stat
import struct
import threading
import time
from collections import deque
from typing import TYPE_CHECKING, Any, Callable, Deque, Dict, List, Optional, Sequence, Tuple

from .errors import ConnectionLost, Disconnected, ProtocolError

if TYPE_CHECKING:
    import zenoh

_ROLES = {1: "workstation", 2: "data-system", 3: "pedestal", 4: "vision", 5: "operator"}
_OPERATOR = 5
_ADDRESS = re.compile(r"([A-Za-z0-9_-][A-Za-z0-9._-]*)@(tls/.+:\d+)")
_PULSE, _DISCONNECT, _WELCOME = 0, 1, 2
_HELLO = struct.Struct("<4sHH")
_VERSION = 3
_CLOCKS = {b"real": 0, b"fast": 1}
_SILENCE = 10.0  # on the 40 ms grid the gateway sends a sample in each tick
_ANSWER = 12.0  # longer than the 10 s of the run


def is_gateway(address: str) -> bool:
    """True for CELL@tls/IP:PORT."""
    return _ADDRESS.fullmatch(address) is not None


def _frame(address: int, data: bytes = b"") -> bytes:
    return struct.pack("<IHHHH", address, 8 + len(data), 0, 0, 0) + data


def _frames(data: bytes) -> List[Tuple[int, bytes]]:
    """Address and all bytes of each frame."""
    found, at = [], 0
    while at < len(data):
        if len(data) - at < 12:
            raise ProtocolError(f"a whole frame was expected, found {len(data) - at} bytes")
        address, length = struct.unpack_from("<IH", data, at)
        end = at + 4 + length
        if not 8 <= length <= 4096 or end > len(data):
            raise ProtocolError(f"a frame of 8 to 4096 bytes was expected after the address {address:05X}, found {length}")
        found.append((address, data[at:end]))
        at = end
    return found


def configuration(endpoints: Sequence[str], keys: str) -> "zenoh.Config":
    """Zenoh's configuration for a connection to one endpoint as a client, or to several as a peer that keeps trying.
    `keys` is the path of a certificate without .pem and .key; ca.pem is beside it."""
    import zenoh

    key, authority = keys + ".key", os.path.join(os.path.dirname(keys), "ca.pem")
    if os.stat(key).st_mode & (stat.S_IRWXG | stat.S_IRWXO):
        raise ConnectionLost(f"{key}: other users can read this private key: use chmod 600")
    is_client = len(endpoints) == 1
    tls = {
        "root_ca_certificate": authority,
        "connect_private_key": key,
        "connect_certificate": keys + ".pem",
        "enable_mtls": True,
        # Zenoh also trusts the public authorities when it connects: the name is what keeps those out.
        "verify_name_on_connect": True,
        "close_link_on_expiration": True,
    }
    config = zenoh.Config()
    for name, value in (
        ("mode", "client" if is_client else "peer"),
        ("listen/endpoints", []),
        ("connect/endpoints", list(endpoints)),
        ("connect/exit_on_failure", is_client),
        ("connect/timeout_ms", 0 if is_client else -1),
        ("open/return_conditions/connect_scouted", False),
        ("scouting/multicast/enabled", False),
        ("scouting/gossip/enabled", False),
        ("transport/link/protocols", ["tls"]),
        ("transport/link/rx/max_message_size", 65536),
        ("transport/link/tls", tls),
    ):
        config.insert_json5(name, json.dumps(value))
    return config


def _access_control(cell: str, rules: List[Dict[str, Any]]) -> str:
    """Only the gateway with the certificate of the cell is listened to, and only under the keys of a claim."""
    for index, rule in enumerate(rules):
        rule.update(id=str(index), permission="allow")
    return json.dumps(
        {
            "enabled": True,
            "default_permission": "deny",
            "rules": rules,
            "subjects": [{"id": "gateway", "cert_common_names": [cell]}],
            "policies": [{"rules": [rule["id"] for rule in rules], "subjects": ["gateway"]}],
        }
    )


def _claim_rules(cell: str, role: str, name: str) -> List[Dict[str, Any]]:
    front, opened = f"rcs/{cell}/{role}/{name}/*", f"rcs/{cell}/open/{role}/{name}"
    liveliness = ["declare_liveliness_subscriber", "liveliness_query"]

    def rule(flow: str, messages: List[str], key: str) -> Dict[str, Any]:
        return {"flows": [flow], "messages": messages, "key_exprs": [key]}

    return [
        rule("egress", ["query"], opened),
        rule("ingress", ["declare_queryable", "reply"], opened),
        rule("egress", ["put"], front + "/in"),
        rule("ingress", ["declare_subscriber"], front + "/in"),
        rule("ingress", ["put"], front + "/out"),
        rule("egress", ["declare_subscriber"], front + "/out"),
        rule("egress", ["liveliness_token"], front + "/alive"),
        rule("ingress", liveliness, front + "/alive"),
        rule("ingress", ["liveliness_token"], f"rcs/{cell}/alive/*"),
        rule("egress", liveliness, f"rcs/{cell}/alive/*"),
    ]


class GatewaySocket:
    """A claim of a role at a gateway, with the methods of a socket.

    `address` is ``CELL@tls/IP:PORT``; `keys` a path without ``.pem`` and ``.key``, whose last part is the common name
    of the certificate; ``ca.pem`` is beside them. Raises :class:`ConnectionLost` if there is no gateway or no run, and
    :class:`Disconnected` if the run refuses the claim.
    """

    def __init__(self, address: str, role: int, keys: Optional[str], timeout: Optional[float]) -> None:
        found = _ADDRESS.fullmatch(address)
        if found is None or keys is None:
            raise ValueError("CELL@tls/IP:PORT was expected, with a path of keys without .pem and .key")
        cell, endpoint = found.groups()
        word, name = _ROLES[role], os.path.basename(keys)
        self._is_operator, self._timeout = role == _OPERATOR, timeout
        self._changed = threading.Condition()
        self._payloads: Deque[bytes] = deque()  # of the network; the latest only, unless lines
        self._lost: Optional[str] = None
        self._input, self._output = b"", b""
        self._written: Dict[int, bytes] = {}  # frames of the mailboxes that this client writes
        self._read: Dict[int, bytes] = {}
        self._pulse = b""  # the last answered one, as a frame
        self._heard = time.monotonic()
        self._has_greeted = self._has_ended = False
        try:
            import zenoh
        except ImportError as error:
            raise ConnectionLost(f"{address}: pip install eclipse-zenoh==1.10.2 ({error})") from error
        try:
            config = configuration([endpoint], keys)
            config.insert_json5("access_control", _access_control(cell, _claim_rules(cell, word, name)))
            self._session = zenoh.open(config)
        except zenoh.ZError as error:
            raise ConnectionLost(f"{address}: {str(error).partition(' at /')[0]}") from error
        try:
            self._open(zenoh, cell, word, name)
        except BaseException:
            self._session.close()
            raise
        # A session of Zenoh that is open when Python ends keeps it from ending.
        atexit.register(self.close)

    def _open(self, zenoh: Any, cell: str, role: str, name: str) -> None:
        claim = secrets.token_hex(16)
        front = f"rcs/{cell}/{role}/{name}/{claim}"
        self._deleted = zenoh.SampleKind.DELETE

        def direct(callback: Callable[[Any], None]) -> Any:
            # Otherwise Zenoh starts a thread for each callback, which keeps Python from ending.
            return zenoh.handlers.Callback(callback, indirect=False)

        self._subscriber = self._session.declare_subscriber(front + "/out", direct(self._deliver))
        liveliness = self._session.liveliness()
        alive = f"rcs/{cell}/alive/*"
        self._watcher = liveliness.declare_subscriber(alive, direct(self._watch), history=True)
        self._publisher = self._session.declare_publisher(
            front + "/in",
            congestion_control=zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.INTERACTIVE_HIGH,
            express=True,
        )
        self._token = liveliness.declare_token(front + "/alive")
        for reply in self._session.get(f"rcs/{cell}/open/{role}/{name}", payload=claim, timeout=_ANSWER):
            if reply.ok is not None:
                clock = reply.ok.payload.to_bytes()
                if clock not in _CLOCKS:
                    raise ProtocolError(f"real or fast was expected, found {clock!r}")
                self._is_fast = _CLOCKS[clock] == 1
                self._input = _HELLO.pack(b"RCS2", _VERSION, _CLOCKS[clock]) + _frame(_WELCOME)
                return
            kind, _, text = reply.err.payload.to_bytes().decode(errors="replace").partition(" ")
            text = "".join(c if c.isprintable() else "?" for c in text)
            if kind == "refused":
                raise Disconnected(text)
            if kind == "absent":
                raise ConnectionLost(text)
        raise ConnectionLost(
            f"the gateway gives no answer: does its --allow have {role}={name}, and is it the gateway of {cell}?"
        )

    def _deliver(self, sample: Any) -> None:
        with self._changed:
            if not self._is_operator:
                self._payloads.clear()
            self._payloads.append(sample.payload.to_bytes())
            self._heard = time.monotonic()
            self._changed.notify()

    def _watch(self, token: Any) -> None:
        if token.kind == self._deleted:
            with self._changed:
                self._lost = "the gateway has gone"
                self._changed.notify()

    def settimeout(self, timeout: Optional[float]) -> None:
        """Set the longest silence of the controller in seconds."""
        self._timeout = timeout

    def recv(self, count: int) -> bytes:
        """Receive 1 to `count` bytes; none at the end."""
        start = time.monotonic()
        while not self._input:
            if self._has_ended:
                return b""
            payload = self._next(start)
            if payload is None:
                return b""
            self._take(payload)
        data, self._input = self._input[:count], self._input[count:]
        return data

    def _next(self, start: float) -> Optional[bytes]:
        """The next payload; `None` at the end."""
        with self._changed:
            while not self._payloads:
                now = time.monotonic()
                if self._lost is not None:
                    raise OSError(self._lost)
                limits = [] if self._timeout is None else [start + self._timeout - now]
                if not self._is_operator and not self._is_fast:
                    limits.append(self._heard + _SILENCE - now)
                if limits and min(limits) <= 0:
                    raise socket.timeout("timed out")
                self._changed.wait(min(limits) if limits else None)
            return self._payloads.popleft() or None

    def _take(self, payload: bytes) -> None:
        """Turn a payload into bytes of the line: mailboxes that have changed, a new pulse, a reason."""
        if self._is_operator:
            self._input += payload
            return
        for address, frame in _frames(payload):
            if address == _DISCONNECT:
                self._has_ended = True
                if len(frame) == 12:
                    return  # without a reason
            elif self._read.get(address) == frame:
                if address == _PULSE and self._pulse == frame:
                    self._publish()  # the run repeats a pulse: the answer was lost
                continue
            self._read[address] = frame
            self._input += frame

    def sendall(self, data: bytes) -> None:
        """Send bytes: after the hello whole frames, or lines of an operator."""
        self._output += data
        if not self._has_greeted:
            if len(self._output) < _HELLO.size:
                return
            self._output, self._has_greeted = self._output[_HELLO.size :], True
        if not self._output:
            return
        data, self._output = self._output, b""
        if self._is_operator:
            self._publisher.put(data)
            return
        for address, frame in _frames(data):
            if address == _PULSE:
                self._pulse = frame
            else:
                self._written[address] = frame
        self._publish()

    def _publish(self, end: bytes = b"") -> None:
        self._publisher.put(b"".join(self._written.values()) + self._pulse + end)

    def close(self) -> None:
        """End the claim in order."""
        atexit.unregister(self.close)
        if not self._session.is_closed():
            self._publisher.put(b"") if self._is_operator else self._publish(_frame(_DISCONNECT))
            self._session.close()

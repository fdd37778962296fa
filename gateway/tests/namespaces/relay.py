#!/usr/bin/env python3
"""A bad line between two network interfaces: whatever comes in at one goes out at the other, later, or not at all.

    relay.py ONE OTHER [SEED]       read what the line is like from standard input, a line each time it changes:
                                    DELAY_MS JITTER_MS LOSS_PERCENT (each way), or "cut"; ends at the end of the input
    relay.py plain INTERFACE        let the kernel finish packets before they leave an interface: checksums and lengths

Frames keep their order, as on a wire. The kernel's netem does the same where it is there; this needs Python and the right to
open packet sockets, and loses the same frames each time.
"""

import ctypes
import fcntl
import heapq
import os
import random
import select
import socket
import struct
import sys
import time

ETH_P_ALL = 3
SIOCETHTOOL = 0x8946
ETHTOOL_STXCSUM, ETHTOOL_STSO, ETHTOOL_SGSO = 0x17, 0x1F, 0x24


def plain(interface):
    """Switch off what is left to network cards: a packet that is read here would be unfinished."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        for command in (ETHTOOL_STXCSUM, ETHTOOL_STSO, ETHTOOL_SGSO):
            value = ctypes.create_string_buffer(struct.pack("II", command, 0))
            request = struct.pack("16sP", interface.encode(), ctypes.addressof(value))
            fcntl.ioctl(any_socket, SIOCETHTOOL, request)


class Line:
    """Both directions."""

    def __init__(self, interfaces, seed):
        self.ends = [socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ALL)) for _ in interfaces]
        for end, interface in zip(self.ends, interfaces):
            end.bind((interface, 0))
            end.setblocking(False)
        self.chance = random.Random(seed)
        self.delay = self.jitter = self.loss = 0.0
        self.whole = True
        self.under_way = []
        self.last = [0.0, 0.0]
        self.count = 0

    def become(self, words):
        if words == ["cut"]:
            self.whole = False
        else:
            delay, jitter, percent = map(float, words)
            self.delay, self.jitter, self.loss, self.whole = delay / 1000, jitter / 1000, percent / 100, True

    def take(self, end):
        """Take in what has come at an end."""
        while True:
            try:
                frame, (_, _, kind, *_) = self.ends[end].recvfrom(65536)
            except BlockingIOError:
                return
            if kind == socket.PACKET_OUTGOING or not self.whole or self.chance.random() < self.loss:
                continue
            due = time.monotonic() + self.delay + self.chance.uniform(-self.jitter, self.jitter)
            self.last[end] = due = max(due, self.last[end])
            self.count += 1
            heapq.heappush(self.under_way, (due, self.count, 1 - end, frame))

    def give(self):
        """Let out what is due; how long there is nothing to do."""
        while self.under_way:
            left = self.under_way[0][0] - time.monotonic()
            if left > 0:
                return left
            _, _, end, frame = heapq.heappop(self.under_way)
            if self.whole:
                try:
                    self.ends[end].send(frame)
                except OSError:
                    pass  # The interface is full, or gone: the frame is lost, as on a wire.
        return None

    def run(self, orders):
        os.set_blocking(orders, False)
        unread = b""
        while True:
            ready, _, _ = select.select([*self.ends, orders], [], [], self.give())
            for end in (0, 1):
                if self.ends[end] in ready:
                    self.take(end)
            if orders in ready:
                piece = os.read(orders, 4096)
                if not piece:
                    return
                *lines, unread = (unread + piece).split(b"\n")
                for line in lines:
                    self.become(line.decode().split())


def main():
    if len(sys.argv) == 3 and sys.argv[1] == "plain":
        plain(sys.argv[2])
    elif len(sys.argv) in (3, 4):
        Line(sys.argv[1:3], int(sys.argv[3]) if len(sys.argv) == 4 else 1).run(sys.stdin.fileno())
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()

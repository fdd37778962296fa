#!/usr/bin/env python3
"""Prints the time and size of each message on /joint_states of a live view (docs/live.md).

    pip install websockets
    rcs-run linkbar --clock real --live
    python3 examples/live.py
"""

import asyncio
import json

import websockets


async def main():
    protocols = [websockets.Subprotocol("foxglove.sdk.v1")]
    async with websockets.connect("ws://127.0.0.1:8765", subprotocols=protocols, max_size=None) as socket:
        info, channels = json.loads(await socket.recv()), json.loads(await socket.recv())["channels"]
        channel = next(channel for channel in channels if channel["topic"] == "/joint_states")
        await socket.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": channel["id"]}]}))
        async for message in socket:
            if message[0] == 1:    # a message: subscription, time in nanoseconds, bytes as in the log
                print(int.from_bytes(message[5:13], "little"), len(message) - 13)


asyncio.run(main())

"""Drives the emulated robot with a client that others have written: a circle of 30 mm in 4 s, back to its start.

    pip install ABBRobotEGM           # or abb_robot_client; each in an environment of its own, since
                                      # both register egm.proto
    rcs-cell --emulate egm:6510 &
    python3 tests/egm/clients.py ABBRobotEGM 6510

Checks what comes from the robot, and prints one line of JSON: messages, how far the robot was from its target at
worst, and at the end, mm.
"""

import json
import math
import sys
import time

import numpy as np

kind, port = sys.argv[1], int(sys.argv[2])
if kind == "ABBRobotEGM":
    from ABBRobotEGM import EGM
else:
    from abb_robot_client.egm import EGM

RADIUS, SECONDS = 30.0, 4.0


def circle(seconds):
    """Way from the start, mm, and its speed, mm/s: at rest at both ends."""
    part = min(seconds / SECONDS, 1.0)
    angle = math.tau * part - math.sin(math.tau * part)
    rate = math.tau * (1.0 - math.cos(math.tau * part)) / SECONDS
    way = RADIUS * np.array([0.0, math.sin(angle), 1.0 - math.cos(angle)])
    return way, RADIUS * rate * np.array([0.0, math.cos(angle), math.sin(angle)])


def pose(state):
    if kind == "ABBRobotEGM":
        pos, orient = state.cartesian.pos, state.cartesian.orient
        return np.array([pos.x, pos.y, pos.z]), np.array([orient.u0, orient.u1, orient.u2, orient.u3])
    return state.cartesian


egm = EGM(port=port)
begun, last, received, worst = None, None, 0, 0.0
while True:
    ok, state = egm.receive_from_robot(timeout=2.0)
    assert ok, "the robot is silent"
    pos, orient = pose(state)
    number = state.robot_message.header.seqno
    assert last is None or number > last, f"sequence number {number} after {last}"
    assert state.motors_on and state.rapid_running and len(state.joint_angles) == 6
    assert abs(np.linalg.norm(orient) - 1.0) < 1e-9
    if begun is None:
        begun, start = time.monotonic(), pos
    seconds = time.monotonic() - begun
    way, speed = circle(seconds)
    error = float(np.linalg.norm(start + way - pos))
    last, received, worst = number, received + 1, max(worst, error)
    if seconds > 1.5 * SECONDS:
        break
    speed = [*speed, 0.0, 0.0, 0.0]
    if kind == "ABBRobotEGM":
        assert egm.send_to_robot(cartesian=(start + way, orient), speed_ref=speed)
    else:
        assert egm.send_to_robot_cart(start + way, orient, speed_ref=speed)
print(json.dumps({"client": kind, "received": received, "worst_mm": worst, "end_mm": error}))

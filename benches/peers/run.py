#!/usr/bin/env python3
"""The same arm, gripper and ten parts in MuJoCo and in rapier: same step, same motors, same references; min of five.

    python3 -m venv venv && venv/bin/pip install mujoco
    venv/bin/python benches/peers/run.py [--step 0.0025]

Run it from the root of the repository. README.md beside this file says what is compared and what is not.
"""

import argparse
import json
import math
import subprocess
import tempfile
import time
from pathlib import Path

import mujoco

SECONDS, TICK, PERIOD, RUNS = 10.0, 0.040, 5.0, 5
EXAMPLE = ["cargo", "run", "--release", "--quiet", "-p", "plant", "--example", "peer_scene", "--"]
# Amplitudes of the references, as in scene.rs; the left finger stands, the right one closes for ever.
SWING = [0.10, 0.05, 0.05, 0.10, 0.10, 0.20]
GRIP = [0.0, 1.0]


def scene(*arguments):
    """Run the example, and read its answer if it gives one."""
    output = subprocess.run([*EXAMPLE, *arguments], check=True, capture_output=True, text=True).stdout
    return json.loads(output) if output.strip() else None


def in_hand(model, data):
    """Where the part in the fingers is, in the axes of the hand."""
    hand = data.body("roll")
    return hand.xmat.reshape(3, 3).T @ (data.body("part_0").xpos - hand.xpos)


def run_mujoco(path, step):
    """Five runs; the least time of a core counts."""
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.timestep = step
    steps = round(TICK / step)
    times = []
    for _ in range(RUNS):
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        before, top = in_hand(model, data), data.body("part_5").xpos[2]
        start = time.thread_time()
        for tick in range(1, round(SECONDS / TICK) + 1):
            phase = 0.5 * (1.0 - math.cos(2.0 * math.pi * tick * TICK / PERIOD))
            data.ctrl[:] = [swing * phase for swing in SWING] + GRIP
            # All steps of a tick in one call: Python's own time is one call in 40 ms.
            mujoco.mj_step(model, data, steps)
        times.append(time.thread_time() - start)
    slid = in_hand(model, data) - before
    return {
        "engine": f"MuJoCo {mujoco.__version__}",
        "simulated_s": SECONDS,
        "cpu_s": times,
        "realtime_factor": SECONDS / min(times),
        "slid_mm": 1e3 * math.sqrt(sum(x * x for x in slid)),
        "sunk_mm": 1e3 * (top - data.body("part_5").xpos[2]),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--step", type=float, default=0.0025, help="seconds; the cell's own step is 0.0025")
    step = parser.parse_args().step
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / "peer.xml"
        scene("mjcf", str(path))
        peer = run_mujoco(path, step)
    rapier = scene("rapier", str(step))
    plant = scene("plant")
    print(f"step {step * 1e3} ms, {SECONDS} s simulated, one core, min of {RUNS} runs")
    print(f"{'':26}{'x real time':>12}{'part slid':>12}{'stack sunk':>12}")
    for each in (peer, rapier):
        print(
            f"{each['engine']:26}{each['realtime_factor']:12.1f}{each['slid_mm']:9.3f} mm{each['sunk_mm']:9.3f} mm"
        )
    print(f"{'the cell of this project':26}{plant['realtime_factor']:12.1f}   (pick, carry, clamp, seat; see README)")
    print(f"rapier / MuJoCo: {rapier['realtime_factor'] / peer['realtime_factor']:.2f}")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""How far parts are from where they should be: docs/cell.md "Achieved".

    pip install mcap mcap-protobuf-support
    cargo build --release && python3 benches/accuracy.py [--seeds 20] [JOB...]

Runs each job with the seeds 1 to 20. Prints the final distance of each part from its place. For a job that begins with a MOVE into
the vise, also prints the spread of the part's position in the vise before the jaw closes. Inches.
"""

import argparse
import json
import statistics
import subprocess
import tempfile
from pathlib import Path

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

ROOT = Path(__file__).resolve().parent.parent
JOBS = ["linkbar", "clevis", "turned-part", "tool-change"]
INTO_VISE = {"linkbar", "clevis"}
STILL = 20.0  # s that the jaw has stood still before it closes on a part


def run(program, job, seed, log):
    command = [program, job, "--seed", str(seed), "--log", log, "--json"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{job}, seed {seed}: {done.stderr.splitlines()[-1]}")
    return json.loads(done.stdout)


def before_closing(log):
    """Where the first part is, world, inches, when the jaw moves for the first time after a long rest."""
    jaw, moved, part = None, None, None
    with open(log, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, _, message, poses in reader.iter_decoded_messages(topics=["/tf"]):
            now = message.log_time / 1e9
            for pose in poses.transforms:
                at = (pose.translation.x, pose.translation.y, pose.translation.z)
                if pose.child_frame_id == "movable_jaw" and at != jaw:
                    if moved is not None and now - moved > STILL:
                        return [axis / 0.0254 for axis in part]
                    jaw, moved = at, now
                if pose.child_frame_id == "part_1" and pose.parent_frame_id == "world":
                    part = at
    raise SystemExit(f"{log}: the jaw does not close on a part")


def told(values):
    low, high = min(values), max(values)
    return f"{low:9.4f} to {high:8.4f}, standard deviation {statistics.pstdev(values):.4f}"


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--seeds", type=int, default=20)
    arguments.add_argument("--program", default=str(ROOT / "target/release/rcs-run"))
    arguments.add_argument("jobs", nargs="*", default=JOBS)
    given = arguments.parse_args()
    for job in given.jobs:
        errors, held = {}, []
        for seed in range(1, given.seeds + 1):
            with tempfile.TemporaryDirectory() as place:
                log = str(Path(place) / "run.mcap") if job in INTO_VISE else "none"
                result = run(given.program, job, seed, log)
                if job in INTO_VISE:
                    held.append(before_closing(log))
            for part in result["parts"]:
                errors.setdefault((part["name"], part["location"], part["sector"]), []).append(part["error_in"])
        for (name, location, sector), values in sorted(errors.items()):
            print(f"{job}: {name} at {location} {sector}, {len(values)} runs: {told(values)}", flush=True)
        for axis, values in zip("XYZ", zip(*held)):
            mean = statistics.fmean(values)
            print(f"{job}: in the vise before it closes, {axis} about {mean:.4f}: {told([v - mean for v in values])}")


if __name__ == "__main__":
    main()

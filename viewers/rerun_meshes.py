#!/usr/bin/env python3
"""Takes meshes, names, marks of contacts, camera pictures and rows of a log and writes them as a recording of Rerun.

    pip install rerun-sdk mcap mcap-protobuf-support
    python3 viewers/rerun_meshes.py runs/linkbar.mcap meshes.rrd

Rerun draws nothing of foxglove.SceneUpdate, and shows no rows of a message. viewers/rerun.sh merges the recording with the log
itself and opens both. A glTF file has Y up, a link has Z up: each mesh is turned by 90 degrees about X.
"""

import argparse
import math
from pathlib import Path

import numpy as np
import rerun as rr

import cell_log

WHITE = (255, 255, 255)
# The joints of the arm, from the base to the roll of the wrist.
ARM = ("base", "shoulder", "elbow", "pitch", "yaw", "roll")


def table(levels):
    """The ladder as a table in Markdown."""
    head = ["| process | command | status | row | step |", "|---|---|---|---|---|"]
    rows = [(it.process, it.command, it.status, f"{it.table} {it.row}" if it.row else "", it.step) for it in levels]
    return "\n".join(head + ["| " + " | ".join(cell.replace("|", "/") for cell in row) + " |" for row in rows])


def main():
    """Write the recording."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("--application", help="the name that the log is converted with; its own without .mcap if not given")
    parser.add_argument("--recording", required=True, help="the recording id that the log is converted with")
    arguments = parser.parse_args()
    log = cell_log.read(arguments.log)
    rr.init(arguments.application or arguments.log.stem, recording_id=arguments.recording)
    rr.save(str(arguments.output))
    upright = rr.RotationAxisAngle(axis=(1, 0, 0), degrees=90)
    for name, frame, data in log.models:
        path = f"meshes/{name}"
        rr.log(path, rr.CoordinateFrame(frame), static=True)
        rr.log(path, rr.InstancePoses3D(rotation_axis_angles=[upright]), static=True)
        rr.log(path, rr.Asset3D(contents=data, media_type="model/gltf-binary"), static=True)
    for number, label in enumerate(log.labels):
        path = f"names/{number}"
        rr.log(path, rr.CoordinateFrame(label.frame), static=True)
        point = rr.Points3D([label.position], labels=[label.text], colors=[WHITE], radii=[0.004])
        rr.log(path, point, static=True)
    rr.log("marks", rr.CoordinateFrame("world"), static=True)
    for time, marks in log.marks:
        rr.set_time("message_log_time", timestamp=np.datetime64(time, "ns"))
        balls = rr.Points3D(
            [mark.position for mark in marks],
            radii=[mark.diameter / 2 for mark in marks],
            colors=[mark.colour for mark in marks],
            labels=[mark.text for mark in marks],
        )
        rr.log("marks", balls)
    arm = [name for name in (log.joints[0][1] if log.joints else {}) if name in ARM]
    rr.log("joints", rr.SeriesLines(names=arm, widths=[1.5] * len(arm)), static=True)
    for time, positions in log.joints:
        rr.set_time("message_log_time", timestamp=np.datetime64(time, "ns"))
        rr.log("joints", rr.Scalars([math.degrees(positions[name]) for name in arm]))
    for time, data in log.pictures:
        rr.set_time("message_log_time", timestamp=np.datetime64(time, "ns"))
        rr.log("vision", rr.EncodedImage(contents=data, media_type="image/png"))
    for time, levels in log.levels:
        rr.set_time("message_log_time", timestamp=np.datetime64(time, "ns"))
        rr.log("rows", rr.TextDocument(table(levels), media_type=rr.MediaType.MARKDOWN))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Pictures moments of a run: cuts each out of its log and lets Rerun draw it, side by side and with captions.

    pip install rerun-sdk mcap mcap-protobuf-support pillow
    python3 viewers/moments.py runs/linkbar.mcap docs/linkbar.png \\
        "1296 parts_gripper at the blank" "1340 parts_gripper the blank is held"

A moment is a tick, the link that the eye looks at, and a caption. Needs a display, or
`xvfb-run -s '-screen 0 12000x8000x24'`: so large that the pointer, in its middle, hovers over nothing. viewers/moments.sh makes
the pictures of README.md and docs/cell.md.
"""

import argparse
import os
import re
import subprocess
import tempfile
from pathlib import Path

import rerun as rr
import rerun.blueprint as rrb
from mcap.reader import make_reader
from mcap.writer import Writer
from mcap_protobuf.decoder import DecoderFactory
from PIL import Image, ImageDraw, ImageFont

TICK = 40_000_000  # ns
MARGIN = (720, 160)  # of Rerun's window around a picture, pixels: what is not the cell


def turned(rotation, vector):
    """A vector turned by a quaternion."""
    x, y, z, w = rotation.x, rotation.y, rotation.z, rotation.w
    a, b, c = vector
    s, t, u = y * c - z * b + w * a, z * a - x * c + w * b, x * b - y * a + w * c
    return (a + 2 * (y * u - z * t), b + 2 * (z * s - x * u), c + 2 * (x * t - y * s))


def place(poses, link):
    """Where the origin of a link is in the world, metres."""
    point = (0.0, 0.0, 0.0)
    while link != "world":
        if link not in poses:
            raise SystemExit(f"the log has no pose of {link}; it has {', '.join(sorted(poses))}")
        pose, turn = poses[link], turned(poses[link].rotation, point)
        shift = pose.translation
        point = (turn[0] + shift.x, turn[1] + shift.y, turn[2] + shift.z)
        link = pose.parent_frame_id
    return point


def cut(log, tick, output):
    """Write the poses that hold in a tick, and the description of the cell, as a log of one moment. Returns the poses."""
    poses, sample = {}, None
    with open(log, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        start = reader.get_summary().statistics.message_start_time
        end = start + tick * TICK
        for schema, channel, message, decoded in reader.iter_decoded_messages(topics=["/tf"], ending_at=end):
            sample = (schema, channel, type(decoded))
            for pose in decoded.transforms:
                poses[pose.child_frame_id] = pose
        file.seek(0)
        kept = list(make_reader(file).iter_messages(topics=["/robot_description", "/tf_static"]))
    if sample is None:
        raise SystemExit(f"{log} has no poses before tick {tick}")
    schema, channel, kind = sample
    scene = kind()
    for pose in poses.values():
        copy = scene.transforms.add()
        copy.CopyFrom(pose)
        copy.timestamp.seconds, copy.timestamp.nanos = divmod(end, 10**9)
    with open(output, "wb") as file:
        writer = Writer(file)
        writer.start()
        for schema, channel, data in [(schema, channel, scene.SerializeToString())] + [
            (s, c, m.data) for s, c, m in kept
        ]:
            number = writer.register_schema(schema.name, schema.encoding, schema.data)
            encoding, metadata = channel.message_encoding, dict(channel.metadata)
            number = writer.register_channel(channel.topic, encoding, number, metadata)
            writer.add_message(number, log_time=end, publish_time=end, data=data)
        writer.finish()
    return poses


def solids(log):
    """Paths of all shapes of the cell, and how they are to be drawn: filled."""
    with open(log, "rb") as file:
        for _, _, message in make_reader(file).iter_messages(topics=["/robot_description"]):
            urdf = message.data.decode(errors="ignore")
            break
    robot = re.search(r'<robot name="([^"]*)"', urdf).group(1)
    shapes = {}
    for link, body in re.findall(r'<link name="([^"]*)">(.*?)</link>', urdf, re.DOTALL):
        for number, shape in enumerate(re.findall(r"<geometry><(\w+)", body)):
            path = rr.new_entity_path([robot, "visual_geometries", link, f"visual_{number}"])
            kind = {"box": rr.Boxes3D, "cylinder": rr.Cylinders3D}[shape]
            shapes[path] = kind.from_fields(fill_mode=rr.components.FillMode.Solid)
    return shapes


def blueprint(target, eye, shapes):
    """Nothing but the cell; `eye` is where it is seen from, relative to the target, metres."""
    view = rrb.Spatial3DView(
        origin="/",
        contents="/**",
        overrides=shapes,
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital,
            position=tuple(t + e for t, e in zip(target, eye)),
            look_target=target,
            eye_up=(0.0, 0.0, 1.0),
        ),
        spatial_information=rrb.SpatialInformation(target_frame="world"),
    )
    return rrb.Blueprint(view, collapse_panels=True, auto_views=False, auto_layout=False)


def rerun(*arguments):
    """Run a command of Rerun; what it says is said only if it fails."""
    done = subprocess.run(
        ["rerun", *map(str, arguments)], capture_output=True, text=True, env=dict(os.environ, RERUN_ANALYTICS="0")
    )
    if done.returncode != 0:
        raise SystemExit(f"rerun {arguments[0]}: {done.stderr}")


def picture(log, moment, eye, size, folder):
    """One moment as an image."""
    tick, link, caption = moment.split(maxsplit=2)
    name = folder / f"moment-{tick}.mcap"
    poses = cut(log, int(tick), name)
    scene, view, shot = name.with_suffix(".rrd"), folder / "view.rbl", folder / "shot.png"
    rerun("mcap", "convert", name, "--output", scene, "--application-id", "moment")
    blueprint(place(poses, link), eye, solids(log)).save("moment", str(view))
    both = folder / "both.rrd"
    rerun("rrd", "merge", view, scene, "--output", both)
    rerun(both, "--window-size", f"{size[0] + MARGIN[0]}x{size[1] + MARGIN[1]}", "--screenshot-to", shot)
    image = Image.open(shot).convert("RGB")
    left, top = (image.width - size[0]) // 2, (image.height - size[1]) // 2
    image = image.crop((left, top, left + size[0], top + size[1]))
    draw = ImageDraw.Draw(image)
    text = f"{int(tick) * 0.04:.1f} s: {caption}"
    draw.rectangle((0, size[1] - 34, size[0], size[1]), fill=(20, 20, 20))
    draw.text((10, size[1] - 29), text, fill=(255, 255, 255), font=ImageFont.load_default(20))
    return image


def main():
    """Picture the moments, and put them beside each other."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("moments", nargs="+", metavar="'TICK LINK CAPTION'")
    parser.add_argument("--columns", type=int, default=3)
    parser.add_argument("--eye", nargs=3, type=float, default=(0.55, -1.25, 0.7), help="metres from the link")
    parser.add_argument("--size", nargs=2, type=int, default=(640, 560), help="pixels of a picture")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        images = [picture(arguments.log, moment, arguments.eye, arguments.size, Path(folder)) for moment in arguments.moments]
    columns = min(arguments.columns, len(images))
    rows = -(-len(images) // columns)
    width, height = arguments.size
    sheet = Image.new("RGB", (columns * width, rows * height), (20, 20, 20))
    for number, image in enumerate(images):
        sheet.paste(image, (number % columns * width, number // columns * height))
    sheet.quantize(64).save(arguments.output, optimize=True)


if __name__ == "__main__":
    main()

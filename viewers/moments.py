#!/usr/bin/env python3
"""Pictures moments of a run as film.py draws them, side by side and with captions.

    pip install bpy mcap mcap-protobuf-support pillow
    python3 viewers/moments.py runs/linkbar.mcap docs/linkbar.png \\
        "1296 parts_gripper at the blank" "1340 parts_gripper the blank is held"

A moment is a tick, the link that the eye looks at, and a caption. viewers/moments.sh makes the pictures of docs/cell.md. A
picture takes about five CPU seconds.
"""

import argparse
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

import cell_log
import film

FOOT = 26  # pixels


def moment(studio, text, eye, size, folder):
    """One moment as an image."""
    tick, link, words = text.split(maxsplit=2)
    if link not in studio.log.moves:
        raise SystemExit(f"the log has no link {link}; it has {', '.join(sorted(studio.log.moves))}")
    tick = int(tick)
    studio.show(tick)
    target = film.matrix(studio.log, link, tick).translation
    film.aim(studio.close, target + film.Vector(eye), target)
    image = studio.picture(studio.close, size, Path(folder, "moment.png"))
    draw = ImageDraw.Draw(image)
    draw.rectangle((0, size[1] - FOOT, size[0], size[1]), fill=film.INK)
    caption = f"{tick * cell_log.TICK / 1e9:.1f} s: {words}"
    draw.text((10, size[1] - FOOT // 2), caption, fill=film.PAPER, font=ImageFont.load_default(13), anchor="lm")
    return image


def main():
    """Picture the moments, and put them beside each other."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("moments", nargs="+", metavar="'TICK LINK CAPTION'")
    parser.add_argument("--columns", type=int, default=3)
    parser.add_argument("--eye", nargs=3, type=float, default=(0.35, -0.95, 0.55), help="metres from the link")
    parser.add_argument("--size", nargs=2, type=int, default=(350, 300), help="pixels of a picture")
    parser.add_argument("--samples", type=int, default=8, help="of each pixel; noise is filtered out")
    arguments = parser.parse_args()
    studio = film.Studio(cell_log.read(arguments.log), arguments.samples)
    size = tuple(arguments.size)
    with tempfile.TemporaryDirectory() as folder:
        images = [moment(studio, text, arguments.eye, size, folder) for text in arguments.moments]
    columns = min(arguments.columns, len(images))
    rows = -(-len(images) // columns)
    sheet = Image.new("RGB", (columns * size[0], rows * size[1]), film.INK)
    for number, image in enumerate(images):
        sheet.paste(image, (number % columns * size[0], number // columns * size[1]))
    film.save(sheet, arguments.output)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Films a run: draws the cell from its log with Cycles, with the commands as captions.

    pip install bpy mcap mcap-protobuf-support pillow
    python3 viewers/film.py runs/linkbar.mcap docs/linkbar.webp
    python3 viewers/film.py runs/linkbar.mcap docs/cell.png --tick 2490

Without --tick the film takes the moments of data/jobs/linkbar.job. A frame takes about five seconds on two cores. --folder
keeps the frames; frames that are there are not drawn again.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

import bpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Matrix, Quaternion, Vector
from PIL import Image, ImageDraw, ImageFont

import cell_log

# From tick, to tick, pictures: what the film shows of the linkbar, slowly where something happens.
STORY = [
    (90, 610, 11),
    (610, 770, 4),
    (780, 1296, 9),
    (1298, 1344, 6),
    (1350, 2500, 20),
    (2505, 2548, 6),
    (2700, 3427, 6),
    (3460, 3890, 5),
    (3905, 4500, 7),
    (4500, 4530, 3),
    (4540, 5468, 13),
    (5470, 5515, 5),
    (5520, 5800, 3),
]
RATE = 10  # pictures a second
EYE, TARGET, LENS = (0.55, -4.9, 1.30), (0.21, -0.35, -0.23), 28.0
# Eyes near by, from the tool point, for the picture in the picture: for a gripper that points down, and for one that is level.
NEAR = (Vector((-0.24, -0.44, 0.20)), Vector((0.05, -0.28, 0.42)))
INK, PAPER = (24, 30, 36), (250, 250, 248)


def matrix(log, frame, tick):
    """Where a frame is in the world."""
    place = Matrix.Identity(4)
    while frame != "world":
        pose = log.pose(frame, tick)
        place = Matrix.Translation(pose.position) @ Quaternion(pose.rotation).to_matrix().to_4x4() @ place
        frame = pose.parent
    return place


def aim(thing, eye, target):
    """Put a camera or a lamp somewhere and turn it to a target."""
    thing.location = eye
    thing.rotation_mode = "QUATERNION"
    thing.rotation_quaternion = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y")


class Studio:
    """The cell, lamps and two cameras in Blender."""

    def __init__(self, log, samples):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.log, self.scene, self.things = log, bpy.context.scene, []
        with tempfile.TemporaryDirectory() as folder:
            for name, frame, data in log.models:
                path = Path(folder, "model.glb")
                path.write_bytes(data)
                bpy.ops.import_scene.gltf(filepath=str(path))
                for thing in bpy.context.selected_objects:
                    self.things.append((thing, frame, thing.matrix_world.copy()))
        self.ground()
        self.lamp((-2.8, -4.6, 4.6), (0.0, -0.6, -0.8), 2.0, 560.0, (1.0, 0.95, 0.88))
        self.lamp((4.2, -4.0, 3.6), (0.4, -0.6, -0.6), 3.0, 190.0, (0.86, 0.93, 1.0))
        self.lamp((-0.5, 3.4, 4.6), (0.0, -0.2, -0.4), 3.0, 260.0, (1.0, 1.0, 1.0))
        world = bpy.data.worlds.new("world")
        self.scene.world = world
        world.use_nodes = True
        sky = world.node_tree.nodes["Background"]
        sky.inputs[0].default_value, sky.inputs[1].default_value = (0.80, 0.86, 0.93, 1.0), 0.85
        self.wide, self.close = self.camera(LENS), self.camera(42.0)
        aim(self.wide, EYE, TARGET)
        render, cycles = self.scene.render, self.scene.cycles
        render.engine, render.use_persistent_data = "CYCLES", True
        render.image_settings.file_format = "PNG"
        cycles.samples, cycles.use_denoising, cycles.seed = samples, True, 1
        cycles.denoising_quality, cycles.denoising_prefilter = "FAST", "NONE"
        cycles.max_bounces, cycles.diffuse_bounces, cycles.glossy_bounces = 4, 2, 2
        self.scene.view_settings.view_transform = "AgX"
        self.scene.view_settings.look = "AgX - Punchy"
        self.scene.view_settings.exposure = 0.35

    def ground(self):
        """A floor beyond the cell's own."""
        bpy.ops.mesh.primitive_plane_add(size=60.0, location=(0.0, 0.0, -1.31))
        paint = bpy.data.materials.new("ground")
        paint.use_nodes = True
        paint.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.62, 0.65, 0.68, 1.0)
        bpy.context.object.data.materials.append(paint)

    def lamp(self, place, target, size, power, colour):
        """A large lamp: its shadows are soft."""
        lamp = bpy.data.lights.new("lamp", "AREA")
        lamp.size, lamp.energy, lamp.color = size, power, colour
        thing = bpy.data.objects.new("lamp", lamp)
        self.scene.collection.objects.link(thing)
        aim(thing, place, target)

    def camera(self, lens):
        """A camera."""
        thing = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        thing.data.lens, thing.data.clip_start = lens, 0.02
        self.scene.collection.objects.link(thing)
        return thing

    def show(self, tick):
        """Put everything where it is in a tick; a part that is not yet there is out of sight."""
        for thing, frame, own in self.things:
            place = matrix(self.log, frame, tick)
            thing.matrix_world = place @ own
            thing.hide_render = frame.startswith("part_") and place.translation.length < 1e-3
        tool = matrix(self.log, "quick_change", tick)
        level = 1.0 - min(max(-tool.col[0].z, 0.0), 1.0)
        aim(self.close, tool.translation + NEAR[0].lerp(NEAR[1], level), tool.translation)

    def picture(self, camera, size, path):
        """Draw what a camera sees."""
        render = self.scene.render
        self.scene.camera = camera
        render.resolution_x, render.resolution_y = size
        render.filepath = str(path)
        bpy.ops.render.render(write_still=True)
        return Image.open(path).convert("RGB")

    def tags(self, tick, size):
        """Names and where they are in the wide picture."""
        self.scene.camera = self.wide
        for label in self.log.labels:
            point = matrix(self.log, label.frame, tick) @ Vector(label.position)
            x, y, depth = world_to_camera_view(self.scene, self.wide, point)
            if depth > 0:
                yield label.text, (x * size[0], (1 - y) * size[1])


def rounded(size, radius):
    """A mask with round corners."""
    mask = Image.new("L", size, 0)
    ImageDraw.Draw(mask).rounded_rectangle((0, 0, size[0] - 1, size[1] - 1), radius, fill=255)
    return mask


def caption(image, studio, tick, scale):
    """Names beside the things, the commands and the time at the foot."""
    log, (width, height) = studio.log, image.size
    draw = ImageDraw.Draw(image, "RGBA")
    small, large = ImageFont.load_default(12 * scale), ImageFont.load_default(17 * scale)
    for text, (x, y) in studio.tags(tick, image.size):
        box = draw.textbbox((x, y), text, font=small, anchor="mm")
        if box[0] > 4 and box[2] < width - 4 and box[1] > 4:
            pad = (box[0] - 5 * scale, box[1] - 3 * scale, box[2] + 5 * scale, box[3] + 3 * scale)
            draw.rounded_rectangle(pad, 4 * scale, fill=(*PAPER, 190))
            draw.text((x, y), text, font=small, anchor="mm", fill=INK)
    foot = 52 * scale
    draw.rectangle((0, height - foot, width, height), fill=(*INK, 235))
    order, step = log.order(tick), log.command(tick, "E-move")
    word, _, rest = step.partition(" ")
    left, middle = 14 * scale, height - foot + 19 * scale
    draw.text((left, middle), word, font=large, anchor="lm", fill=(255, 176, 92))
    draw.text((left + draw.textlength(word + "  ", large), middle), rest, font=large, anchor="lm", fill=PAPER)
    below = f"{order}   {tick * 0.04:.0f} s" if order else f"{tick * 0.04:.0f} s"
    draw.text((left, height - 13 * scale), below, font=small, anchor="lm", fill=(170, 182, 192))


def save(image, path):
    """Save a picture with 128 colours, in a fifth of the bytes."""
    image.quantize(128, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(path, optimize=True)


def frame(studio, tick, size, folder, scale=1):
    """A picture of a tick: the cell, the gripper near by, captions."""
    studio.show(tick)
    image = studio.picture(studio.wide, size, Path(folder, "wide.png"))
    inset = (round(size[0] * 0.235), round(size[0] * 0.235))
    near = studio.picture(studio.close, inset, Path(folder, "close.png"))
    margin = 12 * scale
    corner = (margin, margin)
    edge = 3 * scale
    border = Image.new("RGB", (inset[0] + 2 * edge, inset[1] + 2 * edge), PAPER)
    image.paste(border, (corner[0] - edge, corner[1] - edge), rounded(border.size, 12 * scale))
    image.paste(near, corner, rounded(inset, 10 * scale))
    caption(image, studio, tick, scale)
    return image


def main():
    """Draw a film or a picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", type=Path)
    parser.add_argument("output", type=Path)
    parser.add_argument("--tick", type=int, help="one picture instead of a film")
    parser.add_argument("--size", type=int, nargs=2, default=(720, 450), help="pixels")
    parser.add_argument("--samples", type=int, default=4, help="of each pixel; noise is filtered out")
    parser.add_argument("--quality", type=int, default=62, help="of the film, up to 100")
    parser.add_argument("--folder", type=Path, help="where the frames of the film are kept")
    arguments = parser.parse_args()
    studio = Studio(cell_log.read(arguments.log), arguments.samples)
    size = tuple(arguments.size)
    with tempfile.TemporaryDirectory() as scratch:
        if arguments.tick is not None:
            image = frame(studio, arguments.tick, size, scratch, max(1, round(size[0] / 800)))
            save(image, arguments.output)
            return
        folder = arguments.folder or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        frames = []
        for start, end, number in STORY:
            for tick in (start + (end - start) * n // number for n in range(number)):
                path = folder / f"{tick:06}.png"
                if not path.exists():
                    frame(studio, tick, size, scratch).save(path)
                frames.append(Image.open(path))
        frames[0].save(
            arguments.output, save_all=True, append_images=frames[1:], duration=1000 // RATE, loop=0,
            quality=arguments.quality, method=6,
        )  # fmt: skip


if __name__ == "__main__":
    sys.path.insert(0, os.path.dirname(__file__))
    main()

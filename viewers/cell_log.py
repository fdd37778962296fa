"""What the scripts of this directory read of a log: looks, names, poses, commands.

    pip install mcap mcap-protobuf-support
"""

import bisect
import re
import struct
from dataclasses import dataclass, field

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

TICK = 40_000_000  # ns


@dataclass
class Pose:
    """A frame in its parent: metres, and a unit quaternion w, x, y, z."""

    parent: str
    position: tuple
    rotation: tuple


@dataclass
class Label:
    """A name beside a thing: metres, in a frame."""

    text: str
    frame: str
    position: tuple


@dataclass
class Mark:
    """A ball where things touch: metres in the world, its colour from 0 to 1 each, and which things."""

    position: tuple
    diameter: float
    colour: tuple
    text: str


@dataclass
class CellLog:
    """A log in memory."""

    start: int = 0  # ns
    ticks: int = 0
    models: list = field(default_factory=list)  # (name, frame, GLB file)
    labels: list = field(default_factory=list)
    moves: dict = field(default_factory=dict)  # frame: ([tick], [Pose])
    lines: list = field(default_factory=list)  # (tick, source, text)
    marks: list = field(default_factory=list)  # (ns, [Mark]): those that there are from then on
    pictures: list = field(default_factory=list)  # (ns, PNG file): what the wrist camera saw
    joints: list = field(default_factory=list)  # (ns, {name: position}): radians
    levels: list = field(default_factory=list)  # (ns, [processes]): the ladder from then on

    def pose(self, frame, tick):
        """The pose of a frame in its parent as it holds in a tick."""
        ticks, poses = self.moves[frame]
        return poses[max(bisect.bisect_right(ticks, tick) - 1, 0)]

    def command(self, tick, receiver):
        """The last command that a process was given until a tick, as text."""
        mark = f"-> {receiver}: "
        found = [text for at, _, text in self.lines if at <= tick and text.startswith(mark)]
        return found[-1].removeprefix(mark) if found else ""

    def order(self, tick):
        """The last command of the workstation until a tick, as text."""
        found = [text for at, source, text in self.lines if at <= tick and re.match(r"command \d+: [A-Z]+ [A-Z]", text)]
        return found[-1].partition(": ")[2] if found else ""


def triple(vector):
    """x, y, z of a message."""
    return (vector.x, vector.y, vector.z)


def mark(text, ball):
    """A mark of a contact."""
    colour = (ball.color.r, ball.color.g, ball.color.b)
    return Mark(triple(ball.pose.position), ball.size.x, colour, text)


def joint_state(data):
    """Names and positions of a sensor_msgs/JointState in little-endian CDR."""
    body, at = data[4:], 8  # after the time stamp

    def number():
        nonlocal at
        at = (at + 3) // 4 * 4
        (value,) = struct.unpack_from("<I", body, at)
        at += 4
        return value

    def text():
        nonlocal at
        length = number()
        at += length
        return body[at - length : at - 1].decode()

    text()  # the frame
    names = [text() for _ in range(number())]
    count = number()
    at = (at + 7) // 8 * 8
    return dict(zip(names, struct.unpack_from(f"<{count}d", body, at)))


def read(path):
    """Read a log that `rcs-run` wrote."""
    log = CellLog()
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        statistics = reader.get_summary().statistics
        log.start = statistics.message_start_time
        log.ticks = (statistics.message_end_time - log.start) // TICK
        joints = reader.iter_messages(topics=["/joint_states"])
        log.joints = [(message.log_time, joint_state(message.data)) for _, _, message in joints]
        topics = ["/meshes", "/names", "/tf", "/tf_static", "/log", "/contacts", "/camera", "/ladder"]
        for _, channel, message, decoded in reader.iter_decoded_messages(topics=topics):
            tick = (message.log_time - log.start) // TICK
            if channel.topic == "/log":
                log.lines.append((tick, decoded.name, decoded.message))
            elif channel.topic == "/camera":
                log.pictures.append((message.log_time, decoded.data))
            elif channel.topic == "/ladder":
                log.levels.append((message.log_time, list(decoded.processes)))
            elif channel.topic == "/contacts":
                balls = [(e.id, e.spheres[0]) for e in decoded.entities if e.spheres]
                log.marks.append((message.log_time, [mark(text, ball) for text, ball in balls]))
            elif channel.topic == "/meshes":
                log.models += [(e.id, e.frame_id, e.models[0].data) for e in decoded.entities]
            elif channel.topic == "/names":
                texts = [(e.frame_id, e.texts[0]) for e in decoded.entities]
                log.labels += [Label(t.text, frame, triple(t.pose.position)) for frame, t in texts]
            else:
                for move in decoded.transforms:
                    turn = move.rotation
                    pose = Pose(move.parent_frame_id, triple(move.translation), (turn.w, *triple(turn)))
                    ticks, poses = log.moves.setdefault(move.child_frame_id, ([], []))
                    ticks.append(tick)
                    poses.append(pose)
    if not log.models:
        raise SystemExit(f"{path} has no meshes on /meshes: it is older than them, or of a run without a cell")
    return log

#!/usr/bin/env python3
"""Opens a log, or a live view, with foxglove.json in a Lichtblick, and a log in Rerun; fails if something is not shown.

    pip install websockets pillow
    python3 viewers/check.py runs/linkbar.mcap --lichtblick DIRECTORY --pictures shots
    python3 viewers/check.py ws://127.0.0.1:8765 --lichtblick DIRECTORY --port 8080     # rcs-run --live-origin http://127.0.0.1:8080
    python3 viewers/check.py runs/linkbar.mcap --rerun --pictures shots                 # needs rerun.sh's packages, and xvfb-run

DIRECTORY is a web build of Lichtblick: the directory with its index.html. It is served on 127.0.0.1 and opened in a headless
Chromium. The log plays, each tab is clicked, and within --patience seconds

* no panel is unknown, in error, or waits for a message,
* the robot is visible in each 3D panel and in Rerun: its castings alone are orange,
* each plot and each panel of state transitions has curves, the picture of the camera is there, the log has lines.

Exit status 1 and a line for each panel that fails.
"""

import argparse
import datetime
import json
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.parse
from pathlib import Path

from PIL import Image

import devtools

HERE = Path(__file__).resolve().parent
SIZE = (1600, 1000)
# A run in fast clock begins then. In this tick of the linkbar the fingers close on the blank: there are marks of contacts, and
# lines of the log.
EPOCH, TICK_S, TICK = datetime.datetime(1987, 12, 16, tzinfo=datetime.timezone.utc), 0.04, 1322
# Shares of the pixels of a panel. An empty plot has none; one whose log is still being loaded, 0.003.
ROBOT, CURVE, PICTURE = 0.004, 0.0015, 0.02

PANEL = """(() => {
  const found = document.querySelector(`[data-testid~="${ID}"]`);
  if (!found) return null;
  const box = element => { const {x, y, width, height} = element.getBoundingClientRect(); return [x, y, width, height]; };
  const canvas = [...found.querySelectorAll("canvas")].map(box).sort((a, b) => b[2] * b[3] - a[2] * a[3])[0];
  return {text: found.innerText, canvas: canvas ?? null};
})()"""
# The middle of a thing to click, by what it says when the pointer rests on it.
THING = """(() => {
  const found = document.querySelector(`[title="${TITLE}"]`);
  if (!found) return null;
  const {x, y, width, height} = found.getBoundingClientRect();
  return [x + width / 2, y + height / 2];
})()"""


def share(image, accept):
    """The share of the pixels that a test of hue, saturation and value (0 to 255 each) accepts."""
    colours = image.convert("HSV").getcolors(image.width * image.height)
    return sum(count for count, colour in colours if accept(*colour)) / (image.width * image.height)


def is_orange(hue, saturation, value):
    """The colour of the robot's castings, in light and in shade."""
    return 8 <= hue <= 24 and saturation > 150 and value > 90


def is_coloured(_hue, saturation, value):
    """No grey."""
    return saturation > 90 and value > 60


def panels(part):
    """The panels that a part of a layout shows."""
    if isinstance(part, str):
        return [part]
    return panels(part["first"]) + panels(part["second"])


def fault(panel, shown, picture):
    """What is wrong with a panel, in words; None if nothing is. `shown` is the page's answer to PANEL."""
    kind = panel.partition("!")[0]
    if shown is None:
        return "is not shown"
    text = shown["text"]
    for wrong in ("Unknown panel type", "unexpected error", "Waiting for next message", "Waiting for messages"):
        if wrong in text:
            return f"says {text[text.index(wrong):].splitlines()[0]!r}"
    if kind == "RosOut":
        return None if re.search(r"\[(INFO|WARN|ERROR)\]|->", text) else "has no lines"
    if kind == "RawMessages":
        return None if re.search(r"^(state|row|table|phase|stage|source)", text, re.MULTILINE) else f"has no message: {text!r}"
    if kind == "Table":
        return None if "E-move" in text else f"has no row of E-move: {text!r}"
    if shown["canvas"] is None:
        return "draws nothing"
    x, y, width, height = map(round, shown["canvas"])
    seen = picture.crop((x, y, x + width, y + height))
    test, least, missing = {
        "3D": (is_orange, ROBOT, "the robot is not visible"),
        "Image": (lambda h, s, v: v > 40, PICTURE, "there is no picture"),
    }.get(kind, (is_coloured, CURVE, "there are no curves"))
    part = share(seen, test)
    return None if part >= least else f"{missing}: {part:.2%} of its pixels, {least:.2%} expected"


def lichtblick(arguments, layout):
    """Open the source in Lichtblick and look at each tab. Returns what is wrong."""
    more, is_live = {}, arguments.source.startswith("ws://")
    if not is_live:
        more["/log.mcap"] = Path(arguments.source).resolve()
    address = devtools.serve(arguments.lichtblick, more, arguments.port)
    if is_live:
        query = {"ds": "foxglove-websocket", "ds.url": arguments.source}
    else:
        start = EPOCH + datetime.timedelta(seconds=arguments.tick * TICK_S)
        begin = start.isoformat(timespec="milliseconds").replace("+00:00", "Z")
        query = {"ds": "remote-file", "ds.url": f"{address}/log.mcap", "time": begin}
    page = devtools.Page(arguments.chromium, arguments.size)
    try:
        page.open(
            f"{address}/?{urllib.parse.urlencode(query)}",
            # The page sets it to nothing itself, for who serves it to fill in.
            f'Object.defineProperty(globalThis, "LICHTBLICK_SUITE_DEFAULT_LAYOUT", {{value: {json.dumps(layout)}}});',
        )
        always, tabs = parts(layout)
        if not wait(page, tabs[0]["title"], arguments.patience):
            return [f"Lichtblick: the layout is not shown within {arguments.patience:.0f} s"]
        # The key hides the side bar, which takes a fifth of the width.
        key(page, "[", "BracketLeft")
        faults = look(arguments, page, "with the log open", always)
        if not is_live:
            key(page, " ", "Space")  # plays the log
        for tab in tabs:
            # A click into the tab that is shown would edit its name.
            if tab is not tabs[0]:
                page.click(*wait(page, tab["title"], arguments.patience))
            faults += look(arguments, page, tab["title"], always + panels(tab["layout"]))
        return faults
    finally:
        page.close()


def parts(layout):
    """The panels of a layout that are always shown, and its tabs."""
    shown = panels(layout["layout"])
    tabs = [layout["configById"][panel]["tabs"] for panel in shown if panel.startswith("Tab!")]
    return [panel for panel in shown if not panel.startswith("Tab!")], tabs[0]


def key(page, text, code):
    """Press a key."""
    page.call("Input.dispatchKeyEvent", type="keyDown", key=text, code=code, text=text)
    page.call("Input.dispatchKeyEvent", type="keyUp", key=text, code=code)


def wait(page, title, patience):
    """Wait for a thing to click on. Returns its middle, pixels; None if patience ends."""
    end, place = time.monotonic() + patience, None
    while place is None and time.monotonic() < end:
        time.sleep(0.5)
        place = page.ask(THING.replace("${TITLE}", title))
    return place


def look(arguments, page, name, wanted):
    """Look at panels until nothing is wrong or patience ends. Returns what is wrong."""
    end, wrong = time.monotonic() + arguments.patience, {}
    while True:
        time.sleep(3.0)
        # The places of the panels first: a panel that appears later must not be looked for in an older picture.
        shown = {panel: page.ask(PANEL.replace("${ID}", panel)) for panel in wanted}
        picture = page.picture()
        found = {panel: fault(panel, shown[panel], picture) for panel in wanted}
        wrong = {panel: text for panel, text in found.items() if text}
        if not wrong or time.monotonic() > end:
            break
    if arguments.pictures:
        picture.save(arguments.pictures / f"lichtblick-{name.lower().replace(' ', '-')}.png")
    print(f"Lichtblick, {name}: {len(wanted)} panels, {len(wrong)} not as they should be", flush=True)
    return [f"Lichtblick, {name}, {panel} {text}" for panel, text in wrong.items()]


def rerun(arguments):
    """Open the log in Rerun, with rerun.sh or the command of the last lines of a run. Returns what is wrong."""
    screen = f"-screen 0 {arguments.size[0] + 100}x{arguments.size[1] + 100}x24"
    window = shutil.which("xvfb-run") and ["xvfb-run", "--auto-servernum", "--server-args", screen] or []
    with tempfile.TemporaryDirectory() as folder:
        shot = Path(folder, "shot.png")
        options = ["--window-size", "x".join(map(str, arguments.size)), "--screenshot-to", str(shot)]
        command = shlex.split(arguments.command) if arguments.command else [str(HERE / "rerun.sh"), arguments.source]
        done = subprocess.run([*window, *command, *options], capture_output=True, text=True, check=False)
        if not shot.exists():
            return [f"Rerun ends without a picture: {done.stderr[-400:]}"]
        picture = Image.open(shot).convert("RGB")
    if arguments.pictures:
        picture.save(arguments.pictures / "rerun.png")
    left, right = picture.width * 3 // 5, picture.height // 2
    cell, curves = picture.crop((0, 0, left, picture.height)), picture.crop((left, 0, picture.width, right))
    robot, lines = share(cell, is_orange), share(curves, is_coloured)
    print(f"Rerun: {robot:.2%} of the cell are the robot, {lines:.2%} of the plot are curves")
    wrong = ["Rerun, the robot is not visible"] if robot < ROBOT else []
    return wrong + (["Rerun, there are no curves"] if lines < CURVE else [])


def main():
    """Look, and say what is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", help="a log, or the address of a live view, ws://...")
    parser.add_argument("--lichtblick", type=Path, help="the directory of a web build")
    parser.add_argument("--rerun", action="store_true", help="open the log in Rerun too")
    parser.add_argument("--command", help="the command that opens the log in Rerun, as a run prints it")
    parser.add_argument("--layout", type=Path, default=HERE / "foxglove.json")
    parser.add_argument("--chromium", default="chromium", help="the program")
    parser.add_argument("--port", type=int, default=0, help="of the pages; a live view must be told with --live-origin")
    parser.add_argument("--tick", type=int, default=TICK, help="where the log begins to play")
    parser.add_argument("--size", type=int, nargs=2, default=SIZE, help="pixels")
    parser.add_argument("--patience", type=float, default=120.0, help="seconds for each tab")
    parser.add_argument("--pictures", type=Path, help="where pictures are put")
    arguments = parser.parse_args()
    if arguments.lichtblick is None and not arguments.rerun:
        parser.error("nothing to do: give --lichtblick DIRECTORY, --rerun or both")
    if arguments.lichtblick and not (arguments.lichtblick / "index.html").is_file():
        parser.error(f"{arguments.lichtblick} has no index.html: the directory of a web build of Lichtblick is expected")
    if arguments.pictures:
        arguments.pictures.mkdir(parents=True, exist_ok=True)
    faults = []
    if arguments.lichtblick:
        faults += lichtblick(arguments, json.loads(arguments.layout.read_text(encoding="utf-8")))
    if arguments.rerun:
        faults += rerun(arguments)
    sys.exit("\n".join(faults) or None)


if __name__ == "__main__":
    main()

"""A headless Chromium, spoken to through its DevTools protocol, and a web server for what it opens.

    pip install websockets pillow
"""

import base64
import contextlib
import functools
import http.server
import io
import json
import os
import re
import subprocess
import tempfile
import threading
import time
import urllib.request
from pathlib import Path

from PIL import Image
from websockets.sync.client import connect

# WebGL without a graphics card; no requests to the maker's servers.
FLAGS = (
    "--headless=new --use-angle=swiftshader --enable-unsafe-swiftshader --ignore-gpu-blocklist --hide-scrollbars "
    "--no-first-run --disable-background-networking --disable-component-update --disable-sync --remote-debugging-port=0"
).split()
PATIENCE = 60.0  # s, for Chromium to start and for an answer


class Files(http.server.SimpleHTTPRequestHandler):
    """The files of a directory, and more of other places by name; parts of files, as readers of logs ask for them."""

    def __init__(self, *arguments, more, **keywords):
        self.more = more
        super().__init__(*arguments, **keywords)

    def translate_path(self, path):
        """The file that is asked for."""
        known = self.more.get(path.partition("?")[0])
        return str(known) if known else super().translate_path(path)

    def send_head(self):
        """Answer a request for a part of a file; others are answered as usual."""
        part = re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", ""))
        path = Path(self.translate_path(self.path))
        if part is None or not path.is_file():
            return super().send_head()
        size = path.stat().st_size
        first, last = int(part[1]), min(int(part[2] or size - 1), size - 1)
        with open(path, "rb") as file:
            file.seek(first)
            data = file.read(max(last + 1 - first, 0))
        self.send_response(206)
        self.send_header("Content-Range", f"bytes {first}-{last}/{size}")
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        return io.BytesIO(data)

    def end_headers(self):
        """Say that parts can be had."""
        self.send_header("Accept-Ranges", "bytes")
        super().end_headers()

    def copyfile(self, source, outputfile):
        """Send a file; a page that is closed takes no more."""
        with contextlib.suppress(ConnectionError):
            super().copyfile(source, outputfile)

    def log_message(self, *_):
        """Requests are not told."""


def serve(directory, more, port=0):
    """Serve a directory, and files by path, on 127.0.0.1. Returns the address, as `http://127.0.0.1:1234`."""
    handler = functools.partial(Files, directory=str(directory), more=more)
    server = http.server.ThreadingHTTPServer(("127.0.0.1", port), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}"


class Page:
    """A page in a Chromium of its own."""

    def __init__(self, program, size):
        self.folder = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        flags = [*FLAGS, f"--window-size={size[0]},{size[1]}", f"--user-data-dir={self.folder.name}"]
        if os.geteuid() == 0:
            flags.append("--no-sandbox")
        self.browser = subprocess.Popen([program, *flags, "about:blank"], stderr=subprocess.DEVNULL)
        self.socket, self.number = connect(self.address(), max_size=None, open_timeout=PATIENCE), 0
        width, height = size
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def address(self):
        """Where the page is spoken to."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            try:
                port = Path(self.folder.name, "DevToolsActivePort").read_text(encoding="ascii").splitlines()[0]
                with urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list") as answer:
                    return next(page["webSocketDebuggerUrl"] for page in json.load(answer) if page["type"] == "page")
            except (OSError, IndexError, StopIteration):
                time.sleep(0.2)
        raise SystemExit(f"Chromium did not open its DevTools port within {PATIENCE:.0f} s")

    def call(self, method, **parameters):
        """Call a method of the protocol."""
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self.socket.recv(timeout=PATIENCE))
            if message.get("id") == self.number:
                if "error" in message:
                    raise SystemExit(f"Chromium refuses {method}: {message['error']['message']}")
                return message["result"]

    def open(self, url, before=""):
        """Open an address; a script runs before those of the page."""
        self.call("Page.enable")
        self.call("Page.addScriptToEvaluateOnNewDocument", source=before)
        self.call("Page.navigate", url=url)

    def ask(self, expression):
        """The value of an expression of JavaScript."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        if "exceptionDetails" in answer:
            raise SystemExit(f"{expression}: {answer['exceptionDetails']['exception'].get('description')}")
        return answer["result"].get("value")

    def click(self, x, y):
        """Click somewhere, pixels."""
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def picture(self):
        """What the page looks like."""
        data = base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
        return Image.open(io.BytesIO(data)).convert("RGB")

    def close(self):
        """End the browser."""
        self.socket.close()
        self.browser.terminate()
        self.browser.wait()
        self.folder.cleanup()

# SPDX-License-Identifier: BSD-3-Clause
"""A browser without a screen, told what to do by the DevTools protocol over a pipe; and its screenshots as pixels."""
import base64
import io
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time

import PIL.Image

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--hide-scrollbars",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-extensions",
         "--disable-dev-shm-usage", "--remote-debugging-pipe"]
PATIENCE = 120  # s; only matters where something is wrong


def find():
    """The path of a browser that is installed, or None."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Pixels:
    """A picture as pixels (r, g, b). A box is (left, top, right, bottom)."""

    def __init__(self, data):
        self.image = PIL.Image.open(io.BytesIO(data)).convert("RGB")

    def within(self, box):
        left, top, right, bottom = box or (0, 0, *self.image.size)
        shown = self.image.crop((max(0, left), max(0, top), min(self.image.width, right), min(self.image.height, bottom)))
        return zip(*[iter(shown.tobytes())] * 3)

    def count(self, colour, tolerance=12, box=None):
        """Pixels of about that colour."""
        return sum(all(abs(a - b) <= tolerance for a, b in zip(pixel, colour)) for pixel in self.within(box))

    def differing(self, other, box):
        return sum(a != b for a, b in zip(self.within(box), other.within(box)))


class Page:
    """One page of a browser. Use as a context: it ends the browser."""

    def __init__(self, address, width=1400, height=1100):
        self.profile = tempfile.mkdtemp(prefix="jink-browser-")
        to_browser, self.out = os.pipe()
        self.input, from_browser = os.pipe()
        command = [find(), *FLAGS, f"--user-data-dir={self.profile}", f"--window-size={width},{height}"]
        # The browser reads commands from its descriptor 3 and answers on 4.
        script = f'exec "$@" 3<&{to_browser} 4>&{from_browser}'
        self.process = subprocess.Popen(["bash", "-c", script, "bash", *command], pass_fds=(to_browser, from_browser),
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        os.close(to_browser)
        os.close(from_browser)
        self.buffer, self.next, self.session, self.errors = b"", 0, None, []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.call("Page.navigate", url=address)
        self.wait("document.body && document.body.dataset.ready")

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        os.killpg(self.process.pid, signal.SIGKILL)  # its helpers as well: they would go on to write its profile
        self.process.wait()
        os.close(self.out)
        os.close(self.input)
        shutil.rmtree(self.profile, ignore_errors=True)

    def _message(self, end):
        while b"\0" not in self.buffer:
            if not select.select([self.input], [], [], max(0, end - time.monotonic()))[0]:
                raise TimeoutError("the browser does not answer")
            piece = os.read(self.input, 1 << 16)
            if not piece:
                raise RuntimeError("the browser is gone")
            self.buffer += piece
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **parameters):
        self.next += 1
        message = {"id": self.next, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + PATIENCE
        while True:
            answer = self._message(end)
            if answer.get("id") == self.next:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            if answer.get("method") == "Runtime.exceptionThrown":
                details = answer["params"]["exceptionDetails"]
                self.errors.append(details.get("exception", {}).get("description", details["text"]))
            elif answer.get("method") == "Log.entryAdded" and answer["params"]["entry"]["level"] == "error":
                self.errors.append(answer["params"]["entry"]["text"])

    def value(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']['text']}")
        return result["result"].get("value")

    def wait(self, expression):
        """Until the expression holds; its value."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            value = self.value(expression)
            if value:
                return value
            time.sleep(0.05)
        raise TimeoutError(f"waited in vain for {expression}; errors: {self.errors}")

    def data(self, name):
        return json.loads(self.value(f"document.body.dataset.{name}"))

    def box(self, selector):
        """[left, top, right, bottom] of the first element, in pixels of the window."""
        return json.loads(self.value(
            f"(() => {{ const b = document.querySelector('{selector}').getBoundingClientRect();"
            " return JSON.stringify([b.left, b.top, b.right, b.bottom].map(Math.round)); })()"))

    def click(self, selector):
        left, top, right, bottom = self.box(selector)
        at = {"x": (left + right) / 2, "y": (top + bottom) / 2, "button": "left", "clickCount": 1}
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, **at)

    def screenshot(self):
        return Pixels(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))

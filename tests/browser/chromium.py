"""Headless Chromium, driven by its DevTools protocol over a pair of pipes."""

import base64
import json
import os
import signal
import subprocess
import time


class Chromium:
    """A browser with one page; use it in a `with` statement."""

    def __init__(self, folder, width=1280, height=800):
        to_browser, self._to = os.pipe()
        self._from, from_browser = os.pipe()

        def take_pipes():  # the browser reads from 3 and writes to 4
            os.dup2(to_browser, 13)
            os.dup2(from_browser, 14)
            os.dup2(13, 3)
            os.dup2(14, 4)

        self._process = subprocess.Popen(
            ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--remote-debugging-pipe",
             f"--window-size={width},{height}", "--user-data-dir=" + os.path.join(folder, "profile"), "about:blank"],
            close_fds=False, start_new_session=True, preexec_fn=take_pipes, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self._next = 1
        self._rest = b""
        target = next(its for its in self._send("Target.getTargets")["targetInfos"] if its["type"] == "page")
        self._session = None
        self._session = self._send("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        self._send("Page.enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        os.close(self._to)
        os.close(self._from)

    def _send(self, method, **parameters):
        message = {"id": self._next, "method": method, "params": parameters}
        if getattr(self, "_session", None):
            message["sessionId"] = self._session
        self._next += 1
        os.write(self._to, json.dumps(message).encode() + b"\0")
        while True:
            while b"\0" not in self._rest:
                part = os.read(self._from, 1 << 20)
                if not part:
                    raise RuntimeError("Chromium has ended")
                self._rest += part
            text, self._rest = self._rest.split(b"\0", 1)
            answer = json.loads(text)
            if answer.get("id") == message["id"]:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def open(self, address):
        self._send("Page.navigate", url=address)

    def run(self, script):
        """The value of an expression on the page; a promise is awaited."""
        result = self._send("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{script}: {result['exceptionDetails']['exception'].get('description')}")
        return result["result"].get("value")

    def wait(self, condition, seconds=60):
        """Waits until an expression is true, and returns its value."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.run(condition)
            if value:
                return value
            time.sleep(0.01)
        raise RuntimeError(f"not within {seconds} s: {condition}")

    def press(self, key, code=None, text=None):
        for kind in ("keyDown", "keyUp"):
            self._send("Input.dispatchKeyEvent", type=kind, key=key, code=code or key,
                       **({"text": text} if text and kind == "keyDown" else {}))

    def resize(self, width, height, scale=1, mobile=False):
        self._send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=mobile)

    def use_scheme(self, scheme):
        """`scheme`: light or dark."""
        self._send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])

    def screenshot(self, path, whole=False):
        with open(path, "wb") as file:
            file.write(base64.b64decode(self._send("Page.captureScreenshot", captureBeyondViewport=whole)["data"]))

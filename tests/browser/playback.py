#!/usr/bin/env python3
"""Plays videos of corda in headless Chromium: duration, exact seeking, flat colours within 3/255.

Usage: playback.py CORDA
"""

import functools
import http.server
import json
import os
import random
import subprocess
import sys
import tempfile
import threading

# Chromium turns Y'CbCr into R'G'B' by libyuv, whose factor of Cb in B is 2.000 in place of 2.112 on x86 (it has 8
# bits): blue is off by 5 % of B - Y', (16, 64, 160) shows as (16, 64, 155). So these colours are not saturated.
SCENE = """schema = 1
[world]
duration = 4.0
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 80.0 }
color = "#b07460"
[[rope]]
hang = { links = 2, length = 0.8, angle_deg = -60.0, from = [0.3, 0.0] }
color = "#e0e0d8"
[style]
background = "#2a4a6a"
rope_width_px = 22
payload = false
trail_s = 0.0
[video]
size = [480, 270]
"""
SIZE = [480, 270]
# Per frame rate: its name and the value for `render`.
VIDEOS = {"h264.mp4": ["--fps", "60"], "ntsc.mp4": ["--fps", "30000/1001"], "av1.mp4": ["--fps", "30", "--codec", "av1"],
          "vp9.webm": ["--fps", "60"], "film.webm": ["--fps", "24000/1001"],
          "film.gif": ["--fps", "50"]}
SEEKS = 16


def make_case(corda, scene, folder, name, options):
    """Renders a video and its exact frames; returns their description for the page."""
    run = functools.partial(subprocess.run, check=True, stdout=subprocess.DEVNULL)
    pictures = name.replace(".", "_") + "/%04d.png"
    run([corda, "render", scene, "-q", "-o", os.path.join(folder, name), *options])
    run([corda, "render", scene, "-q", "-o", os.path.join(folder, pictures), "--fps", options[1]])
    frames = len(os.listdir(os.path.join(folder, os.path.dirname(pictures))))
    rate = [int(part) for part in options[1].split("/")] + [1]
    # The state at frame 0 may repeat in frame 1: the motion begins at rest. Later frames all differ.
    seeks = random.Random(name).sample(range(4, frames), SEEKS - 1) + [frames - 1]
    return {"video": name, "is_animation": name.endswith(".gif"), "pictures": pictures, "size": SIZE, "frames": frames, "fps": rate[0] / rate[1],
            "seeks": seeks}


def played(folder):
    """The data that the page posts after Chromium has played everything."""
    posted = {}
    done = threading.Event()

    class Handler(http.server.SimpleHTTPRequestHandler):
        """Serves the folder with byte ranges, which Chromium needs to seek."""

        def do_POST(self):
            posted["results"] = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            self.send_response(200)
            self.end_headers()
            done.set()

        def do_GET(self):
            wanted = self.headers.get("Range")
            path = self.translate_path(self.path)
            if wanted is None or not os.path.isfile(path):
                return super().do_GET()
            with open(path, "rb") as file:
                data = file.read()
            first, last = wanted.removeprefix("bytes=").split("-")
            first, last = int(first), min(int(last or len(data) - 1), len(data) - 1)
            self.send_response(206)
            self.send_header("Content-Type", self.guess_type(path))
            self.send_header("Content-Range", f"bytes {first}-{last}/{len(data)}")
            self.send_header("Content-Length", str(last - first + 1))
            self.end_headers()
            try:
                self.wfile.write(data[first:last + 1])
            except BrokenPipeError:
                pass  # the browser has read enough
            return None

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    page = f"http://127.0.0.1:{server.server_address[1]}/playback.html"
    browser = subprocess.Popen(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--mute-audio",
                                "--user-data-dir=" + os.path.join(folder, "profile"), "--remote-debugging-port=0", page],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        if not done.wait(240):
            sys.exit("Chromium posted no results within 240 s")
    finally:
        browser.kill()
        browser.wait()
        server.shutdown()
    return posted["results"]


def faults_of(case, result):
    """The problems of a video, as lines."""
    if "error" in result:
        return [result["error"]]
    faults = []
    # A WebM counts milliseconds.
    if abs(result["duration"] - case["frames"] / case["fps"]) > 0.0011:
        faults.append(f"takes {result['duration']} s, not {case['frames'] / case['fps']}")
    if result["size"] != case["size"]:
        faults.append(f"is {result['size']}")
    faults += [f"shows frame {seek['shown']} when sought for {seek['frame']}"
               for seek in result["seeks"] if seek["shown"] != seek["frame"]]
    if len(result["colors"]) < 3:
        faults.append("has fewer than three flat colours")
    faults += [f"shows {color['exact']} as {color['shown']}" for color in result["colors"]
               if max(abs(a - b) for a, b in zip(color["exact"], color["shown"])) > 3]
    return faults


def main():
    corda = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        scene = os.path.join(folder, "scene.toml")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(SCENE)
        cases = [make_case(corda, scene, folder, name, options) for name, options in VIDEOS.items()]
        with open(os.path.join(folder, "cases.json"), "w", encoding="utf-8") as file:
            json.dump(cases, file)
        os.symlink(os.path.join(os.path.dirname(os.path.abspath(__file__)), "playback.html"),
                   os.path.join(folder, "playback.html"))
        results = played(folder)
    failed = False
    for case, result in zip(cases, results):
        faults = faults_of(case, result)
        failed |= bool(faults)
        colors = result.get("colors", [])
        worst = max((abs(a - b) for color in colors for a, b in zip(color["exact"], color["shown"])), default=None)
        print(f"{case['video']}: {result.get('duration')} s, {len(result.get('seeks', []))} seeks, "
              f"{len(colors)} colours within {worst}: {'; '.join(faults) or 'as it should be'}")
    sys.exit(failed)


if __name__ == "__main__":
    main()

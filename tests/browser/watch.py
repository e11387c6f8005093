#!/usr/bin/env python3
"""Edits scenes under `corda watch` and looks at its page in headless Chromium.

Usage: watch.py CORDA [--saves N] [--figures FOLDER]
--saves: how often the scene is saved in a row (default 30); prints the times from a save to its picture.
--figures: where to keep pictures of the page.
"""

import argparse
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
import zlib

from chromium import Chromium

SCENE = """# A comment that stays.
schema = 1
[world]
duration = 4.0
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 80.0 }  # degrees
[video]
fps = 30
size = [1280, 720]
"""


class Watching:
    """The program and a page that shows it."""

    def __init__(self, corda, browser, scene):
        self.scene, self.browser = scene, browser
        self.program = subprocess.Popen([corda, "watch", scene, "-q"], stdout=subprocess.PIPE, text=True)
        self.address = self.program.stdout.readline().strip()
        browser.open(self.address)
        browser.wait("document.readyState === 'complete' && typeof film === 'object' && film !== null && drawn >= 0")

    def save(self, text):
        """Saves the scene as an editor does, by another file in its place."""
        with open(self.scene + "~", "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(self.scene + "~", self.scene)

    def film(self):
        return self.browser.run("film.number")

    def end(self):
        self.program.send_signal(signal.SIGINT)
        return self.program.wait(timeout=20)


def pixels_of(browser):
    """CRC-32 of the RGBA pixels on the canvas."""
    return browser.run("""(() => {
        const bytes = pen.getImageData(0, 0, canvas.width, canvas.height).data;
        let crc = -1;
        for (const byte of bytes) {
            crc ^= byte;
            for (let bit = 0; bit < 8; ++bit) crc = (crc >>> 1) ^ (0xEDB88320 & -(crc & 1));
        }
        return [canvas.width, canvas.height, (crc ^ -1) >>> 0];
    })()""")


def still_of(corda, scene, folder, frame, size):
    """The same of the picture that `still` writes."""
    path = os.path.join(folder, f"{frame}.y4m")
    picture = os.path.join(folder, "still.png")
    subprocess.run([corda, "still", scene, "--frame", str(frame), "--size", size, "-o", picture, "--force", "-q"],
                   check=True, stdout=subprocess.DEVNULL)
    raw = subprocess.run(["ffmpeg", "-v", "error", "-i", picture, "-f", "rawvideo", "-pix_fmt", "rgba", "-"], check=True,
                         stdout=subprocess.PIPE).stdout
    width, height = map(int, size.split("x"))
    assert len(raw) == 4 * width * height, path
    return [width, height, zlib.crc32(raw)]


def check(condition, message):
    if not condition:
        sys.exit("watch.py: " + message)


def resident_kib(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS"))


def check_scrubbing(watching, corda, folder):
    browser = watching.browser
    for frame in (0, 7, 119, 60):
        browser.run(f"timeline.value = {frame}, timeline.dispatchEvent(new Event('input'))")
        browser.wait(f"drawn === {frame}")
        check(pixels_of(browser) == still_of(corda, watching.scene, folder, frame, "640x360"), f"frame {frame} is not that of still")
    browser.run("document.activeElement.blur()")
    for key, expected in (("ArrowRight", 61), ("ArrowLeft", 60), ("Home", 0), ("End", 119)):
        browser.press(key)
        browser.wait(f"drawn === {expected}")
    browser.press(" ", "Space", " ")
    browser.wait("playing !== null && drawn > 5 && drawn < 100")
    browser.press(" ", "Space", " ")
    browser.wait("playing === null")


def check_errors(watching):
    browser, film = watching.browser, watching.film()
    before = pixels_of(browser)
    watching.save(SCENE.replace("length = 1.0", "lenght = 1.0"))
    text = browser.wait("!byId('problems').hidden && byId('problems').textContent")
    check("line 6, column" in text and "length" in text, f"the error reads: {text}")
    check(pixels_of(browser) == before and watching.film() == film, "the last good picture did not stay")
    watching.save(SCENE.replace("links = 3", "links = 4"))
    browser.wait(f"film.number > {film} && byId('problems').hidden && canvas.dataset.frame.startsWith(film.number + ':')")
    check(pixels_of(browser) != before, "the picture did not change")


def check_numbers(watching):
    browser = watching.browser
    watching.save(SCENE)
    browser.wait("rows.has('rope[0].hang.angle_deg') && rows.get('rope[0].hang.links').slider.value === '3'")
    film = watching.film()
    browser.run("(() => { const {slider} = rows.get('rope[0].hang.angle_deg'); slider.value = 45; slider.dispatchEvent(new Event('input')); })()")
    browser.wait(f"film.number > {film} && !byId('writing').hidden")
    with open(watching.scene, encoding="utf-8") as file:
        check(file.read() == SCENE, "a slider wrote to the file")
    browser.run("byId('write').click()")
    browser.wait("byId('writing').hidden")
    with open(watching.scene, encoding="utf-8") as file:
        written = file.read()
        check(written == SCENE.replace("80.0", "45.0"), f"writing made of the file: {written}")


def check_saves(watching, count):
    """Saves the scene again and again; returns the milliseconds from each save to its picture."""
    browser = watching.browser
    browser.run("seek(20)")
    times_ms = []
    kib = []
    for i in range(count):
        film = watching.film()
        text = SCENE.replace("angle_deg = 80.0", f"angle_deg = {20 + i % 60}.5")
        # The page notes the time, because asking it takes time.
        done = browser.run(f"""window.shownAt = new Promise((resolve) => {{
            const look = () => film.number > {film} && drawn === frame && canvas.dataset.frame === film.number + ':' + frame
                ? resolve(Date.now()) : setTimeout(look, 1);
            look();
        }}), 0""")
        check(done == 0, "no promise")
        start = time.time()
        watching.save(text)
        times_ms.append(browser.run("shownAt") - 1000 * start)
        kib.append(resident_kib(watching.program.pid))
    check(max(kib[len(kib) // 2:]) < 1.1 * max(kib[:len(kib) // 2]), f"memory grows: {kib[0]} to {kib[-1]} KiB")
    return times_ms


def keep_figures(watching, folder):
    browser = watching.browser
    os.makedirs(folder, exist_ok=True)
    for name, width, height, scale, mobile in (("desktop", 1280, 860, 1, False), ("phone", 390, 844, 2, True)):
        browser.resize(width, height, scale, mobile)
        for scheme in ("light", "dark"):
            browser.use_scheme(scheme)
            time.sleep(0.5)
            browser.screenshot(os.path.join(folder, f"{name}-{scheme}.png"), mobile)
    browser.resize(1280, 860)
    watching.save(SCENE.replace("length = 1.0", "lenght = -1.0").replace("fps = 30", "fps = 0"))
    browser.wait("!byId('problems').hidden")
    browser.screenshot(os.path.join(folder, "error.png"))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("corda")
    parser.add_argument("--saves", type=int, default=30)
    parser.add_argument("--figures")
    options = parser.parse_args()
    corda = os.path.abspath(options.corda)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        scene = os.path.join(folder, "scene.toml")
        with open(scene, "w", encoding="utf-8") as file:
            file.write(SCENE)
        with Chromium(folder) as browser:
            watching = Watching(corda, browser, scene)
            try:
                check_scrubbing(watching, corda, folder)
                check_errors(watching)
                check_numbers(watching)
                times_ms = sorted(check_saves(watching, options.saves))
                if options.figures:
                    keep_figures(watching, options.figures)
            finally:
                status = watching.end()
            check(status == 130, f"ends with {status} after Ctrl-C")
            print(f"from a save to its picture, {len(times_ms)} saves: median {statistics.median(times_ms):.0f} ms, "
                  f"95 % {times_ms[int(0.95 * len(times_ms))]:.0f} ms")


main()

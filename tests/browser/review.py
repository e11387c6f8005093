#!/usr/bin/env python3
"""Reviews golden pictures on the page of `corda golden --review` in headless Chromium.

Usage: review.py CORDA [--figures FOLDER]
--figures: where to keep pictures of the page.
"""

import argparse
import filecmp
import os
import shutil
import subprocess
import sys
import tempfile

from chromium import Chromium

SCENE = """schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 60.0 }
[golden]
at = [0.0, 0.5, 1.0]
"""


def check(condition, message):
    if not condition:
        sys.exit("review.py: " + message)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("corda")
    parser.add_argument("--figures")
    options = parser.parse_args()
    corda = os.path.abspath(options.corda)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        scenes, kept, before = (os.path.join(folder, name) for name in ("scenes", "ref", "before"))
        os.mkdir(scenes)
        for name, text in (("long", SCENE), ("short", SCENE.replace("length = 1.0", "length = 0.5"))):
            with open(os.path.join(scenes, name + ".toml"), "w", encoding="utf-8") as file:
                file.write(text)
        suite = [corda, "golden", scenes, "--dir", kept, "-q"]
        subprocess.run([*suite, "--update"], check=True, stdout=subprocess.DEVNULL)
        shutil.copytree(kept, before)
        # One cause for the pictures of one scene, another one for those of the other.
        for name, old, new in (("long", "links = 3", "links = 4"), ("short", "angle_deg = 60.0", "angle_deg = 50.0")):
            path = os.path.join(scenes, name + ".toml")
            with open(path, encoding="utf-8") as file:
                text = file.read()
            with open(path, "w", encoding="utf-8") as file:
                file.write(text.replace(old, new))
        program = subprocess.Popen([*suite, "--review"], stdout=subprocess.PIPE, text=True)
        address = next(line for line in program.stdout if line.startswith("http://")).strip()
        with Chromium(folder) as browser:
            browser.open(address)
            browser.wait("document.readyState === 'complete' && typeof pictures === 'object' && pictures.length === 6")
            check(browser.run("document.querySelectorAll('#list section').length") == 2, "the causes are not two groups")
            whole = "[...document.querySelectorAll('#pair img')].every((image) => image.complete && image.naturalWidth === 320)"
            for view in range(1, 6):
                browser.press(str(view), text=str(view))
                browser.wait(whole)
                if options.figures:
                    os.makedirs(options.figures, exist_ok=True)
                    browser.screenshot(os.path.join(options.figures, f"view-{view}.png"))
            browser.press("A", "KeyA", "A")
            browser.press("r", "KeyR", "r")  # the first one all the same
            check(not filecmp.dircmp(kept, before).diff_files, "something was written before Apply")
            chosen = browser.run("pictures.filter((picture) => stateOf(picture) === 'accept').map((picture) => picture.name)")
            check(len(chosen) == 2, f"chosen are {chosen}")
            # A page that is loaded again has the marks.
            browser.run("pictures = null")
            browser.open(address)
            browser.wait("document.readyState === 'complete' && typeof pictures === 'object' && pictures !== null && pictures.length === 6")
            again = browser.run("pictures.filter((picture) => stateOf(picture) === 'accept').map((picture) => picture.name)")
            check(again == chosen, f"after a reload {again} are chosen")
            check(browser.run("pictures.filter((picture) => stateOf(picture) === 'reject').length") == 1, "a rejected one is open again")
            browser.run("byId('end').click()")
            browser.wait("byId('outcome').textContent.startsWith('2 accepted pictures are not written')")
            if options.figures:
                for name, width, height, mobile in (("desktop", 1440, 900, False), ("phone", 390, 844, True)):
                    browser.resize(width, height, 1, mobile)
                    for scheme in ("light", "dark"):
                        browser.use_scheme(scheme)
                        browser.wait(whole)
                        browser.screenshot(os.path.join(options.figures, f"{name}-{scheme}.png"), mobile)
            browser.run("byId('apply').click()")
            browser.wait("byId('outcome').textContent === '2 written'")
            check(sorted(filecmp.dircmp(kept, before).diff_files) == sorted(chosen), "others than the accepted pictures were written")
            browser.run("byId('end').click()")
            browser.wait("byId('status').textContent === 'the review has ended'")
        check(program.wait(timeout=20) == 7, "pictures that were not accepted are no failure")
        last = program.stdout.read().splitlines()[-1]
        check(last == f"review: 2 pictures written to '{kept}', 4 not accepted", f"the terminal says: {last}")
        rest = subprocess.run(suite, check=False, stdout=subprocess.PIPE, text=True)
        check(rest.returncode == 7 and "6 pictures: 2 passed, 4 failed" in rest.stdout, rest.stdout)


main()

#!/usr/bin/env python3
"""Renders small videos with every codec and container, each with two fillings of fresh memory: the bytes must be the same.

An encoder that reads memory that nothing wrote makes other bytes on another run.
Usage: encoder_bytes.py CORDA
CORDA_TEST_LONG=1 renders every size with every preset, takes a third filling, and looks for such reads by valgrind as well,
if it can run the program: on some virtual machines it refuses an instruction of a library of libavcodec.
"""

import hashlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

IS_LONG = bool(os.environ.get("CORDA_TEST_LONG"))
FILLINGS = ("1", "255", "85") if IS_LONG else ("1", "255")
SCENE = """schema = 1
world = { duration = 4.0, gravity = 3.73 }
video = { fps = 15, jobs = 1 }
[[rope]]
hang = { links = 12, length = 1.0, angle_deg = 9.394409849494874 }
"""
CLEAR = ["--set", "style.background=transparent"]
OF_X264 = ["ultrafast", "veryfast", "medium"]
# Ending, codec and more options; presets; sizes. Odd sizes are padded where 4:2:0 needs it.
SIZES = ["16x16", "33x17", "64x64", "96x54"]
OF_64 = ["64x64", "65x91", "96x96"]  # which have no smaller ones
NO_VALGRIND = "libsvtav1"  # its functions are too long for valgrind 3.19
FORMATS = [
    (".mp4 --codec libx264", OF_X264, SIZES),
    (".mp4 --codec libx264 --pix 444", OF_X264, SIZES),
    (".mp4 --codec libx265", OF_X264, ["66x66", "67x91", "96x96"]),
    (".mp4 --codec libsvtav1", ["12", "10", "8"], OF_64),
    (".webm --codec libsvtav1", ["12", "10", "8"], OF_64),
    (".webm --codec libaom-av1", ["8", "7", "6"], OF_64),
    (".webm --codec libvpx-vp9", ["8", "6", "4"], SIZES),
    (".webm CLEAR", ["8", "6", "4"], SIZES),
    (".mov", [None], SIZES),
    (".mov CLEAR", [None], SIZES),
    (".mkv", [None], SIZES),
    (".mkv CLEAR", [None], SIZES),
    (".gif", [None], SIZES),
]
ENCODERS = re.compile(r"lib(x264|SvtAv1Enc|aom|vpx|avcodec)")


def cases():
    """The ending and the options of each video."""
    for k, (words, presets, sizes) in enumerate(FORMATS):
        ending, *options = words.replace("CLEAR", " ".join(CLEAR)).split()
        for i, preset in enumerate(presets):
            has_small = words == ".mp4 --codec libx264"  # whose bytes once differed, at sizes below some 90 pixels
            for size in sizes if IS_LONG or has_small else [sizes[(i + k) % len(sizes)]]:
                yield ending, [*options, *(["--preset", preset] if preset else []), "--size", size, "--pad"]


def render(corda, folder, ending, options, before=(), **environment):
    video = pathlib.Path(folder, "out" + ending)
    done = subprocess.run([*before, corda, "render", pathlib.Path(folder, "scene.toml"), "-q", "--force", "-o", video, *options],
                          env=os.environ | environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{ending} {' '.join(options)}: {done.stderr}")
    return video.read_bytes()


def faults_under_valgrind(corda, folder, ending, options, made):
    """Other bytes than `made`, the hashes, and what valgrind says of an encoder that uses memory that nothing wrote.

    Not of x265: its vector code loads more than it uses, of which valgrind follows only a part.
    """
    report = os.path.join(folder, "valgrind.xml")
    video = render(corda, folder, ending, options, ["valgrind", "-q", "--xml=yes", "--xml-file=" + report])
    if hashlib.sha256(video).hexdigest() not in made:
        yield "other bytes under valgrind"
    for error in xml.etree.ElementTree.parse(report).getroot().iter("error"):
        frames = [frame.findtext("obj") or "" for frame in error.find("stack").iter("frame")]
        if error.findtext("kind").startswith("Uninit") and ENCODERS.search(frames[0]):
            yield f"{error.findtext('what')} in {frames[0]}, {error.find('stack').findtext('frame/fn')}"


def main():
    corda = os.path.abspath(sys.argv[1])
    failed = videos = 0
    has_valgrind = IS_LONG and subprocess.run(["valgrind", "-q", corda, "--version"], capture_output=True, check=False).returncode == 0
    if IS_LONG and not has_valgrind:
        print("valgrind cannot run the program on this machine")
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "scene.toml").write_text(SCENE, encoding="utf-8")
        for ending, options in cases():
            made = {hashlib.sha256(render(corda, folder, ending, options, MALLOC_PERTURB_=fill)).hexdigest() for fill in FILLINGS}
            videos += 1
            faults = [] if len(made) == 1 else [f"{len(made)} different files"]
            if has_valgrind and NO_VALGRIND not in options:
                faults += sorted(set(faults_under_valgrind(corda, folder, ending, options, made)))
            for fault in faults:
                print(f"{ending} {' '.join(options)}: {fault}")
            failed += bool(faults)
    print(f"{videos} videos, {failed} of them with faults")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()

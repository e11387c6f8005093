#!/usr/bin/env python3
"""Measures the chapters of tests/benchmark/README.md, draws their plots and writes their tables into that page.

Usage: study.py [CHAPTER ...]                           measures, and writes the tables and plots of the page
       study.py --scene SCENE [--set KEY=VALUE] [-o FOLDER]  measures your own scene: speed against error of every method
       study.py [CHAPTER ...] [--quick] -o FOLDER       writes a page of its own, FOLDER/README.md, with all numbers
       study.py --from FOLDER [CHAPTER ...] [-o FOLDER] draws again what was measured before
Chapters: speed, findings, accuracy, hard_cases, challenge, horizons; and peers, which tests/benchmark/peers.sh measures.
The measurements are kept as CHAPTER.json beside a page of its own, otherwise in build/study. Needs python3-matplotlib.
"""
import argparse
import importlib.util
import json
import os
import pathlib
import subprocess
import sys

from page import ROOT, marks_of, page_text, put, replace_file, save_picture

HERE = pathlib.Path(__file__).resolve().parent
PAGES = [HERE / "README.md", ROOT / "README.md"]
MEASURED = ("speed", "findings", "accuracy", "hard_cases", "challenge", "horizons")  # by benchmark_study
CHAPTERS = (*MEASURED, "peers")


def fail(code, message):
    """Ends with an exit code of src/corda/app/README.md."""
    print(f"study.py: {message}", file=sys.stderr)
    sys.exit(code)


def options_of(arguments):
    """The command line; ends with exit code 2 if it is wrong."""
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1], add_help=True)
    parser.add_argument("chapters", nargs="*", metavar="CHAPTER")
    parser.add_argument("--scene", type=pathlib.Path, help="scene file (TOML)")
    parser.add_argument("--set", action="append", default=[], help="override a key of the scene")
    parser.add_argument("--quick", action="store_true", help="fewer and shorter runs, not to quote from")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="folder of a page of its own")
    parser.add_argument("--force", action="store_true", help="write into a folder that is not empty")
    parser.add_argument("--from", dest="source", type=pathlib.Path, help="folder with measurements")
    parser.add_argument("--program", type=pathlib.Path, help="benchmark_study; built if it is not given")
    options = parser.parse_args(arguments)
    for name in options.chapters:
        if name not in CHAPTERS:
            fail(2, f'there is no chapter "{name}"; known are {", ".join(CHAPTERS)}')
    if "peers" in options.chapters and not options.source:
        fail(2, "peers are measured by tests/benchmark/peers.sh; give its folder: --from build/peers/runs")
    if options.set and not options.scene:
        fail(2, "--set changes a scene; name its file with --scene")
    if options.scene and not options.output:
        options.output = pathlib.Path(f"{options.scene.stem}-study")
    if options.quick and not options.output:
        fail(2, "a quick study is not to quote from; give a folder for its page: -o FOLDER")
    if options.source:
        options.chapters = options.chapters or chapters_in(options.source)
    else:
        options.chapters = options.chapters or (["speed"] if options.scene else MEASURED)
    return options


def file_of(chapter):
    return "runs.csv" if chapter == "peers" else f"{chapter}.json"


def chapters_in(folder):
    """The chapters whose measurements are in a folder."""
    found = [name for name in CHAPTERS if (folder / file_of(name)).exists()]
    return found or fail(6, f"{folder}: has no measurements; they are files such as speed.json")


def program_of(options):
    """The program that measures, built if none was given."""
    if options.program:
        return options.program
    build = pathlib.Path(os.environ.get("BUILD_DIR", ROOT / "build" / "ci"))
    try:
        if not (build / "build.ninja").exists():
            subprocess.run(["cmake", "--preset", "ci"], cwd=ROOT, check=True, stdout=sys.stderr)
        subprocess.run(["cmake", "--build", build, "--target", "benchmark_study"], check=True, stdout=sys.stderr)
    except subprocess.CalledProcessError:
        fail(1, "benchmark_study cannot be built; see above, or give --program")
    return build / "tests" / "benchmark_study"


def measure(name, options, path):
    """Measures a chapter and keeps its JSON at `path`. Ends with the program's exit code if it fails."""
    command = [options.program, name]
    command += ["--quick"] if options.quick else []
    command += ["--scene", options.scene] if options.scene else []
    for setting in options.set:
        command += ["--set", setting]
    run = subprocess.run(command, stdout=subprocess.PIPE, check=False)
    if run.returncode != 0:
        if not any(path.parent.iterdir()):
            path.parent.rmdir()
        sys.exit(run.returncode if run.returncode > 0 else 128 - run.returncode)
    replace_file(path, run.stdout)


def read(path, chapter):
    """The measurements of a chapter in a file. Ends with exit code 6 if they cannot be read."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        fail(6, f"{path}: is not JSON of benchmark_study: {error}")
    if not isinstance(found, dict) or found.get("chapter") != chapter:
        fail(6, f"{path}: is not JSON of benchmark_study {chapter}")
    return found


def prepare(folder, force):
    """Makes the folder of a page."""
    if folder.exists() and not folder.is_dir():
        fail(6, f"{folder}: exists and is not a folder; choose another name")
    if folder.is_dir() and any(folder.iterdir()) and not force:
        fail(6, f"{folder}: is not empty; give --force to replace files of the same names")
    folder.mkdir(parents=True, exist_ok=True)


def chapter_of(name, path):
    """The tables and plots of the measurements in a file."""
    import chapters  # with matplotlib, which takes a second
    from peers.tables import peers
    return peers(path) if name == "peers" else chapters.CHAPTERS[name](read(path, name))


def write_own_page(folder, title, chapters):
    """Writes all chapters as FOLDER/README.md, with the pictures of the last."""
    for picture in chapters[-1].pictures:
        save_picture(picture, folder)
    replace_file(folder / "README.md", page_text(title, chapters))


def write_parts(chapter, pages):
    """Writes the parts of a chapter between their marks in pages, and the pictures that a page shows into its folder."""
    for part in chapter.parts:
        if part.failures and any(part.mark in marks_of(page.read_text(encoding="utf-8")) for page in pages):
            fail(1, f"part {part.mark} has runs that failed and is not written: {part.failures[0]}")
    for page in pages:
        text = page.read_text(encoding="utf-8")
        for part in chapter.parts:
            text = put(text, part)
        replace_file(page, text)
        for picture in chapter.pictures:
            if f"({picture.name})" in text:
                save_picture(picture, page.parent)


def main():
    options = options_of(sys.argv[1:])
    if not importlib.util.find_spec("matplotlib"):
        fail(2, "there is no matplotlib; install the package python3-matplotlib")
    kept = options.output or ROOT / "build" / "study"
    if options.output:
        prepare(options.output, options.force)
    kept.mkdir(parents=True, exist_ok=True)
    if not options.source:
        options.program = program_of(options)
    subject = os.fsencode(options.scene.stem).decode("utf-8", "backslashreplace") if options.scene else "the methods of Corda"
    title = f"Study of {subject}{' (quick: not to quote from)' if options.quick else ''}"
    chapters = []
    for name in options.chapters:  # each is written when it is measured, so that a failure keeps those before it
        path = (options.source or kept) / file_of(name)
        if not options.source:
            measure(name, options, path)
        chapters.append(chapter_of(name, path))
        if options.output:
            write_own_page(options.output, title, chapters)
        else:
            write_parts(chapters[-1], PAGES)
    for page in [options.output / "README.md"] if options.output else PAGES:
        sys.stdout.buffer.write(os.fsencode(page) + b"\n")


if __name__ == "__main__":
    try:
        main()
        sys.stdout.flush()
    except KeyboardInterrupt:
        fail(130, "interrupted; chapters that were measured are kept")
    except OSError as error:
        fail(6, f"{error.filename or 'standard output'}: {error.strerror or error}")

#!/usr/bin/env python3
"""Clips of 64x64 pixels and 60 frames with all labels: whole sweeps by one and two processes, and stages one after the other.

Usage: PYTHONPATH=build/ci/python sweep.py [--json] [--samples N]
"""

import argparse
import collections
import json
import pathlib
import tempfile
import time

from corda import _corda, _parameters, _run_sweep, _sample, _shards, _sweep_file

SCENE = """schema = 1
[world]
duration = 2.0
[[rope]]
hang = { links = 8, length = 1.0, angle_deg = 40.0 }
[video]
fps = 30
size = [64, 64]
"""
SWEEP = """schema = 1
scene = "first.toml"
samples = SAMPLES
[vary]
"rope[0].hang.angle_deg" = { uniform = [5.0, 90.0] }
"rope[0].hang.links" = { integer = [3, 30] }
"rope[0].mass" = { log_uniform = [0.01, 10.0] }
"world.gravity" = [1.62, 9.81]
"""


class Quiet:
    """Progress that nobody sees."""

    def __call__(self, done, total):
        pass

    def end(self):
        pass


def whole(sweep, folder, jobs):
    """Seconds of a sweep from its start to its last file, processes included."""
    start = time.perf_counter()
    _run_sweep.run_sweep(sweep, _run_sweep.Run(folder, jobs=jobs), Quiet())
    return time.perf_counter() - start


def stages(sweep, count):
    """Seconds of each stage of the first samples, in one process."""
    spent = collections.Counter()

    def timed(name, function):
        def call(*arguments):
            start = time.perf_counter()
            try:
                return function(*arguments)
            finally:
                spent[name] += time.perf_counter() - start
        return call

    wrapped = [(_parameters, "parameters_of", "parameters"), (_corda, "sample_film", "scene and plan"),
               (_corda, "sample_facts", "motion and camera"), (_corda, "labels", "labels and masks"),
               (_sample, "_draw", "drawing and video"),
               (_sample, "_summary", "summary"), (_shards, "npz_bytes", "npz")]
    kept = [(module, name, getattr(module, name)) for module, name, _ in wrapped]
    for module, name, stage in wrapped:
        setattr(module, name, timed(stage, getattr(module, name)))
    start = time.perf_counter()
    for number in range(count):
        _shards.pack(_sample.make_sample(sweep, number, sweep.pictures))
    total = time.perf_counter() - start
    for module, name, function in kept:
        setattr(module, name, function)
    spent["other"] = total - sum(spent.values())
    return dict(spent)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--samples", type=int, default=1024)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "first.toml").write_text(SCENE)
        (folder / "sweep.toml").write_text(SWEEP.replace("SAMPLES", str(options.samples)))
        sweep = _sweep_file.load(folder / "sweep.toml")
        rows = [{"name": f"whole, {jobs} processes", "clips_per_s": options.samples / whole(sweep, str(folder / str(jobs)), jobs)}
                for jobs in (1, 2)]
        _sample.make_sample(sweep, 0, sweep.pictures)  # opens OpenGL
        count = min(64, options.samples)
        rows += [{"name": stage, "ms_per_clip": 1000.0 * seconds / count} for stage, seconds in stages(sweep, count).items()]
    if options.json:
        print(json.dumps({"schema": 1, "benchmarks": rows}, indent=1))
        return
    for row in rows:
        (figure, value), = ((key, value) for key, value in row.items() if key != "name")
        print(f"{row['name']:<20} {value:8.2f} {figure.replace('_per_', '/')}")


if __name__ == "__main__":
    main()

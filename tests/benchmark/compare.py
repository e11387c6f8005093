"""Prints ratios of times of two builds of Corda that take turns; see compare.sh."""

import argparse
import json
import pathlib
import re
import resource
import statistics
import subprocess
import tempfile

KERNELS = ["relaxation", "rattle", "exact", "pipeline"]
# Counters of the benchmarks that are times, in order of preference; otherwise the CPU time of an iteration.
TIMES = ["avx2_ns/bar", "avx_ns/bar", "s/particle-step", "s/particle"]
VIDEOS = [
    ("swing.toml", "640x360", []),
    ("swing.toml", "1920x1080", []),
    ("cloth.toml", "1280x720", []),
    ("swing.toml", "1280x720", ["--set", "video.shutter=0.5"]),
]


def cases_of(build, program):
    """Names of the cases of a benchmark program; none if the build does not have it."""
    path = build / "tests" / f"benchmark_{program}"
    if not path.exists():
        return []
    listed = subprocess.run([path, "--benchmark_list_tests"], capture_output=True, text=True, check=True)
    return listed.stdout.split("\n")[:-1]


def kernel_time(build, program, case):
    """Time of one case in its own unit."""
    command = [
        build / "tests" / f"benchmark_{program}",
        f"--benchmark_filter=^{re.escape(case)}$",
        "--benchmark_min_time=0.2",
        "--benchmark_format=json",
    ]
    result = subprocess.run(command, capture_output=True, text=True, check=True)
    row = json.loads(result.stdout)["benchmarks"][0]
    return next((row[name] for name in TIMES if name in row), row["cpu_time"])


def common_scene(builds, name, size, options):
    """An example of the first build that all of them can render; None if there is none: keys may differ."""
    for own in builds:
        scene = own.resolve().parents[1] / "examples" / name
        try:
            for build in builds:
                render_time(build, scene, size, options)
            return scene
        except subprocess.CalledProcessError:
            pass
    return None


def render_time(build, scene, size, options):
    """CPU time in s of rendering a video of 2 s."""
    with tempfile.TemporaryDirectory() as folder:
        command = [build / "corda", "render", scene, "-o", f"{folder}/video.mp4", "--size", size, "--duration", "2"]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([*command, *options], capture_output=True, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def report(name, measure, builds, repeats):
    """Measures both builds in turn and prints the ratio, its spread and the median times."""
    turns = [[measure(build) for build in (builds if i % 2 == 0 else builds[::-1])] for i in range(repeats)]
    turns = [turn if i % 2 == 0 else turn[::-1] for i, turn in enumerate(turns)]
    ratios = sorted(ours / theirs for ours, theirs in turns)
    ours, theirs = (statistics.median(column) for column in zip(*turns))
    print(f"{statistics.median(ratios):6.3f}  {ratios[0]:6.3f} .. {ratios[-1]:6.3f}  {ours:10.4g} {theirs:10.4g}  {name}",
          flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("other", type=pathlib.Path)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--filter", default="", help="regular expression of case names")
    options = parser.parse_args()
    builds = [options.build, options.other]
    print(" ratio   least .. largest        here      other  case")
    for program in KERNELS:
        others = cases_of(options.other, program)
        for case in [name for name in cases_of(options.build, program) if name in others]:
            if re.search(options.filter, f"{program} {case}"):
                report(f"{program} {case}", lambda b: kernel_time(b, program, case), builds, options.repeats)
    for name, size, extra in VIDEOS:
        case = " ".join(["video", name, size, *extra])
        if not re.search(options.filter, case):
            continue
        scene = common_scene(builds, name, size, extra)
        if scene is None:
            print(f"   -    they have no scene in common                        {case}")
            continue
        report(case, lambda b: render_time(b, scene, size, extra), builds, options.repeats)


if __name__ == "__main__":
    main()

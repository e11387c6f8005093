"""Times of short commands, most of which is the start of the program.

Usage: startup.py PROGRAM EXAMPLES [--json] [--repeats N] [--beside PROGRAM]
Prints milliseconds per command, the medians of wall time and of processor time. With --beside, both programs take turns.
"""
import argparse
import json
import os
import statistics
import subprocess
import time

parser = argparse.ArgumentParser()
parser.add_argument("program")
parser.add_argument("examples")
parser.add_argument("--json", action="store_true")
parser.add_argument("--repeats", type=int, default=50)
parser.add_argument("--beside")
options = parser.parse_args()

COMMANDS = [["--version"], ["help"]] + [
    [command, scene] for command in ("plan", "simulate") for scene in ("swing.toml", "first.toml")]


def times_ms(program, command):
    """Wall time and processor time of one run."""
    start = time.perf_counter()
    process = subprocess.Popen([program, *command], cwd=options.examples,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    if status != 0:
        raise SystemExit(f"{program} {' '.join(command)} failed")
    return 1e3 * wall, 1e3 * (usage.ru_utime + usage.ru_stime)


rows = []
for command in COMMANDS:
    programs = [os.path.abspath(program) for program in (options.program, options.beside) if program]
    runs = [[times_ms(program, command) for program in programs] for _ in range(options.repeats)]
    for i, program in enumerate(programs):
        wall, cpu = (statistics.median(run[i][k] for run in runs) for k in (0, 1))
        rows.append({"program": program, "command": " ".join(command), "wall_ms": wall, "cpu_ms": cpu})
if options.json:
    print(json.dumps({"schema": 1, "starts": rows}, indent=1))
else:
    for row in rows:
        print(f"{row['command']:<20} {row['wall_ms']:6.1f} ms, {row['cpu_ms']:6.1f} ms of processor time  {row['program']}")

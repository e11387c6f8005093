#!/usr/bin/env python3
"""The source report's program in numpy (section 1 of src/corda/sim/README.md) on the chains of peer.cpp.

Usage: report.py TRUTH_FOLDER [PROBLEM ...]

Bars join neighbours only, because longer ones make another rope. Prints rows of CSV as run_peer() does.
"""
import pathlib
import sys
import time

import numpy

FPS = 60
LONGEST_RUN_S = 0.1
GRAVITY = {"swing": 9.8, "chain": 9.81, "payload": 9.81}


def start_of(problem):
    """Positions and masses."""
    if problem == "swing":
        return numpy.arange(40)[:, None] * numpy.array([0.1, -1.0]), numpy.ones(40)
    masses = numpy.ones(11)
    if problem == "payload":
        masses[-1] = 1000.0
    return numpy.arange(11)[:, None] * numpy.array([0.1, 0.0]), masses


class Rope:
    """Verlet steps, each followed by passes over all bars."""

    def __init__(self, problem, steps_per_frame, sweeps):
        self.now, self.masses = start_of(problem)
        self.before = self.now.copy()
        self.step_s = 1.0 / (FPS * steps_per_frame)
        self.pull = numpy.array([0.0, -GRAVITY[problem]]) * self.step_s**2
        self.rest = numpy.linalg.norm(numpy.diff(self.now, axis=0), axis=1)
        self.sweeps = sweeps

    def relax(self):
        for k, rest in enumerate(self.rest):
            along = self.now[k + 1] - self.now[k]
            distance = numpy.sqrt(along @ along)
            adjust = (distance - rest) / distance * along
            if k == 0:
                self.now[k + 1] -= adjust
            else:
                self.now[k] += adjust / 2
                self.now[k + 1] -= adjust / 2

    def step(self):
        after = 2 * self.now - self.before + self.pull
        after[0] = self.now[0]
        self.before, self.now = self.now, after
        for _ in range(self.sweeps):
            self.relax()


def energies(positions, velocities, masses, gravity):
    return (masses[1:] * ((velocities[:, 1:] ** 2).sum(axis=2) / 2 + gravity * positions[:, 1:, 1])).sum(axis=1)


def measure(problem, truth, steps_per_frame, sweeps):
    """Error, energy error, CPU seconds, and why it failed."""
    rope = Rope(problem, steps_per_frame, sweeps)
    length = rope.rest.sum()
    positions, velocities = [], []
    run_s = 0.0
    for _ in truth:
        from_s = time.process_time()
        for _ in range(steps_per_frame):
            rope.step()
        run_s += time.process_time() - from_s
        positions.append(rope.now.copy())
        velocities.append((rope.now - rope.before) / rope.step_s)
    count = len(rope.now)
    true = truth.reshape(len(truth), 4, count)
    true_positions = true[:, :2].transpose(0, 2, 1)
    apart = numpy.sqrt(((numpy.array(positions) - true_positions) ** 2).sum(axis=2)).max() / length
    gravity = GRAVITY[problem]
    change = energies(numpy.array(positions), numpy.array(velocities), rope.masses, gravity) - energies(
        true_positions, true[:, 2:].transpose(0, 2, 1), rope.masses, gravity
    )
    energy = abs(change).max() / (rope.masses[1:].sum() * gravity * length)
    return apart, energy, run_s, "" if apart < 3 else "diverged"


def main():
    if len(sys.argv) < 2:
        sys.exit("usage: report.py TRUTH_FOLDER [PROBLEM ...]")
    folder = pathlib.Path(sys.argv[1])
    for problem in [name for name in GRAVITY if name in (sys.argv[2:] or GRAVITY)]:
        count = len(start_of(problem)[0])
        truth = numpy.fromfile(folder / f"{problem}.truth").reshape(-1, 4 * count)
        for sweeps in (1, 16):
            steps = 1
            while True:
                error, energy, run_s, failure = measure(problem, truth, steps, sweeps)
                ms = 1e3 * run_s / (len(truth) / FPS)
                method = f"relaxation with {sweeps} sweep{'s' if sweeps > 1 else ''}"
                print(
                    f"{problem},Source report (numpy),{numpy.__version__},{method},steps per frame,{steps},"
                    f"{error:.4g},{energy:.4g},{ms:.5g},{failure}",
                    flush=True,
                )
                if run_s > LONGEST_RUN_S:
                    break
                steps *= 2 if steps < 16 else 4


main()

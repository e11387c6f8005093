"""Periods of swinging bodies by theory, for corda.plot and corda.report."""

import math
from typing import NamedTuple

import numpy as np

_LEAST_ZERO_OF_J0 = 2.404825557695773


class Period(NamedTuple):
    """A period by theory."""

    seconds: float
    model: str  #: "a point pendulum of this amplitude"


def mean(a, b):
    """The arithmetic-geometric mean of two positive numbers."""
    while abs(a - b) > 4e-16 * a:
        a, b = 0.5 * (a + b), math.sqrt(a * b)
    return a


def pendulum_period(omega, angle_deg):
    """The period in s of a pendulum that swings through `angle_deg`, 0 .. 180 (excluded), to each side, whose small swings
    have the angular frequency `omega` in 1/s: the complete elliptic integral, 4 K(sin(angle / 2)) / omega, by the
    arithmetic-geometric mean (R2 of src/corda/sim/README.md)."""
    return 2.0 * math.pi / (omega * mean(1.0, math.cos(math.radians(angle_deg) / 2.0)))


def rod_omega(particles, spacing_m, gravity):
    """The angular frequency in 1/s of small swings of a rigid rod with equal masses at spacing, 2 spacing, ... from its pin
    (R3)."""
    first = particles * (particles + 1) / 2.0
    second = first * (2 * particles + 1) / 3.0
    return math.sqrt(gravity * first / (spacing_m * second))


def rope_omega(links, spacing_m, gravity):
    """The least angular frequency in 1/s of a hanging rope of equal masses and links: sqrt(gravity x / spacing), where x is
    the least zero of the Laguerre polynomial L_links (R4). By Newton's method from the zero's asymptotic value, which is below
    it; L_n' = n (L_n - L_(n-1)) / x."""
    x = 1.0 if links == 1 else _LEAST_ZERO_OF_J0**2 / (4.0 * links + 2.0)
    for _ in range(50):
        before, value = 1.0, 1.0 - x
        for n in range(1, links):
            before, value = value, ((2 * n + 1 - x) * value - n * before) / (n + 1)
        step = value * x / (links * (value - before))
        x -= step
        if abs(step) <= 1e-16 * x:
            break
    return math.sqrt(gravity / spacing_m * x)


def _gravity(motion, body):
    """The acceleration downwards in m/s2 that a body feels; 0 if there is none that theory knows."""
    gravity = motion.gravity
    if motion.force is not None:
        gravity = np.asarray(motion.force) / motion.masses[body.particles][0]
    return -gravity[1] if gravity[0] == 0.0 else 0.0


def hangs_plainly(motion, body):
    """Whether a body is a rope that hangs from its first particle, which is at rest, and only weight acts on it."""
    first = body.particles.start
    return (body.is_chain and not body.is_net and body.compliance == 0.0 and not motion.bends and motion.drag == 0.0
            and not motion.has_events and np.flatnonzero(motion.pinned[body.particles]).tolist() == [0]
            and not np.ptp(motion.positions[:, first], axis=0).any() and _gravity(motion, body) > 0.0)


def hangs_alone(motion):
    """Whether the scene is one such rope."""
    return len(motion.bodies) == 1 and hangs_plainly(motion, motion.bodies[0])


def weights_below(motion):
    """The tensions in N of the links of a rope that hangs at rest (see hangs_alone): the weight of all below each."""
    return _gravity(motion, motion.bodies[0]) * np.cumsum(motion.masses[:0:-1])[::-1]


def period_of(motion, angle_deg, body=None):
    """The Period of a body, by default the first, that swings through `angle_deg`: of a point pendulum, also of a rope whose
    end has all but a hundredth of its mass, whose period is shorter by less than 0.1 %; of a rigid rod, which bars to more than
    the next particle make of a rope; or of a hanging rope at small angles. The links are equal. None for other scenes."""
    body = motion.bodies[0] if body is None else body
    if not hangs_plainly(motion, body) or not angle_deg < 180.0:
        return None
    gravity, links = _gravity(motion, body), len(body.rest_m)
    start, masses = motion.positions[0, body.particles], motion.masses[body.particles]
    link_m = np.hypot(*np.diff(start, axis=0).T)
    is_at_rest_length = np.allclose(link_m, body.rest_m, rtol=1e-9, atol=0.0)
    if not is_at_rest_length or not np.allclose(link_m, link_m[0], rtol=1e-9, atol=0.0):
        return None
    spacing_m = link_m[0]
    length_m = links * spacing_m
    if links == 1:
        return Period(pendulum_period(math.sqrt(gravity / length_m), angle_deg), "a point pendulum of this amplitude")
    own_kg = masses.sum() - body.payload_kg
    is_straight = abs(np.hypot(*(start[-1] - start[0])) - length_m) <= 1e-9 * length_m
    if is_straight and own_kg <= 0.01 * body.payload_kg:
        return Period(pendulum_period(math.sqrt(gravity / length_m), angle_deg),
                      "a point pendulum of this amplitude, with all mass at the end of the rope,")
    if body.payload_kg != 0.0 or np.any(masses != masses[0]):
        return None
    if body.reach > 1:
        return Period(pendulum_period(rod_omega(links, spacing_m, gravity), angle_deg),
                      "a rigid rod of this amplitude, as which longer bars tend to hold a rope,")
    return Period(2.0 * math.pi / rope_omega(links, spacing_m, gravity), f"a hanging rope of {links} links at small angles")

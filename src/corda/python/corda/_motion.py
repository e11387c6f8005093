"""The motion of a film in numbers, for corda.plot and corda.report."""

import dataclasses
import functools
from typing import NamedTuple

import numpy as np

from . import _corda

_TURN = 2.0 * np.pi
#: Within this share of its body's length from its pin, a particle has no angle worth showing.
_NEAR_PIN = 0.1


class Extreme(NamedTuple):
    """The largest size of a quantity, when and where it was."""

    size: float
    time: float  #: in s
    body: int
    index: int  #: of the link or the particle, among its body's


@dataclasses.dataclass
class Body:
    """A rope or a net."""

    name: str  #: its label, or "rope 0"; no two bodies have the same
    shown_name: str  #: the same in the language of the scene
    key: str  #: the name in the columns of tables
    color: str  #: "#rrggbb" in print; empty if it does not show on white or tells something else
    is_net: bool
    is_chain: bool  #: link k joins its particles k and k + 1
    particles: slice  #: its part of all particles
    links: slice  #: its part of all links
    rest_m: np.ndarray  #: rest lengths of the links
    ends: np.ndarray  #: (links, 2): particles of the whole scene
    reach: int
    compliance: float
    payload_kg: float
    method: str
    knows_tensions: bool
    moves: bool
    tracked: int = None  #: the particle that stands for the motion of the body; None of a body without curves
    is_free_end: bool = False
    pin: int = None  #: its only pinned particle


class Track:
    """The tracked particle of a body at the times of all frames."""

    def __init__(self, motion, body):
        self.body = body
        self.times = motion.times
        #: Positions relative to the origin of the motion, and velocities: (frames, 2).
        self.position = motion.positions[:, body.tracked]
        self.velocity = motion.velocities[:, body.tracked]
        #: The positions of the pin, if there is one.
        self.pin = pin = None if body.pin is None else motion.positions[:, body.pin]
        self.start = self.position[0] if pin is None else pin[0]
        self.arm = None if pin is None else self.position - pin
        #: The velocity relative to the pin.
        self.arm_velocity = None if pin is None else self.velocity - motion.velocities[:, body.pin]
        # `relaxation` has one velocity per step, which is not the slope of its path.
        self.is_stepped = body.method == "relaxation"

    @functools.cached_property
    def turns(self):
        """Whether the particle turns about the pin of its body, and keeps away from it."""
        if self.arm is None or not self.body.is_free_end:
            return False
        return np.hypot(*self.arm.T).min() >= _NEAR_PIN * self.body.rest_m.sum()

    @functools.cached_property
    def swing(self):
        """The Swing; the body has a pin."""
        return Swing(self)

    @functools.cached_property
    def angle(self):
        """Angle of the way from the pin in rad from straight down, positive towards +x, and its rate in rad/s: two arrays.
        Turns are counted on by the rate, since a fast rope may turn by more than half a turn between frames. Between two frames
        the rate is the geometric mean of both, that of a uniform rotation."""
        (x, y), (vx, vy) = self.arm.T, self.arm_velocity.T
        with np.errstate(all="ignore"):
            rate = (x * vy - y * vx) / (x * x + y * y)
            raw = _corda.angle(x, -y)
            product = rate[:-1] * rate[1:]
            mean = np.where(product > 0.0, np.copysign(np.sqrt(np.maximum(product, 0.0)), rate[1:]), 0.0)
            turns = np.round((raw[:-1] + mean * np.diff(self.times) - raw[1:]) / _TURN)
        counted = np.concatenate([[0.0], np.cumsum(np.where(np.isfinite(turns), turns, 0.0))])
        return raw + _TURN * counted, rate

    def curve(self, values, slopes):
        """Points of a smooth curve through values of all frames: up to eight per frame, by cubic polynomials with the slopes
        of the frames. Shape (points, ...)."""
        frames = len(self.times)
        count = int(np.clip(4000 // max(frames, 1), 1, 8))
        if self.is_stepped and frames > 1:
            slopes = np.gradient(values, self.times, axis=0)
        return hermite(self.times, values, slopes, count)

    def phase(self):
        """Angle and angular velocity, of a smooth curve: (points, 2)."""
        angle, rate = self.angle
        if self.is_stepped:
            return np.stack([angle, rate], axis=1)
        return self._with_slope(angle, rate)

    def horizontal(self):
        """x from the pin, or from the start without one, and the horizontal velocity: (points, 2)."""
        x, vx = self.position[:, 0] - self.start[0], self.velocity[:, 0]
        return np.stack([x, vx], axis=1) if self.is_stepped else self._with_slope(x, vx)

    def _with_slope(self, values, slopes):
        # The slope of the interpolating polynomial has the error of its third order, a hundredth of a pixel at 60 frames/s.
        count = int(np.clip(4000 // max(len(self.times), 1), 1, 8))
        return np.stack([hermite(self.times, values, slopes, count), hermite_slope(self.times, values, slopes, count)], axis=1)


def _pieces(times, values, slopes, count):
    """Of each interval: the place of `count` points in it, 0 .. 1, its length, and its ends, in shapes for broadcasting."""
    more = (1,) * (values.ndim - 1)
    place = (np.arange(count) / count).reshape(1, count, *more)
    step = np.diff(times).reshape(-1, 1, *more)
    ends = (values[:-1, None], step * slopes[:-1, None], values[1:, None], step * slopes[1:, None])
    return place, step, ends


def hermite(times, values, slopes, count):
    """Cubic Hermite interpolation: `count` points per interval and the last value, of shape (points, ...)."""
    s, _, (v0, d0, v1, d1) = _pieces(times, values, slopes, count)
    rise = v1 - v0
    inside = v0 + s * (d0 + s * (3 * rise - 2 * d0 - d1 + s * (d0 + d1 - 2 * rise)))
    return np.concatenate([inside.reshape(-1, *values.shape[1:]), values[-1:]])


def hermite_slope(times, values, slopes, count):
    """The derivative of hermite()."""
    s, step, (v0, d0, v1, d1) = _pieces(times, values, slopes, count)
    rise = v1 - v0
    inside = (d0 + s * (2 * (3 * rise - 2 * d0 - d1) + 3 * s * (d0 + d1 - 2 * rise))) / step
    return np.concatenate([inside.reshape(-1, *values.shape[1:]), slopes[-1:]])


def first_turn(path, pin=None):
    """The frame at which a path (frames, 2) first turns back about that of a pin, or in x without one, a quarter of its whole way
    or more from its start; None if there is none. A quarter of a turn about the pin is always enough."""
    way = path[:, 0] if pin is None else np.unwrap(_corda.angle(path[:, 0] - pin[:, 0], pin[:, 1] - path[:, 1]))
    enough = 0.25 * (np.ptp(way) if pin is None else min(np.ptp(way), _TURN))
    before, after = np.diff(way)[:-1], np.diff(way)[1:]
    turns = (before * after < 0.0) | ((before != 0.0) & (after == 0.0))
    at = np.flatnonzero(turns & (np.abs(way[1:-1] - way[0]) >= enough)) + 1
    return int(at[0]) if enough > 0.0 and len(at) else None


def spread(times, last, count):
    """Up to `count` of the times, evenly spread from the first to number `last`; None: to the last of all."""
    last = len(times) - 1 if last is None else last
    return list(dict.fromkeys(float(times[int(last * i / (count - 1) + 0.5)]) for i in range(count)))


def _root(function, count):
    """Where each of `count` functions of 0 .. 1 changes its sign, by bisection."""
    low, high = np.zeros(count), np.ones(count)
    rises = function(high) > 0.0
    for _ in range(53):
        middle = 0.5 * (low + high)
        is_beyond = (function(middle) > 0.0) == rises
        high = np.where(is_beyond, middle, high)
        low = np.where(is_beyond, low, middle)
    return 0.5 * (low + high)


def _cubic(v0, d0, v1, d1):
    """The polynomial of hermite() for one interval, and its derivative, as functions of the place in it."""
    rise = v1 - v0
    second, third = 3 * rise - 2 * d0 - d1, d0 + d1 - 2 * rise
    return (lambda s: v0 + s * (d0 + s * (second + s * third))), (lambda s: d0 + s * (2 * second + 3 * s * third))


class Swing:
    """Period and amplitude of a Track with a pin, from its frames."""

    def __init__(self, track):
        #: Times of the passes below the pin, in s, and the period, in s; None for a `reason`, if passes do not agree.
        self.passes, self.period, self.reason = _corda.swing(track.times, track.arm, track.arm_velocity)
        #: The largest angle to a side, in degrees.
        self.amplitude_deg = np.degrees(self._largest_angle(track, np.diff(track.times)))

    @staticmethod
    def _largest_angle(track, step):
        angle, (_, rate) = _corda.angle(track.arm[:, 0], -track.arm[:, 1]), track.angle
        with np.errstate(invalid="ignore"):
            at = np.flatnonzero((rate[:-1] * rate[1:] < 0.0) & (np.abs(np.diff(angle)) < 0.5 * np.pi))
        value, slope = _cubic(angle[at], step[at] * rate[at], angle[at + 1], step[at] * rate[at + 1])
        return np.abs(np.concatenate([angle, value(_root(slope, len(at)))])).max()


class Motion:
    """The numbers of all frames of a film, up to the end of its scene, or to the frame before the motion diverges: arrays as
    those of Film, but positions relative to `origin` and energies (frames, 3) of motion, weight and elasticity in J; and the facts
    of its scene and plan in the types of the C++ half (figures.cpp)."""

    def __init__(self, film):
        numbers = film._film.rows()
        facts = film._film.facts()
        for name, value in {**numbers, **facts}.items():
            setattr(self, name, value)
        self.masses = self.mass_kg
        self.bodies = _bodies(facts["bodies"])
        self.tracks = [Track(self, body) for body in self.bodies if body.tracked is not None]

    @functools.cached_property
    def moving_count(self):
        return sum(body.moves for body in self.bodies)

    @functools.cached_property
    def is_elastic(self):
        return self.bends or any(body.compliance > 0.0 for body in self.bodies)

    @functools.cached_property
    def speed(self):
        return self._extreme(np.sqrt((self.velocities**2).sum(axis=2)), [body.particles for body in self.bodies])

    @functools.cached_property
    def tension(self):
        return self._extreme(np.abs(self.tensions), [body.links for body in self.bodies])

    @functools.cached_property
    def strain(self):
        return self._extreme(np.abs(self.strains), [body.links for body in self.bodies])

    def _extreme(self, sizes, parts):
        """The largest of (frames, n) sizes; None if all are NaN."""
        if sizes.size == 0 or np.all(np.isnan(sizes)):
            return None
        frame, column = np.unravel_index(np.nanargmax(sizes), sizes.shape)
        body = next(b for b, part in enumerate(parts) if part.start <= column < part.stop)
        return Extreme(float(sizes[frame, column]), float(self.times[frame]), body, int(column - parts[body].start))

    def unknown_tensions(self):
        """The bodies whose method told no tension."""
        return [body for body in self.bodies if len(body.rest_m) and np.all(np.isnan(self.tensions[:, body.links]))]

    def largest(self, values, body):
        """The largest size of a quantity of a body's links in each frame, and the index of the link: NaN if unknown."""
        sizes = np.abs(values[:, body.links])
        known = ~np.all(np.isnan(sizes), axis=1) if sizes.shape[1] else np.zeros(len(sizes), bool)
        size, link = np.full(len(sizes), np.nan), np.full(len(sizes), np.nan)
        if known.any():
            link[known] = np.nanargmax(sizes[known], axis=1)
            size[known] = np.nanmax(sizes[known], axis=1)
        return size, link


def _distinct(names):
    """The names, with a number after those that were there before."""
    taken, repeats, distinct = set(), {}, []
    for name in names:
        one = name
        while one in taken:
            repeats[name] = repeats.get(name, 1) + 1
            one = f"{name} {repeats[name]}"
        taken.add(one)
        distinct.append(one)
    return distinct


def _bodies(facts):
    names = _distinct([body["name"] for body in facts])
    shown_names = _distinct([body["shown_name"] for body in facts])
    bodies, links = [], 0
    for body, name, shown_name in zip(facts, names, shown_names):
        values = dict(body, name=name, shown_name=shown_name, particles=slice(*body["particles"]),
                      links=slice(links, links + len(body["rest_m"])))
        links = values["links"].stop
        bodies.append(Body(**values))
    return bodies


def motion_of(film):
    """The Motion of a film, which is read once."""
    if film._motion is None:
        film._motion = Motion(film)
    return film._motion

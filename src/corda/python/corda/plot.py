"""Plots of a film's motion by matplotlib:

    import corda
    import corda.plot                       # needs matplotlib: the package python3-matplotlib
    film = corda.Film("swing.toml")
    ax = corda.plot.angle(film)             # axes in new figure, or in those given as ax
    ax.set_title("A rope")

Each function takes a Film and axes (None: of a new figure), draws a curve per rope or net, and returns the axes. The first
six bodies that move are shown, by the particle that stands for each: the free end of a rope, or else the middle one of its
free particles, or the most central of a net. Axes have SI units, with the prefix that suits the values, and words and the
decimal sign of the scene's language. Curves have the colours of the bodies on paper; colours of their own, if two bodies have
the same or one does not show on white. A motion that diverges is shown up to there.

Raises corda.Error: code 2 for a scene that has no such plot, and as Film for a motion that cannot be simulated.
"""

import math as _math

import numpy as _np

from . import _corda
from ._arguments import make_error as _make_error
from ._motion import motion_of as _motion_of
from ._theory import hangs_alone as _hangs_alone, period_of as _period_of, weights_below as _weights_below

try:
    from matplotlib.ticker import ScalarFormatter as _ScalarFormatter
except ImportError as _missing:
    raise ImportError("corda.plot needs matplotlib, which is not installed for this Python; install the package "
                      "python3-matplotlib (apt-get install python3-matplotlib, or pip install matplotlib)") from _missing

__all__ = ["angle", "divergence", "energy", "phase", "strain", "tension", "tension_along", "tip"]

#: Colours that colour-blind readers can tell apart on white (after Okabe and Ito 2008, without their yellow and black).
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5fd0", "#8c6d31")
_THEORY = {"color": "#5b6470", "linestyle": (0, (4, 2)), "linewidth": 0.8}
_PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}


class _Formatter(_ScalarFormatter):
    """Numbers with the decimal sign of a language, and no offset."""

    def __init__(self, sign):
        super().__init__(useOffset=False)
        self.set_scientific(False)
        self._sign = sign

    def __call__(self, x, pos=None):
        return super().__call__(x, pos).replace(".", self._sign)


class _Plot:
    """Axes in the language of a film."""

    def __init__(self, motion, ax):
        self.motion = motion
        if ax is None:
            import matplotlib.pyplot  # chooses how figures are shown, which axes that are given have done

            ax = matplotlib.pyplot.subplots()[1]
        self.ax = ax
        self.ax.grid(True, color="#dddddd", linewidth=0.5)
        self.ax.set_axisbelow(True)
        self._legend = []  # pairs of an artist and its name

    def word(self, english):
        return _corda.translated(english, self.motion.language)

    def name_axes(self, x, y, is_log=False):
        """Sets titles (words, unit, largest size of the values); returns the divisors of the values."""
        units = []
        for axis, (words, unit, largest) in ((self.ax.xaxis, x), (self.ax.yaxis, y)):
            title, size = _title(self.word(words), unit, largest)
            axis.set_label_text(title)
            units.append(size)
        sign = "." if self.motion.language == 0 else ","
        self.ax.xaxis.set_major_formatter(_Formatter(sign))
        if x[1] == "s":
            self.ax.margins(x=0.0)
        if is_log:
            self.ax.set_yscale("log")
        else:
            self.ax.yaxis.set_major_formatter(_Formatter(sign))
        return units

    def line(self, x, y, name, color):
        (artist,) = self.ax.plot(x, y, color=color, linewidth=0.9, label=name or None, solid_capstyle="round")
        if name:
            self._legend.append((artist, name))

    def theory(self, name, x, y=None):
        """A dashed line, level if there is no y."""
        artist = self.ax.axhline(x, label=name, **_THEORY) if y is None else self.ax.plot(x, y, label=name, **_THEORY)[0]
        self._legend.append((artist, name))

    def circles(self, x, y, name):
        (artist,) = self.ax.plot(x, y, linestyle="none", marker="o", markersize=3.0, markerfacecolor="white",
                                 markeredgecolor=_THEORY["color"], markeredgewidth=0.8, zorder=3, label=name)
        self._legend.append((artist, name))

    def finish(self):
        """Adds the names of the curves above the axes, in as many columns as fit."""
        if self._legend:
            artists, names = zip(*self._legend)
            font = self.ax.xaxis.label.get_size()
            width_pt = 72.0 * self.ax.bbox.width / self.ax.figure.dpi  # of axes of figures and of subfigures
            entry_pt = font * (0.56 * max(map(len, names)) + 2.8)
            columns = int(_np.clip(width_pt // entry_pt, 1, len(names)))
            # matplotlib leaves out names that begin with "_": names are set afterwards.
            legend = self.ax.legend(artists, [str(k) for k in range(len(names))], loc="lower left", bbox_to_anchor=(0.0, 1.0),
                                    ncol=columns, frameon=False, borderaxespad=0.2, handlelength=1.6, columnspacing=1.2,
                                    fontsize=font)
            for text, name in zip(legend.get_texts(), names):
                text.set_text(name)
        return self.ax


def _plain(text):
    """A text of the scene for matplotlib, which reads the text between two dollar signs as a formula."""
    return text.replace("$", r"\$")


def _title(name, unit, largest):
    """The title of numbers up to `largest`, such as "tension (kN)", and the divisor of their values for it. Angles and
    seconds take no prefix; without a unit: a power of ten."""
    least = 0.1 if unit else 0.01
    is_plain = largest == 0.0 or not _math.isfinite(largest) or least * (1 - 1e-9) <= largest < 1e4
    exponent = 0 if is_plain or unit == "s" else 3 * _math.floor(_math.log10(largest * (1 + 1e-9)) / 3)
    size = 10.0**exponent if exponent >= 0 else 1.0 / 10.0**-exponent
    takes_prefix = unit and not unit.startswith(("°", "rad")) and exponent in _PREFIXES
    if takes_prefix:
        return f"{name} ({_PREFIXES[exponent]}{unit})", size
    factor = f"$10^{{{exponent}}}$" if exponent else ""
    inside = " ".join(part for part in (factor, unit) if part)
    return f"{name} ({inside})" if inside else name, size


def _largest(curves, column):
    """The largest finite size of a column of several arrays; 0 if there is none."""
    values = _np.concatenate([_np.abs(curve[:, column]) for curve in curves])
    values = values[_np.isfinite(values)]
    return float(values.max()) if len(values) else 0.0


def _draw(film, ax, curves, x, y, is_log=False):
    """A plot of (points, 2) arrays, as triples of array, name and colour, over axes with (words, unit)."""
    plot = _Plot(_motion_of(film), ax)
    arrays = [curve for curve, _, _ in curves]
    x_unit, y_unit = plot.name_axes((*x, _largest(arrays, 0)), (*y, _largest(arrays, 1)), is_log)
    for curve, name, color in curves:
        plot.line(curve[:, 0] / x_unit, curve[:, 1] / y_unit, name, color)
    return plot, x_unit, y_unit


def _colors(bodies):
    """The colours of the bodies in print, or others if they do not tell all apart."""
    own = [body.color for body in bodies]
    return own if all(own) and len(set(own)) == len(own) else [_COLORS[k % len(_COLORS)] for k in range(len(own))]


def _curves(motion, tracks, curve_of):
    """Curves of tracks for _draw(), by a function of a track."""
    colors = _colors([track.body for track in motion.tracks])
    named = len(motion.tracks) > 1
    return [(curve_of(track), _plain(track.body.shown_name) if named else "", colors[motion.tracks.index(track)])
            for track in tracks]


def _moving(motion, what):
    if not motion.tracks:
        raise _make_error(f"corda.plot.{what}: nothing moves, because all particles are pinned")
    return motion.tracks


def angle(film, ax=None):
    """Angle of the line from the pin to the free end of each rope that turns about one pin, in degrees from straight down,
    positive towards +x, over time in s. If the first swings and theory has a period for the scene, circles are where the
    theory has it below the pin, counted from the first pass: of a point pendulum or a rigid rod of this amplitude, by the
    elliptic integral, or of a hanging rope at small angles, by the least zero of a Laguerre polynomial (R2 to R4 of
    src/corda/sim/README.md)."""
    motion = _motion_of(film)
    tracks = [track for track in motion.tracks if track.turns]
    if not tracks:
        raise _make_error("corda.plot.angle: no rope of the scene turns about one pin and keeps away from it; use corda.plot.phase "
                          "or corda.plot.tip")

    def over_time(track):
        return _np.stack([track.curve(track.times, _np.ones_like(track.times)),
                          _np.degrees(track.curve(*track.angle))], axis=1)

    plot, _, _ = _draw(film, ax, _curves(motion, tracks, over_time), ("t", "s"), ("angle", "°"))
    swing = tracks[0].swing
    theory = _period_of(motion, swing.amplitude_deg) if len(motion.bodies) == 1 and swing.period is not None else None
    if theory:
        passes = _np.arange(swing.passes[0], motion.times[-1], 0.5 * theory.seconds)
        whole_turns = 360.0 * round(tracks[0].angle[0][0] / (2.0 * _math.pi))
        plot.circles(passes, _np.full_like(passes, whole_turns), plot.word("theory"))
    return plot.finish()


def phase(film, ax=None):
    """Phase portrait: the angular velocity of each rope in rad/s over its angle in rad (see angle), turns counted on. If a
    body does not turn about one pin, or comes near to it: the horizontal velocity over the horizontal position of all bodies,
    counted from their pins or, of bodies with none or several, from the start."""
    motion = _motion_of(film)
    tracks = _moving(motion, "phase")
    if all(track.turns for track in tracks):
        curves, axes = _curves(motion, tracks, lambda track: track.phase()), (("angle", "rad"), ("angular velocity", "rad/s"))
    else:
        curves, axes = _curves(motion, tracks, lambda track: track.horizontal()), (("x", "m"), ("vx", "m/s"))
    return _draw(film, ax, curves, *axes)[0].finish()


def tip(film, ax=None):
    """The path of each body's particle in m: x and y with equal scales. Of a scene that is far from (0, 0) for its size,
    counted from the first body's origin."""
    motion = _motion_of(film)
    tracks = _moving(motion, "tip")
    shift = _np.zeros(2) if is_far(motion) else _np.asarray(motion.origin)
    curves = _curves(motion, tracks, lambda track: track.curve(track.position, track.velocity) + shift)
    largest = max(_largest([curve for curve, _, _ in curves], column) for column in (0, 1))
    plot = _Plot(motion, ax)
    unit, _ = plot.name_axes(("x", "m", largest), ("y", "m", largest))
    for curve, name, color in curves:
        plot.line(curve[:, 0] / unit, curve[:, 1] / unit, name, color)
    plot.ax.set_aspect("equal")
    return plot.finish()


def is_far(motion):
    """Whether axes in the scene's coordinates would have the same number at each tick."""
    path = _np.concatenate([track.position for track in motion.tracks])
    return _np.abs(motion.origin).max() > 1e3 * _np.ptp(path, axis=0).max()


def energy(film, ax=None):
    """Energy of all free particles over time in J: kinetic, that of the weight since the start, elastic if anything stretches
    or bends, and their sum, which a scene without drag keeps."""
    motion = _motion_of(film)
    kinds = ["kinetic", "weight", "elastic"] if motion.is_elastic else ["kinetic", "weight"]
    values = [motion.energies[:, k] for k in range(len(kinds))] + [motion.energies.sum(axis=1)]
    translated = [_corda.translated(kind, motion.language) for kind in (*kinds, "total")]
    curves = [(_np.stack([motion.times, value], axis=1), name, color)
              for value, name, color in zip(values, translated, [*_COLORS[: len(kinds)], "#000000"])]
    return _draw(film, ax, curves, ("t", "s"), ("energy", "J"))[0].finish()


def tension(film, ax=None):
    """The largest tension of a link of each body over time in N; one that pushes counts by the size of its force. Dashed, for one
    rope that hangs from its first particle: the largest at rest, which is its weight."""
    motion = _motion_of(film)
    tracks = [track for track in _moving(motion, "tension")
              if not _np.all(_np.isnan(motion.largest(motion.tensions, track.body)[0]))]
    if not tracks:
        raise _make_error("corda.plot.tension: no tension is known; use method exact or rattle, and bars that do not depend on "
                          "each other")
    curves = _curves(motion, tracks, lambda track: _np.stack(
        [motion.times, motion.largest(motion.tensions, track.body)[0]], axis=1))
    plot, _, unit = _draw(film, ax, curves, ("t", "s"), ("largest tension", "N"))
    if _hangs_alone(motion):
        plot.theory(plot.word("at rest"), _weights_below(motion)[0] / unit)
    return plot.finish()


def tension_along(film, ax=None):
    """The tensions in N of the links of the rope with the largest of all, when it is reached, against the distance in m of
    their middles from particle 0 along the rope at rest. Dashed, for one rope that hangs from its first particle: at rest."""
    motion = _motion_of(film)
    largest = motion.tension
    body = None if largest is None else motion.bodies[largest.body]
    if body is None or body.is_net or len(body.rest_m) < 3:
        raise _make_error("corda.plot.tension_along: the largest tension is not in a rope of three links or more")
    middles = _np.cumsum(body.rest_m) - 0.5 * body.rest_m
    frame = int(_np.flatnonzero(motion.times == largest.time)[0])
    curve = _np.stack([middles, motion.tensions[frame, body.links]], axis=1)
    plot, x_unit, unit = _draw(film, ax, [(curve, "", _COLORS[0])], ("distance along the rope", "m"), ("tension", "N"))
    if _hangs_alone(motion):
        plot.theory(plot.word("at rest"), middles / x_unit, _weights_below(motion) / unit)
    return plot.finish()


def strain(film, ax=None):
    """The largest strain, | length / rest length - 1 |, of a link of each body over time; a slack link of a string counts as
    0."""
    motion = _motion_of(film)
    curves = _curves(motion, _moving(motion, "strain"), lambda track: _np.stack(
        [motion.times, motion.largest(motion.strains, track.body)[0]], axis=1))
    return _draw(film, ax, curves, ("t", "s"), ("largest strain", ""))[0].finish()


def divergence(film, ax=None):
    """The distance in m of the ends of the first two bodies that move over time, on a logarithmic axis: a straight line where
    the motion magnifies a difference at a constant rate. Equal positions are drawn as the smallest distance."""
    motion = _motion_of(film)
    if len(motion.tracks) < 2:
        raise _make_error("corda.plot.divergence: the scene has one body that moves, or none; give it two, such as copies of a "
                          "rope")
    first, second = motion.tracks[:2]
    apart = _np.hypot(*(first.position - second.position).T)
    size = _np.ptp(motion.positions[0], axis=0).max()
    least = apart[apart > 0.0].min() if _np.any(apart > 0.0) else 1e-16 * size
    name = _plain(f"{first.body.shown_name} – {second.body.shown_name}") if motion.moving_count > 2 else ""
    curve = _np.stack([motion.times, _np.maximum(apart, least)], axis=1)
    plot = _Plot(motion, ax)
    plot.name_axes(("t", "s", 0.0), ("distance of the tips", "m", 0.0), is_log=True)
    plot.line(curve[:, 0], curve[:, 1], name, _COLORS[0])
    return plot.finish()

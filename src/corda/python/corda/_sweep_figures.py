"""Figures of a sweep by matplotlib: plots of one column over another, and a contact sheet."""

import io
import math
import os
import re

import numpy as np

from . import _corda, _parameters, _theory
from ._archive import csv_text, save_file
from ._arguments import make_error
from ._corda import Error
from ._distributions import Distribution
from ._motion import first_turn, spread
from ._sample import REFUSALS
from ._shards import rows_of
from ._sweep_file import is_number, section_of, short_text, value_text

try:
    from matplotlib import style
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    from .plot import _COLORS, _plain
except ImportError:
    raise make_error("--plot and --sheet need matplotlib, which is not installed for this Python; install the package "
                     "python3-matplotlib (apt-get install python3-matplotlib, or pip install matplotlib)") from None

_UNITS = {"_m_s": "m/s", "_s": "s", "_deg": "°", "_n": "N", "_px": "px", "_m": "m"}
_STYLE = {"font.size": 9.0, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True,
          "grid.color": "#dddddd", "grid.linewidth": 0.5, "legend.frameon": False, "svg.hashsalt": "corda", "savefig.dpi": 300}
_PAGE_MM = 170.0
_MM_PER_INCH = 25.4
_CURVE_POINTS = 200
_MAX_CELLS = 36
_CELL_PX, _TEXT_PX, _LINE_PX, _GAP_PX = 240, 13, 17, 12
_POSES = 6


def _short_name(key):
    """"angle_deg" of "rope[0].hang.angle_deg"."""
    return key.rpartition(".")[2]


class _Column:
    """A column of metadata.csv."""

    def __init__(self, name, is_summary):
        self.name = name
        self.is_summary = is_summary

    def title(self):
        """"angle max (°)", "mass (kg)"."""
        text = _short_name(self.name)
        ending = next((ending for ending in _UNITS if text.endswith(ending)), "")
        unit = _UNITS.get(ending, "")
        if not unit and not self.is_summary:
            section, name = section_of(self.name)
            unit = _corda.scene_keys(section).get(name, "")
        text = text.removesuffix(ending).replace("_", " ")
        return f"{text} ({unit})" if unit else text

    def value(self, row):
        value = row.get("summary" if self.is_summary else "parameters", {}).get(self.name)
        return float(value) if is_number(value) else None


def find_columns(sweep, text):
    """The columns of "Y:X". Raises Error (code 2)."""
    y, colon, x = text.partition(":")
    if not colon:
        raise make_error(f"--plot {short_text(text)}: is not Y:X, such as period_s:angle_max_deg")
    return _find_column(sweep, y), _find_column(sweep, x)


def _find_column(sweep, name):
    found = [_Column(column, True) for column in sweep.summary if column == name]
    found += [_Column(key, False) for key in sweep.vary if name in (key, _short_name(key))]
    if len(found) == 1:
        return found[0]
    problem = "several columns are named" if found else "there is no column"
    raise make_error(f'--plot: {problem} "{short_text(name)}"; give Y:X, two of {", ".join([*sweep.summary, *sweep.vary])}')


def _file_name(sweep, column):
    """"mass", or "rope_0__mass" if another key ends alike."""
    short = _short_name(column.name)
    name = column.name if sum(_short_name(key) == short for key in sweep.vary) > 1 else short
    return re.sub(r"[\[\].]", "_", name)


def _series_keys(sweep, x):
    """Keys whose choices are series of their own: those with the fewest values, but not `x`."""
    choices = [(len(values), key) for key, values in sweep.vary.items()
               if isinstance(values, list) and key != x.name and len(values) > 1]
    keys, count = [], 1
    for values, key in sorted(choices, key=lambda choice: choice[0]):
        count *= values
        if count <= len(_COLORS):
            keys.append(key)
    return keys


def period_theory(sweep, parameters, angle_deg):
    """The period in s of the scene with these parameters that swings through an angle, by theory; None if there is none."""
    swing = _corda.swing_of(sweep.scene_toml, os.fsencode(sweep.scene_source), _parameters.settings_of(parameters))
    if swing is None or not abs(angle_deg) < 180.0:
        return None
    model, links, spacing_m, gravity = swing
    if model == "rope":
        return 2.0 * math.pi / _theory.rope_omega(links, spacing_m, gravity)
    omega = math.sqrt(gravity / spacing_m) if model == "point" else _theory.rod_omega(links, spacing_m, gravity)
    return _theory.pendulum_period(omega, angle_deg)


def _order(value):
    """Sorts numbers by their size, before words and lists by their text."""
    return (0, value, "") if is_number(value) else (1, 0.0, value_text(value))


def _read_points(sweep, folder, y, x):
    """The samples of a plot: the parameters of the first of each series by its name, in the order of the values that name it, a
    dictionary per point, and the number of samples that lack a figure; and whether the points of a series lie on a line, and
    those of its theory on a curve over angles."""
    keys = _series_keys(sweep, x)
    series, points, others = {}, [], 0
    for number, row in rows_of(sweep, folder):
        values = x.value(row), y.value(row)
        if None in values or "failure" in row:
            others += 1
            continue
        parameters = row["parameters"]
        name = ", ".join(f"{_short_name(key)} = {value_text(parameters[key])}" for key in parameters if key in keys)
        series.setdefault(name, parameters)
        angle_deg = row["summary"].get("angle_max_deg")
        theory = period_theory(sweep, parameters, angle_deg) if y.name == "period_s" and is_number(angle_deg) else None
        points.append({"key": _parameters.key_of(number), "series": name, "x": values[0], "y": values[1], "theory": theory})
    if not points:
        raise make_error(f"--plot {y.name}:{x.name}: no finished sample in '{folder}' has both figures (a period needs three "
                         "passes below the only pin, and successive ones that agree)")
    others_vary = [key for key, values in sweep.vary.items()
                   if key not in keys and not (isinstance(values, list) and len(values) == 1)]
    is_line = len(others_vary) <= 1
    is_curve = (x.name == "angle_max_deg" or _short_name(x.name) == "angle_deg") and all(
        _short_name(key) == "angle_deg" for key in others_vary)
    series = dict(sorted(series.items(), key=lambda one: [_order(one[1][key]) for key in keys]))
    return series, points, others, is_line, is_curve


def _draw_points(sweep, axes, series, points, is_line, is_curve):
    for i, (name, parameters) in enumerate(series.items()):
        own = sorted((point for point in points if point["series"] == name), key=lambda point: point["x"])
        color = _COLORS[i % len(_COLORS)]
        known = [(point["x"], point["theory"]) for point in own if point["theory"] is not None]
        shown = _plain(name)
        label = f"theory, {shown}" if name else "theory"
        if known and is_curve:
            angles = np.linspace(min(known)[0], max(known)[0], _CURVE_POINTS + 1)
            periods = [period_theory(sweep, parameters, angle) for angle in angles]
            axes.plot(angles, periods, color=color, linewidth=0.9, linestyle="--", label=label)
        elif known:
            axes.plot(*zip(*known), linewidth=0.9, linestyle="--" if is_line else "none", marker="x", markersize=4.0, color=color,
                      label=label)
        axes.plot([point["x"] for point in own], [point["y"] for point in own], linewidth=0.9,
                  linestyle="-" if is_line else "none", marker="o", markersize=3.0, markerfacecolor="none", color=color,
                  label=shown or "measured")


def write_plot(sweep, folder, columns):
    """Draws Y over X of the finished samples as SVG, PDF, PNG and CSV in the folder; returns the paths. Raises Error: code 2 if
    no sample has both, and 6."""
    y, x = find_columns(sweep, columns)
    series, points, others, is_line, is_curve = _read_points(sweep, folder, y, x)
    stem = os.path.join(folder, f"{_file_name(sweep, y)}-{_file_name(sweep, x)}")
    paths = []
    with style.context(["default", _STYLE]):  # whatever the user's matplotlibrc says
        figure = Figure(figsize=(_PAGE_MM / _MM_PER_INCH, 0.6 * _PAGE_MM / _MM_PER_INCH), layout="constrained")
        axes = figure.add_subplot()
        _draw_points(sweep, axes, series, points, is_line, is_curve)
        axes.set_xlabel(x.title())
        axes.set_ylabel(y.title())
        axes.set_title(_plain(os.path.splitext(os.path.basename(sweep.source))[0]), loc="left", fontsize=9.0)
        if others:
            axes.set_title(f"{others} of {others + len(points)} samples have no such figures", loc="right", fontsize=8.0)
        values = sweep.vary.get(x.name)
        if isinstance(values, Distribution) and values.shape == "log_uniform":
            axes.set_xscale("log")
        axes.legend(loc="best", fontsize=8.0)
        for extension, date in (("svg", "Date"), ("pdf", "CreationDate"), ("png", "Software")):
            file = io.BytesIO()
            figure.savefig(file, format=extension, metadata={date: None})
            paths.append(f"{stem}.{extension}")
            save_file(paths[-1], file.getvalue())
    rows = [[point[name] for name in ("key", "series", "x", "y", "theory")] for point in points]
    paths.append(f"{stem}.csv")
    save_file(paths[-1], csv_text(["key", "series", x.name, y.name, "theory"], rows).encode())
    return paths


def _first_swing(film):
    """Six frame times from the start to the first turn of the tracked particle, or else to the end."""
    facts = _corda.sample_facts(film)
    arrays = _corda.labels(film, ["times", "positions"])
    particle, pin = (None if facts[key] is None else arrays["positions"][:, facts[key]] for key in ("particle", "pin"))
    turn = None if particle is None else first_turn(particle, pin)
    return spread(arrays["times"], turn, _POSES)


def _cell(sweep, number, gl):
    """The poses of a sample (None if the scene refuses it) and the lines below them."""
    lines = [_parameters.key_of(number)]
    try:
        parameters = _parameters.parameters_of(sweep, number)
        for key, value in parameters.items():
            rounded = float(f"{value:.4g}") if isinstance(value, float) else value
            lines.append(f"{_short_name(key)} = {short_text(value_text(rounded))}")
        scene = sweep.scene_toml, os.fsencode(sweep.scene_source)
        settings = _parameters.settings_of(parameters)
        width, height = _corda.picture_size(*scene, settings)
        size = [max(1, math.floor(_CELL_PX * side / max(width, height) + 0.5)) for side in (width, height)]
        film = _corda.sample_film(*scene, [*settings, "overlay={time=false}", f"video.size={size}"], *gl)
        times = _first_swing(film)
        picture = _corda.poses(film, times)
    except Error as error:
        if error.code not in REFUSALS:
            raise
        return None, [*lines, "refused"]
    return picture, [*lines, f"{len(times)} poses, t = 0 .. {times[-1]:.4g} s"]


def write_sheet(sweep, folder, gl):
    """Draws the first swing of up to 36 samples with their parameters and times as sheet.png in the folder; returns the path.
    `gl`: that of a Run."""
    count = min(_MAX_CELLS, sweep.samples)
    columns = math.ceil(math.sqrt(count))
    cells = [_cell(sweep, i * sweep.samples // count, gl) for i in range(count)]
    with style.context("default"):
        picture = _sheet_png(cells, columns)
    path = os.path.join(folder, "sheet.png")
    save_file(path, picture)
    return path


def _sheet_png(cells, columns):
    """The bytes of a PNG of the cells, pairs of a picture and lines of text."""
    picture_px = max((len(picture) for picture, _ in cells if picture is not None), default=0)
    row_px = picture_px + max(len(lines) for _, lines in cells) * _LINE_PX + 2 * _GAP_PX
    width_px = columns * (_CELL_PX + _GAP_PX) + _GAP_PX
    height_px = -(-len(cells) // columns) * row_px
    figure = Figure(figsize=(width_px / 100.0, height_px / 100.0), dpi=100)
    canvas = FigureCanvasAgg(figure)
    for i, (picture, lines) in enumerate(cells):
        left = _GAP_PX + i % columns * (_CELL_PX + _GAP_PX)
        top = _GAP_PX + i // columns * row_px
        if picture is not None:
            figure.figimage(picture, left, height_px - top - len(picture), origin="upper")
        for k, line in enumerate(lines, 1):
            text = figure.text(left / width_px, 1.0 - (top + picture_px + k * _LINE_PX) / height_px, line, fontsize=_TEXT_PX * 0.72,
                               verticalalignment="baseline", parse_math=False)
            while text.get_window_extent(canvas.get_renderer()).width > _CELL_PX:
                line = line[:-1]
                text.set_text(line + "…")
    file = io.BytesIO()
    figure.savefig(file, format="png", metadata={"Software": None})
    return file.getvalue()

"""`python3 -m corda sweep --plot --sheet`: figures of the samples for people."""

import csv
import math
import xml.etree.ElementTree

import matplotlib
import numpy as np
import pytest

import corda
import corda.sweep
from corda import _sweep_figures, _sweep_file
from corda._motion import first_turn, spread

SCENE = """schema = 1
[world]
duration = 5.0
[[rope]]
hang = { links = 1, length = 1.0, angle_deg = 40.0 }
[solver]
method = "exact"
[video]
size = [64, 48]
fps = 30
[overlay]
title = "a title"
"""
QUICK = '[output]\npictures = "none"\nlabels = []\n'


@pytest.fixture
def run(tmp_path, capfd):
    """Runs a sweep of the scene with these lines; returns exit code, output and messages."""
    (tmp_path / "scene.toml").write_text(SCENE)

    def run(text, *more):
        (tmp_path / "sweep.toml").write_text(f'schema = 1\nscene = "scene.toml"\n{text}{QUICK}')
        code = corda.sweep.main([str(tmp_path / "sweep.toml"), "-o", str(tmp_path / "out"), "--jobs", "1", *more])
        return code, *capfd.readouterr()

    return run


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def pendulum_period(length_m, gravity, angle_deg):
    mean, other = 1.0, math.cos(math.radians(angle_deg) / 2.0)
    for _ in range(8):
        mean, other = 0.5 * (mean + other), math.sqrt(mean * other)
    return 2.0 * math.pi * math.sqrt(length_m / gravity) / mean


def test_titles_have_the_units_of_their_keys(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "sweep.toml").write_text('schema = 1\nscene = "scene.toml"\nsamples = 1\n[vary]\n"rope[0].payload" = [1]\n'
                                         '"world.drag" = [0]\n"rope[0].hang.angle_deg" = [1]\n"rope[0].hang.links" = [1]\n')
    sweep = _sweep_file.load(tmp_path / "sweep.toml")
    titles = {columns: tuple(column.title() for column in _sweep_figures.find_columns(sweep, columns)) for columns in (
        "period_s:payload", "world.drag:angle_deg", "tension_max_n:links")}
    assert titles == {"period_s:payload": ("period (s)", "payload (kg)"), "world.drag:angle_deg": ("drag (1/s)", "angle (°)"),
                      "tension_max_n:links": ("tension max (N)", "links")}


def test_a_plot_has_theory_beside_the_measured_periods(run, tmp_path):
    text = 'samples = 6\n[vary]\n"world.gravity" = [9.81, 3.73]\n"rope[0].hang.angle_deg" = { uniform = [10.0, 80.0] }\n'
    code, out, messages = run(text, "--plot", "period_s:angle_max_deg")
    assert code == 0, messages
    paths = [tmp_path / "out" / f"period_s-angle_max_deg.{extension}" for extension in ("svg", "pdf", "png", "csv")]
    assert out.splitlines() == [str(tmp_path / "out"), *map(str, paths)]
    rows = rows_of(paths[-1])
    assert list(rows[0]) == ["key", "series", "angle_max_deg", "period_s", "theory"] and len(rows) == 6
    sweep = corda.Sweep(tmp_path / "sweep.toml")
    for i, row in enumerate(rows):
        angle_deg, gravity = (sweep.parameters(i)[key] for key in ("rope[0].hang.angle_deg", "world.gravity"))
        assert (row["key"], row["series"]) == (f"{i:06}", f"gravity = {gravity}")
        assert abs(float(row["angle_max_deg"]) - angle_deg) < 1e-9
        assert abs(float(row["theory"]) / pendulum_period(1.0, gravity, angle_deg) - 1.0) < 1e-12
        assert abs(float(row["period_s"]) / float(row["theory"]) - 1.0) < 1e-4
    texts = "".join(xml.etree.ElementTree.parse(paths[0]).getroot().itertext())
    svg = paths[0].read_text()
    for words in ("period (s)", "angle max (°)", "gravity = 9.81", "theory, gravity = 3.73"):
        assert words in texts or words in svg
    assert paths[1].read_bytes().startswith(b"%PDF") and corda.read_png(paths[2]).shape[1] == int(170 / 25.4 * 300)
    before = [path.read_bytes() for path in paths]
    run(text, "--plot", "period_s:angle_max_deg")
    assert [path.read_bytes() for path in paths] == before  # without dates


def test_a_plot_draws_a_line_per_series_in_order_of_value(run, tmp_path, monkeypatch):
    drawn = []
    plot = matplotlib.axes.Axes.plot

    def keep(axes, *points, **style):
        drawn.append((style["label"], style["linestyle"], style["color"], list(points[0])))
        return plot(axes, *points, **style)

    monkeypatch.setattr(matplotlib.axes.Axes, "plot", keep)
    grid = 'grid = true\n[vary]\n"world.gravity" = [9.81, 3.73, 10]\n"rope[0].hang.angle_deg" = [50.0, 20.0, 80.0]\n'
    assert run(grid, "--plot", "period_s:angle_deg")[0] == 0
    names = [f"gravity = {value}" for value in ("3.73", "9.81", "10")]
    assert [label for label, *_ in drawn] == [label for name in names for label in (f"theory, {name}", name)]
    assert [line for _, line, *_ in drawn] == 3 * ["--", "-"]
    assert all(theory[2] == line[2] for theory, line in zip(drawn[::2], drawn[1::2]))
    assert all(line[3] == [20.0, 50.0, 80.0] for line in drawn[1::2])
    drawn.clear()
    two = ('samples = 5\n[vary]\n"rope[0].mass" = { uniform = [1.0, 2.0] }\n"rope[0].hang.angle_deg" = { uniform = [10.0, 80.0] }\n'
           '"world.gravity" = [9.81, 3.73]\n')
    assert run(two, "--plot", "period_s:angle_deg", "--force")[0] == 0
    assert {line for label, line, *_ in drawn if not label.startswith("theory")} == {"none"}  # two keys vary in a series


def test_a_hanging_rope_has_the_theory_of_its_links(run, tmp_path):
    code, _, messages = run('grid = true\n[vary]\n"rope[0].hang.links" = [1, 5, 20]\n"rope[0].hang.angle_deg" = [2.0]\n',
                            "--plot", "period_s:links")
    assert code == 0, messages
    rows = rows_of(tmp_path / "out" / "period_s-links.csv")
    for row in rows:
        # The least zero of the Laguerre polynomial of that degree (Abramowitz and Stegun, table 25.9).
        zero = {"1": 1.0, "5": 0.263560319718, "20": 0.070539889692}[row["rope[0].hang.links"]]
        expected = 2.0 * math.pi / math.sqrt(9.81 * float(row["rope[0].hang.links"]) * zero)
        assert abs(float(row["theory"]) / expected - 1.0) < 1e-4  # measured 7.6e-5, for the amplitude of one link


def test_a_plot_leaves_refused_samples_out(run, tmp_path):
    code, _, messages = run('grid = true\n[vary]\n"rope[0].mass" = [1.0, -1.0, 2.0]\n"rope[0].hang.angle_deg" = [20.0]\n',
                            "--plot", "mass:angle_deg")
    assert code == 0, messages
    assert [row["key"] for row in rows_of(tmp_path / "out" / "mass-angle_deg.csv")] == ["000000", "000002"]


def test_a_plot_has_the_words_and_the_style_of_no_one_else(run, tmp_path, monkeypatch):
    (tmp_path / "dollars").mkdir()
    text = 'samples = 4\n[vary]\n"rope[0].label" = ["$a$", "b"]\n"rope[0].hang.angle_deg" = { uniform = [10.0, 80.0] }\n'
    more = "--plot", "period_s:angle_deg", "--sheet"
    assert run(text, *more)[0] == 0
    paths = [tmp_path / "out" / name for name in ("period_s-angle_deg.svg", "sheet.png")]
    before = [path.read_bytes() for path in paths]
    assert b"<!-- label = $a$ -->" in before[0] and b"<!-- theory, label = $a$ -->" in before[0]
    with matplotlib.rc_context({"axes.facecolor": "black", "savefig.facecolor": "red", "font.family": "monospace"}):
        assert run(text, *more)[0] == 0
    assert [path.read_bytes() for path in paths] == before
    (tmp_path / "sweep.toml").rename(tmp_path / "$x$.toml")
    assert corda.sweep.main([str(tmp_path / "$x$.toml"), "-o", str(tmp_path / "out"), *more]) == 0
    assert b"<!-- $x$ -->" in paths[0].read_bytes()


@pytest.mark.parametrize("angle_deg", [180.0, -180.0, 250.0, -250.0])
def test_a_swing_over_the_top_has_no_theory(tmp_path, angle_deg):
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "sweep.toml").write_text('schema = 1\nscene = "scene.toml"\nsamples = 1\n[vary]\n"rope[0].mass" = [1]\n')
    sweep = _sweep_file.load(tmp_path / "sweep.toml")
    assert _sweep_figures.period_theory(sweep, {"rope[0].mass": 1}, angle_deg) is None
    assert _sweep_figures.period_theory(sweep, {"rope[0].mass": 1}, math.copysign(179.0, angle_deg)) > 5.0


def test_a_plot_without_samples_is_refused(run):
    code, _, messages = run('samples = 1\n[vary]\n"world.duration" = [0.1]\n', "--plot", "period_s:duration")
    assert code == 2 and "no finished sample in" in messages and "a period needs three passes below the only pin" in messages


@pytest.mark.parametrize("columns, words", [
    ("period:mass", 'there is no column "period"; give Y:X, two of period_s, '),
    ("period_s:mass", 'several columns are named "mass"'), ("period_s", "--plot period_s: is not Y:X")])
def test_unknown_columns_are_refused_at_once(run, tmp_path, columns, words):
    (tmp_path / "scene.toml").write_text(SCENE + "[[rope]]\nhang = { links = 1, length = 1.0 }\n")
    code, _, messages = run('samples = 1\n[vary]\n"rope[0].mass" = [1]\n"rope[1].mass" = [1]\n', "--plot", columns)
    assert code == 2 and words in messages
    assert not (tmp_path / "out").exists()


def test_a_contact_sheet_is_drawn_with_a_gpu_if_the_command_says_so(run, tmp_path):
    expected = 0
    try:
        corda.Film(text=SCENE, require_gpu=True).frame(0)
    except corda.Error as error:
        expected = error.code
    text = 'samples = 1\n[vary]\n"rope[0].mass" = [1]\n'
    assert run(text, "--require-gpu")[0] == 0  # without pictures
    (tmp_path / "all.toml").write_text((tmp_path / "sweep.toml").read_text().replace("labels = []", ""))
    assert corda.sweep.main([str(tmp_path / "all.toml"), "-o", str(tmp_path / "all"), "--jobs", "1", "--require-gpu"]) == 0
    assert run(text, "--sheet", "--require-gpu")[0] == expected
    assert (tmp_path / "out" / "sheet.png").exists() == (expected == 0)


def test_a_contact_sheet_shows_poses_and_parameters(run, tmp_path):
    code, out, messages = run('grid = true\n[vary]\n"rope[0].hang.angle_deg" = [30.0, -30.0, 60.0]\n"rope[0].mass" = [1.0, -1.0]\n',
                              "--sheet")
    assert code == 0, messages
    assert out.splitlines()[-1] == str(tmp_path / "out" / "sheet.png")
    sheet = corda.read_png(tmp_path / "out" / "sheet.png")
    row_px = 180 + 4 * 17 + 2 * 12  # a picture of 240 x 180, key, two parameters and the times
    assert sheet.shape == (2 * row_px, 3 * 252 + 12, 4)
    cells = [sheet[12 + row * row_px :, 12 + column * 252 :][:180, :240] for row in range(2) for column in range(3)]
    is_drawn = [len(np.unique(cell.reshape(-1, 4), axis=0)) > 10 for cell in cells]
    assert is_drawn == [True, False, True, False, True, False]  # a negative mass is refused
    mirrored, plain = (corda.compare(cells[0][:, ::step], cells[2]).mean for step in (-1, 1))
    assert mirrored < 0.6 * plain  # measured 1.57 and 3.47: the hatches of the support are not mirrored
    film = corda.Film(text=SCENE, size=(240, 180), settings={"rope[0].hang.angle_deg": 30.0, "overlay": {"time": False}})
    last = first_turn(film.positions[:, 1], film.positions[:, 0])
    film.save_still(tmp_path / "poses.png", spread(film.times, last, 6))
    assert (corda.read_png(tmp_path / "poses.png") == cells[0]).all()  # without times at the poses
    labels = sheet[12 + 180 : row_px - 12, 12:252]
    assert (labels[..., 0] < 100).sum() > 200  # text

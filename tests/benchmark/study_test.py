"""study.py on a scene and on a chapter: its JSON, tables and pictures; what it refuses; and the parts of the pages.

Needs the program in CORDA_STUDY.
"""
import json
import os
import pathlib
import re
import subprocess
import sys

import pytest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import chapters  # noqa: E402
import page  # noqa: E402
from peers import tables  # noqa: E402

SCENE = """schema = 1
[world]
duration = 0.2
[[rope]]
hang = { links = 5, length = 1.0, angle_deg = 30.0 }
"""


def study(*arguments, cwd):
    return subprocess.run([sys.executable, HERE / "study.py", "--program", os.environ["CORDA_STUDY"], *arguments],
                          cwd=cwd, capture_output=True, text=True, check=False)


def tables_of(text):
    """The tables of a page: a list of rows of cells each, the heads first."""
    found = re.findall(r"(?:^\|.*\n)+", text, re.MULTILINE)
    return [[re.split(r"(?<!\\)\|", line)[1:-1] for line in table.splitlines()] for table in found]


def test_a_scene(tmp_path):
    name = "'x ]] & <b> \"q\" `id` | rope-1"
    (tmp_path / f"{name}.toml").write_text(SCENE)
    run = study("--scene", f"{name}.toml", "--quick", "--set", "video.fps=30", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    folder = tmp_path / f"{name}-study"
    assert run.stdout == f"{name}-study/README.md\n"
    data = json.loads((folder / "speed.json").read_text())
    assert (data["schema"], data["chapter"], data["quick"]) == (1, "speed", True)
    (problem,) = data["problems"]
    assert problem["title"] == name
    by_series = {}
    for measured in problem["runs"]:
        by_series.setdefault(measured["series"], []).append(measured)
    assert len(by_series) == 2 * 4 + 4 + 1  # reaches and sweeps of relaxation, orders of rattle, exact
    best = {series: min(run["error_rms_over_length"] for run in runs) for series, runs in by_series.items()}
    assert best["exact"] < 1e-13  # measured 1.4e-16
    assert best["rattle, order 8"] < 1e-13  # measured 1.4e-16
    # Steps divide a frame.
    assert all(abs(1 / 30 / run["parameter"] % 1.0 - 0.5) > 0.49 for run in by_series["rattle, order 4"])
    text = (folder / "README.md").read_text()
    assert text.startswith("# Study of 'x \\]\\] \\& \\<b\\>")
    setting, fastest, runs = tables_of(text)
    assert [len(row) for row in fastest] == [7] * (2 + len(chapters.ACCURACIES))
    assert len(runs) == 2 + len(problem["runs"])
    assert {len(row) for row in runs} == {10}
    assert ["Corda", data["corda"]] in [[cell.strip() for cell in row] for row in setting]
    (picture,) = folder.glob("*.png")
    assert f"]({picture.name})" in text
    assert picture.read_bytes().startswith(b"\x89PNG")
    again = study("--from", folder, "-o", tmp_path / "again", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert tables_of((tmp_path / "again" / "README.md").read_text())[1:] == [fastest, runs]


def test_a_chapter(tmp_path):
    run = study("accuracy", "--quick", "-o", "out", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    rows = json.loads((tmp_path / "out" / "accuracy.json").read_text())["rows"]
    assert {row["reference"] for row in rows} == {"R1", "R2", "R3", "R4", "R5", "R6", "R7", "R8", "R9", "R10", "R11", "spring"}
    for row in rows:
        assert "failure" not in row, row
        assert row["error"] <= row["bound"], row
    _, short, every = tables_of((tmp_path / "out" / "README.md").read_text())
    assert len(every) == 2 + len(rows)
    cases = [row[0].strip() for row in short[2:]]
    assert "R5 released chains (tip / L, heavy tip)" in cases
    assert len({(row[0], row[1]) for row in short[2:]}) == len(short) - 2


def test_refusals_write_nothing(tmp_path):
    (tmp_path / "scene.toml").write_text("schema = 1\n[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0]]\nmass = 0.0\n")
    for arguments, code, message in [
            (["speeds", "-o", "out"], 2, 'there is no chapter "speeds"; known are speed, findings'),
            (["findings", "--scene", "scene.toml", "--set", "rope[0].mass=1.0"], 2,
             'chapter "findings" is about built-in problems'),
            (["--set", "video.fps=30", "-o", "out"], 2, "--set changes a scene; name its file"),
            (["--quick"], 2, "give a folder for its page: -o FOLDER"),
            (["peers"], 2, "peers are measured by tests/benchmark/peers.sh"),
            (["--scene", "scene.toml"], 3, "scene.toml:4:8: rope[0].mass: 0 is not"),
            (["--scene", "missing.toml"], 6, "missing.toml: cannot read the scene file"),
            (["speed", "-o", "scene.toml"], 6, "scene.toml: exists and is not a folder"),
            (["speed", "-o", "."], 6, "is not empty; give --force"),
            (["--from", ".", "-o", "out"], 6, "has no measurements")]:
        run = study(*arguments, cwd=tmp_path)
        assert run.returncode == code, (arguments, run.stderr)
        assert message in run.stderr, arguments
        assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"], arguments


def test_ends_leave_what_was_written(tmp_path):
    broken = tmp_path / "broken"
    broken.mkdir()
    (broken / "speed.json").write_text('{"schema": 1}')
    slow, full = tmp_path / "slow", tmp_path / "full"
    for folder in (slow, full):
        folder.mkdir()
        (folder / "README.md").write_text("kept")
    program = tmp_path / "program"
    program.write_text("#!/bin/sh\nkill -INT $PPID\nsleep 60\n")
    program.chmod(0o755)
    after = f"sys.path.insert(0, {str(HERE)!r}); sys.argv = sys.argv[1:]; runpy.run_path(sys.argv[0], run_name='__main__')"
    large = (sys.executable, "-c", "import resource, runpy, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN); "
             f"resource.setrlimit(resource.RLIMIT_FSIZE, (9, 9)); {after}")
    hidden = (sys.executable, "-c", "import importlib.util, runpy, sys; importlib.util.find_spec = lambda name: None; " + after)
    measured = tmp_path / "measured"
    measured.mkdir()
    (measured / "accuracy.json").write_text(json.dumps(sample("accuracy")))
    for runner, arguments, code, message in [
            ((sys.executable,), ["--from", broken, "-o", "out"], 6, "speed.json: is not JSON of benchmark_study speed"),
            ((sys.executable,), ["speed", "--program", "missing", "-o", "none"], 6, "missing: No such file or directory"),
            ((sys.executable,), ["speed", "--program", program, "-o", slow, "--force"], 130, "interrupted"),
            (large, ["--from", measured, "-o", full, "--force"], 6, "File too large"),
            (hidden, ["--from", measured, "-o", "out"], 2, "python3-matplotlib")]:
        run = subprocess.run([*runner, HERE / "study.py", *arguments], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert run.returncode == code, (arguments, run.stderr)
        assert message in run.stderr and "Traceback" not in run.stderr, (arguments, run.stderr)
    for folder in (slow, full):
        assert [(path.name, path.read_text()) for path in folder.iterdir()] == [("README.md", "kept")]


def sample(chapter):
    """Measurements of a chapter that are few, and made up."""
    common = {"chapter": chapter, "compiler": "C", "build": "B", "corda": "1", "times": "T"}
    run = {"series": "exact", "parameter": 0.01, "error_rms_over_length": 1e-5, "error_largest_over_length": 2e-5,
           "strain_largest": 0.0, "energy_error_over_mgl": None, "ms_per_simulated_s": 2.0, "ms_least": 1.0, "ms_largest": 3.0,
           "steps": 7}
    swing = {"particles": 40, "mass_kg": 1.0, "sweeps": 1, "reach": 7, "bars": 252, "strain_largest": 0.1,
             "rope_error_rms_over_length": 0.2, "rod_error_rms_over_length": 0.3, "energy_error_over_mgl": 0.4, "tip_speed_m_s": 5.0}
    return common | {
        "speed": {"problems": [{"id": "report_swing", "title": "S", "truth": "t", "truth_of_exact": None, "horizon_s": None,
                                "runs": [run, {**run, "series": "rattle, order 4", "error_rms_over_length": 1e-7,
                                               "ms_per_simulated_s": 2.5}]}]},
        "accuracy": {"rows": [{"reference": "R1", "subject": "s", "quantity": "q", "case": str(error), "method": "m",
                               "error": error, "bound": 1.0, "wall_ms": 1.0, "ms_per_simulated_s": 1.0 / error}
                              for error in (0.25, 0.5)]},
        "findings": {"masses_under_gravity_kg": [0.1, 10.0], "difference_under_gravity_over_length": 0.0, "watched_s": 9.0,
                     "rates": [{"particles": 20, "bars": 112, "report_updates_per_s": 610, "updates_per_s": 1e5}],
                     "bars": [swing], "sizes": [swing],
                     "settling": [{"delta": 0.0, "step_s": 0.1, "drag_1_s": 0.0, "relaxation_settles_s": None,
                                   "rope_settles_s": 5.0}]},
        "hard_cases": {"cases": [{"case": f"c{passed}", "method": "m", "criterion": "x < 1", "measured": "0.5", "passed": passed}
                                 for passed in (True, True, False, None)]},
        "challenge": {"pendulums": [{"id": "three", "pendulum": "3 links", "compared_s": 4.0, "true_last_pose_m": [[0, 0], [1, 0]],
                                     "true_path_of_the_end_m": [[0, 0], [1, 1]],
                                     "runs": [{"method": method, "setting": setting, "error_m": error, "energy_error_over_mgl": 0.1,
                                               "strain_largest": 0.0, "us_per_frame": time, "last_pose_m": [[0, 0], [1, 0]]}
                                              for method, setting, error, time in (
                                                  ("XPBD", "50 substeps", 0.2, 6.0), ("XPBD", "500 substeps", 0.01, 60.0),
                                                  ("Corda, exact", "loose", 0.1, 2.0), ("Corda, exact", "tight", 0.001, 3.0))]}]},
        "horizons": {"families": [{"ropes": "few", "scenes": 5, "not_judged": 0, "without_horizon": 1, "not_passed": 1,
                                   "claimed_s_and_observed_over_claimed": [[1.0, 1.5], [2.0, 0.9], [3.0, 1.2]]}]},
    }[chapter]


def rows_of(part):
    return [[cell.strip() for cell in row] for row in tables_of(part.markdown + "\n")[0][2:]]


def part_of(chapter, mark):
    return next(part for part in chapters.CHAPTERS[chapter](sample(chapter)).parts if part.mark == mark)


def test_tables_follow_from_the_measurements():
    fastest = rows_of(part_of("speed", "fastest_report_swing"))
    assert [row[1] for row in fastest] == ["exact", "exact", "rattle, order 4", "none", "none", "none"]
    assert fastest[2] == ["1e-6", "rattle, order 4", "0.01", "1e-7", "2.5", "1", "3"]
    assert rows_of(part_of("accuracy", "accuracy")) == [["R1 s (q)", "m", "0.5", "4"]]  # the largest of either
    assert part_of("hard_cases", "hard_cases_passed").markdown == "Of 4 hard cases, 2 passed, 1 failed and 1 were not run."
    assert [row[4] for row in rows_of(part_of("hard_cases", "hard_cases"))] == ["yes", "yes", "no", "not run"]
    assert rows_of(part_of("findings", "settling")) == [["0", "0.1", "0", "", "5"]]
    assert [row[3:] for row in rows_of(part_of("challenge", "challenge_ratios"))] == [
        ["loose", "0.1", "3"], ["tight", "0.001", "20"]]
    assert rows_of(part_of("horizons", "horizons")) == [["few", "5", "2", "1", "1", "1", "0.9", "0.9", "1.2", "1.2", "1.5"]]


def test_failed_runs_are_shown():
    data = sample("speed")
    data["problems"][0]["runs"].append({"series": "relaxation", "parameter": 0.1, "failure": "diverged"})
    part = chapters.speed(data).parts[2]
    assert part.failures == ("diverged",)
    assert rows_of(part)[-1] == ["relaxation", "0.1", *[""] * 8, "diverged"]


def test_every_mark_of_the_pages_has_a_part_with_the_heads_of_its_table():
    parts = {part.mark: part for chapter, draw in chapters.CHAPTERS.items() for part in draw(sample(chapter)).parts}
    for path in (HERE / "README.md", page.ROOT / "README.md"):
        text = path.read_text(encoding="utf-8")
        for mark in page.marks_of(text):
            if mark in ("peers", "peers_rows"):
                continue
            shown = tables_of(text.split(f"<!-- begin of {mark} -->")[1].split(f"<!-- end of {mark} -->")[0])
            written = tables_of(parts[mark].markdown + "\n")
            assert [table[0] for table in shown] == [table[0] for table in written], mark
            replaced = page.put(text, parts[mark])
            assert parts[mark].markdown in replaced, mark
            assert page.put(replaced, parts[mark]) == replaced, mark


def test_peers(tmp_path):
    head = "problem,peer,version,method,parameter,value,error,energy_error,ms_per_s,failure\n"
    runs = [("Corda", "exact", "tolerance", 1e-3, 1e-4, 1.0), ("Corda", "exact", "tolerance", 1e-9, 1e-10, 4.0),
            ("Corda auto", "plan and run", "tolerance", 1e-6, 1e-7, 9.0),
            ("Box2D", "1 iteration", "steps per frame", 4, 1e-2, 3.0), ("Boost.odeint", "RK", "tolerance", 1e-9, 1e-10, 8.0)]
    (tmp_path / "runs.csv").write_text(head + "".join(
        f"{problem},{peer},1.0,{method},{parameter},{value},{error},0,{ms},\n"
        for problem in tables.PROBLEMS for peer, method, parameter, value, error, ms in runs))
    run = study("peers", "--from", tmp_path, "-o", "out", cwd=tmp_path)
    assert run.returncode == 0, run.stderr
    text = (tmp_path / "out" / "README.md").read_text()
    best, of_all, swing = tables_of(text)[:3]
    assert best[2][1].strip() == "3 (Box2D: 1 iteration)"
    assert of_all[2][6].strip() == "2.52 (Boost.odeint: RK)"  # 8 over 4^(5/6)
    assert [row[0].strip() for row in swing[2:]] == [
        "Corda, best method 1.0", "Corda auto, plan and run 1.0", "Boost.odeint 1.0", "Box2D 1.0"]
    rows = tables_of(text)[-1][2:]
    assert [row[3].strip() for row in rows] == 2 * ["9", "9", "no estimate"]
    assert len(list((tmp_path / "out").glob("peers_*.png"))) == len(tables.PROBLEMS)


@pytest.mark.parametrize("value, text", [
    (0.00123456, "0.00123"), (1234.5, "1230"), (2e-5, "2e-5"), (1.5e7, "1.5e+7"), (4000, "4000"),
    (None, ""), (float("nan"), "")])
def test_numbers(value, text):
    assert page.number_text(value) == text

"""`python3 -m corda report`: its files, their validity for other programs, and early ends."""

import html
import json
import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

import corda

SCENE = """schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 4, length = 1.0, angle_deg = 40.0 }
[solver]
method = "exact"
[video]
size = [320, 180]
fps = 30
"""
RUN = [sys.executable, "-c", "import sys, corda.report; sys.exit(corda.report.main(sys.argv[1:]))"]
FIGURES = ["strobe", "still_1", "still_2", "path", "angle", "phase", "energy", "tension", "tension_along"]


def run(*arguments, **options):
    return subprocess.run([*RUN, *map(str, arguments)], capture_output=True, text=True, **options)


def write(folder, text, name="scene.toml"):
    path = folder / name
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """A report of SCENE: its folder and what the command printed."""
    folder = tmp_path_factory.mktemp("report")
    ended = run(write(folder, SCENE), "-o", folder / "out", "--at", "0,0.4", "--json")
    assert ended.returncode == 0, ended.stderr
    return folder / "out", json.loads(ended.stdout)


def test_every_figure_is_there_in_three_formats_and_two_widths(report):
    folder, answer = report
    assert answer["schema"] == 1 and answer["method"] == "exact" and answer["simulation_passes"] == 1
    assert answer["files"][0] == str(folder / "report.html")
    assert sorted(answer["files"]) == sorted(map(str, folder.iterdir()))
    figures = {f"{figure}_{width}mm.{ending}" for figure in FIGURES for width in (85, 170) for ending in ("svg", "pdf", "png")}
    numbers = {f"{name}.csv" for name in ("tip", "energy", "tension", "tension_along", "strain", "largest", "setting")}
    assert {path.name for path in folder.iterdir()} == figures | numbers | {"report.html"}


def test_columns_have_keys_with_units_and_a_row_per_frame(report):
    folder, _ = report
    headers = {
        "tip": "t_s,rope_0_x_m,rope_0_y_m,rope_0_vx_m_s,rope_0_vy_m_s,rope_0_angle_rad,rope_0_angular_velocity_rad_s",
        "energy": "t_s,kinetic_j,weight_since_start_j,elastic_j,total_since_start_j,energy_error",
        "tension": "t_s,rope_0_largest_n,rope_0_link",
        "strain": "t_s,largest,rope_0_largest,rope_0_link"}
    tables = {}
    for name, header in headers.items():
        assert (folder / f"{name}.csv").read_text().split("\n")[0] == header
        tables[name] = np.genfromtxt(folder / f"{name}.csv", delimiter=",", names=True)
        assert np.array_equal(tables[name]["t_s"], np.arange(31) / 30)
    along = np.genfromtxt(folder / "tension_along.csv", delimiter=",", names=True)
    assert along.dtype.names == ("link", "rest_length_m", "tension_n")
    assert along["link"].tolist() == [0, 1, 2, 3] and along["rest_length_m"] == pytest.approx(0.25)
    assert (folder / "largest.csv").read_text().startswith("quantity,size,unit,t_s,where\nspeed,")
    # The same numbers as those of the film, to the last bit.
    film = corda.Film(text=SCENE)
    tip = tables["tip"]
    assert np.array_equal(tip["rope_0_x_m"][:30], film.positions[:, 4, 0])
    assert np.array_equal(tip["rope_0_vy_m_s"][:30], film.velocities[:, 4, 1])
    assert np.array_equal(tables["tension"]["rope_0_largest_n"][:30], np.abs(film.tensions).max(axis=1))
    assert np.array_equal(tables["energy"]["kinetic_j"][:30], film.energy[:, 0])
    assert tip["rope_0_angle_rad"] == pytest.approx(np.arctan2(tip["rope_0_x_m"], -tip["rope_0_y_m"]), abs=1e-15)
    rate = (tip["rope_0_x_m"] * tip["rope_0_vy_m_s"] - tip["rope_0_y_m"] * tip["rope_0_vx_m_s"]) / (
        tip["rope_0_x_m"] ** 2 + tip["rope_0_y_m"] ** 2)
    assert tip["rope_0_angular_velocity_rad_s"] == pytest.approx(rate, rel=1e-14)


def test_files_have_the_same_bytes_on_a_second_run(report, tmp_path):
    folder, _ = report
    time.sleep(1.1)  # a time in a file would be another one
    style = write(tmp_path, "font.size: 20\nlines.linewidth: 5\n", "matplotlibrc")  # of the user, and without an effect
    ended = run(folder.parent / "scene.toml", "-o", tmp_path / "again", "--at", "0,0.4", "-q",
                env={**os.environ, "MATPLOTLIBRC": str(style), "PYTHONHASHSEED": "7"})
    assert ended.returncode == 0 and ended.stderr == "", ended.stderr
    for path in folder.iterdir():
        assert (tmp_path / "again" / path.name).read_bytes() == path.read_bytes(), path.name


def test_other_programs_find_no_fault(report):
    folder, _ = report
    svgs = sorted(map(str, folder.glob("*.svg")))
    subprocess.run(["xmllint", "--noout", "--nonet", *svgs], check=True)
    subprocess.run(["xmllint", "--noout", "--nonet", "--dropdtd", folder / "report.html"], check=True)
    page = (folder / "report.html").read_text()
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids)) > len(FIGURES)
    for link in re.findall(r'href="([^"#]+)"', page):
        assert (folder / link).is_file(), link
    assert 'href="tip.csv">CSV</a>' in page
    for source in re.findall(r'(?:src|href)="([^"]+)"', page):
        assert not source.startswith(("http", "//")), source  # it needs no other file to be shown


@pytest.mark.parametrize("figure", ["still_1", "energy"])
def test_figures_can_be_printed_at_their_width(report, figure, tmp_path):
    folder, _ = report
    for width_mm in (85, 170):
        stem = folder / f"{figure}_{width_mm}mm"
        assert f'width="{width_mm}mm"' in stem.with_suffix(".svg").read_text()[:1500]
        subprocess.run(["rsvg-convert", "-d", "300", "-p", "300", f"{stem}.svg", "-o", tmp_path / "svg.png"], check=True)
        subprocess.run(["pdftoppm", "-r", "300", "-png", "-singlefile", f"{stem}.pdf", tmp_path / "pdf"], check=True)
        for path in (f"{stem}.png", tmp_path / "svg.png", tmp_path / "pdf.png"):
            picture = corda.read_png(path)
            assert abs(picture.shape[1] - width_mm / 25.4 * 300) < 5, path  # a PDF page is a whole number of points wide
            assert picture[..., 1].min() < 120, path  # it is not blank


def word_height(path, word):
    """The height in points of the box of a word in a PDF, which is 1.164 times the size of its letters."""
    box = subprocess.run(["pdftotext", "-bbox", path, "-"], capture_output=True, text=True, check=True).stdout
    (found,) = re.findall(rf'yMin="([\d.]+)" xMax="[\d.]+" yMax="([\d.]+)">{word}<', box)
    return float(found[1]) - float(found[0])


def test_letters_have_nine_points_at_any_width(report):
    folder, _ = report
    for width_mm in (85, 170):
        assert word_height(folder / f"energy_{width_mm}mm.pdf", "kinetic") == pytest.approx(1.164 * 9.0, rel=0.03)


def test_the_page_says_what_the_figures_show(report):
    folder, _ = report
    page = html.unescape((folder / "report.html").read_text())
    for sentence in ("5 particles, 4 bars (4 real); gravity of (0, -9.81) m/s2", "Method: exact at tolerance 1e-09, because the "
                     "scene asks for exact. There is no estimate of its error.", "Strobe: poses at t = 0 and 0.4 s, the fainter "
                     "the earlier.", "The scene at t = 0.4 s.", "No period is stated: fewer than three passages below the pin.", "The energy error, | E -",
                     "The links keep their lengths", "Path of the free end of rope 0 (particle 4).", "Tension of the links of rope "
                     "0 at "):
        assert sentence in page, sentence


def test_labels_name_columns_and_captions():
    from corda import _chapters, report
    from corda._motion import motion_of

    rope = "[[rope]]\nhang = { links = 1, length = 1.0, angle_deg = 30.0 }\nlabel = \"8 kg\"\n"
    film = corda.Film(text="schema = 1\n[world]\nduration = 0.2\n" + rope + rope, size=(320, 180))
    columns = report._columns(motion_of(film))["tension.csv"]
    assert [key for key, _ in columns] == ["8_kg_largest_n", "8_kg_link", "8_kg_2_largest_n", "8_kg_2_link"]
    (figure,) = _chapters.path_chapter(motion_of(film), film).figures
    assert figure.caption == "Path of the free ends of 8 kg, 8 kg 2 (particle 1 of each)."


def test_a_net_in_german_without_tensions(tmp_path):
    net = write(tmp_path, "schema = 1\n[world]\nduration = 0.2\n[[net]]\ngrid = { columns = 5, rows = 4, spacing = 0.1 }\n"
                "[solver]\nmethod = \"relaxation\"\n[video]\nsize = [320, 180]\nfps = 20\n")
    out = tmp_path / "out"
    ended = run(net, "-o", out, "--frame", "2", "-q", "--set", "overlay.language=de", "--font-pt", "12")
    assert ended.returncode == 0, ended.stderr
    assert word_height(out / "energy_85mm.pdf", "kinetisch") == pytest.approx(1.164 * 12.0, rel=0.03)
    page = (out / "report.html").read_text()
    assert re.search(r'<td class="number" title="[0-9]+,[0-9]+">[0-9]+,[0-9]+<', page)
    assert not re.search(r'<td class="number" title="[0-9]+\.', page)
    assert "Phasenporträt" in page and "Bericht zu scene" in page
    assert re.search(r"\nspeed,[0-9]+\.[0-9]+,m/s,", (out / "largest.csv").read_text())
    assert not (out / "tension_85mm.svg").exists() and (out / "strain_85mm.svg").exists()
    assert "Tensions of net 0 are not known: method relaxation" in page
    assert "\n0,,\n" in (out / "tension.csv").read_text()


def test_a_motion_is_covered_until_it_diverges(tmp_path):
    wild = write(tmp_path, "schema = 1\n[world]\nduration = 1.0\ngravity = [1e14, 0.0]\n[[rope]]\npoints = [[0.0, 0.0], [1.0, "
                 "0.0]]\npinned = []\n[solver]\nmethod = \"relaxation\"\n[video]\nsize = [320, 180]\nfps = 50\n")
    out = tmp_path / "out"
    ended = run(wild, "-o", out, "--at", "0,0.5")
    assert ended.returncode == 8, ended.stderr
    # The motion exceeds the limit of 1e12 m after sqrt(2e-2) s = 0.141 s.
    assert "the simulation diverged before t = 0.16 s" in ended.stderr
    assert f"files are written, the last of them is {out / 'report.html'}" in ended.stderr
    assert "It diverges after 0.14 s; the figures show the motion before that." in (out / "report.html").read_text()
    assert len((out / "tip.csv").read_text().splitlines()) == 1 + 8
    assert (out / "still_1_85mm.png").exists() and not (out / "still_2_85mm.png").exists()  # at 0.5 s there is nothing


def test_drawings_are_those_of_the_first_swing(tmp_path):
    """By the library alone: drawing them takes long."""
    from corda import _chapters
    from corda._motion import motion_of

    toml = SCENE.replace("links = 4", "links = 1").replace("duration = 1.0", "duration = 3.0").replace("40.0", "60.0")
    motion = motion_of(corda.Film(text=toml, fps=100))
    times = _chapters.drawing_times(motion, [])
    assert times.is_swing and len(times.strobe) == 6 and times.strobe[0] == 0.0
    assert times.strobe[-1] == pytest.approx(1.0765, abs=0.01)  # half of the period at 60 degrees (R2)
    assert times.stills == [0.0, 0.75, 1.5, 2.25, 3.0]
    above = motion_of(corda.Film(text=toml.replace("60.0", "150.0"), fps=100))
    assert _chapters.drawing_times(above, []).strobe[-1] == pytest.approx(1.767, abs=0.01)  # half of 3.535 s
    whirls = motion_of(corda.Film(text=toml.replace("60.0 }", "0.0 }\nvelocity = [9.0, 0.0]"), fps=100))
    assert not _chapters.drawing_times(whirls, []).is_swing  # it never turns back
    flies = motion_of(corda.Film(text="schema = 1\n[world]\nduration = 1.0\n[[rope]]\npoints = [[0.0, 0.0], [1.0, 0.0]]\n"
                                      "pinned = []\n[video]\nfps = 10\n"))
    assert _chapters.drawing_times(flies, []) == ([0.0, 0.2, 0.4, 0.6, 0.8, 1.0], [0.0, 0.3, 0.5, 0.8, 1.0], False)


def test_captions_name_what_is_shown():
    from corda import _chapters
    from corda._motion import motion_of

    def text(bodies):
        motion = motion_of(corda.Film(text="schema = 1\n[world]\nduration = 0.05\n" + bodies, size=(64, 48)))
        return _chapters.tracked_text(motion) + "." + _chapters.left_out_text(motion)

    rope = "[[rope]]\nhang = { links = 2, length = 1.0 }\n"
    assert text("[[rope]]\npoints = [[0, 0], [1, 0]]\npinned = [0, 1]\n" + 9 * rope) == (
        "the free ends of rope 1 to rope 6 (particle 2 of each). 3 more bodies are not shown.")
    assert text(rope + rope + "pinned = [-1]\n" + rope + "pinned = []\n") == "the free ends of rope 0 to rope 2 (particles 2, 0, 2)."
    assert text(rope + "label = \"a\"\n" + rope) == "the free ends of a, rope 1 (particle 2 of each)."
    assert text("[[rope]]\npoints = [[0, 0], [1, -1], [2, -1.5], [3, -1], [4, 0]]\npinned = [0, -1]\n[[net]]\ngrid = { columns = 5, "
                "rows = 3, spacing = 0.1 }\npinned = [[0, 0], [4, 0]]\n") == (
        "particle 2 of rope 0 (the middle one of its free ones) and particle 7 of net 0 (the most central of its free ones).")
    assert [_chapters.short_number(value) for value in (0.0, -0.0, 1.0, 1234.0, 1234.5, 0.012345, 1.23e-5, 1.5e7, 999999.0)] == [
        "0", "0", "1", "1234", "1230", "0.0123", "1.23e-5", "1.5e7", "999999"]
    assert _chapters.quantity_text(1234567.0, "N") == "1.23 MN" and _chapters.quantity_text(3.13, "m/s") == "3.13 m/s"


def test_each_rope_has_its_period_and_theory_and_energy_its_reason(tmp_path):
    scene = write(tmp_path, """schema = 1
world.duration = 5.0
video = { size = [320, 180], fps = 30 }
overlay.language = "de"
[[rope]]
hang = { links = 1, length = 1.0, angle_deg = 20.0 }
moves = [{ pin = 0, waves = [{ amplitude = [0.1, 0.0], frequency = 0.7 }] }]
[[rope]]
label = "second"
hang = { links = 1, length = 1.0, angle_deg = 20.0, from = [1.5, 0.0] }
""")
    assert run(scene, "-o", tmp_path / "rep", "-q").returncode == 0
    page = (tmp_path / "rep" / "report.html").read_text()
    assert "No period of rope 0 is stated: successive periods differ by" in page
    assert ("The period of second is 2,0215 s, by 5 passages below the pin; that of a point pendulum of this amplitude is "
            "2,0215 s.") in page
    assert "There is no energy error to tell: supports that move do work." in page
    assert "at tolerance 0,0" in page and "at tolerance 0.0" in (tmp_path / "rep" / "setting.csv").read_text()
    # A name that is longer than the axis makes the page higher.
    names = subprocess.run(["pdftotext", tmp_path / "rep" / "phase_85mm.pdf", "-"], capture_output=True, text=True, check=True)
    assert "Winkelgeschwindigkeit (rad/s)" in names.stdout


def test_the_theme_is_paper_unless_the_scene_chooses(tmp_path):
    rope = "[[rope]]\nhang = { links = 1, length = 1.0, angle_deg = 30.0 }\n"

    def ground(style, own=""):
        film = corda.Film(text="schema = 1\n[world]\nduration = 0.1\n" + rope + own + style, size=(160, 120))
        film._film.save_report_still(str(tmp_path / "a.png"), [0.0], 20.0, 9.0, True)
        return corda.read_png(tmp_path / "a.png")[2, 2, :3].tolist()

    assert ground("") == [255, 255, 255]
    assert ground("[style]\ntheme = \"dark\"\n")[0] < 40
    assert ground("[style]\npalette = [\"#c026d3\"]\n") == [255, 255, 255]
    assert ground("[style]\npalette = [\"#c026d3\", \"#fff2a8\"]\n")[0] < 40
    assert ground("", "color = \"white\"\n")[0] < 40


def test_a_still_in_print_is_that_of_the_program(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE + "[overlay]\nplots = [\"angle\"]\n")
    corda.Film(scene).save_still(tmp_path / "a.png", 0.5, width_mm=85, ppi=150)
    subprocess.run([os.environ["CORDA_PROGRAM"], "still", scene, "--at", "0.5", "--width-mm", "85", "--ppi", "150", "-o",
                    tmp_path / "b.png"], check=True, capture_output=True)
    assert np.array_equal(corda.read_png(tmp_path / "a.png"), corda.read_png(tmp_path / "b.png"))


def test_a_still_has_a_width_in_print(tmp_path):
    film = corda.Film(text=SCENE)
    for ending in ("png", "svg", "pdf"):
        film.save_still(tmp_path / f"a.{ending}", [0.0, 0.5], width_mm=85)
    picture = corda.read_png(tmp_path / "a.png")
    assert picture.shape == (565, 1004, 4)
    assert 'width="85mm"' in (tmp_path / "a.svg").read_text()
    film.save_still(tmp_path / "b.png", 0.5)
    assert np.array_equal(corda.read_png(tmp_path / "b.png"), film.still(0.5))
    film.save_still(tmp_path / "c.png", 0.5, width_mm=20, ppi=96)
    assert corda.read_png(tmp_path / "c.png").shape == (43, 76, 4)
    tall = corda.Film(text=SCENE, size=(100, 10000))
    tall._film.save_report_still(str(tmp_path / "tall.png"), [0.0], 85.0, 9.0, False)
    assert corda.read_png(tmp_path / "tall.png").shape == (1406, 1004, 4)  # fits a page
    for call, code in ((lambda: film.save_still(tmp_path / "a.png", 0), 6), (lambda: film.save_still(tmp_path / "a.bmp", 0), 2),
                       (lambda: film.save_still(tmp_path / "d.png", 9), 2), (lambda: film.save_still(tmp_path / "d.png", []), 2),
                       (lambda: film.save_still(tmp_path / "d.png", 0, width_mm=0), 2),
                       (lambda: film.save_still(tmp_path / "d.png", 0, width_mm=85, font_pt=0), 2), (lambda: film.save_still(tmp_path / "d.png", 0, ppi=0), 2),
                       (lambda: tall.save_still(tmp_path / "d.png", 0, width_mm=85), 2)):
        with pytest.raises(corda.Error) as raised:
            call()
        assert raised.value.code == code, raised.value


@pytest.mark.parametrize("arguments, code, message", [
    (["{scene}"], 2, "-o/--output"),
    (["{scene}", "-o", ""], 2, "--output: the value is empty"),
    (["{scene}", "-o", "{out}", "--at", "2"], 2, "--at 2: is not within 0 .. 1 s"),
    (["{scene}", "-o", "{out}", "--at", "x"], 2, "--at x: takes times in seconds"),
    (["{scene}", "-o", "{out}", "--frame", "30:32"], 2, "--frame 30:32: the frames are 0 to 29"),
    (["{scene}", "-o", "{out}", "--frame", "a"], 2, "--frame a: is neither a frame number nor a range"),
    (["{scene}", "-o", "{out}", "--font-pt", "0"], 2, "--font-pt 0: takes 1 .. 18 points"),
    (["{scene}", "-o", "{out}", "--fps", "0"], 2, "fps"),
    (["{scene}", "-o", "{out}", "--backend", "none"], 2, "backend \"none\" is unknown"),
    (["{scene}", "-o", "{out}", "--bogus"], 2, "--bogus"),
    (["{scene}", "-o", "{out}", "--set", "world.gravty=1"], 3, "did you mean \"gravity\""),
    (["{folder}/missing.toml", "-o", "{out}"], 6, "missing.toml: cannot read the scene file"),
    (["{scene}", "-o", "{scene}"], 6, "scene.toml: exists and is not a folder"),
    (["{scene}", "-o", "{scene}/a", "--dry-run"], 6, "scene.toml: exists and is not a folder"),
    (["{scene}", "-o", "{folder}/" + 300 * "x"], 6, "File name too long"),
    (["{scene}", "-o", "{folder}"], 6, "is not empty; give --force")])
def test_mistakes_are_refused_before_anything_is_written(arguments, code, message, tmp_path):
    names = {"scene": write(tmp_path, SCENE), "out": tmp_path / "out", "folder": tmp_path}
    ended = run(*[argument.format(**names) for argument in arguments])
    assert ended.returncode == code, ended.stderr
    assert message in ended.stderr and "Traceback" not in ended.stderr
    assert list(tmp_path.iterdir()) == [tmp_path / "scene.toml"]


def test_a_dry_run_writes_nothing_and_errors_are_json(tmp_path):
    scene = write(tmp_path, SCENE)
    ended = run("-", "-o", tmp_path / "out", "--dry-run", "--json", input=scene.read_text())
    assert json.loads(ended.stdout)["method"] == "exact"
    assert not (tmp_path / "out").exists()
    ended = run(scene, "-o", tmp_path, "--json")
    assert json.loads(ended.stdout)["error"]["code"] == ended.returncode == 6


@pytest.mark.parametrize("option", ["--backend=device:99", "--require-gpu"])
def test_without_opengl_nothing_is_written(option, tmp_path):
    if option == "--require-gpu" and run(write(tmp_path, SCENE), "-o", tmp_path / "gpu", option).returncode == 0:
        pytest.skip("there is a GPU")
    ended = run(write(tmp_path, SCENE), "-o", tmp_path / "out", option)
    assert ended.returncode == 4 and "no usable OpenGL" in ended.stderr
    assert not (tmp_path / "out").exists()


def test_force_replaces_links_themselves(tmp_path):
    from corda import report

    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "a.csv").symlink_to(write(tmp_path, "kept", "target"))
    (tmp_path / "out" / "b.csv").mkdir()
    folder = report.Folder(tmp_path / "out", True, False)
    folder.write("a.csv", "new")
    assert (tmp_path / "out" / "a.csv").read_text() == "new" and not (tmp_path / "out" / "a.csv").is_symlink()
    assert (tmp_path / "target").read_text() == "kept" and folder.files == [str(tmp_path / "out" / "a.csv")]
    with pytest.raises(corda.Error, match="no ordinary file") as raised:
        folder.write("b.csv", "new")
    assert raised.value.code == 6 and not list((tmp_path / "out").glob("*.tmp"))


@pytest.mark.parametrize("sent, code", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_keeps_a_page_of_the_figures_so_far(sent, code, tmp_path):
    out = tmp_path / "out"
    process = subprocess.Popen([*RUN, write(tmp_path, SCENE), "-o", out], stderr=subprocess.PIPE, text=True)
    while not (out / "path_85mm.svg").exists():
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(sent)
    _, said = process.communicate()
    assert process.returncode == code, said
    assert f"the last of them is {out / 'report.html'}" in said
    assert (out / "tip.csv").exists() and not (out / "tension_along_170mm.pdf").exists()
    assert not list(out.glob("*.tmp"))
    page = (out / "report.html").read_text()
    assert "figure-strobe" in page and "figure-strain" not in page and "Ends early" in page


def test_a_missing_matplotlib_is_named(tmp_path):
    scene = write(tmp_path, SCENE)
    hidden = ("import sys; sys.modules['matplotlib'] = None; import corda.report; "
              "sys.exit(corda.report.main(sys.argv[1:]))")
    ended = subprocess.run([sys.executable, "-c", hidden, scene, "-o", tmp_path / "out"], capture_output=True, text=True)
    assert ended.returncode == 2 and len(ended.stderr.splitlines()) == 1
    assert "python3-matplotlib" in ended.stderr
    assert not (tmp_path / "out").exists()
    ended = subprocess.run([sys.executable, "-c", "import sys; sys.modules['matplotlib'] = None; import corda; corda.plot"],
                           capture_output=True, text=True)
    assert "ImportError: corda.plot needs matplotlib" in ended.stderr and "python3-matplotlib" in ended.stderr

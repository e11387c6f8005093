"""Values from Python, numpy and the file system: each is accepted for what it is, or refused with its keyword."""

import decimal
import fractions
import os
import pathlib

import numpy as np
import pytest

import corda

SCENE = """schema = 1
[world]
duration = 1.0
[[rope]]
hang = { links = 6, length = 1.0, angle_deg = 60.0 }
[video]
size = [160, 90]
fps = 30
"""


def film(**keywords):
    return corda.Film(text=SCENE, **keywords)


@pytest.mark.parametrize("size", [(64, 48), [64, 48], np.array([64, 48]), np.array([64, 48], dtype=np.int16),
                                  (np.int64(64), np.float32(48)), (64.0, decimal.Decimal(48))])
def test_a_size_is_any_pair_of_whole_numbers(size):
    assert film(size=size).size == (64, 48)


@pytest.mark.parametrize("duration", [0.5, np.float32(0.5), decimal.Decimal("0.5"), fractions.Fraction(1, 2), np.array(0.5)])
def test_a_duration_is_any_number(duration):
    assert len(film(duration=duration)) == 15


def test_a_rate_is_exact():
    assert film(fps=np.int32(25)).fps == 25
    assert film(fps=25.0).fps == 25
    assert film(fps=np.float32(0.1), duration=20).fps == 0.1
    assert film(codec="libaom-av1", preset=8).size == (160, 90)
    assert film(fps=fractions.Fraction(30000, 1001)).fps == 30000 / 1001
    assert film(fps="30000/1001").fps == 30000 / 1001


def test_arrays_and_dictionaries_are_settings():
    still = film(settings={"rope[0].velocity": np.zeros((7, 2))})
    assert np.array_equal(still.positions, film().positions)
    assert film(settings={"rope[0].hang": {"links": 3, "length": 1.0}}).positions.shape == (30, 4, 2)
    assert film(settings={"style.supports": np.bool_(False), "overlay.title": np.str_("a \"b\" \\")}).size == (160, 90)


def test_none_leaves_a_key_as_it_is():
    assert film(size=None, settings={"world.duration": None}).size == (160, 90)


@pytest.mark.parametrize("keywords, words", [
    ({"size": b"64x48"}, "size: takes"), ({"duration": object()}, "duration: takes"), ({"world__drag": 1j}, "world__drag: takes"),
    ({"size": {64, 48}}, "size: takes"), ({"duration": np.timedelta64(1, "s")}, "^duration: takes seconds as a number"),
    ({"duration": np.array(["2020"], dtype="datetime64[ns]")}, "^duration: takes seconds"), ({"backend": 3}, "^backend: takes a str"),
    ({"settings": "rope"}, "^settings: takes a dictionary"), ({"settings": {3: 4}}, "^settings: takes a str, not int"),
    ({"fps": 25, "settings": {"video.fps": 30}}, "^fps: is given by video.fps, too"), ({"require_gpu": "no"}, "^require_gpu: "),
    ({"settings": {"rope[0].hang": {1: 2}}}, r"^rope\[0\].hang: takes a str, not int"),
    ({"world__drag": np.ma.masked}, "^world__drag: takes a value, not a masked one"),
])
def test_other_types_are_refused_by_their_keyword(keywords, words):
    with pytest.raises(TypeError, match=words):
        film(**keywords)


HOLDS_ITSELF = [1.0]
HOLDS_ITSELF.append(HOLDS_ITSELF)


@pytest.mark.parametrize("keywords, words", [
    ({"duration": "x"}, r'^duration="x": '), ({"size": (0, 3)}, r"^size=\[0, 3\]: "),
    ({"world__drag": float("nan")}, "^world__drag=nan: "), ({"settings": {"rope[0].mas": 2}}, r"^rope\[0\].mas=2: "),
    ({"rope__0__mass": 2}, r"use settings=\{'rope\[0\]\.mass': 2\}$"),
    ({"overlay__title": "\ud800"}, "^overlay__title: character 0 is the lone surrogate"),
    ({"duration": decimal.Decimal("1e400")}, "^duration: takes a number that a float can hold"),
    ({"duration": decimal.Decimal("Infinity")}, "^duration=inf: "),
    ({"duration": decimal.Decimal("sNaN")}, "^duration: takes a number that a float can hold"),
    ({"duration": fractions.Fraction(10**400)}, "^duration: takes a number that a float can hold"),
    ({"fps": 30000 / 1001}, '29.97002997002997 is not exact; write "30000/1001"'),
    ({"settings": {"rope[0].mass": HOLDS_ITSELF}}, r"^rope\[0\].mass: takes no list or dictionary that holds itself"),
    ({"jobs": 10**30}, "^jobs: takes no number as large"), ({"settings": {"rope[0].mass=2": 3}}, "has a =; give the value"),
])
def test_errors_name_the_keyword_of_the_caller(keywords, words):
    with pytest.raises(corda.Error, match=words) as refused:
        film(**keywords)
    assert refused.value.code in (2, 3)
    assert "--set" not in str(refused.value)


def test_the_remedy_for_an_index_works():
    assert film(settings={"rope[0].mass": 2}).size == (160, 90)


def test_frames_and_times_have_numbers():
    some = film()
    assert np.array_equal(some.frame(np.int64(3)), some.frame(3))
    assert np.array_equal(some.still(decimal.Decimal("0.5")), some.still(np.float64(0.5)))
    for k in (3.0, "3", None):
        with pytest.raises(TypeError, match="^k: takes an integer"):
            some.frame(k)
    for k in (10**30, -(10**30), 31, 30, -31):
        with pytest.raises(IndexError, match=f"^frame {k} is not within 0 .. 29, nor within -30 .. -1 from the end$"):
            some.frame(k)
    for time in ("soon", "0.5", None):
        with pytest.raises(TypeError, match="^time: takes a number"):
            some.still(time)
    with pytest.raises(corda.Error, match="^time: takes a number that a float can hold"):
        some.still(10**400)


def test_controls_in_texts_are_those_of_the_caller():
    for text in ("a\tb", "a\x7fb", "\x01"):  # which no picture can show
        with pytest.raises(corda.Error, match="^overlay__title=.* has a control character"):
            film(overlay__title=text)


def test_names_of_files_are_any_bytes(tmp_path):
    folder = os.fsencode(tmp_path)
    scene = os.path.join(folder, b"caf\xe9.toml")
    with open(scene, "wb") as file:
        file.write(SCENE.encode())
    for name in (scene, os.fsdecode(scene), pathlib.Path(os.fsdecode(scene))):
        assert corda.Film(name).size == (160, 90)
    assert film().save(os.fsdecode(os.path.join(folder, b"caf\xe9.mp4"))) == 30
    with pytest.raises(corda.Error) as missing:
        corda.Film(os.fsdecode(b"\xe9.toml"))
    assert os.fsencode(str(missing.value)).find(b"\xe9.toml") >= 0


def test_a_name_with_nul_is_refused(tmp_path):
    with pytest.raises(corda.Error, match="path: .* holds a NUL character"):
        corda.Film("a\0.toml")
    with pytest.raises(TypeError, match="^path: takes a str, bytes or a path, not 3"):
        corda.Film(3)
    with pytest.raises(corda.Error, match="^path: .* has a lone surrogate"):
        corda.Film("\ud800x")
    (tmp_path / "a").write_text("kept")
    with pytest.raises(corda.Error, match="holds a NUL character"):
        film().save(str(tmp_path / "a") + "\0b.mp4", force=True)
    with pytest.raises(corda.Error, match="holds a NUL character"):
        corda.read_png("\0")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]
    assert (tmp_path / "a").read_text() == "kept"


def test_a_text_that_is_none_is_refused_in_short():
    with pytest.raises(corda.Error, match="^text: character .* is the lone surrogate") as refused:
        corda.Film(text="# \udcff" + SCENE * 100)
    assert len(str(refused.value)) < 200
    with pytest.raises(TypeError, match="^text: takes a str, not bytes"):
        corda.Film(text=SCENE.encode())


def test_only_false_from_a_callback_stops(tmp_path):
    for answer in (None, True, np.bool_(True), 0, ""):
        assert film().save(tmp_path / "film.mp4", force=True, on_progress=lambda done, total: answer) == 30
    for answer in (False, np.bool_(False)):
        with pytest.raises(corda.Error) as stopped:
            film().save(tmp_path / "film.mp4", force=True, on_progress=lambda done, total: answer)
        assert stopped.value.code == 130
    with pytest.raises(TypeError, match="^on_progress: takes a function"):
        film().save(tmp_path / "other.mp4", on_progress=True)


@pytest.mark.parametrize("keywords, kind, width", [
    ({"size": (161, 91)}, "mp4", 162), ({"style__background": "transparent"}, "webm", 160),
    ({"style__background": "#00000080", "size": (33, 31)}, "webm", 34), ({"codec": "ffv1"}, "mp4", 160),
])
def test_a_notebook_shows_films_that_mp4_does_not_take(keywords, kind, width):
    shown = film(**keywords)._repr_html_()
    assert f"data:video/{kind};base64," in shown
    assert f'width="{width}"' in shown

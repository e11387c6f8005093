"""Films of positions that are given: corda.Film(scene, positions=..., times=...), and .npz files of the program."""

import io
import os
import random
import subprocess
import zipfile

import numpy as np
import pytest

import corda
import corda.plot

PROGRAM = os.environ["CORDA_PROGRAM"]
SCENE = """schema = 1
world.duration = 0.5
[[rope]]
hang = { links = 2, length = 1.0, angle_deg = 60.0, from = [0.25, 3.0] }
[video]
size = [96, 64]
fps = 30
[camera]                 # else it is fitted to the state at the end, too, which no frame shows
center = [0.25, 2.5]
height = 1.6
"""
OPEN = SCENE.replace("world.duration = 0.5\n", "")
RNG = np.random.default_rng(7)


@pytest.fixture(scope="module")
def film():
    return corda.Film(text=SCENE)


def test_the_frames_are_those_of_the_positions(film):
    given = corda.Film(text=SCENE, positions=film.positions, times=film.times)
    assert len(given) == len(film) == 15
    assert np.array_equal(given.positions, film.positions)
    for k in range(len(film)):
        assert np.array_equal(given.frame(k), film.frame(k))
        assert np.array_equal(given.mask(k), film.mask(k))
    assert given.plan == {"methods": ["given"], "error_estimate_m": None, "error_estimate_px": None, "horizon_s": None,
                          "notes": []}
    assert np.isnan(given.tensions).all() and given.tensions.shape == (15, 2)
    # Of finite differences of positions at 30 per second.
    assert np.abs(given.velocities - film.velocities)[1:-1].max() < 0.02 * np.abs(film.velocities).max()  # measured 0.005
    assert np.allclose(given.energy[1:-1, 1], film.energy[1:-1, 1], atol=1e-12)


def test_the_duration_is_that_of_the_times(film):
    open_film = corda.Film(text=OPEN, positions=film.positions, times=film.times)
    assert open_film.times[-1] < film.times[-1] and len(open_film) == 14
    assert len(corda.Film(text=OPEN, positions=film.positions, times=film.times, duration=len(film) / film.fps)) == 15
    assert len(corda.Film(text=OPEN, positions=film.positions, times=film.times, fps=60)) == 28
    with pytest.raises(corda.Error, match="positions end at .* give world.duration = ") as raised:
        corda.Film(text=SCENE, positions=film.positions, times=film.times, duration=1)
    assert raised.value.code == 2


def test_integers_slices_and_lists_are_positions():
    times = np.arange(4)
    positions = np.zeros((3, 4, 2), dtype=np.int32).transpose(1, 0, 2)
    positions[:, 1:] = [[0, -1], [1, -2]]
    film = corda.Film(text=OPEN, positions=positions, times=times)
    assert len(film) == 90 and np.array_equal(film.positions[17], positions[0])
    assert len(corda.Film(text=OPEN, positions=positions.tolist(), times=list(times))) == 90


@pytest.mark.parametrize("arrays, error, words", [
    ({"positions": np.zeros((4, 3, 2))}, TypeError, "positions and times together"),
    ({"times": np.zeros(4)}, TypeError, "positions and times together"),
    ({"positions": np.zeros((4, 3, 2)), "times": np.arange(5.0)}, ValueError, r"\(5, particles, 2\) for 5 times, not \(4, 3, 2\)"),
    ({"positions": np.zeros((4, 6)), "times": np.arange(4.0)}, ValueError, r"not \(4, 6\)"),
    ({"positions": np.zeros((4, 3, 3)), "times": np.arange(4.0)}, ValueError, r"not \(4, 3, 3\)"),
    ({"positions": np.zeros((4, 3, 2)), "times": np.zeros((4, 1))}, ValueError, r"times: takes an array of shape \(n,\)"),
    ({"positions": np.zeros((4, 3, 2), complex), "times": np.arange(4.0)}, TypeError, "not of complex128"),
    ({"positions": np.zeros((4, 3, 2)), "times": np.array(list("abcd"))}, TypeError, "times: takes an array of numbers"),
    ({"positions": np.zeros((4, 2, 2)), "times": np.arange(4.0)}, corda.Error, "positions of 2 particles, and the scene has 3"),
    ({"positions": np.full((4, 3, 2), np.nan), "times": np.arange(4.0)}, corda.Error, r"positions\[0\]\[0\]: \[nan, nan\]"),
    ({"positions": np.zeros((4, 3, 2)), "times": np.arange(4.0)[::-1]}, corda.Error, r"times\[1\]: 2 s comes after 3 s"),
    ({"positions": np.zeros((0, 3, 2)), "times": np.zeros(0)}, corda.Error, "0 times; give at least two"),
])
def test_other_arrays_are_refused(arrays, error, words):
    with pytest.raises(error, match=words):
        corda.Film(text=OPEN, **arrays)


def test_a_given_film_can_be_plotted_and_saved(film, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    given = corda.Film(text=SCENE, positions=film.positions, times=film.times)
    for plot in (corda.plot.angle, corda.plot.energy, corda.plot.tip, corda.plot.phase, corda.plot.strain):
        plot(given)
    given.save_still(tmp_path / "a.pdf", [0.0, 0.25], width_mm=80)
    assert given.save(tmp_path / "a.mkv") == 15
    assert "video" in corda.Film(text=SCENE, positions=film.positions, times=film.times, size=(95, 63))._repr_html_()


# Files of the program.


def plan(tmp_path, data):
    (tmp_path / "scene.toml").write_text(OPEN)
    (tmp_path / "m.npz").write_bytes(data)
    return subprocess.run([PROGRAM, "plan", tmp_path / "scene.toml", "--positions", tmp_path / "m.npz", "--json"],
                          capture_output=True, text=True, errors="replace")


def npz(save=np.savez, **arrays):
    file = io.BytesIO()
    save(file, **arrays)
    return file.getvalue()


TIMES = np.linspace(0.0, 0.5, 31)
POSITIONS = RNG.normal(size=(31, 3, 2))


def test_files_of_numpy_give_the_same_pictures(tmp_path):
    (tmp_path / "scene.toml").write_text(OPEN)
    expected = corda.Film(text=OPEN, positions=POSITIONS, times=TIMES).still(0.123)
    for save in (np.savez, np.savez_compressed):
        (tmp_path / "m.npz").write_bytes(npz(save, more=np.arange(9), positions=POSITIONS, times=TIMES))
        subprocess.run([PROGRAM, "still", tmp_path / "scene.toml", "--positions", tmp_path / "m.npz", "--at", "0.123", "-o",
                        tmp_path / "a.png", "--force"], check=True, capture_output=True)
        assert np.array_equal(corda.read_png(tmp_path / "a.png"), expected)


def test_files_have_float32_and_headers_of_savetxt(tmp_path):
    (tmp_path / "scene.toml").write_text(OPEN)
    single = POSITIONS.astype(np.float32)
    expected = corda.Film(text=OPEN, positions=single, times=TIMES).still(0.123)
    np.savez(tmp_path / "m.npz", times=TIMES.astype(np.float32), positions=single)
    rows = np.column_stack([TIMES, single.reshape(len(TIMES), -1)])
    np.savetxt(tmp_path / "comma.csv", rows, delimiter=",", header="t,x0,y0,x1,y1,x2,y2")
    np.savetxt(tmp_path / "space.csv", rows, header="t x0 y0 x1 y1 x2 y2")
    for name, most in (("m.npz", 1), ("comma.csv", 0), ("space.csv", 0)):  # times of float32 differ by 3e-8 s
        subprocess.run([PROGRAM, "still", tmp_path / "scene.toml", "--positions", tmp_path / name, "--at", "0.123", "-o",
                        tmp_path / "a.png", "--force"], check=True, capture_output=True)
        difference = corda.read_png(tmp_path / "a.png").astype(int) - expected
        assert np.abs(difference).max() <= most, name


def raw_npz(header, body=POSITIONS.tobytes()):
    """An .npz whose array `positions` has this header."""
    text = header.encode().ljust(117) + b"\n"
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("times.npy", _npy(TIMES))
        archive.writestr("positions.npy", b"\x93NUMPY\1\0" + len(text).to_bytes(2, "little") + text + body)
    return file.getvalue()


def _npy(array):
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def shaped(shape):
    return raw_npz("{'descr': '<f8', 'fortran_order': False, 'shape': %s, }" % shape)


@pytest.mark.parametrize("data, words", [
    (npz(times=TIMES), 'there is no array \\"positions\\"; save it by numpy.savez(FILE, times=times, positions=positions)'),
    (npz(times=TIMES, positions=POSITIONS.astype("f2")), "positions: numbers of type '<f2', not '<f8' or '<f4'; save positions.astype('<f8')"),
    (npz(times=TIMES.astype(">f8"), positions=POSITIONS), "times: numbers of type '>f8', not '<f8' or '<f4'"),
    (npz(times=TIMES, positions=np.array([None, 1])), "positions: numbers of type '|O', not '<f8' or '<f4'"),
    (npz(times=TIMES, positions=np.zeros(3, [("a", "f8")])), "positions: numbers of type [('a', '<f8')], not '<f8' or '<f4'"),
    (npz(times=TIMES, positions=np.asfortranarray(POSITIONS)), "Fortran order); save numpy.ascontiguousarray(positions)"),
    (npz(times=TIMES[:, None], positions=POSITIONS), "times: shape (31, 1); give the shape (n,)"),
    (npz(times=TIMES, positions=POSITIONS[:5]), "positions: shape (5, 3, 2); give the shape (31, particles, 2) for 31 times"),
    (npz(times=TIMES, positions=POSITIONS[:, :2]), "positions of 2 particles, and the scene has 3"),
    (npz(times=TIMES, positions=np.where(POSITIONS > 2, np.inf, POSITIONS)), "is not within -1e12 .. 1e12 m"),
    (_npy(POSITIONS), "this is one array; save both by numpy.savez"),
    (shaped("(4611686018427387904, 4611686018427387904, 2)"), "positions has a shape that it cannot have"),
    (shaped("(99999999999999999999, 3, 2)"), "positions has a shape that it cannot have"),
    (shaped("(31, -3, 2)"), "positions has a shape that it cannot have"),
    (shaped("(31, 1000000000, 2)"), "positions is not as long as its shape"),
    (shaped("(0, 3, 2)"), "positions is not as long as its shape"),
    (shaped("()"), "positions is not as long as its shape"),
    (shaped("31"), "positions has a bad header"),
    (shaped("(31, 3, 2"), "positions has a bad header"),
    (raw_npz("{}"), "positions: numbers of type "),
])
def test_a_wrong_file_is_refused(tmp_path, data, words):
    result = plan(tmp_path, data)
    assert result.returncode == 2
    assert words in result.stdout
    assert "m.npz" in result.stdout


def test_no_damage_harms(tmp_path):
    chance = random.Random(5)
    for save in (np.savez, np.savez_compressed):
        whole = npz(save, times=TIMES, positions=POSITIONS)
        assert plan(tmp_path, whole).returncode == 0
        damaged = [whole[: chance.randrange(len(whole))] for _ in range(5)]
        for _ in range(10):
            some = bytearray(whole)
            for _ in range(chance.choice((1, 1, 5))):
                some[chance.randrange(len(some))] = chance.randrange(256)
            damaged.append(bytes(some))
        for data in damaged:
            result = plan(tmp_path, data)
            assert result.returncode in (0, 2), result.stdout + result.stderr


def test_a_size_beyond_the_limit_is_refused_before_it_is_read(tmp_path):
    data = bytearray(npz(np.savez_compressed, times=TIMES, positions=POSITIONS))
    size = data.rindex(b"PK\1\2") + 24  # of the last file in the list
    data[size:size + 4] = (3 << 30).to_bytes(4, "little")
    result = plan(tmp_path, bytes(data))
    assert result.returncode == 2 and "positions takes more than 1024 MiB; give fewer times" in result.stdout

"""Samples of a sweep in Python: the data of `corda sweep` and of Film, and their physics."""

import fractions
import io
import json
import os
import pathlib
import signal
import subprocess
import sys
import tarfile
import threading
import warnings

import numpy as np
import pytest

import corda

PROGRAM = os.environ["CORDA_PROGRAM"]
A01 = pathlib.Path(__file__).parents[1] / "accuracy" / "data" / "a01_pendulum.txt"

ROPE = """schema = 1
[world]
duration = 0.5
[[rope]]
hang = { links = 6, length = 1.0, angle_deg = 60.0 }
[video]
size = [64, 48]
fps = "30000/1001"
"""
# A point pendulum in front of a plain ground. The rope covers less than half of any pixel.
BALL = """schema = 1
[world]
duration = 4.0
[[rope]]
hang = { links = 1, length = 1.0, angle_deg = 60.0 }
payload = 1.5
color = "#ffffff"
[style]
background = "#000000"
rope_width_px = 0.4
supports = false
halo = false
[overlay]
time = false
scale_bar = false
[camera]
center = [0.0, -0.4]
height = 2.0
[video]
size = [128, 128]
fps = 60
"""
VARY = """
[vary]
"rope[0].hang.links" = { integer = [1, 8] }
"rope[0].mass" = { log_uniform = [0.1, 10.0] }
"world.gravity" = [[0.5, -9.0], 9.81]
"""


def write(folder, scene, sweep):
    """A sweep file of a scene in a folder."""
    (folder / "scene.toml").write_text(scene)
    path = folder / "sweep.toml"
    path.write_text(f'schema = 1\nscene = "scene.toml"\n{sweep}')
    return path


def film_of(sample, scene):
    return corda.Film(text=scene, settings=sample["parameters"])


def test_a_sample_is_the_film_of_its_parameters(tmp_path):
    path = write(tmp_path, ROPE, "samples = 4\nseed = 3" + VARY + "[split]\ntrain = 0.5\ntest = 0.5")
    samples = list(corda.sweep(path))
    assert [sample["key"] for sample in samples] == ["000000", "000001", "000002", "000003"]
    assert len({sample["parameters"]["rope[0].mass"] for sample in samples}) == 4
    for sample in samples:
        film = film_of(sample, ROPE)
        assert sample["fps"] == fractions.Fraction(30000, 1001)
        assert sample["split"] in ("train", "test")
        for name in ("times", "positions", "velocities", "tensions", "energy"):
            assert np.array_equal(sample[name], getattr(film, name), equal_nan=True), name
        assert np.array_equal(sample["pixels"], film.to_pixels(film.positions))
        assert np.array_equal(sample["mask"], [film.mask(k) for k in range(len(film))])
        assert np.array_equal(sample["frames"], [film.frame(k) for k in range(len(film))])
        for name in ("error_bound_m", "error_bound_px", "horizon_s"):
            assert sample[name] == film.plan[name]
        assert sample["method"] == film.plan["methods"][0]
        assert sample["camera"] == {"center": film.camera["center"], "height": film.camera["height"]}
        assert sample["px_per_m"] == 48 / film.camera["height"]
    sample["mask"][:] = 7  # arrays are the caller's


def test_samples_are_those_of_the_shards_of_the_program(tmp_path):
    path = write(tmp_path, ROPE, "samples = 7\nshard_samples = 2\n" + VARY + '[output]\npictures = "npz"')
    subprocess.run([PROGRAM, "sweep", path, "-o", tmp_path / "shards"], check=True, capture_output=True)
    yielded = [sample for index in range(3) for sample in corda.sweep(path, shard=(index, 3))]
    assert [sample["sample"] for sample in yielded] == [0, 1, 6, 2, 3, 4, 5]  # shards 0 and 3, 1, 2
    written = {}
    for shard in sorted((tmp_path / "shards").glob("*.tar")):
        with tarfile.open(shard) as tar:
            written.update({entry.name: tar.extractfile(entry).read() for entry in tar})
    assert len(written) == 14
    for sample in yielded:
        info = json.loads(written[sample["key"] + ".json"])
        arrays = np.load(io.BytesIO(written[sample["key"] + ".npz"]))
        assert set(sample) - set(info) == set(arrays) - {"frames"}
        for name, value in sample.items():
            if name in arrays:
                assert np.array_equal(value, arrays[name], equal_nan=True) and value.dtype == arrays[name].dtype
            elif name == "fps":
                assert value == fractions.Fraction(info["fps"])
            elif name == "camera":
                assert [list(value["center"]), value["height"]] == list(info["camera"].values())
            else:
                assert value == info[name], name


def test_a_sample_has_the_arrays_that_the_file_names(tmp_path):
    output = '[output]\npictures = "none"\nlabels = ["energy"]\nsummary = ["period_s"]'
    (sample,) = corda.sweep(write(tmp_path, ROPE, "samples = 1" + VARY + output))
    assert {name for name, value in sample.items() if isinstance(value, np.ndarray)} == {"times", "energy"}
    assert set(sample["summary"]) == {"period_s"}
    assert sample["split"] is None


def test_a_refused_sample_is_left_out_with_a_warning(tmp_path):
    path = write(tmp_path, ROPE, 'grid = true\n[vary]\n"rope[0].mass" = [1.0, -1.0, 2.0]')
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert [sample["sample"] for sample in corda.sweep(path)] == [0, 2]
    (warning,) = caught
    assert "sample 000001 is left out: " in str(warning.message) and "rope[0].mass=-1" in str(warning.message)
    assert warning.filename == __file__


@pytest.mark.parametrize("shard, error, words", [
    ((2, 2), corda.Error, r"shard: takes \(index, count\) with 0 <= index < count, not \(2, 2\)"),
    ((-1, 2), corda.Error, "^shard: "), ((0, 0), corda.Error, "^shard: "), (3, TypeError, "^shard: takes two integers"),
    ((0.0, 2), TypeError, "^shard: "), ((0, 1, 2), TypeError, "^shard: "),
])
def test_a_wrong_shard_is_refused_at_once(tmp_path, shard, error, words):
    path = write(tmp_path, ROPE, "samples = 1" + VARY)
    with pytest.raises(error, match=words):
        corda.sweep(path, shard=shard)


def test_a_wrong_file_is_refused_at_once(tmp_path):
    with pytest.raises(corda.Error, match="missing.toml") as missing:
        corda.sweep(tmp_path / "missing.toml")
    assert missing.value.code == 6
    with pytest.raises(corda.Error, match='unknown key "sample"; did you mean "samples"') as unknown:
        corda.sweep(write(tmp_path, ROPE, "sample = 1" + VARY))
    assert unknown.value.code == 3


def sums_of(path, shard):
    return {sample["key"]: (int(sample["frames"].sum()), float(sample["positions"].sum()))
            for sample in corda.sweep(path, shard=shard)}


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_workers_make_the_samples_of_their_shards(tmp_path, method):
    path = write(tmp_path, ROPE, "samples = 6\nshard_samples = 1\n" + VARY)
    # In a process of its own: this one has drawn, perhaps with threads that a forked child lacks.
    program = f"""
import multiprocessing, test_sweep
if __name__ == "__main__":
    with multiprocessing.get_context("{method}").Pool(2) as pool:
        parts = pool.starmap_async(test_sweep.sums_of, [({str(path)!r}, (i, 2)) for i in range(2)]).get(60)
    print(parts)
"""
    (tmp_path / "work.py").write_text(program)
    folders = os.pathsep.join([os.path.dirname(__file__), os.environ["PYTHONPATH"]])
    ended = subprocess.run([sys.executable, tmp_path / "work.py"], env={**os.environ, "PYTHONPATH": folders},
                           capture_output=True, text=True, timeout=60)
    assert ended.returncode == 0, ended.stderr
    assert eval(ended.stdout) == [sums_of(path, (0, 2)), sums_of(path, (1, 2))]


def test_ctrl_c_ends_a_sample_while_other_threads_run(tmp_path):
    path = write(tmp_path, ROPE.replace("0.5", "1e5"), "samples = 1" + VARY)
    timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))  # runs only without the interpreter's lock
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        next(corda.sweep(path))

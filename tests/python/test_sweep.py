"""corda.Sweep: a sequence of samples, with the data of the shards and of Film, and their physics."""

import fractions
import io
import json
import math
import os
import pathlib
import pickle
import shutil
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
EXAMPLES = pathlib.Path(os.environ["CORDA_EXAMPLES"]) / "sweep"
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
# A point pendulum in front of a plain ground. Its rope covers less than half of any pixel.
BALL = """schema = 1
[world]
duration = 4.0
[[rope]]
hang = { links = 1, length = 1.0, angle_deg = 60.0 }
payload = 1.5
color = "#ff8000"
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
height = 2.4
[video]
size = [128, 128]
fps = 30
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
    samples = list(corda.Sweep(path))
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
        for name in ("error_estimate_m", "error_estimate_px", "horizon_s"):
            assert sample[name] == film.plan[name]
        assert sample["method"] == film.plan["methods"][0]
        assert sample["camera"] == {"center": film.camera["center"], "height": film.camera["height"]}
        assert sample["px_per_m"] == 48 / film.camera["height"]
    sample["mask"][:] = 7  # arrays are the caller's


def test_samples_are_those_of_the_shards(tmp_path):
    path = write(tmp_path, ROPE, "samples = 7\nshard_samples = 2\n" + VARY + '[output]\npictures = "npz"')
    assert corda.sweep.main([str(path), "-o", str(tmp_path / "shards"), "--jobs", "1", "-q"]) == 0
    yielded = [sample for index in range(3) for sample in corda.Sweep(path).shard(index, 3)]
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
    (sample,) = corda.Sweep(write(tmp_path, ROPE, "samples = 1" + VARY + output))
    assert {name for name, value in sample.items() if isinstance(value, np.ndarray)} == {"times", "energy"}
    assert set(sample["summary"]) == {"period_s"}
    assert sample["split"] is None


def test_a_refused_sample_is_left_out_with_a_warning(tmp_path):
    path = write(tmp_path, ROPE, 'grid = true\n[vary]\n"rope[0].mass" = [1.0, -1.0, 2.0]')
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert [sample["sample"] for sample in corda.Sweep(path)] == [0, 2]
    (warning,) = caught
    assert f"{path}: sample 000001: vary rope[0].mass=-1: rope[0].mass: -1 is not" in str(warning.message)
    assert warning.filename == __file__


@pytest.mark.parametrize("shard, error, words", [
    ((2, 2), corda.Error, "shard: takes index and count with 0 <= index < count, not 2 and 2"),
    ((-1, 2), corda.Error, "^shard: "), ((0, 0), corda.Error, "^shard: "), ((0.0, 2), TypeError, "^shard: takes two integers"),
])
def test_a_wrong_shard_is_refused_at_once(tmp_path, shard, error, words):
    path = write(tmp_path, ROPE, "samples = 1" + VARY)
    with pytest.raises(error, match=words):
        corda.Sweep(path).shard(*shard)


def test_splits_have_the_samples_that_say_so(tmp_path):
    path = write(tmp_path, ROPE, "samples = 40" + VARY + "[split]\ntrain = 0.75\ntest = 0.25\n")
    sweep = corda.Sweep(path)
    parts = {name: list(sweep.split(name)._numbers) for name in ("train", "test")}
    assert sorted(parts["train"] + parts["test"]) == list(range(40)) and 4 < len(parts["test"]) < 18
    assert sweep.split("test")[2]["split"] == "test" and sweep.split("test")[2]["sample"] == parts["test"][2]
    assert list(sweep[10:].split("test").shard(0, 2)._numbers) == [number for number in parts["test"] if number >= 10]
    with pytest.raises(corda.Error, match="split: 'validation' is no split of .*; it has train, test"):
        sweep.split("validation")


def test_a_wrong_file_is_refused_at_once(tmp_path):
    with pytest.raises(corda.Error, match="missing.toml") as missing:
        corda.Sweep(tmp_path / "missing.toml")
    assert missing.value.code == 6
    with pytest.raises(corda.Error, match='unknown key "sample"; did you mean "samples"') as unknown:
        corda.Sweep(write(tmp_path, ROPE, "sample = 1" + VARY))
    assert unknown.value.code == 3


@pytest.mark.parametrize("how, words", [({"backend": 3}, "^backend: takes a str"),
                                        ({"require_gpu": "no"}, "^require_gpu: takes True or")])
def test_opengl_is_chosen_as_for_a_film(tmp_path, how, words):
    path = write(tmp_path, ROPE, "samples = 1" + VARY)
    for make in (corda.Sweep, corda.Film):
        with pytest.raises(TypeError, match=words):
            make(path, **how)
    with pytest.raises(corda.Error, match='backend "typo" is unknown') as unknown:
        corda.Sweep(path, backend="typo")
    assert unknown.value.code == 2


def test_a_sequence_needs_no_encoder(tmp_path):
    path = write(tmp_path, ROPE.replace("64, 48", "33, 21"), "samples = 1" + VARY)
    assert corda.Sweep(path)[0]["frames"].shape[1:] == (21, 33, 4)
    assert corda.sweep.main([str(path), "-o", str(tmp_path / "shards"), "-q"]) == 2  # clips have even sides


def test_a_sweep_is_a_sequence(tmp_path):
    sweep = corda.Sweep(write(tmp_path, ROPE, "samples = 7\nshard_samples = 2\nseed = 5" + VARY))
    assert len(sweep) == 7 and repr(sweep).startswith("<corda.Sweep of 7 samples of ")
    in_order = list(sweep)
    for i in (6, 2, -1, np.int64(3)):  # in any order
        assert_equal(sweep[i], in_order[i])
        assert sweep.parameters(i) == in_order[i]["parameters"]
    for part in (slice(2, 5), slice(None, None, 3), slice(5, None, -2)):
        assert len(sweep[part]) == len(in_order[part])
        assert [sample["sample"] for sample in sweep[part]] == [sample["sample"] for sample in in_order[part]]
    assert sweep[2:5][-1]["sample"] == 4 and sweep[2:5][1:][0]["sample"] == 3
    for index in (7, -8):
        with pytest.raises(IndexError, match=f"there is no sample {index}: the sweep has 7"):
            sweep[index]
    for index in ("1", 1.0, None):
        with pytest.raises(TypeError, match="a sample has a whole number"):
            sweep[index]
    assert_equal(pickle.loads(pickle.dumps(sweep))[3], in_order[3])


def test_shards_are_sequences_that_divide_the_samples(tmp_path):
    sweep = corda.Sweep(write(tmp_path, ROPE, "samples = 1_000_000_000\nshard_samples = 256" + VARY))
    shards = [sweep.shard(i, 7) for i in range(7)]  # of a sweep too long for a list
    assert sum(map(len, shards)) == 1_000_000_000
    numbers = [shards[2][i]["sample"] for i in (0, 1, 255, 256, -1)]
    assert numbers == [512, 513, 767, 2304, numbers[-1]] and numbers[-1] // 256 % 7 == 2
    small = sweep[100:1100]
    parts = [list(small.shard(i, 3)._numbers) for i in range(3)]
    assert sorted(sum(parts, [])) == list(range(100, 1100))
    assert all(number // 256 % 3 == i for i in range(3) for number in parts[i])
    assert list(small[::5].shard(1, 3)._numbers) == [number for number in range(100, 1100, 5) if number // 256 % 3 == 1]
    assert list(small.shard(1, 3)[3:9:2]._numbers) == parts[1][3:9:2]


def test_a_refused_sample_raises_if_it_is_asked_for(tmp_path):
    path = write(tmp_path, ROPE, 'grid = true\n[vary]\n"rope[0].mass" = [1.0, -1.0, 2.0]')
    sweep = corda.Sweep(path)
    with pytest.raises(corda.Error, match="sweep.toml: sample 000001: vary rope.0..mass=-1: ") as refused:
        sweep[1]
    assert refused.value.code == 3
    assert list(sweep.failures) == [1] and "rope[0].mass" in sweep.failures[1]


def assert_equal(sample, other):
    assert list(sample) == list(other)
    for name, value in sample.items():
        assert np.array_equal(value, other[name], equal_nan=True) if isinstance(value, np.ndarray) else value == other[name], name


def sums_of(path, shard):
    return {sample["key"]: (int(sample["frames"].sum()), float(sample["positions"].sum()))
            for sample in corda.Sweep(path).shard(*shard)}


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
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        corda.Sweep(path)[0]


def test_masks_are_the_silhouettes_of_the_drawn_bodies(tmp_path):
    style = 'halo = false\npayload = PAYLOAD\npalette = ["#ffffff"]\n[overlay]\ntime = false\nscale_bar = false\n[video]'
    scene = ROPE.replace("[video]", '[style]\nbackground = "#000000"\nsupports = false\n' + style)
    for sample in corda.Sweep(write(tmp_path, scene.replace("PAYLOAD", "false"), "samples = 6" + VARY)):
        assert np.array_equal(sample["mask"] == 1, sample["frames"][..., 0] >= 128)
    # A pixel of which a ball and its outline each cover less than half gets at most 3/4 of their brightness.
    for sample in corda.Sweep(write(tmp_path, scene.replace("PAYLOAD", "true"), "samples = 6" + VARY)):
        brightness, drawn = sample["frames"][..., 0], sample["mask"] == 1
        assert brightness[drawn].min() >= 128
        assert brightness[~drawn].max() < 192


def centroid(frames):
    """x and y in pixels of the pixels of each frame that are more than half red."""
    weight = np.maximum(frames[..., 0] / 255.0 - 0.5, 0.0)
    rows, columns = np.indices(weight.shape[1:]) + 0.5
    return [(weight * place).sum(axis=(1, 2)) / weight.sum(axis=(1, 2)) for place in (columns, rows)]


def tracked_gravity(sample):
    """Gravity from the frames alone: from the period, the amplitude and the length of the pendulum that they show."""
    column, row = centroid(sample["frames"])
    height, width = sample["frames"].shape[1:3]
    x = sample["camera"]["center"][0] + (column - 0.5 * width) / sample["px_per_m"]
    y = sample["camera"]["center"][1] - (row - 0.5 * height) / sample["px_per_m"]
    angle = np.arctan2(x, -y)
    k = np.flatnonzero(angle[:-1] * angle[1:] < 0.0)
    crossings = k + angle[k] / (angle[k] - angle[k + 1])
    period_s = 2.0 * np.polyfit(np.arange(len(k)), crossings, 1)[0] / float(sample["fps"])
    # The period is 2 pi sqrt(L / g) over the arithmetic-geometric mean of 1 and cos(amplitude / 2).
    mean, other = 1.0, math.cos(0.5 * angle[0])
    for _ in range(6):
        mean, other = 0.5 * (mean + other), math.sqrt(mean * other)
    return np.hypot(x, y).mean() * (2.0 * math.pi / (mean * period_s)) ** 2


def test_a_tracker_recovers_gravity_and_the_labels_say_where_the_ball_is(tmp_path):
    path = write(tmp_path, BALL, """samples = 20
seed = 5
[vary]
"rope[0].hang.angle_deg" = { uniform = [10.0, 80.0] }
"world.gravity" = { uniform = [4.0, 20.0] }
[output]
labels = ["pixels"]
""")
    for sample in corda.Sweep(path):
        error = tracked_gravity(sample) / sample["parameters"]["world.gravity"] - 1.0
        assert abs(error) < 1e-3  # measured 4.0e-4
        places = np.stack(centroid(sample["frames"]), axis=1)
        assert np.abs(places - sample["pixels"][:, 1]).max() < 0.5  # measured 0.055


def test_energy_and_tension_are_those_of_a_point_pendulum(tmp_path):
    scene = ROPE.replace("links = 6", "links = 1").replace("60.0", "90.0").replace("0.5", "200.0").replace("30000/1001", "2")
    path = write(tmp_path, scene + "[solver]\nmethod = \"exact\"\ntolerance = 1e-13\n", """grid = true
[vary]
"rope[0].mass" = [1.0, 2.5]
[output]
pictures = "none"
""")
    places = np.loadtxt(A01)  # R1: x and y at 0.5 s, 1 s, ...
    for sample in corda.Sweep(path):
        place = places[: len(sample["times"]) - 1]
        weight = 9.81 * sample["parameters"]["rope[0].mass"]
        kinetic, potential, total = sample["energy"][1:].T / weight
        assert np.abs(sample["positions"][1:, 1] - place).max() < 1e-12  # measured 2.9e-13
        assert np.abs(kinetic + place[:, 1]).max() < 1e-12  # measured 1.8e-13
        assert np.abs(potential - place[:, 1]).max() < 1e-12  # measured 1.8e-13
        assert np.abs(total).max() < 1e-14  # measured 3.3e-15
        assert np.abs(sample["tensions"][1:, 0] / weight + 3.0 * place[:, 1]).max() < 2e-12  # measured 5.4e-13


class Chains:
    """The motion of chains of equal links, at rest at first, by another method than Corda's: the equations of the angles with a
    dense matrix, and Gragg's extrapolation of order 16 in time (Hairer, Norsett, Wanner, Solving ODEs I, II.9)."""

    def __init__(self, angle_rad, masses, gravity):
        links = masses.shape[1]
        self.link = 1.0 / links
        self.start = np.stack([np.repeat(angle_rad[:, None], links, axis=1), np.zeros(masses.shape)])
        below = np.cumsum(masses[:, ::-1], axis=1)[:, ::-1]
        self.coupled = below[:, np.maximum.outer(np.arange(links), np.arange(links))]
        self.weight = gravity[:, None] / self.link * below

    def rate(self, state):
        angle, speed = state
        between = angle[:, :, None] - angle[:, None, :]
        force = (self.coupled * np.sin(between)) @ (speed**2)[:, :, None] + (self.weight * np.sin(angle))[:, :, None]
        return np.stack([speed, -np.linalg.solve(self.coupled * np.cos(between), force)[:, :, 0]])

    def step(self, state, step_s):
        row = []
        for parts in range(2, 17, 2):
            part_s = step_s / parts
            before, now = state, state + part_s * self.rate(state)
            for _ in range(parts - 1):
                before, now = now, before + 2.0 * part_s * self.rate(now)
            last, row = row, [0.5 * (before + now + part_s * self.rate(now))]
            for k, coarser in enumerate(last):
                row.append(row[k] + (row[k] - coarser) / ((parts / (parts - 2 * k - 2)) ** 2 - 1.0))
        return row[-1]

    def positions(self, times_s, steps):
        """Of the free particles: (frames, chains, links, 2). `steps`: between two times."""
        states = [self.start]
        for step_s in np.diff(times_s) / steps:
            state = states[-1]
            for _ in range(steps):
                state = self.step(state, step_s)
            states.append(state)
        angle = np.array(states)[:, 0]
        return np.cumsum(self.link * np.stack([np.sin(angle), -np.cos(angle)], axis=-1), axis=2)


def test_the_arms_of_a_double_pendulum_vary_one_by_one(tmp_path):
    scene = ROPE.replace("links = 6, length = 1.0, angle_deg = 60.0", "lengths = [1.0, 0.5], angles_deg = [90.0, 0.0]")
    path = write(tmp_path, scene, """samples = 3
[vary]
"rope[0].hang.angles_deg[1]" = { uniform = [-180.0, 180.0] }
"rope[0].hang.rates_deg_s" = { uniform = [[-90.0, 0.0], [90.0, 360.0]] }
[output]
pictures = "none"
""")
    for sample in corda.Sweep(path):
        (end, rates) = (sample["parameters"][key] for key in ("rope[0].hang.angles_deg[1]", "rope[0].hang.rates_deg_s"))
        (first, second), (end, *_) = np.radians(rates), np.radians([end])
        along = 0.5 * np.array([np.sin(end), -np.cos(end)])
        across = 0.5 * second * np.array([np.cos(end), np.sin(end)])
        assert np.abs(sample["positions"][0] - [[0, 0], [1, 0], [1, 0] + along]).max() < 1e-15
        assert np.abs(sample["velocities"][0] - [[0, 0], [0, first], [0, first] + across]).max() < 1e-14


def test_the_error_estimate_holds(tmp_path):
    path = write(tmp_path, ROPE.replace("0.5", "2.0").replace("30000/1001", "30"), """samples = 200
seed = 11
[vary]
"rope[0].hang.angle_deg" = { uniform = [5.0, 90.0] }
"rope[0].hang.links" = { integer = [1, 3] }
"rope[0].mass" = { log_uniform = [0.3, 3.0] }
"rope[0].payload" = { uniform = [0.0, 1.0] }
"world.gravity" = { uniform = [1.62, 24.8] }
[output]
pictures = "none"
labels = ["positions"]
""")
    samples = list(corda.Sweep(path))
    assert len(samples) == 200
    for links in (1, 2, 3):
        alike = [sample for sample in samples if sample["parameters"]["rope[0].hang.links"] == links]
        angle_deg, mass, payload, gravity = (np.array([sample["parameters"][key] for sample in alike]) for key in (
            "rope[0].hang.angle_deg", "rope[0].mass", "rope[0].payload", "world.gravity"))
        masses = np.repeat(mass[:, None], links, axis=1)
        masses[:, -1] += payload
        chains = Chains(np.radians(angle_deg), masses, gravity)
        estimate = np.array([sample["error_estimate_m"] for sample in alike])
        steps = 2
        rough, truth = (chains.positions(alike[0]["times"], n) for n in (1, 2))
        while np.abs(truth - rough).max() > 0.01 * estimate.min():
            steps *= 2
            rough, truth = truth, chains.positions(alike[0]["times"], steps)
        made = np.stack([sample["positions"][:, 1:] for sample in alike], axis=1)
        error = np.linalg.norm(made - truth, axis=-1).max(axis=(0, 2))
        assert (error / estimate).max() < 1.0  # measured 0.3334, of 4.3e-7 m .. 4.9e-5 m


@pytest.fixture(scope="module")
def clips(tmp_path_factory):
    """A folder with the sweep file of the examples, of 40 samples, and its shards."""
    folder = tmp_path_factory.mktemp("clips")
    shutil.copy(EXAMPLES / "clip.toml", folder)
    sweep = (EXAMPLES / "clips.toml").read_text().replace("samples = 2000", "samples = 40")
    (folder / "clips.toml").write_text(sweep.replace("shard_samples = 100", "shard_samples = 5"))
    subprocess.run([sys.executable, "-m", "corda", "sweep", folder / "clips.toml", "-o", folder / "shards"], check=True,
                   capture_output=True)
    return folder


def lines_of_example(name, path):
    ended = subprocess.run([sys.executable, EXAMPLES / name, path], capture_output=True, text=True, timeout=120)
    assert (ended.returncode, ended.stderr) == (0, "")
    return ended.stdout.splitlines()


@pytest.mark.long
def test_the_workers_of_a_data_loader_make_all_clips(clips):
    lines = lines_of_example("torch_clips.py", clips / "clips.toml")
    assert len(lines) == 5  # batches of 8
    made = []
    for line in lines:
        shapes, _, gravity = line.rpartition(" [")
        gravity = json.loads("[" + gravity)
        assert shapes == f"({len(gravity)}, 60, 3, 64, 64) ({len(gravity)}, 60, 2)"
        made += gravity
    expected = [sample["parameters"]["world.gravity"] for sample in corda.Sweep(clips / "clips.toml")]
    assert sorted(made) == sorted(expected)


def test_tarfile_and_numpy_read_the_shards(clips):
    lines = [line.split() for line in lines_of_example("read_shards.py", clips / "shards")]
    assert [line[0] for line in lines] == [f"{i:06}" for i in range(40)]
    assert {line[1] for line in lines} == {"train", "validation", "test"}
    assert all(" ".join(line[-3:]) == "(60, 64, 64)" for line in lines)


@pytest.mark.long
def test_pandas_reads_the_table(clips):
    lines = lines_of_example("table.py", clips / "shards")
    assert lines[0].split() == ["world.gravity", "1.62", "3.73", "9.81"]
    for line in lines[2:]:  # a heavier weight swings faster
        periods = [float(number) for number in line.split()[-3:]]
        assert periods == sorted(periods, reverse=True)

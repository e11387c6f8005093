"""Sweep files: values read, errors with their places, and the parameters of samples."""

import json
import math
import os
import random

import numpy as np
import pytest

import corda
from corda import _parameters, _sample, _sweep_file

LABELS, SUMMARY = list(_sweep_file.LABELS), list(_sweep_file.SUMMARY)
SCENE = """schema = 1
[world]
duration = 0.1
[[rope]]
hang = { links = 3, length = 1.0, angle_deg = 40.0 }
[video]
size = [32, 32]
fps = 30
"""
VARY = '[vary]\n"rope[0].mass" = [1, 2]\n'


@pytest.fixture
def load(tmp_path):
    (tmp_path / "scene.toml").write_text(SCENE)

    def load(text):
        (tmp_path / "sweep.toml").write_text(f'schema = 1\nscene = "scene.toml"\n{text}')
        return _sweep_file.load(tmp_path / "sweep.toml")

    load.path = str(tmp_path / "sweep.toml")
    return load


def failure_of(load, text):
    with pytest.raises(corda.Error) as raised:
        load(text)
    assert raised.value.code == 3
    return str(raised.value)


def test_defaults_are_all_pictures_labels_and_columns(load):
    sweep = load("samples = 3\n" + VARY)
    assert (sweep.source, sweep.scene_name, sweep.scene_toml) == (load.path, "scene.toml", SCENE)
    assert (sweep.samples, sweep.is_grid, sweep.seed, sweep.shard_samples, sweep.pictures) == (3, False, 0, 256, "mp4")
    assert (sweep.labels, sweep.summary, sweep.splits) == (LABELS, SUMMARY, {})
    assert sweep.encoder == ""
    _sweep_file.find_encoder(sweep)
    assert sweep.encoder.startswith("libx264 ")


def test_without_pictures_a_mask_is_drawn_only_if_it_is_named(load):
    assert load(OUTPUT + 'pictures = "none"\n').labels == [label for label in LABELS if label != "mask"]
    assert load(OUTPUT + 'pictures = "none"\nlabels = ["mask"]\n').labels == ["mask"]


def test_every_key_is_read(load):
    sweep = load("""samples = 1000000000
seed = 9223372036854775807
shard_samples = 1000000
[vary]
"world.gravity" = [1.62, [0.0, -9.81]]
"rope[0].hang.links" = { integer = [-3, 30] }
"rope[0].mass" = { normal = [1, 2], min = 0.1 }
"rope[0].hang.from" = { uniform = [[0, 0], [1.0, 2]] }
[output]
pictures = "npz"
labels = ["mask", "energy"]
summary = ["horizon_s", "period_s"]
[split]
train = 0.9
test = 0.1
""")
    assert (sweep.samples, sweep.seed, sweep.shard_samples) == (1_000_000_000, 2**63 - 1, 1_000_000)
    gravity, links, mass, start = sweep.vary.values()
    assert list(sweep.vary) == ["world.gravity", "rope[0].hang.links", "rope[0].mass", "rope[0].hang.from"]
    assert gravity == [1.62, [0.0, -9.81]]
    assert (links.shape, links.is_vector, links.first, links.second) == ("integer", False, [-3.0], [30.0])
    assert (mass.min, mass.max) == ([0.1], [math.inf])
    assert (start.is_vector, start.second) == (True, [1.0, 2.0])
    assert (sweep.pictures, sweep.labels, sweep.summary) == ("npz", ["energy", "mask"], ["horizon_s", "period_s"])
    assert sweep.splits == {"train": 0.9, "test": 0.1}


def test_a_sweep_file_may_begin_with_the_mark_of_utf_8(load, tmp_path):
    load("samples = 3\n" + VARY)
    text = (tmp_path / "sweep.toml").read_text()
    (tmp_path / "sweep.toml").write_text("\ufeff" + text)
    assert _sweep_file.load(tmp_path / "sweep.toml").samples == 3


MASS = '"rope[0].mass" = { uniform = [1, 2] }\n'
HUGE = "0x" + 5000 * "f"
LISTS = "samples = 1\n[vary]\n\"world.gravity\" = [\n  [0.0, -1.0],\n  [0.0]\n]\n"
MANY = "grid = true\n[vary]\n" + "".join(f'"{key}" = {[1] * 100}\n' for key in (
    "rope[0].mass", "rope[0].payload", "world.drag", "world.gravity", "world.duration"))
OUTPUT = "samples = 1\n" + VARY + "[output]\n"
SPLIT = "samples = 1\n" + VARY + "[split]\n"


def vary(values):
    """A sweep of a key with these values, on line 5."""
    return f'samples = 1\n[vary]\n"rope[0].mass" = {values}\n'


@pytest.mark.parametrize("text, place, part", [
    (VARY, ":1:1: samples: ", "is missing; give a number of samples, or grid = true"),
    ("samples = 1\nshards = 3\n" + VARY, ":4:1: shards: ", 'unknown key "shards"; there are schema, scene, samples'),
    ("samples = 1\nsede = 3\n" + VARY, ":4:1: sede: ", 'unknown key "sede"; did you mean "seed"?'),
    ("samples = 0\n" + VARY, ":3:11: samples: ", "0 is an integer; give an integer, 1 .. 1000000000"),
    (f"samples = {HUGE}\n" + VARY, ":3:11: samples: ", "this is an integer beyond 64 bits; give an integer, 1 .. 1000000000"),
    (f"samples = 1\nseed = {2**63}\n" + VARY, ":4:8: seed: ", "beyond 64 bits; give an integer, 0 .. 9223372036854775807"),
    ("samples = 10.0\n" + VARY, ":3:11: samples: ", "10.0 is a number with a point; give an integer"),
    ("samples = 1000000001\n" + VARY, ":3:11: samples: ", "give an integer, 1 .. 1000000000"),
    ("samples = 1\nseed = -1\n" + VARY, ":4:8: seed: ", "-1 is an integer; give an integer, 0 .. "),
    ("samples = 1\nshard_samples = 0\n" + VARY, ":4:17: shard_samples: ", "give an integer, 1 .. 1000000"),
    ("samples = 1\n", ":1:1: vary: ", "no key varies; give [vary] with keys of the scene"),
    ("samples = 1\n[vary]\n", ":4:1: vary: ", "no key varies"),
    ("samples = 1\nvary = 3\n", ":4:8: vary: ", "3 is an integer; give a table [vary]"),
    ('samples = 1\noutput = "mp4"\n' + VARY, ":4:10: output: ", '"mp4" is a string; give a table [output]'),
    ("samples = \n" + VARY, ":3:", "Invalid value"),
    ("samples = 1\nsamples = 2\n" + VARY, ":4:", "Cannot overwrite a value"),
    ("samples = " + 5000 * "1" + "\n" + VARY, ":", "digits"),
    ("a = " + 5000 * "[" + "\n", ": ", "nested too deeply"),
    ("samples = 3\ngrid = true\n" + VARY, ":3:11: samples: ", "a grid has a sample for each combination; leave it out"),
    ("grid = 1\n" + VARY, ":3:8: grid: ", "1 is an integer; give true or false"),
    ("grid = false\n" + VARY, ":1:1: samples: ", "is missing"),
    ("grid = true\n[vary]\n" + MASS, ':5:18: vary."rope[0].mass": ', "a distribution has no combinations; give a list of values"),
    (MANY, ":3:8: grid: ", "more than 1000000000 combinations; give shorter lists"),
    ('samples = 1\n[vary]\n"rope[0].mas" = [1]\n', ':5:1: vary."rope[0].mas": ', 'no key of a scene; did you mean "mass"'),
    ("samples = 1\n[vary]\nrope.mass = [1]\n", ':5:1: vary."rope": ', 'quote a dotted key, such as "rope[0].hang.angle_deg"'),
    ("samples = 1\n[vary]\nrope[0].hang.links = [1]\n", ":5:5: ", 'needs quotes; write "rope[0].hang.links" = ...'),
    ('samples = 1\n[vary]\n"mass" = [1]\n', ':5:1: vary."mass": ', "no key of a scene"),
    ('samples = 1\n[vary]\n"rope[7].mass" = [1]\n', ':5:18: vary."rope[7].mass": ',
     "does not fit scene.toml: rope: index 7 is out of range; the list has 1; give 0"),
    ('samples = 1\n[vary]\n"net[0].mass" = [1]\n', ':5:17: vary."net[0].mass": ', 'the scene gives no list "net"; add net to it first'),
    ('samples = 1\n[vary]\n"rope.mass" = [1]\n', ':5:15: vary."rope.mass": ', "give an index: rope[0]"),
    ('samples = 1\n[vary]\n"rope[²].mass" = [1]\n', ':5:18: vary."rope[²].mass": ', "is not a key; give one such as rope[0].mass"),
    ('samples = 1\n[vary]\n"rope[a].mass" = [1]\n', ':5:18: vary."rope[a].mass": ', "is not a key; give one such as rope[0].mass"),
    (vary("1.0"), ':5:18: vary."rope[0].mass": ', "1.0 is a number with a point; give a list of values, or a distribution"),
    (vary("[]"), ':5:18: vary."rope[0].mass": ', "an empty list; give values to choose from"),
    (vary("[1979-05-27]"), ':5:18: vary."rope[0].mass": ', "this is a date or a time; no key of a scene takes"),
    (vary("[inf]"), ':5:18: vary."rope[0].mass": ', "no key of a scene takes"),
    (vary("[9223372036854775808]"), ':5:18: vary."rope[0].mass": ', "no key of a scene takes"),
    (vary(f"[{HUGE}]"), ':5:18: vary."rope[0].mass": ', "this is an integer beyond 64 bits; no key of a scene takes"),
    (vary(f"{{ uniform = [1, {HUGE}] }}"), ':5:18: vary."rope[0].mass": ', "uniform is [least, largest]"),
    (LISTS + '"rope[0].mas" = [1]\n', ':9:1: vary."rope[0].mas": ', 'did you mean "mass"'),
    (f"# \u2028 \x85\n{vary('1.0')}", ':6:18: vary."rope[0].mass": ', "1.0 is a number with a point"),
    (vary("{ }"), ':5:18: vary."rope[0].mass": ', "no distribution; give uniform, log_uniform, normal, integer, range"),
    (vary("{ range = [1, 2, 0.1], min = 1 }"), ':5:18: vary."rope[0].mass": ', "a range and a distribution; give one"),
    (vary("{ range = [0, 1, 1e-6] }"), ':5:18: vary."rope[0].mass": ', "range has more than 1000000 numbers; give a larger step"),
    (vary("{ unifrom = [1, 2] }"), ':5:20: vary."rope[0].mass".unifrom: ', 'unknown key "unifrom"; did you mean "uniform"?'),
    (vary("{ uniform = [1, 2], normal = [1, 2] }"), ':5:18: vary."rope[0].mass": ', "two distributions; give one"),
    (vary("{ uniform = [1, 2], min = 1 }"), ':5:44: vary."rope[0].mass": ', "min bounds a normal distribution only; leave it out"),
    (vary('{ normal = [1, 2], max = "3" }'), ':5:43: vary."rope[0].mass": ', 'max: "3" is a string; give as many numbers as normal has'),
    (vary("{ normal = [[1, 2], [3, 4]], max = 3 }"), ':5:53: vary."rope[0].mass": ', "as many numbers as normal has"),
    (vary("{ normal = [1, 2], min = 3, max = 3 }"), ':5:18: vary."rope[0].mass": ', "min is not less than max"),
    (OUTPUT + 'pictures = "gif"\n', ":7:12: output.pictures: ", '"gif" is a string; give mp4, png, npz, none'),
    (OUTPUT + "pictures = true\n", ":7:12: output.pictures: ", "true is a boolean; give mp4"),
    (OUTPUT + 'labels = "mask"\n', ":7:10: output.labels: ", '"mask" is a string; give a list of positions, velocities'),
    (OUTPUT + 'labels = ["mask", "masks"]\n', ":7:10: output.labels[1]: ", '"masks" is a string; did you mean "mask"?'),
    (OUTPUT + 'labels = ["colours"]\n', ":7:10: output.labels[0]: ", '"colours" is a string; give positions, velocities'),
    (OUTPUT + 'summary = ["angle"]\n', ":7:11: output.summary[0]: ", '"angle" is a string; did you mean "angle_max_deg"?'),
    (OUTPUT + 'summary = ["period"]\n', ":7:11: output.summary[0]: ", '"period" is a string; did you mean "period_s"?'),
    (OUTPUT + 'summary = ["error"]\n', ":7:11: output.summary[0]: ", '"error" is a string; give period_s, angle_max_deg'),
    (OUTPUT + 'picture = "mp4"\n', ":7:1: output.picture: ", 'did you mean "pictures"?'),
    (SPLIT + "train = 0.8\ntest = 0.1\n", ":6:1: split: ", "the shares have the sum 0.9; give shares with the sum 1"),
    (SPLIT + "train = 0.8\ntest = 0.3\n", ":6:1: split: ", "the sum 1.1"),
    (SPLIT + 'train = 1\n"a/b" = 0\n', ":8:9: split.a/b: ", "no name of a split; give a word such as train"),
    (SPLIT + f"train = {HUGE}\ntest = 1\n", ":7:9: split.train: ", "this is an integer beyond 64 bits; give a share, 0 .. 1"),
    (SPLIT + 'train = "all"\ntest = 1\n', ":7:9: split.train: ", '"all" is a string; give a share, 0 .. 1'),
])
def test_an_error_has_its_place_and_a_remedy(load, text, place, part):
    message = failure_of(load, text)
    assert message.startswith(load.path + place) and part in message, message
    assert "\n" not in message


UNIFORM = "uniform is [least, largest], two numbers, the smaller first, or two vectors of one length"
LOG_UNIFORM = "log_uniform is [least, largest], two positive numbers"
NORMAL = "normal is [mean, standard deviation], the second positive"
RANGE = "range is [first, last, step], three numbers"
INTEGER = "integer is [least, largest], two whole numbers, both included"


@pytest.mark.parametrize("values, part", [
    *((f"uniform = {ends}", UNIFORM) for ends in (
        "3", "[1]", "[1, 2, 3]", "[2, 1]", '[1, "2"]', "[[1], 2]", "[1, [2]]", "[[1, 2], [3]]", "[[], []]", "[1, inf]", "[nan, 1]",
        "[-1e308, 1e308]", "[true, 2]")),
    *((f"log_uniform = {ends}", LOG_UNIFORM) for ends in ("[0, 1]", "[-1, 1]", "[2, 1]", "[1e-320, 1]", "[1e-300, 1e300]")),
    *((f"normal = {ends}", NORMAL) for ends in ("[1, 0]", "[1, -1]")),
    *((f"range = {ends}", RANGE) for ends in (
        "3", "[1, 2]", "[1, 2, 0]", "[1, 2, -1]", "[2, 1, 1]", '[1, 2, "1"]', "[[1], [2], [3]]", "[1, inf, 1]", "[-1e308, 1e308, 1e-5]")),
    *((f"integer = {ends}", INTEGER) for ends in ("[1.5, 2]", "[2, 1]", "[0, 9007199254740992]")),
])
def test_distributions_have_sound_ends(load, values, part):
    message = failure_of(load, vary("{ " + values + " }"))
    assert message.startswith(load.path + ':5:18: vary."rope[0].mass": ') and part in message


@pytest.mark.parametrize("text, values", [
    ("[5, 170, 5]", list(range(5, 171, 5))),
    ("[3, 1, -1]", [3, 2, 1]),
    ("[0.1, 0.7, 0.2]", [0.1, 0.3, 0.5, 0.7]),
    ("[0.0, 1.0, 0.3]", [0.0, 0.3, 0.6, 0.9]),
    ("[0.2, -0.2, -0.1]", [0.2, 0.1, 0.0, -0.1, -0.2]),
    ("[1, 2, 0.5]", [1.0, 1.5, 2.0]),
    ("[2, 2, 1]", [2]),
])
def test_a_range_is_a_list(load, text, values):
    loaded = load("grid = true\n[vary]\n" + '"rope[0].mass" = { range = ' + text + " }\n")
    assert loaded.samples == len(values)
    assert [repr(value) for value in loaded.vary["rope[0].mass"]] == [repr(value) for value in values]


def test_ends_may_be_equal_and_shares_inexact(load):
    for values in ("uniform = [1, 1]", "integer = [2.0, 2]", "log_uniform = [1, 1]"):
        load(vary("{ " + values + " }"))
    load(SPLIT + "a = 0.1\nb = 0.2\nc = 0.7\n")
    none = load(OUTPUT + "labels = []\nsummary = []\n")
    assert (none.labels, none.summary) == ([], [])


def test_all_problems_are_named_in_order(load):
    lines = failure_of(load, 'samples = 0\nsede = 1\n[vary]\n"rope[0].mas" = [1]\n').splitlines()
    places = [":3:11: samples: ", ":4:1: sede: ", ':6:1: vary."rope[0].mas": ']
    assert len(lines) == 3 and all(line.startswith(load.path + place) for line, place in zip(lines, places))


@pytest.mark.parametrize("inner, outer", [("rope[0].hang.links", "rope[0].hang"), ("rope[0].mass", "rope[00].mass"),
                                          ("camera.center[0]", "camera.center")])
def test_keys_that_overlap_are_refused(load, inner, outer):
    message = failure_of(load, f'samples = 1\n[vary]\n"{inner}" = [1]\n"{outer}" = [2]\n')
    assert f'lies within "{outer}", which varies, too; leave one of them out' in message


def test_the_scene_must_be_there_and_sound(tmp_path):
    def failure(line):
        (tmp_path / "sweep.toml").write_text(f"schema = 1\n{line}\nsamples = 1\n{VARY}")
        with pytest.raises(corda.Error) as raised:
            _sweep_file.load(tmp_path / "sweep.toml")
        return raised.value.code, str(raised.value).removeprefix(str(tmp_path / "sweep.toml"))

    code, message = failure('scene = "none.toml"')
    assert code == 6 and message.startswith(f":2:9: scene: {tmp_path / 'none.toml'}: cannot read the scene file: No such file")
    assert failure("")[1].startswith(":1:1: scene: is missing; give the path of a scene")
    assert failure("scene = 3")[1].startswith(":2:9: scene: 3 is an integer; give the path of a scene")
    assert failure('scene = "-"')[1].startswith(':2:9: scene: "-" is standard input, which the sweep file alone may be; give the path')
    assert failure('scene = ""')[1].startswith(':2:9: scene: "" is a string; give the path')
    (tmp_path / "bad.toml").write_text(SCENE.replace("duration", "gravty"))
    code, message = failure('scene = "bad.toml"')
    assert code == 3 and message.startswith(f"{tmp_path / 'bad.toml'}:3:1: world.gravty: unknown key")
    (tmp_path / "bad.toml").write_bytes(b"schema = 1\n# \xff\n")
    assert failure('scene = "bad.toml"')[1].startswith(f":2:9: scene: {tmp_path / 'bad.toml'}:2: the scene file is no UTF-8 text")
    with pytest.raises(corda.Error, match="no.toml: cannot read the sweep file") as missing:
        _sweep_file.load(tmp_path / "no.toml")
    assert missing.value.code == 6


def test_identity_is_all_that_determines_a_sample(load, tmp_path):
    text = '[vary]\n"rope[0].mass" = { normal = [1, 2], min = 0.5 }\n'
    identity = _parameters.identity_of(load("samples = 3\n" + text))
    assert _parameters.identity_of(load("samples = 9\n" + text)) == identity  # more of the same samples
    for other in ("samples = 3\nseed = 1\n" + text, "samples = 3\nshard_samples = 2\n" + text,
                  f'samples = 3\n{text}[output]\npictures = "png"\n', f"samples = 3\n{text}[output]\nlabels = []\n",
                  f"samples = 3\n{text}[output]\nsummary = []\n", f"samples = 3\n{text}[split]\ntrain = 1\n",
                  f'samples = 3\n{text}"world.drag" = [0]\n', "samples = 3\n" + text.replace("0.5", "0.6"),
                  'samples = 3\n[vary]\n"rope[0].mass" = { uniform = [1, 2] }\n'):
        assert _parameters.identity_of(load(other)) != identity, other
    (tmp_path / "scene.toml").write_text(SCENE + "# another scene\n")
    assert _parameters.identity_of(load("samples = 3\n" + text)) != identity


COUNT = 4000


def values_of(sweep):
    """The values of the first key in all samples."""
    return [next(iter(_parameters.parameters_of(sweep, i).values())) for i in range(sweep.samples)]


def numbers_of(load, distribution):
    return np.array(values_of(load(f'samples = {COUNT}\n[vary]\n"rope[0].mass" = {distribution}\n')))


def test_random_numbers_are_those_of_philox():
    """Words of Philox4x64-10 by Random123, the library of its authors, for counter and key of zeros; numpy's counter is one ahead."""
    first = np.random.Philox(key=np.zeros(2, np.uint64), counter=np.array([2**64 - 1] * 4, np.uint64)).random_raw(4)
    assert [hex(word) for word in first] == ["0x16554d9eca36314c", "0xdb20fe9d672d0fdc", "0xd7e772cee186176b", "0x7e68b68aec7ba23b"]
    numbers = _parameters.Random(7, 12, "rope[0].mass", 1)
    assert [numbers.uniform() for _ in range(5)] == KNOWN
    seen = {_parameters.Random(seed, sample, name, component).uniform() for seed in (0, 1, 2**63 - 1) for sample in (0, 1, 2**40)
            for name in ("", "rope[0].mass", "rope[1].mass") for component in (0, 1, 65535)}
    assert len(seen) == 3**4


KNOWN = [0.7762212807619358, 0.5884737710281202, 0.9474213686813456, 0.40271229672559994, 0.9878429053785232]


def test_uniform_numbers_have_their_moments(load):
    numbers = numbers_of(load, "{ uniform = [2.0, 6] }")
    assert numbers.min() >= 2.0 and numbers.max() <= 6.0
    assert abs(numbers.mean() - 4.0) < 0.07 and abs(numbers.std() - 4.0 / math.sqrt(12.0)) < 0.04


def test_log_uniform_numbers_are_uniform_in_their_logarithm(load):
    logs = np.log10(numbers_of(load, "{ log_uniform = [0.01, 10.0] }"))
    assert logs.min() >= -2.0 and logs.max() <= 1.0
    assert abs(logs.mean() + 0.5) < 0.05 and abs(logs.std() - 3.0 / math.sqrt(12.0)) < 0.04


def test_normal_numbers_have_their_moments_and_bounds(load):
    numbers = numbers_of(load, "{ normal = [3.0, 0.5] }")
    assert abs(numbers.mean() - 3.0) < 0.03 and abs(numbers.std() - 0.5) < 0.03
    # Mean phi(0) / (1 - Phi(0)) above 3, in units of the deviation: sqrt(2 / pi).
    numbers = numbers_of(load, "{ normal = [3.0, 0.5], min = 3 }")
    assert numbers.min() >= 3.0 and abs(numbers.mean() - 3.0 - 0.5 * math.sqrt(2.0 / math.pi)) < 0.02
    numbers = numbers_of(load, "{ normal = [3.0, 0.5], min = 2.9, max = 3.1 }")
    assert numbers.min() >= 2.9 and numbers.max() <= 3.1
    far = load('samples = 1\n[vary]\n"rope[0].mass" = { normal = [0.0, 1.0], min = 50.0 }\n')
    with pytest.raises(corda.Error, match='vary."rope.0..mass": of 1000 numbers .* give wider bounds') as raised:
        _parameters.parameters_of(far, 0)
    assert raised.value.code == 3


def test_parameters_have_twelve_digits(load):
    for distribution in ("{ uniform = [2.0, 6] }", "{ log_uniform = [0.01, 10.0] }", "{ normal = [3.0, 0.5] }"):
        numbers = numbers_of(load, distribution)[:100]
        assert all(float(f"{number:.12g}") == number for number in numbers)
        assert len({f"{number:.11g}" for number in numbers}) == 100


def test_integers_are_equally_likely_with_both_ends(load):
    values, counts = np.unique(numbers_of(load, "{ integer = [3, 7] }"), return_counts=True)
    assert values.tolist() == [3, 4, 5, 6, 7] and np.abs(counts - COUNT / 5).max() < 110
    assert all(type(value) is int for value in values_of(load(vary("{ integer = [-4, -4] }"))))


def test_choices_are_equally_likely_and_keep_their_type(load):
    values = [json.dumps(value) for value in values_of(load(f'samples = {COUNT}\n[vary]\n"world.gravity" = [9.81, 2, [0.0, -1], "x"]\n'))]
    assert sorted(set(values)) == sorted(['9.81', '2', '[0.0, -1]', '"x"'])
    assert all(abs(values.count(value) - COUNT / 4) < 130 for value in set(values))


def test_components_of_a_vector_are_independent(load):
    values = np.array(values_of(load(f'samples = {COUNT}\n[vary]\n"world.gravity" = {{ uniform = [[-1, 10], [1, 30.0]] }}\n')))
    x, y = values[:, 0], (values[:, 1] - 20.0) / 10.0
    assert np.abs([x, y]).max() <= 1.0 and abs((3.0 * x * y).mean()) < 0.06


def test_keys_and_seeds_are_independent(load):
    mass, links = '"rope[0].mass" = { uniform = [1.0, 2.0] }\n', '"rope[0].hang.links" = { integer = [3, 30] }\n'
    one, both, other = (load(f"samples = 50\n{seed}[vary]\n{keys}") for seed, keys in (
        ("", mass), ("seed = 0\n", links + mass), ("seed = 1\n", mass)))
    for i in range(50):
        assert _parameters.parameters_of(both, i)["rope[0].mass"] == _parameters.parameters_of(one, i)["rope[0].mass"]
        assert _parameters.parameters_of(other, i) != _parameters.parameters_of(one, i)
        assert _parameters.split_of(one, i) == ""


def test_a_grid_has_every_combination_and_the_last_key_varies_fastest(load):
    sweep = load('grid = true\n[vary]\n"world.gravity" = [9.81, 1.62]\n"rope[0].hang.links" = [3, 5, 8]\n')
    made = [_parameters.settings_of(_parameters.parameters_of(sweep, i)) for i in range(sweep.samples)]
    assert made == [[f"rope[0].hang.links={links}", f"world.gravity={gravity}"] for gravity in (9.81, 1.62) for links in (3, 5, 8)]


def test_splits_have_their_shares(load):
    sweep = load(f'samples = {COUNT}\n[vary]\n"rope[0].mass" = {{ uniform = [1.0, 2.0] }}\n'
                 "[split]\ntrain = 0.7\ntest = 0.2\nunused = 0\nvalidation = 0.1\n")
    splits = [_parameters.split_of(sweep, i) for i in range(COUNT)]
    assert set(splits) == {"train", "test", "validation"}
    for name, share in (("train", 0.7), ("test", 0.2), ("validation", 0.1)):
        assert abs(splits.count(name) - share * COUNT) < 90
    masses = [mass for split, mass in zip(splits, values_of(sweep)) if split == "test"]
    assert abs(np.mean(masses) - 1.5) < 0.05  # independent of the parameters
    sweep.splits = {"a": 0.5e-12, "b": 0.5e-12, "c": 0.0}
    assert _parameters.split_of(sweep, 3) == "b"  # as if shares were rounded


def test_values_are_toml():
    value = [1, -0.5, True, 'a"b', {"t": 0.0, "at": [1e300, 3]}]
    assert _sweep_file.toml_of(value) == '[1, -0.5, true, "a\\"b", {"at" = [1e300, 3], "t" = 0}]'
    numbers = {0.1: "0.1", -0.0: "-0.0", 2.0: "2", 1e-9: "1e-9", 1e5: "100000", 1e6: "1e6", 123456.0: "123456", 1e22: "1e22", 0.08: "0.08",
               1.5e-7: "1.5e-7", 1234567.25: "1234567.25"}
    assert {number: _sweep_file.number_text(number) for number in numbers} == numbers
    assert (_sweep_file.value_text("a b"), _sweep_file.value_text([1, 2])) == ("a b", "[1, 2]")


def test_angles_are_those_of_the_library():
    x, y = np.random.default_rng(1).uniform(-1.0, 1.0, (2, 10_000))
    expected = np.arctan2(y.astype(np.longdouble), x.astype(np.longdouble))
    assert np.abs((_sample.angle_of(x, y) - expected) / np.spacing(np.abs(expected.astype(float)))).max() < 6.0  # measured below
    x, y = np.array([[0.0, 0.0], [2.0, 0.0], [-2.0, 0.0], [0.0, 1.0], [0.0, -1.0], [-1.0, -1.0]]).T
    expected = [0.0, 0.0, np.pi, np.pi / 2, -np.pi / 2, -3 * np.pi / 4]
    assert np.allclose(_sample.angle_of(x, y), expected, rtol=0.0, atol=1e-15)


def test_keys_have_at_least_six_digits():
    assert [_parameters.key_of(i) for i in (0, 999_999, 1_000_000)] == ["000000", "999999", "1000000"]


def test_a_broken_file_gives_a_sweep_or_an_error(load):
    more = '"world.drag" = { normal = [0.1, 0.05], min = 0.0 }\n"rope[0].hang.links" = { integer = [3, 30] }\n[output]'
    text = OUTPUT.replace("[output]", more) + 'labels = ["mask"]\n[split]\ntrain = 0.5\ntest = 0.5\n'
    pieces = ['"', "[", "]", "{", "}", "=", "\n", "-", "1e400", "nan", "[[vary]]", "'''", "9" * 30, "\x00", "é", ".", "vary", "true"]
    chance = random.Random(3)
    loaded = 0
    for _ in range(5000 if os.environ.get("CORDA_TEST_LONG") else 400):
        broken = text
        for _ in range(chance.choice((1, 1, 1, 2))):
            at = chance.randrange(len(broken))
            broken = broken[:at] + chance.choice(pieces) + broken[at + chance.randint(0, 4):]
        try:
            sweep = load(broken)
            _parameters.parameters_of(sweep, sweep.samples - 1), _parameters.split_of(sweep, 0), _parameters.identity_of(sweep)
            loaded += 1
        except corda.Error as error:
            assert error.code in (3, 6) and str(error), broken
    assert loaded > 2  # measured 5

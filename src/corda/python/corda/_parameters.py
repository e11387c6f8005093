"""The parameters of the samples of a sweep: functions of the sweep file, the seed and the number of the sample alone."""

import hashlib
import json

from ._corda import __version__
from ._distributions import Distribution, Random, draw
from ._sweep_file import number_text, toml_of

_MAX_IDENTITY_TEXT = 200


def parameters_of(sweep, sample):
    """The value of each key of [vary] in a sample. Raises Error (code 3) if no number of a normal distribution is within its
    bounds."""
    parameters, rest = {}, sample
    for key, values in reversed(sweep.vary.items()):
        if isinstance(values, Distribution):
            numbers = [draw(values, i, Random(sweep.seed, sample, key, i), key) for i in range(len(values.first))]
            parameters[key] = numbers if values.is_vector else numbers[0]
        elif sweep.is_grid:
            rest, index = divmod(rest, len(values))
            parameters[key] = values[index]
        else:
            parameters[key] = values[int(Random(sweep.seed, sample, key).uniform() * len(values))]
    return {key: parameters[key] for key in sweep.vary}


def split_of(sweep, sample):
    """The split of a sample, which does not depend on its parameters; "" if the file has none."""
    if not sweep.splits:
        return ""
    rest = Random(sweep.seed, sample, "[split]").uniform()
    for name, share in sweep.splits.items():
        if rest < share:
            return name
        rest -= share
    return [name for name, share in sweep.splits.items() if share > 0.0][-1]  # the shares were rounded


def settings_of(parameters):
    """The parameters as settings of the scene, "key=value", sorted."""
    return sorted(f"{key}={toml_of(value)}" for key, value in parameters.items())


def key_of(sample):
    """The key of a sample: its number with at least 6 digits, with which the names of its files begin."""
    return f"{sample:06}"


def hash_text(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def identity_of(sweep):
    """All that determines the bytes of a sample, as text by key: two sweeps with the same have the same samples."""
    identity = {"version": __version__,
                "random": "philox4x64",
                "scene": hash_text(f"{sweep.scene_name}\n{sweep.scene_toml}"),
                "grid": toml_of(sweep.is_grid),
                "seed": str(sweep.seed),
                "shard_samples": str(sweep.shard_samples),
                "output.pictures": sweep.pictures,
                "output.summary": " ".join(sweep.summary),
                "output.labels": " ".join(["times", *sweep.labels])}
    if sweep.encoder:
        identity["encoder"] = sweep.encoder
    identity.update({f"split.{name}": number_text(share) for name, share in sweep.splits.items()})
    for i, (key, values) in enumerate(sweep.vary.items()):
        if isinstance(values, Distribution):
            ends = (values.first, values.second, values.min, values.max)
            text = " ".join([values.shape, *map(toml_of, ends)])
        else:
            text = json.dumps(values, ensure_ascii=False, separators=(",", ":"))
        text = f"{i}: {text}" if sweep.is_grid else text
        identity[f"vary.{json.dumps(key)}"] = text if len(text) <= _MAX_IDENTITY_TEXT else hash_text(text)
    return identity

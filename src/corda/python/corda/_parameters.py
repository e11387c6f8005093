"""The parameters of the samples of a sweep: functions of the sweep file, the seed and the number of the sample alone."""

import decimal
import hashlib
import json
import math

import numpy as np

from . import _error
from ._corda import __version__
from ._sweep_file import Distribution, number_text, toml_of

_MAX_TRIES = 1000
_MAX_IDENTITY_TEXT = 200
# Its logarithm and exponential are rounded correctly, so their digits are the same with every C library and CPU.
_DECIMAL = decimal.Context(prec=25)


class Random:
    """The random numbers of one component of one quantity of one sample.

    Number n is (w >> 11) / 2**53, 0 <= u < 1, of word w number n of numpy.random.Philox (Philox4x64-10: Salmon, Moraes, Dror and
    Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11, 2011) with the key (seed, h) and the counter (0, component, sample,
    0), where h is the first 8 bytes of the SHA-256 of the quantity's name, little endian. Philox adds one to the first word of the
    counter before every four words.
    """

    def __init__(self, seed, sample, quantity, component=0):
        name = int.from_bytes(hashlib.sha256(quantity.encode()).digest()[:8], "little")
        self._words = np.random.Philox(key=np.array([seed, name], np.uint64),
                                       counter=np.array([0, component, sample, 0], np.uint64))

    def uniform(self):
        """The next number, 0 <= u < 1, a multiple of 2**-53."""
        return (int(self._words.random_raw()) >> 11) * 2.0**-53

    def normal(self):
        """A number of the standard normal distribution, by Marsaglia's polar method: u sqrt(-2 ln s / s), s = u^2 + v^2 < 1."""
        while True:
            u = 2.0 * self.uniform() - 1.0
            v = 2.0 * self.uniform() - 1.0
            square = u * u + v * v
            if 0.0 < square < 1.0:
                return u * math.sqrt(-2.0 * float(_DECIMAL.ln(decimal.Decimal(square))) / square)


def _rounded(value):
    """A number rounded to 12 significant digits."""
    return float(f"{value:.11e}")


def _draw(distribution, component, random, key):
    first, second = distribution.first[component], distribution.second[component]
    if distribution.shape == "uniform":
        return min(max(_rounded(first + (second - first) * random.uniform()), first), second)
    if distribution.shape == "log_uniform":
        low, high = (_DECIMAL.ln(decimal.Decimal(end)) for end in (first, second))
        power = _DECIMAL.fma(_DECIMAL.subtract(high, low), decimal.Decimal(random.uniform()), low)
        return min(max(_rounded(float(_DECIMAL.exp(power))), first), second)
    if distribution.shape == "integer":
        return int(first + math.floor((second - first + 1.0) * random.uniform()))
    assert distribution.shape == "normal", distribution.shape
    for _ in range(_MAX_TRIES):
        value = _rounded(first + second * random.normal())
        if distribution.min[component] <= value <= distribution.max[component]:
            return value
    raise _error(f'vary."{key}": of {_MAX_TRIES} numbers of the normal distribution none was within its bounds; give wider '
                 "bounds", 3)


def parameters_of(sweep, sample):
    """The value of each key of [vary] in a sample. Raises Error (code 3) if no number of a normal distribution is within its
    bounds."""
    parameters, rest = {}, sample
    for key, values in reversed(sweep.vary.items()):
        if isinstance(values, Distribution):
            numbers = [_draw(values, i, Random(sweep.seed, sample, key, i), key) for i in range(len(values.first))]
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

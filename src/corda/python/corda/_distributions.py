"""The distributions that a key of a sweep can have, a row of SHAPES each, and the random numbers that they are drawn from."""

import dataclasses
import decimal
import hashlib
import math
import sys

import numpy as np

from ._arguments import make_error

_MAX_TRIES = 1000
_LEAST_NORMAL = sys.float_info.min
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


@dataclasses.dataclass(frozen=True)
class Distribution:
    """Independent numbers, one per component; of a number, one component."""

    shape: str  #: a key of SHAPES
    is_vector: bool
    first: list  #: per component: the least number; of "normal", the mean
    second: list  #: per component: the largest number; of "normal", the standard deviation
    min: list  #: bounds of "normal", which may be infinite
    max: list


def rounded(value):
    """A number rounded to 12 significant digits, without a negative zero; an integer stays."""
    return value if isinstance(value, int) else float(f"{value:.11e}") + 0.0


def _uniform(low, high, random):
    return min(max(rounded(low + (high - low) * random.uniform()), low), high)


def _log_uniform(low, high, random):
    from_, to = (_DECIMAL.ln(decimal.Decimal(end)) for end in (low, high))
    power = _DECIMAL.fma(_DECIMAL.subtract(to, from_), decimal.Decimal(random.uniform()), from_)
    return min(max(rounded(float(_DECIMAL.exp(power))), low), high)


def _normal(mean, deviation, random):
    return rounded(mean + deviation * random.normal())


def _integer(low, high, random):
    return int(low + math.floor((high - low + 1.0) * random.uniform()))


#: By distribution: a test of its two numbers, their description in messages, and a number drawn.
SHAPES = {
    "uniform": (lambda low, high: low <= high and math.isfinite(high - low),
                "is [least, largest], two numbers, the smaller first, or two vectors of one length", _uniform),
    "log_uniform": (lambda low, high: _LEAST_NORMAL <= low <= high and math.isfinite(high / low),
                    "is [least, largest], two positive numbers or two vectors of one length", _log_uniform),
    "normal": (lambda mean, deviation: deviation > 0.0,
               "is [mean, standard deviation], the second positive, or two vectors of one length; bounds are min and max", _normal),
    "integer": (lambda low, high: low == math.floor(low) and high == math.floor(high) and low <= high
                and max(abs(low), abs(high)) <= 2.0**52,
                "is [least, largest], two whole numbers, both included, or two vectors of one length", _integer),
}


def draw(distribution, component, random, key):
    """A number of a component. Raises Error (code 3) if none is within the bounds of a normal distribution."""
    ends = distribution.first[component], distribution.second[component]
    for _ in range(_MAX_TRIES):
        value = SHAPES[distribution.shape][2](*ends, random)
        if distribution.min[component] <= value <= distribution.max[component]:
            return value
    raise make_error(f'vary."{key}": of {_MAX_TRIES} numbers of the normal distribution none was within its bounds; give wider '
                     "bounds", 3)

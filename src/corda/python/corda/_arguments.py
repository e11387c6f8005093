"""Converts arguments for the C++ half: file names, text, numbers, settings and arrays. Errors name the argument."""

import collections.abc as abc
import decimal
import fractions
import json
import math
import numbers
import operator
import os

import numpy as np

from ._corda import Error

_SHORT = {"size": "video.size", "fps": "video.fps", "duration": "world.duration", "crf": "video.crf",
          "preset": "video.preset", "codec": "video.codec", "jobs": "video.jobs"}


def make_error(message, code=2):
    """An Error; `code` is the exit code of the program."""
    error = Error(message)
    error.code = code
    return error


def path_bytes(path, name="path"):
    """The bytes of a file name; os.fsencode accepts the names of os.listdir in any encoding."""
    try:
        name_bytes = os.fsencode(path)
    except TypeError:
        raise TypeError(f"{name}: takes a str, bytes or a path, not {path!r}") from None
    except UnicodeEncodeError as error:
        raise make_error(f"{name}: {path!a} has a lone surrogate at {error.start}, which no file name holds") from None
    if b"\0" in name_bytes:
        raise make_error(f"{name}: {path!r} holds a NUL character, which no file name can; leave it out")
    return name_bytes


def checked_text(text, name):
    """The text, if it is a str that UTF-8 can hold."""
    if not isinstance(text, str):
        raise TypeError(f"{name}: takes a str, not {type(text).__name__}")
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise make_error(f"{name}: character {error.start} is the lone surrogate {text[error.start]!a}, which UTF-8 cannot "
                         "hold; decode the text by the encoding of its file") from None
    return text


def quoted(text, name):
    """The text as a TOML string. TOML allows no control characters; JSON allows 0x7f."""
    return json.dumps(checked_text(text, name), ensure_ascii=False).replace("\x7f", "\\u007f")


def to_float(value, name):
    """The float nearest to a number of any kind."""
    if isinstance(value, (str, bytes, bytearray)) or value is np.ma.masked:
        raise TypeError(f"{name}: takes a number, not {value!r}")
    try:
        number = float(value)
    except TypeError:
        raise TypeError(f"{name}: takes a number, not {value!r}") from None
    except (OverflowError, ValueError):  # from an int, or from a signalling NaN
        raise make_error(f"{name}: takes a number that a float can hold, not {value!r:.40}") from None
    if math.isinf(number) and value != number:
        raise make_error(f"{name}: takes a number that a float can hold, not {value!r:.40}")
    return number


def gl_options(backend, require_gpu):
    """How to reach OpenGL: the backend, and whether only a GPU will do."""
    backend = checked_text(backend, "backend") if backend is not None else ""
    if not isinstance(require_gpu, (bool, np.bool_)):
        raise TypeError(f"require_gpu: takes True or False, not {require_gpu!r}")
    return backend or os.environ.get("CORDA_BACKEND") or "auto", bool(require_gpu)


def to_toml(value, name):
    """A Python or numpy value as a TOML value. `name` is its keyword."""
    try:
        return _to_toml(value, name)
    except RecursionError:
        raise make_error(f"{name}: takes no list or dictionary that holds itself") from None


def _to_toml(value, name):
    if value is np.ma.masked:
        raise TypeError(f"{name}: takes a value, not a masked one")
    if getattr(getattr(value, "dtype", None), "kind", "") in "mM" and hasattr(value, "dtype"):
        raise TypeError(f"{name}: takes seconds as a number, not {value.dtype}; divide by numpy.timedelta64(1, 's')")
    if isinstance(value, np.floating) and not isinstance(value, float):
        value = float(str(value))  # numpy.float32(0.1) is 0.1, not the nearest double of 24 bits
    if isinstance(value, np.generic) or (isinstance(value, np.ndarray) and value.ndim == 0):
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value, name)
    if isinstance(value, numbers.Integral):
        if name in ("preset", "video.preset", "video__preset"):  # presets of libaom and SVT-AV1 are numbers
            return f'"{int(value)}"'
        if not -2**63 <= value < 2**63:
            raise make_error(f"{name}: takes no number as large as {value!r:.40}")
        return str(int(value))
    if isinstance(value, fractions.Fraction) and value.denominator != 1 and name in ("fps", "video.fps", "video__fps"):
        return f'"{value.numerator}/{value.denominator}"'
    if isinstance(value, (numbers.Real, decimal.Decimal)):
        number = to_float(value, name)
        # A rate is an integer, or exact with a few decimals.
        return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, abc.Mapping):
        return "{" + ", ".join(f"{quoted(key, name)} = {_to_toml(one, name)}" for key, one in value.items()) + "}"
    if isinstance(value, abc.Iterable) and not isinstance(value, (bytes, bytearray, abc.Set)):
        return "[" + ", ".join(_to_toml(one, name) for one in value) + "]"
    raise TypeError(f"{name}: takes numbers, text, lists, tuples, arrays and dictionaries of these, not "
                    f"{type(value).__name__}")


def setting_lines(settings, keys):
    """Lines key=value for --set, with the caller's name of each. None leaves a key unchanged."""
    if not isinstance(settings, (abc.Mapping, type(None))):
        raise TypeError(f"settings: takes a dictionary of keys and values, not {settings!r}")
    named = {key: (key, value) for key, value in (settings or {}).items()}
    for key in named:
        if "=" in checked_text(key, "settings"):
            raise make_error(f"settings: a key is a name such as 'rope[0].mass', and {key!r} has a =; give the value as a value")
    for name, value in keys.items():
        parts = name.split("__")
        if any(part.isdigit() for part in parts):
            key = "".join(f"[{part}]" if part.isdigit() else f".{part}" for part in parts).lstrip(".")
            raise make_error(f"{name}: a keyword cannot hold an index; use settings={{{key!r}: {value!r}}}")
        key = _SHORT.get(name, ".".join(parts))
        if value is not None and named.get(key, (key, None))[1] is not None:
            raise TypeError(f"{name}: is given by {named[key][0]}, too; leave one of them out")
        named[key] = (name, value)
    return {f"{key}={to_toml(value, name)}": (key, name) for key, (name, value) in named.items() if value is not None}


def in_words_of_the_caller(error, settings):
    """The error of a setting, with its keyword in place of the command line option."""
    message = str(error)
    for key, name in settings.values():
        message = message.replace(f"--set {key}=", f"{name}=")
    return make_error(message, error.code)


def frame_index(value, film):
    """The number of a frame, counted from the end if it is negative, as in a list."""
    try:
        k = operator.index(value)
    except TypeError:
        raise TypeError(f"k: takes an integer, not {value!r}") from None
    count = len(film)
    if not -count <= k < count:
        raise IndexError(f"frame {k} is not within 0 .. {count - 1}, nor within -{count} .. -1 from the end")
    return k % count


def _real_array(value, name):
    """An array of float64 of real numbers."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: takes an array of numbers, not of {array.dtype}")
    return np.ascontiguousarray(array, dtype=np.float64)


def given_motion(positions, times):
    """The arrays of a given motion, times first; None without them."""
    if positions is None and times is None:
        return None
    if positions is None or times is None:
        raise TypeError("Film takes positions and times together")
    times, positions = _real_array(times, "times"), _real_array(positions, "positions")
    if times.ndim != 1:
        raise ValueError(f"times: takes an array of shape (n,), not {times.shape}")
    if positions.ndim != 3 or positions.shape[0] != len(times) or positions.shape[2] != 2:
        raise ValueError(f"positions: takes an array of shape ({len(times)}, particles, 2) for {len(times)} times, not "
                         f"{positions.shape}")
    return times, positions


def answering(on_progress):
    """Wraps a callback: only False (of Python or numpy) stops the work; None and other results continue it."""
    if on_progress is None:
        return None
    if not callable(on_progress):
        raise TypeError(f"on_progress: takes a function of (done, total), not {on_progress!r}")

    def answer(done, total):
        given = on_progress(done, total)
        return bool(given) if isinstance(given, (bool, np.bool_)) else True

    return answer

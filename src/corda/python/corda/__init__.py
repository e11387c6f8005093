"""Corda: rope pendulums as exact frames and video, on a machine without a screen.

    import corda
    film = corda.Film("swing.toml", size=(640, 360))
    film.frame(30)            # numpy uint8 (height, width, 4), row 0 on top; film[30], film[-1], film[0:10]
    film.positions            # float64 (frames, particles, 2), metres, y up
    film.save("swing.mp4")

    import corda.plot         # needs matplotlib
    corda.plot.angle(film)    # and energy, phase, tip, tension, divergence

    sweep = corda.Sweep("sweep.toml")           # one scene, many parameters: dictionaries of parameters and arrays
    sweep[12]["frames"], len(sweep), sweep.shard(0, 8)

Coordinates are in metres, y up; times in seconds. Failures raise corda.Error, whose `code` is the exit code of
the program (`corda help codes` lists them). Pictures are arrays of RGBA bytes, sRGB, with straight alpha.
"""

import atexit as _atexit
import base64 as _base64
import collections.abc as _abc
import decimal as _decimal
import fractions as _fractions
import importlib as _importlib
import json as _json
import math as _math
import numbers as _numbers
import operator as _operator
import os as _os
import pathlib as _pathlib
import signal as _signal
import sys as _sys
import tempfile as _tempfile
from typing import NamedTuple as _NamedTuple

if _sys.argv[:1] == ["-m"] and "corda" in _sys.orig_argv:
    # `python3 -m corda` is importing its package: Ctrl-C has no traceback to show of that.
    _signal.signal(_signal.SIGINT, lambda *_: _os._exit(130))

import numpy as _np


def _built_for():
    """The versions of Python for which C++ halves are in this folder, such as "3.11"."""
    tags = [path.name.split("-")[1] for path in _pathlib.Path(__file__).parent.glob("_corda.cpython-*.so")]
    return sorted(f"{tag[0]}.{tag[1:]}" for tag in tags)


try:
    from . import _corda
except ImportError:
    _versions, _this = _built_for(), "%d.%d" % _sys.version_info[:2]
    if not _versions or _this in _versions:
        raise
    raise ImportError(f"the module corda is built for {', '.join(_versions)}, this is {_this}; run python{_versions[-1]}, or build "
                      "Corda with this Python") from None
from ._corda import Error, __version__

__all__ = ["Difference", "Error", "Film", "Sweep", "__version__", "compare", "read_png", "write_png"]


def __getattr__(name):
    """corda.plot without `import corda.plot`; it needs matplotlib, which all else does without."""
    if name == "plot":
        return _importlib.import_module(".plot", __name__)
    raise AttributeError(f"module 'corda' has no attribute {name!r}")


Error.__doc__ = "A failure of Corda, with a message. `code`: the exit code of the program (int)."

# Daemon threads may be drawing when the interpreter ends.
_atexit.register(_corda.begin_end)
_os.register_at_fork(after_in_child=_corda.forget_calls)

_SHORT = {"size": "video.size", "fps": "video.fps", "duration": "world.duration", "crf": "video.crf",
          "preset": "video.preset", "codec": "video.codec", "jobs": "video.jobs"}


def _error(message, code=2):
    error = Error(message)
    error.code = code
    return error


def _path(path, name="path"):
    """The bytes of a file name; os.fsencode accepts the names of os.listdir in any encoding."""
    try:
        name_bytes = _os.fsencode(path)
    except TypeError:
        raise TypeError(f"{name}: takes a str, bytes or a path, not {path!r}") from None
    except UnicodeEncodeError as error:
        raise _error(f"{name}: {path!a} has a lone surrogate at {error.start}, which no file name holds") from None
    if b"\0" in name_bytes:
        raise _error(f"{name}: {path!r} holds a NUL character, which no file name can; leave it out")
    return name_bytes


def _text(text, name):
    """The text, if it is a str that UTF-8 can hold."""
    if not isinstance(text, str):
        raise TypeError(f"{name}: takes a str, not {type(text).__name__}")
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise _error(f"{name}: character {error.start} is the lone surrogate {text[error.start]!a}, which UTF-8 cannot "
                     "hold; decode the text by the encoding of its file") from None
    return text


def _quoted(text, name):
    """The text as a TOML string. TOML allows no control characters; JSON allows 0x7f."""
    return _json.dumps(_text(text, name), ensure_ascii=False).replace("\x7f", "\\u007f")


def _float(value, name):
    """The float nearest to a number of any kind."""
    if isinstance(value, (str, bytes, bytearray)) or value is _np.ma.masked:
        raise TypeError(f"{name}: takes a number, not {value!r}")
    try:
        number = float(value)
    except TypeError:
        raise TypeError(f"{name}: takes a number, not {value!r}") from None
    except (OverflowError, ValueError):  # from an int, or from a signalling NaN
        raise _error(f"{name}: takes a number that a float can hold, not {value!r:.40}") from None
    if _math.isinf(number) and value != number:
        raise _error(f"{name}: takes a number that a float can hold, not {value!r:.40}")
    return number


def _gl(backend, require_gpu):
    """How to reach OpenGL: the backend, and whether only a GPU will do."""
    backend = _text(backend, "backend") if backend is not None else ""
    if not isinstance(require_gpu, (bool, _np.bool_)):
        raise TypeError(f"require_gpu: takes True or False, not {require_gpu!r}")
    return backend or _os.environ.get("CORDA_BACKEND") or "auto", bool(require_gpu)


def _limit(value, name):
    return None if value is None else _float(value, name)


def _toml(value, name):
    """A Python or numpy value as a TOML value. `name` is its keyword."""
    try:
        return _toml_of(value, name)
    except RecursionError:
        raise _error(f"{name}: takes no list or dictionary that holds itself") from None


def _toml_of(value, name):
    if value is _np.ma.masked:
        raise TypeError(f"{name}: takes a value, not a masked one")
    if getattr(getattr(value, "dtype", None), "kind", "") in "mM" and hasattr(value, "dtype"):
        raise TypeError(f"{name}: takes seconds as a number, not {value.dtype}; divide by numpy.timedelta64(1, 's')")
    if isinstance(value, _np.floating) and not isinstance(value, float):
        value = float(str(value))  # numpy.float32(0.1) is 0.1, not the nearest double of 24 bits
    if isinstance(value, _np.generic) or (isinstance(value, _np.ndarray) and value.ndim == 0):
        value = value.item()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _quoted(value, name)
    if isinstance(value, _numbers.Integral):
        if name in ("preset", "video.preset", "video__preset"):  # presets of libaom and SVT-AV1 are numbers
            return f'"{int(value)}"'
        if not -2**63 <= value < 2**63:
            raise _error(f"{name}: takes no number as large as {value!r:.40}")
        return str(int(value))
    if isinstance(value, _fractions.Fraction) and value.denominator != 1 and name in ("fps", "video.fps", "video__fps"):
        return f'"{value.numerator}/{value.denominator}"'
    if isinstance(value, (_numbers.Real, _decimal.Decimal)):
        number = _float(value, name)
        # A rate is an integer, or exact with a few decimals.
        return str(int(number)) if number.is_integer() and abs(number) < 2**53 else repr(number)
    if isinstance(value, _np.ndarray):
        value = value.tolist()
    if isinstance(value, _abc.Mapping):
        return "{" + ", ".join(f"{_quoted(key, name)} = {_toml_of(one, name)}" for key, one in value.items()) + "}"
    if isinstance(value, _abc.Iterable) and not isinstance(value, (bytes, bytearray, _abc.Set)):
        return "[" + ", ".join(_toml_of(one, name) for one in value) + "]"
    raise TypeError(f"{name}: takes numbers, text, lists, tuples, arrays and dictionaries of these, not "
                    f"{type(value).__name__}")


def _settings(settings, keys):
    """Lines key=value for --set, with the caller's name of each. None leaves a key unchanged."""
    if not isinstance(settings, (_abc.Mapping, type(None))):
        raise TypeError(f"settings: takes a dictionary of keys and values, not {settings!r}")
    named = {key: (key, value) for key, value in (settings or {}).items()}
    for key in named:
        if "=" in _text(key, "settings"):
            raise _error(f"settings: a key is a name such as 'rope[0].mass', and {key!r} has a =; give the value as a value")
    for name, value in keys.items():
        parts = name.split("__")
        if any(part.isdigit() for part in parts):
            key = "".join(f"[{part}]" if part.isdigit() else f".{part}" for part in parts).lstrip(".")
            raise _error(f"{name}: a keyword cannot hold an index; use settings={{{key!r}: {value!r}}}")
        key = _SHORT.get(name, ".".join(parts))
        if value is not None and named.get(key, (key, None))[1] is not None:
            raise TypeError(f"{name}: is given by {named[key][0]}, too; leave one of them out")
        named[key] = (name, value)
    return {f"{key}={_toml(value, name)}": (key, name) for key, (name, value) in named.items() if value is not None}


def _in_words_of_the_caller(error, settings):
    """The error of a setting, with its keyword in place of the command line option."""
    message = str(error)
    for key, name in settings.values():
        message = message.replace(f"--set {key}=", f"{name}=")
    return _error(message, error.code)


def _index(value, name):
    try:
        return _operator.index(value)
    except TypeError:
        raise TypeError(f"{name}: takes an integer, not {value!r}") from None


def _frame_index(value, film):
    """The number of a frame, counted from the end if it is negative, as in a list."""
    k = _index(value, "k")
    count = len(film)
    if not -count <= k < count:
        raise IndexError(f"frame {k} is not within 0 .. {count - 1}, nor within -{count} .. -1 from the end")
    return k % count


def _real_array(value, name):
    """An array of float64 of real numbers."""
    array = _np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: takes an array of numbers, not of {array.dtype}")
    return _np.ascontiguousarray(array, dtype=_np.float64)


def _given(positions, times):
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


def _answering(on_progress):
    """Wraps a callback: only False (of Python or numpy) stops the work; None and other results continue it."""
    if on_progress is None:
        return None
    if not callable(on_progress):
        raise TypeError(f"on_progress: takes a function of (done, total), not {on_progress!r}")

    def answer(done, total):
        given = on_progress(done, total)
        return bool(given) if isinstance(given, (bool, _np.bool_)) else True

    return answer


class Film:
    """A scene as pictures: planned and simulated once, then drawn in any order. A sequence of its frames, in the order of
    time: len(film), film[k], film[-1], film[0:10], for frame in film.

    path: a scene file; or `text`, the scene itself as TOML. Other keywords set keys of the scene, like --set of the program:
    size=(width, height), fps, duration, crf, preset, codec and jobs by these names, other keys by their own name with two
    underscores for the dot (world__drag=0.1), or in `settings`, a dictionary ({"rope[0].mass": 2}). Values are numbers of any
    kind, text, and lists, arrays and dictionaries of these; None leaves a key unchanged. `backend` and `require_gpu` choose
    OpenGL like --backend and --require-gpu.

    positions, times: a motion in place of a simulation, such as one of MuJoCo, a measurement or an integrator of your own:
    float64 of shape (n, particles, 2) in m, ropes before nets, at n increasing times in s, the first of them at most 0. Between
    these times, particles move along cubic polynomials. The bodies and their look are those of the scene, the duration is the
    last time unless the scene or a keyword gives it, and the plan's methods are "given". Velocities follow from the positions;
    tensions are NaN.

    Raises Error for a scene that cannot be read (code 6) or is invalid (3); reading or drawing raises Error for a motion that
    diverges (8), an unknown backend (2), and drawing without OpenGL (4). Warns before a simulation of many seconds. Ctrl-C ends
    every call. Threads may share a film; it serves one at a time, without holding the interpreter's lock.
    """

    #: Largest video in bytes that a notebook embeds.
    largest_embedded = 32_000_000

    #: For corda.plot: see corda/_motion.py.
    _motion = None

    def __init__(self, path=None, *, text=None, positions=None, times=None, settings=None, backend=None, require_gpu=False,
                 **keys):
        if (path is None) == (text is None):
            raise TypeError("Film takes a path or text=..., and not both")
        lines = _settings(settings, keys)
        source = _path(path) if path is not None else b"text"
        self._gl = _gl(backend, require_gpu)
        given = _given(positions, times)
        try:
            self._film = _corda.Film(_text(text or "", "text"), source, path is not None, list(lines), *self._gl, given)
        except Error as error:
            raise _in_words_of_the_caller(error, lines) from None

    def __len__(self):
        """Number of frames of the scene's video."""
        return self._film.frame_count()

    def __getitem__(self, k):
        """film[k]: the same as frame(k). film[first:end:step]: a list of frames."""
        if isinstance(k, slice):
            return [self.frame(i) for i in range(*k.indices(len(self)))]
        return self.frame(k)

    def __iter__(self):
        """All frames, drawn one after the other."""
        return map(self.frame, range(len(self)))

    def __repr__(self):
        width, height = self.size
        return f"<corda.Film of {len(self)} frames, {width}x{height} at {self.fps:g} per second>"

    @property
    def size(self):
        """Width and height of a frame in pixels."""
        return self._film.size()

    @property
    def fps(self):
        """Frames per second; frame k is at exactly k / fps."""
        numerator, denominator = self._film.fps()
        return numerator / denominator

    def frame(self, k):
        """Frame `k`, -len(film) <= k < len(film), negative ones counted from the end, as numpy uint8 of shape (height, width,
        4). Raises IndexError for other numbers, TypeError for what is no integer."""
        return self._film.frame(_frame_index(k, self))

    def still(self, time, shutter=0.0):
        """The picture at a time in seconds, 0 .. duration, like frame(); `shutter`, 0 .. 1, blurs it like video.shutter.
        Raises Error (code 2) for other values."""
        return self._film.still(_float(time, "time"), _float(shutter, "shutter"))

    def save_still(self, path, times, *, width_mm=None, ppi=None, font_pt=None, force=False):
        """Draws the poses at one or more times in s, 0 .. duration, in one picture, earlier ones fainter, like `corda still`
        and `corda strobe`; the extension of `path`, .png, .svg or .pdf, chooses the format.

        width_mm: its width in print, 1 .. 10000; without it, the picture has the pixels of a frame. ppi: pixels per inch, 1 ..
        10000; 96, or 300 with width_mm, whose pixels it sets. font_pt: the size of letters in points, 1 .. 100; with width_mm,
        8 unless the scene has overlay.text_px. force: replace an existing file. Raises Error: code 2 for times, sizes or
        extension, 6 for a file that exists or cannot be written, 4 without OpenGL for .png.
        """
        times = [times] if isinstance(times, (_numbers.Real, _decimal.Decimal)) else times
        times = sorted({_float(time, "times") for time in times})
        sizes = []
        for name, value, most, unit in (("width_mm", width_mm, 10000.0, "mm"), ("ppi", ppi, 10000.0, "pixels per inch"),
                                        ("font_pt", font_pt, 100.0, "points")):
            if value is not None and not 1.0 <= _float(value, name) <= most:
                raise _error(f"{name}: takes 1 .. {most:.0f} {unit}, not {value!r}")
            sizes.append(value if value is None else float(value))
        self._film.save_still(_path(path), times, *sizes, bool(force))

    @property
    def positions(self):
        """Positions of all particles in all frames, in metres: float64 of shape (frames, particles, 2), ropes before nets."""
        return self._film.positions()

    @property
    def velocities(self):
        """Velocities of all particles in all frames, in m/s, 0 for pinned ones; shaped like positions. The first of
        velocities, tensions and energy to be read simulates the motion once more."""
        return self._film.velocities()

    @property
    def tensions(self):
        """Tensions of all links in all frames, in N, positive if they pull: float64 of shape (frames, links), body by body.
        NaN where the method does not know them."""
        return self._film.tensions()

    @property
    def energy(self):
        """Kinetic, potential and total energy of all bodies in all frames, in J: float64 of shape (frames, 3). The potential
        energy of the weight is 0 in frame 0."""
        return self._film.energy()

    def to_pixels(self, positions):
        """Positions in m, of shape (..., 2), in pixels of a frame, y down: a pixel's centre is at (column + 0.5, row + 0.5).
        If the camera moves, positions are those of all frames, of shape (frames, n, 2). Raises ValueError for another shape."""
        return self._film.to_pixels(positions)

    def mask(self, k):
        """The body at each pixel of frame `k` without motion blur, as numpy uint8 of shape (height, width): 0 for the ground,
        else 1 + the index of the body in front (ropes before nets). A pixel belongs to a body that covers at least half of it;
        supports, annotations and bars beyond the links are not in it. Raises IndexError as frame(), and Error (code 2) for more
        than 255 bodies."""
        return self._film.mask(_frame_index(k, self))

    @property
    def times(self):
        """Times of all frames, in seconds: float64 of shape (frames,)."""
        return self._film.times()

    @property
    def plan(self):
        """The plan of the film: a dictionary of methods (one per body), error_estimate_m, error_estimate_px, horizon_s and
        notes (a list of what to know about the choice); unknown values are None."""
        return self._film.plan()

    @property
    def camera(self):
        """center (x, y) and height in metres, and margin, a share of the shorter side."""
        return self._film.camera()

    def save(self, path, *, force=False, resume=False, on_progress=None):
        """Renders the video; the extension of `path` chooses the format. Returns the number of frames.

        force: replace an existing file. resume: of pictures ("frames/%06d.png"), draw those that are missing or damaged.
        on_progress: called with the number of finished frames and of all frames, at most every 50 ms and at the end; returning
        False stops, which raises Error (code 130): there is no video then, and pictures that are finished stay. It must not use
        this film, which raises Error (code 2).
        """
        return self._film.save(_path(path), bool(force), bool(resume), _answering(on_progress))

    def _repr_html_(self):
        """The film as a video in a notebook: MP4, or WebM if its background is transparent. Odd sides get one more pixel."""
        ending, fitted = self._film.for_browser(*self._gl)
        film = fitted or self._film
        with _tempfile.TemporaryDirectory() as folder:
            path = _os.path.join(folder, "film" + ending)
            film.save(path, False, False, None)
            if _os.path.getsize(path) > self.largest_embedded:
                return (f"<p>{_os.path.getsize(path)} bytes of video are more than a notebook should hold; use "
                        "film.save(...), or a smaller size, rate or duration</p>")
            with open(path, "rb") as file:
                data = _base64.b64encode(file.read()).decode("ascii")
        width, height = film.size()
        return (f'<video controls loop width="{width}" height="{height}" '
                f'src="data:video/{ending[1:]};base64,{data}"></video>')


class Difference(_NamedTuple):
    """The difference of two pictures. If not same_size, the numbers are meaningless."""

    same_size: bool
    equal: bool  #: all bytes are the same
    max: float  #: largest difference of a channel, 0 .. 255; a fraction only for files with 16 bits
    mean: float  #: mean difference over all channels and pixels, 0 .. 255
    share: float  #: share of the pixels that differ, 0 .. 1


def _is_path(picture):
    return isinstance(picture, (str, bytes, _os.PathLike))


def _pixels(picture):
    return read_png(picture) if _is_path(picture) else picture


def compare(a, b):
    """Compares two pictures, arrays or paths of PNG files, pixel by pixel, at 16 bits if a file has them; returns a
    Difference."""
    return Difference(*_corda.compare(*(_path(given) if _is_path(given) else given for given in (a, b))))


def read_png(path):
    """Reads any PNG as numpy uint8 of shape (height, width, 4)."""
    return _corda.read_png(_path(path))


def write_png(path, picture, *, force=False):
    """Writes an array of shape (height, width, 4), or (height, width, 3), as PNG. force: replace an existing file."""
    _corda.write_png(_path(path), picture, bool(force))


from .sweep import Sweep  # noqa: E402: it needs the names above

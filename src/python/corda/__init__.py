"""Corda: rope pendulums as exact frames and video, on a machine without a screen.

    import corda
    film = corda.Film("swing.toml", size=(640, 360))
    film.frame(30)            # numpy uint8 (height, width, 4), row 0 on top
    film.positions            # float64 (frames, particles, 2), metres, y up
    film.save("swing.mp4")

Coordinates are in metres, y up; times in seconds. What fails raises corda.Error, whose `code` is the exit code of
the program (`corda --help` lists them). Pictures are arrays of RGBA bytes, sRGB, with straight alpha.
"""

import base64 as _base64
import json as _json
import os as _os
import tempfile as _tempfile
from typing import NamedTuple as _NamedTuple

from ._corda import Error, __version__
from . import _corda

__all__ = ["Difference", "Error", "Film", "__version__", "compare", "read_png", "write_png"]

Error.__doc__ = "What Corda refuses or cannot do, in words. `code`: the exit code of the program (int)."

_SHORT = {"size": "video.size", "fps": "video.fps", "duration": "world.duration", "crf": "video.crf",
          "preset": "video.preset", "codec": "video.codec", "jobs": "video.jobs"}


def _toml(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(one) for one in value) + "]"
    if isinstance(value, str):
        return _json.dumps(value, ensure_ascii=False)
    return repr(value.item() if hasattr(value, "item") else value)


class Film:
    """A scene as pictures: planned and simulated once, then drawn in any order.

    path: a scene file; or `text`, the scene itself as TOML. Other keywords set keys of the scene as --set of the program does:
    size=(width, height), fps, duration, crf, preset, codec and jobs by these names, any other by its own name with two
    underscores for the dot (world__drag=0.1), or in `settings`, a dictionary ({"rope[0].mass": 2}). `backend` and
    `require_gpu`: how to reach OpenGL, as --backend and --require-gpu.

    Raises Error for a scene that cannot be read or simulated. Ctrl-C ends every call. Threads may share a film; it serves
    one at a time, without holding the interpreter's lock.
    """

    #: Largest video in bytes that a notebook embeds.
    largest_embedded = 32_000_000

    def __init__(self, path=None, *, text=None, settings=None, backend=None, require_gpu=False, **keys):
        if (path is None) == (text is None):
            raise TypeError("Film takes a path or text=..., and not both")
        all_settings = dict(settings or {})
        for name, value in keys.items():
            all_settings[_SHORT.get(name, name.replace("__", "."))] = value
        lines = [f"{key}={_toml(value)}" for key, value in all_settings.items()]
        source = _os.fspath(path) if path is not None else "text"
        self._film = _corda.Film(text or "", source, path is not None, lines,
                                 backend or _os.environ.get("CORDA_BACKEND") or "auto", require_gpu)

    def __len__(self):
        """Number of frames of the scene's video."""
        return self._film.frame_count()

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
        """Frame `k`, 0 <= k < len(film) or the one at the end, as numpy uint8 of shape (height, width, 4)."""
        return self._film.frame(k)

    def still(self, time, shutter=0.0):
        """The picture at a time in seconds, 0 .. duration, as frame(); `shutter`, 0 .. 1, blurs it as video.shutter does."""
        return self._film.still(time, shutter)

    @property
    def positions(self):
        """Of all particles in all frames, in metres: float64 of shape (frames, particles, 2), ropes before nets."""
        return self._film.positions()

    @property
    def times(self):
        """Of all frames, in seconds: float64 of shape (frames,)."""
        return self._film.times()

    @property
    def plan(self):
        """What moves the bodies and how far it holds: a dictionary of methods (one per body), error_bound_m, error_bound_px
        and horizon_s; None for what is not known."""
        return self._film.plan()

    @property
    def camera(self):
        """center (x, y) and height in metres, and margin, a share of the shorter side."""
        return self._film.camera()

    def save(self, path, *, force=False, resume=False, on_progress=None):
        """Renders the video; the ending of `path` chooses the format. Returns the number of frames.

        force: replace an existing file. resume: resume what an interrupted render of the same film has left beside
        `path`, to the bytes of a whole one; without such a part it begins anew. on_progress: called with the frames done and all; returning False stops, which
        raises Error (code 130) and keeps what is done beside `path`.
        """
        return self._film.save(_os.fspath(path), force, resume, on_progress)

    def _repr_html_(self):
        """The film as a video in a notebook."""
        with _tempfile.TemporaryDirectory() as folder:
            path = _os.path.join(folder, "film.mp4")
            self.save(path)
            if _os.path.getsize(path) > self.largest_embedded:
                return (f"<p>{_os.path.getsize(path)} bytes of video are more than a notebook should hold; use "
                        "film.save(...), or a smaller size, rate or duration</p>")
            with open(path, "rb") as file:
                data = _base64.b64encode(file.read()).decode("ascii")
        width, height = self.size
        return (f'<video controls loop width="{width}" height="{height}" '
                f'src="data:video/mp4;base64,{data}"></video>')


class Difference(_NamedTuple):
    """How far two pictures differ. If not same_size, the figures mean nothing."""

    same_size: bool
    equal: bool  #: all bytes are the same
    max: int  #: largest difference of a channel, 0 .. 255
    mean: float  #: mean difference over all channels and pixels
    share: float  #: share of the pixels that differ, 0 .. 1


def _pixels(picture):
    return read_png(picture) if isinstance(picture, (str, _os.PathLike)) else picture


def compare(a, b):
    """Compares two pictures, arrays or paths of PNG files, pixel by pixel; returns a Difference."""
    return Difference(*_corda.compare(_pixels(a), _pixels(b)))


def read_png(path):
    """Reads any PNG as numpy uint8 of shape (height, width, 4)."""
    return _corda.read_png(_os.fspath(path))


def write_png(path, picture, *, force=False):
    """Writes an array of shape (height, width, 4), or (height, width, 3), as PNG. force: replace an existing file."""
    _corda.write_png(_os.fspath(path), picture, force)

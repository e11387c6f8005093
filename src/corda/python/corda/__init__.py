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
import importlib as _importlib
import os as _os
import pathlib as _pathlib
import signal as _signal
import sys as _sys

if _sys.argv[:1] == ["-m"] and "corda" in _sys.orig_argv:
    # `python3 -m corda` is importing its package: Ctrl-C has no traceback to show of that.
    _signal.signal(_signal.SIGINT, lambda *_: _os._exit(130))


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
from ._film import Film
from ._pictures import Difference, compare, read_png, write_png
from .sweep import Sweep

__all__ = ["Difference", "Error", "Film", "Sweep", "__version__", "compare", "read_png", "write_png"]


for _each in (Film, Difference, compare, read_png, write_png):
    _each.__module__ = __name__  # as users import them


def __getattr__(name):
    """corda.plot without `import corda.plot`; it needs matplotlib, which all else does without."""
    if name == "plot":
        return _importlib.import_module(".plot", __name__)
    raise AttributeError(f"module 'corda' has no attribute {name!r}")


Error.__doc__ = "A failure of Corda, with a message. `code`: the exit code of the program (int)."

# Daemon threads may be drawing when the interpreter ends.
_atexit.register(_corda.begin_end)
_os.register_at_fork(after_in_child=_corda.forget_calls)

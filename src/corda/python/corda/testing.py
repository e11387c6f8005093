"""Golden pictures in pytest and other tests: one picture, or a test case per scene of a suite:

    import corda
    import corda.testing
    import pytest

    def test_swing():
        film = corda.Film("scenes/swing.toml")
        corda.testing.assert_matches_golden(film.frame(120), "swing_0120.png", film=film)

    @pytest.mark.parametrize("scene", corda.testing.golden_scenes("scenes"))
    def test_golden(scene):
        corda.testing.assert_golden(scene, "ref")
"""

import os as _os
import pathlib as _pathlib
import shlex as _shlex
import subprocess as _subprocess
import sys as _sys
import tomllib as _tomllib

from . import _corda
from ._arguments import make_error as _make_error, path_bytes as _path_bytes, to_float as _to_float
from ._pictures import pixels_of as _pixels_of

__all__ = ["assert_golden", "assert_matches_golden", "golden_scenes"]


def _rerun():
    """The command that runs the present test of pytest alone; "" elsewhere."""
    test = _os.environ.get("PYTEST_CURRENT_TEST", "").rpartition(" (")[0]
    return f"python3 -m pytest {_shlex.quote(test)}" if test else ""


def assert_matches_golden(picture, name, *, folder=None, max=None, mean=None, share=None, film=None):
    """Raises AssertionError unless a picture equals the golden one NAME.png, or one of its variants NAME.CAUSE.png. The message
    has the figures, the command that repeats the test, and the one that accepts the picture.

    picture: an array, or the path of a PNG file. folder: the folder of golden pictures; the default is CORDA_GOLDEN_DIR of
    the environment, or the current folder. max, mean, share: limits, as in `corda compare`; with limits, pictures
    within all of them match, too. A picture of one colour never matches. film: the Film of the picture; then an update records
    its scene in the golden picture, and a failure names the keys that have changed since.

    CORDA_UPDATE_GOLDENS=1 in the environment writes pictures that are missing or differ; CORDA_GOLDEN_ARTIFACTS names a
    folder for NAME.new.png and NAME.difference.png. Raises corda.Error for a picture that cannot be read or written.
    """
    __tracebackhide__ = True  # pytest shows the line of the test
    given = {"max": max, "mean": mean, "share": share}
    limits = tuple(None if value is None else _to_float(value, key) for key, value in given.items())
    matches, written, message = _corda.check_golden(_pixels_of(picture), _path_bytes(name, "name"),
                                                    _path_bytes(folder or "", "folder"), limits,
                                                    None if film is None else film._film, _rerun())
    if written:
        print(message, file=_sys.stderr)
    if not matches:
        raise AssertionError(message)


def golden_scenes(folder):
    """The scenes of a folder, and of folders in it, that have a table [golden]: sorted paths."""
    def is_golden(path):
        try:
            return "golden" in _tomllib.loads(path.read_text())
        except ValueError:
            return True  # the test of this scene says what is wrong

    return [str(path) for path in sorted(_pathlib.Path(folder).rglob("*.toml")) if is_golden(path)]


def assert_golden(scene, references, *options):
    """Raises AssertionError unless the pictures of a scene equal those in the folder `references`, by `corda golden` with these
    further options. The message is what the program says, with the commands that repeat and accept. A folder of
    scenes with the option "--stale" finds pictures that no scene asks for."""
    __tracebackhide__ = True
    command = ["corda", "golden", str(scene), "--dir", str(references), *options]
    try:
        ended = _subprocess.run(command, capture_output=True, text=True)
    except FileNotFoundError:
        raise _make_error("the program corda is in no folder of PATH; add its own (build/release of the source)", 6) from None
    if ended.returncode != 0:
        raise AssertionError(f"{ended.stdout}{ended.stderr}repeat: {_shlex.join(command)}\n"
                             f"accept: {_shlex.join([*command, '--update'])}, or --review to see them first")

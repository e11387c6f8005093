"""Golden pictures in pytest and other tests:

    import corda
    import corda.testing

    def test_swing():
        film = corda.Film("scenes/swing.toml")
        corda.testing.assert_matches_golden(film.frame(120), "swing_0120.png")
"""

import sys as _sys

from . import _corda, _limit, _path, _pixels

__all__ = ["assert_matches_golden"]


def assert_matches_golden(picture, name, *, folder=None, max=None, mean=None, share=None):
    """Raises AssertionError unless a picture equals the golden one NAME.png, or one of its variants NAME.CAUSE.png.

    picture: an array, or the path of a PNG file. folder: the folder of golden pictures; the default is CORDA_GOLDEN_DIR of
    the environment, or the current folder. max, mean, share: limits, as in `corda compare`; with limits, pictures
    within all of them match, too. A picture of one colour never matches.

    CORDA_UPDATE_GOLDENS=1 in the environment writes pictures that are missing or differ; CORDA_GOLDEN_ARTIFACTS names a
    folder for NAME.new.png and NAME.difference.png. Raises corda.Error for a picture that cannot be read or written.
    """
    __tracebackhide__ = True  # pytest shows the line of the test
    given = {"max": max, "mean": mean, "share": share}
    limits = tuple(_limit(value, key) for key, value in given.items())
    matches, written, message = _corda.check_golden(_pixels(picture), _path(name, "name"), _path(folder or "", "folder"), limits)
    if written:
        print(message, file=_sys.stderr)
    if not matches:
        raise AssertionError(message)

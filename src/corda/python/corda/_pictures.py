"""Pictures as arrays and PNG files, and their comparison."""

import os
from typing import NamedTuple

from . import _corda
from ._arguments import path_bytes


class Difference(NamedTuple):
    """The difference of two pictures. If not same_size, the numbers are meaningless."""

    same_size: bool
    equal: bool  #: all bytes are the same
    max: float  #: largest difference of a channel, 0 .. 255; a fraction only for files with 16 bits
    mean: float  #: mean difference over all channels and pixels, 0 .. 255
    share: float  #: share of the pixels that differ, 0 .. 1


def _is_path(picture):
    return isinstance(picture, (str, bytes, os.PathLike))


def pixels_of(picture):
    """The array of a picture, which may be the path of a PNG file."""
    return read_png(picture) if _is_path(picture) else picture


def compare(a, b):
    """Compares two pictures, arrays or paths of PNG files, pixel by pixel, at 16 bits if a file has them; returns a
    Difference."""
    return Difference(*_corda.compare(*(path_bytes(given) if _is_path(given) else given for given in (a, b))))


def read_png(path):
    """Reads any PNG as numpy uint8 of shape (height, width, 4)."""
    return _corda.read_png(path_bytes(path))


def write_png(path, picture, *, force=False):
    """Writes an array of shape (height, width, 4), or (height, width, 3), as PNG. force: replace an existing file."""
    _corda.write_png(path_bytes(path), picture, bool(force))

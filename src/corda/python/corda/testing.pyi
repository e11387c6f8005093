from os import PathLike

import numpy as np
from numpy.typing import NDArray

from . import Film

def assert_matches_golden(
    picture: NDArray[np.uint8] | str | PathLike[str],
    name: str | PathLike[str],
    *,
    folder: str | PathLike[str] | None = None,
    max: float | None = None,
    mean: float | None = None,
    share: float | None = None,
    film: Film | None = None,
) -> None: ...
def golden_scenes(folder: str | PathLike[str]) -> list[str]: ...
def assert_golden(scene: str | PathLike[str], references: str | PathLike[str], *options: str) -> None: ...

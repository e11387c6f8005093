from os import PathLike

import numpy as np
from numpy.typing import NDArray

def assert_matches_golden(
    picture: NDArray[np.uint8] | str | PathLike[str],
    name: str | PathLike[str],
    *,
    folder: str | PathLike[str] | None = None,
    max: float | None = None,
    mean: float | None = None,
    share: float | None = None,
) -> None: ...

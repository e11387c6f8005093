from collections.abc import Callable, Iterable, Iterator, Mapping
from fractions import Fraction
from os import PathLike
from typing import Any, NamedTuple, NotRequired, SupportsIndex, TypedDict, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

class Error(Exception):
    code: int

class Plan(TypedDict):
    methods: list[str]
    error_estimate_m: float | None
    error_estimate_px: float | None
    horizon_s: float | None
    notes: list[str]

class Camera(TypedDict):
    center: tuple[float, float]
    height: float
    margin: float

class Film:
    largest_embedded: int
    def __init__(
        self,
        path: str | bytes | PathLike[str] | None = None,
        *,
        text: str | None = None,
        positions: ArrayLike | None = None,
        times: ArrayLike | None = None,
        settings: Mapping[str, Any] | None = None,
        backend: str | None = None,
        require_gpu: bool = False,
        **keys: Any,
    ) -> None: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, k: SupportsIndex) -> NDArray[np.uint8]: ...
    @overload
    def __getitem__(self, k: slice) -> list[NDArray[np.uint8]]: ...
    def __iter__(self) -> Iterator[NDArray[np.uint8]]: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def fps(self) -> float: ...
    def frame(self, k: SupportsIndex) -> NDArray[np.uint8]: ...
    def still(self, time: float, shutter: float = 0.0) -> NDArray[np.uint8]: ...
    def save_still(
        self,
        path: str | bytes | PathLike[str],
        times: float | Iterable[float],
        *,
        width_mm: float | None = None,
        ppi: float | None = None,
        font_pt: float | None = None,
        force: bool = False,
    ) -> None: ...
    @property
    def positions(self) -> NDArray[np.float64]: ...
    @property
    def velocities(self) -> NDArray[np.float64]: ...
    @property
    def tensions(self) -> NDArray[np.float64]: ...
    @property
    def energy(self) -> NDArray[np.float64]: ...
    def to_pixels(self, positions: ArrayLike) -> NDArray[np.float64]: ...
    def mask(self, k: SupportsIndex) -> NDArray[np.uint8]: ...
    @property
    def times(self) -> NDArray[np.float64]: ...
    @property
    def plan(self) -> Plan: ...
    @property
    def camera(self) -> Camera: ...
    def save(
        self,
        path: str | bytes | PathLike[str],
        *,
        force: bool = False,
        resume: bool = False,
        on_progress: Callable[[int, int], bool | None] | None = None,
    ) -> int: ...

class Difference(NamedTuple):
    same_size: bool
    equal: bool
    max: float
    mean: float
    share: float

def compare(a: NDArray[np.uint8] | str | PathLike[str], b: NDArray[np.uint8] | str | PathLike[str]) -> Difference: ...
def read_png(path: str | bytes | PathLike[str]) -> NDArray[np.uint8]: ...
def write_png(path: str | bytes | PathLike[str], picture: NDArray[np.uint8], *, force: bool = False) -> None: ...

class SampleCamera(TypedDict):
    center: tuple[float, float]
    height: float

class Sample(TypedDict):
    key: str
    sample: int
    split: str | None
    parameters: dict[str, Any]
    fps: Fraction
    camera: SampleCamera
    px_per_m: float
    method: str
    error_estimate_m: float | None
    error_estimate_px: float | None
    horizon_s: float | None
    summary: dict[str, float | None]
    times: NDArray[np.float64]
    positions: NotRequired[NDArray[np.float64]]
    velocities: NotRequired[NDArray[np.float64]]
    tensions: NotRequired[NDArray[np.float64]]
    energy: NotRequired[NDArray[np.float64]]
    pixels: NotRequired[NDArray[np.float64]]
    mask: NotRequired[NDArray[np.uint8]]
    frames: NotRequired[NDArray[np.uint8]]

class Sweep:
    failures: dict[int, str]
    def __init__(
        self, path: str | bytes | PathLike[str], *, backend: str | None = None, require_gpu: bool = False
    ) -> None: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, index: int) -> Sample: ...
    @overload
    def __getitem__(self, index: slice) -> Sweep: ...
    def __iter__(self) -> Iterator[Sample]: ...
    def shard(self, index: int, count: int) -> Sweep: ...
    def split(self, name: str) -> Sweep: ...
    def parameters(self, index: int) -> dict[str, Any]: ...

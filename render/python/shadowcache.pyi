"""Bakes the visibility of a static set once, and renders it under any HDRI."""
from os import PathLike
from typing import Any, Callable, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Path = Union[str, "PathLike[str]"]
_Turn = Union[float, Sequence[float], Sequence[Sequence[float]], NDArray[Any]]
_Progress = Union[Callable[[str, int, int], object], None]

__version__: str

class Error(RuntimeError): ...

class Scene:
    @property
    def triangles(self) -> int: ...
    @property
    def bounds(self) -> NDArray[np.float64]: ...
    @property
    def report(self) -> str: ...
    @property
    def lamps(self) -> int: ...
    def camera(self, name: str, *, frame: int = ..., fps: float = ..., shutter: float = ...) -> Camera: ...
    @property
    def frame(self) -> int | None: ...
    def at_frame(self, frame: int, *, progress: _Progress = ..., threads: int = ...) -> Scene: ...
    def with_lamps(self, lamps: Lamps, *, progress: _Progress = ..., threads: int = ...) -> Scene: ...
    def intersect(
        self, origins: ArrayLike, directions: ArrayLike, *, progress: _Progress = ..., threads: int = ...
    ) -> dict[str, NDArray[Any]]: ...
    def occluded(
        self, origins: ArrayLike, directions: ArrayLike, *, reach: float = ..., progress: _Progress = ..., threads: int = ...
    ) -> Any: ...  # bool of single vectors, else NDArray[np.bool_]

class Lamps:
    @staticmethod
    def points(
        positions: ArrayLike, intensity: ArrayLike, *, radius: ArrayLike = ..., camera: bool = ..., name: str = ...
    ) -> Lamps: ...
    @staticmethod
    def spots(
        positions: ArrayLike,
        directions: ArrayLike,
        intensity: ArrayLike,
        *,
        inner: ArrayLike = ...,
        outer: ArrayLike = ...,
        radius: ArrayLike = ...,
        camera: bool = ...,
        name: str = ...,
    ) -> Lamps: ...
    @staticmethod
    def suns(
        directions: ArrayLike, irradiance: ArrayLike, *, angle: ArrayLike = ..., camera: bool = ..., name: str = ...
    ) -> Lamps: ...
    @staticmethod
    def areas(
        positions: ArrayLike,
        widths: ArrayLike,
        heights: ArrayLike,
        radiance: ArrayLike,
        *,
        shape: str = ...,
        spread: ArrayLike = ...,
        camera: bool = ...,
        name: str = ...,
    ) -> Lamps: ...
    @property
    def names(self) -> list[str]: ...
    def __add__(self, other: Lamps) -> Lamps: ...
    def __len__(self) -> int: ...

class Cache:
    @staticmethod
    def open(path: _Path, *, memory: str | None = ...) -> Cache: ...
    def save(self, path: _Path) -> int: ...
    @property
    def path(self) -> str | None: ...
    @property
    def spacing(self) -> float: ...
    @property
    def header(self) -> dict[str, Any]: ...
    @property
    def nbytes(self) -> int: ...
    def __len__(self) -> int: ...
    def items(self) -> NDArray[np.void]: ...
    def visibility(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        directions: ArrayLike,
        *,
        scene: Scene | None = ...,
        progress: _Progress = ...,
        threads: int = ...,
    ) -> Any: ...  # float of single vectors, else NDArray[np.float32]
    def irradiance(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        environment: Environment,
        *,
        bounces: int | str = ...,
        scene: Scene | None = ...,
        albedo: ArrayLike = ...,
        progress: _Progress = ...,
        threads: int = ...,
    ) -> NDArray[np.float32]: ...
    def operator(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        *,
        level: int = ...,
        bounces: int | str = ...,
        scene: Scene | None = ...,
        albedo: ArrayLike = ...,
        progress: _Progress = ...,
        threads: int = ...,
    ) -> NDArray[np.float32]: ...
    def sampler(self, environment: Environment) -> LightSampler: ...

class LightSampler:
    def sample(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        *,
        count: int = ...,
        seed: int = ...,
        control: bool = ...,
        progress: _Progress = ...,
        threads: int = ...,
    ) -> dict[str, NDArray[Any]]: ...
    def look_up(
        self,
        points: ArrayLike,
        normals: ArrayLike,
        directions: ArrayLike,
        *,
        control: bool = ...,
        progress: _Progress = ...,
        threads: int = ...,
    ) -> dict[str, NDArray[Any]]: ...

class Environment:
    @staticmethod
    def load(path: _Path, *, rotate: _Turn = ..., gain: ArrayLike = ..., progress: _Progress = ...) -> Environment: ...
    @staticmethod
    def from_array(texels: ArrayLike, *, rotate: _Turn = ..., progress: _Progress = ...) -> Environment: ...
    @staticmethod
    def constant(radiance: ArrayLike) -> Environment: ...
    def rotate(self, degrees: _Turn, *, progress: _Progress = ...) -> Environment: ...
    def tint(self, gain: ArrayLike, *, progress: _Progress = ...) -> Environment: ...
    def integrate(self, *, progress: _Progress = ..., threads: int = ...) -> NDArray[np.float64]: ...
    def sample(
        self, count: int, *, seed: int = ..., progress: _Progress = ..., threads: int = ...
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]: ...
    def look_up(
        self, directions: ArrayLike, *, progress: _Progress = ..., threads: int = ...
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]: ...
    def patches(self, level: int = ..., *, progress: _Progress = ..., threads: int = ...) -> NDArray[np.float64]: ...
    @property
    def rotation(self) -> float: ...
    @property
    def turn(self) -> NDArray[np.float64]: ...
    @property
    def notes(self) -> list[str]: ...

class Camera:
    def __init__(
        self,
        eye: ArrayLike,
        look_at: ArrayLike,
        *,
        fov: float | None = ...,
        lens_radius: float = ...,
        focus: float | None = ...,
        blades: int = ...,
        blade_rotation: float = ...,
        height: float | None = ...,
    ) -> None: ...
    @staticmethod
    def load(path: _Path, *, frame: int = ..., shutter: float = ...) -> Camera: ...
    @staticmethod
    def moving(opening: Camera, closing: Camera) -> Camera: ...
    @property
    def origin(self) -> NDArray[np.float64]: ...
    @property
    def forward(self) -> NDArray[np.float64]: ...
    @property
    def up(self) -> NDArray[np.float64]: ...
    @property
    def fov(self) -> float | None: ...
    @property
    def height(self) -> float | None: ...
    @property
    def lens_radius(self) -> float: ...

def patch_directions(level: int = ...) -> NDArray[np.float64]: ...
def set_threads(threads: int) -> None: ...
def load_set(
    set: Union[_Path, Sequence[_Path], ArrayLike],
    triangles: ArrayLike | None = ...,
    *,
    colors: ArrayLike | None = ...,
    normals: ArrayLike | None = ...,
    up: str | None = ...,
    scale: float | None = ...,
    frame: int | None = ...,
    fps: float | None = ...,
    smooth: float | None = ...,
    surfaces: str | None = ...,
    lamps: str | None = ...,
    lamp: Sequence[str] | None = ...,
    allow_external: bool | None = ...,
    progress: _Progress = ...,
    threads: int = ...,
) -> Scene: ...
def bake(
    scene: Scene,
    *,
    cameras: Sequence[Camera] | None = ...,
    size: tuple[int, int] | None = ...,
    margin: int | None = ...,
    spacing: float | None = ...,
    quality: str | None = ...,
    level: int | None = ...,
    rays: int | None = ...,
    uniform: bool | None = ...,
    transport: bool | None = ...,
    lamps: bool | None = ...,
    seed: int | None = ...,
    progress: _Progress = ...,
    threads: int = ...,
) -> Cache: ...
def render(
    scene: Scene,
    cache: Cache | None,
    environment: Environment,
    camera: Camera,
    *,
    frame: int = ...,
    progress: _Progress = ...,
    threads: int = ...,
    size: tuple[int, int] | None = ...,
    crop: tuple[int, int, int, int] | None = ...,
    spp: int | None = ...,
    bounces: int | str | None = ...,
    preview: bool | None = ...,
    target_error: float | None = ...,
    estimator: str | None = ...,
    camera_rays: int | None = ...,
    samples: int | None = ...,
    budget: str | None = ...,
    aovs: Sequence[str] | None = ...,
    light_groups: Sequence[str] | None = ...,
    albedo: ArrayLike | None = ...,
    material: dict[str, float] | None = ...,
    transparent: bool | None = ...,
    filter: str | None = ...,
    filter_width: float | None = ...,
    clamp_indirect: float | None = ...,
    pass_rays: int | None = ...,
    seed: int | None = ...,
    sequence: str | None = ...,
    stale_ok: bool | None = ...,
) -> dict[str, NDArray[np.float32]]: ...
def read_exr(path: _Path) -> dict[str, NDArray[np.float32]]: ...

# SPDX-License-Identifier: Apache-2.0
from os import PathLike
from types import TracebackType
from typing import Any, Callable, Iterable, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
INVALID_ID: int
ray_dtype: np.dtype[np.void]
hit_dtype: np.dtype[np.void]
light_dtype: np.dtype[np.void]
light_receiver_dtype: np.dtype[np.void]
user_hit_dtype: np.dtype[np.void]

class KiwamiError(Exception):
    result: int | None

class InvalidArgumentError(KiwamiError, ValueError): ...
class InvalidStateError(KiwamiError, RuntimeError): ...
class OutOfMemoryError(KiwamiError, MemoryError): ...
class UnsupportedIsaError(KiwamiError, RuntimeError): ...
class TooLargeError(KiwamiError, ValueError): ...
class CallbackError(KiwamiError, RuntimeError): ...
class CancelledError(KiwamiError, RuntimeError): ...
class ValidationError(KiwamiError, RuntimeError): ...
class CapacityError(KiwamiError, ValueError): ...
class IoError(KiwamiError, OSError): ...
class InvalidFileError(KiwamiError, ValueError): ...

def make_rays(
    origins: ArrayLike,
    directions: ArrayLike,
    tmin: ArrayLike = ...,
    tmax: ArrayLike = ...,
    time: ArrayLike = ...,
    mask: ArrayLike = ...,
    flags: ArrayLike = ...,
) -> NDArray[np.void]: ...
def default_device() -> Device: ...

class _Handle:
    def close(self) -> None: ...
    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None: ...

class Device(_Handle):
    def __init__(self, isa: str = ..., threads: int = ..., validate: bool = ...) -> None: ...
    def __enter__(self) -> Device: ...
    @property
    def isa(self) -> str: ...
    @property
    def available_isas(self) -> list[str]: ...
    @property
    def threads(self) -> int: ...
    @property
    def bvh_width(self) -> int: ...

class Hits:
    records: NDArray[np.void]
    def __init__(self, records: NDArray[np.void]) -> None: ...
    @property
    def t(self) -> NDArray[np.float32]: ...
    @property
    def u(self) -> NDArray[np.float32]: ...
    @property
    def v(self) -> NDArray[np.float32]: ...
    @property
    def normal(self) -> NDArray[np.float32]: ...
    @property
    def primitive_id(self) -> NDArray[np.uint32]: ...
    @property
    def geometry_id(self) -> NDArray[np.uint32]: ...
    @property
    def instance_id(self) -> NDArray[np.uint32]: ...
    @property
    def is_hit(self) -> NDArray[np.bool_]: ...
    def points(self, origins: ArrayLike, directions: ArrayLike) -> NDArray[np.float64]: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: Any) -> Hits: ...

_Cull = Literal["back", "front"] | None
_Filter = Callable[[Any], int]

class Scene(_Handle):
    def __init__(
        self,
        vertices: ArrayLike | None = ...,
        faces: ArrayLike | None = ...,
        *,
        device: Device | None = ...,
        mask: int = ...,
        quality: Literal["fast", "balanced", "best"] | None = ...,
    ) -> None: ...
    def __enter__(self) -> Scene: ...
    @property
    def device(self) -> Device: ...
    @property
    def info(self) -> dict[str, Any]: ...
    @property
    def bounds(self) -> NDArray[np.float32]: ...
    def add(
        self,
        vertices: ArrayLike,
        faces: ArrayLike | None = ...,
        *,
        mask: int = ...,
        share: bool = ...,
    ) -> int: ...
    def add_spheres(self, points: ArrayLike, *, mask: int = ...) -> int: ...
    def add_discs(self, points: ArrayLike, normals: ArrayLike, *, mask: int = ...) -> int: ...
    def add_curves(
        self, points: ArrayLike, segments: ArrayLike | None = ..., *, mask: int = ...
    ) -> int: ...
    def add_moving_mesh(
        self,
        vertices: ArrayLike,
        faces: ArrayLike | None = ...,
        *,
        times: tuple[float, float] = ...,
        mask: int = ...,
    ) -> int: ...
    def add_instances(
        self,
        scenes: Scene | Iterable[Scene],
        transforms: ArrayLike,
        *,
        scene_indices: ArrayLike | None = ...,
        masks: ArrayLike | None = ...,
        mask: int = ...,
    ) -> int: ...
    def add_user_geometry(
        self,
        count: int,
        bounds: Callable[[int, int], ArrayLike],
        intersect: Callable[[np.void, NDArray[np.uint32]], Any],
        *,
        mask: int = ...,
    ) -> int: ...
    def remove(self, geometry_id: int) -> None: ...
    def enable(self, geometry_id: int, is_enabled: bool = ...) -> None: ...
    def move(self, geometry_id: int, vertices: ArrayLike) -> None: ...
    def set_parameter(self, parameter: int, value: float) -> None: ...
    def commit(self, progress: Callable[[float], Any] | None = ...) -> None: ...
    def refit(self, progress: Callable[[float], Any] | None = ...) -> None: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def to_bytes(self) -> bytes: ...
    @classmethod
    def load(
        cls,
        path: str | PathLike[str],
        *,
        map: bool = ...,
        trusted: bool = ...,
        device: Device | None = ...,
    ) -> Scene: ...
    @classmethod
    def from_bytes(cls, data: bytes, *, device: Device | None = ...) -> Scene: ...
    def closest(
        self,
        rays: ArrayLike,
        directions: ArrayLike | None = ...,
        *,
        tmin: ArrayLike = ...,
        tmax: ArrayLike = ...,
        time: ArrayLike = ...,
        mask: ArrayLike = ...,
        cull: _Cull = ...,
        filter: _Filter | None = ...,
        out: Hits | NDArray[np.void] | None = ...,
    ) -> Hits: ...
    def any(
        self,
        rays: ArrayLike,
        directions: ArrayLike | None = ...,
        *,
        tmin: ArrayLike = ...,
        tmax: ArrayLike = ...,
        time: ArrayLike = ...,
        mask: ArrayLike = ...,
        cull: _Cull = ...,
        filter: _Filter | None = ...,
        out: NDArray[np.bool_] | None = ...,
    ) -> NDArray[np.bool_]: ...
    def multi_hit(
        self,
        rays: ArrayLike,
        directions: ArrayLike | None = ...,
        *,
        max_hits: int = ...,
        tmin: ArrayLike = ...,
        tmax: ArrayLike = ...,
        time: ArrayLike = ...,
        mask: ArrayLike = ...,
        cull: _Cull = ...,
        filter: _Filter | None = ...,
    ) -> tuple[Hits, NDArray[np.int64]]: ...
    def count(
        self,
        rays: ArrayLike,
        directions: ArrayLike | None = ...,
        *,
        tmin: ArrayLike = ...,
        tmax: ArrayLike = ...,
        time: ArrayLike = ...,
        mask: ArrayLike = ...,
        cull: _Cull = ...,
        filter: _Filter | None = ...,
    ) -> NDArray[np.uint32]: ...

class LightTree(_Handle):
    def __init__(
        self,
        device: Device | None = ...,
        *,
        width: int = ...,
        builder: Literal["saoh", "octants"] = ...,
        distant_probability: float = ...,
    ) -> None: ...
    def __enter__(self) -> LightTree: ...
    def add_lights(self, lights: NDArray[np.void]) -> int: ...
    def add_mesh(
        self,
        vertices: ArrayLike,
        faces: ArrayLike | None = ...,
        *,
        radiance: ArrayLike = ...,
        two_sided: bool = ...,
        link_mask: int = ...,
    ) -> int: ...
    def set_powers(self, first: int, powers: ArrayLike) -> None: ...
    def commit(self) -> None: ...
    def refit(self) -> None: ...
    @property
    def info(self) -> dict[str, Any]: ...
    def sample(
        self,
        points: ArrayLike,
        normals: ArrayLike | None = ...,
        random: ArrayLike | None = ...,
        *,
        link_mask: ArrayLike = ...,
        segments: ArrayLike | None = ...,
    ) -> NDArray[np.void]: ...
    def pdf(
        self,
        points: ArrayLike,
        normals: ArrayLike | None,
        light_id: ArrayLike,
        instance_id: ArrayLike = ...,
        *,
        link_mask: ArrayLike = ...,
        segments: ArrayLike | None = ...,
    ) -> NDArray[np.float32]: ...

class RayMeshIntersector:
    mesh: Any
    scene: Scene
    def __init__(self, geometry: Any, device: Device | None = ...) -> None: ...
    def intersects_first(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike
    ) -> NDArray[np.int64]: ...
    def intersects_any(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike
    ) -> NDArray[np.bool_]: ...
    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = ...,
        max_hits: int = ...,
        return_locations: bool = ...,
    ) -> tuple[NDArray[Any], ...]: ...
    def intersects_location(
        self, ray_origins: ArrayLike, ray_directions: ArrayLike, multiple_hits: bool = ...
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]: ...
    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]: ...

class RaycastingScene:
    INVALID_ID: int
    scene: Scene
    def __init__(self, nthreads: int = ..., device: Device | None = ...) -> None: ...
    def add_triangles(
        self, vertex_positions: Any, triangle_indices: ArrayLike | None = ...
    ) -> int: ...
    def cast_rays(self, rays: ArrayLike) -> dict[str, NDArray[Any]]: ...
    def test_occlusions(
        self, rays: ArrayLike, tnear: float = ..., tfar: float = ...
    ) -> NDArray[np.bool_]: ...
    def count_intersections(self, rays: ArrayLike) -> NDArray[np.int32]: ...
    def list_intersections(self, rays: ArrayLike) -> dict[str, NDArray[Any]]: ...

def __getattr__(name: str) -> int: ...

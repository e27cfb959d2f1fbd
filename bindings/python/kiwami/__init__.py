# SPDX-License-Identifier: Apache-2.0
"""Kiwami: ray tracing on CPUs: exact, the same to the bit everywhere, in batches.

    import kiwami
    scene = kiwami.Scene(vertices, faces)
    hits = scene.closest(origins, directions)
    print(hits.t, hits.primitive_id)
"""

from . import _native
from ._library import library as _loaded
from .arrays import INVALID_ID, hit_dtype, make_rays, ray_dtype
from .device import Device, default_device
from .errors import (
    CallbackError,
    CancelledError,
    CapacityError,
    InvalidArgumentError,
    InvalidFileError,
    InvalidStateError,
    IoError,
    KiwamiError,
    OutOfMemoryError,
    TooLargeError,
    UnsupportedIsaError,
    ValidationError,
)
from .hits import Hits
from .lights import LightTree, light_dtype, light_receiver_dtype
from .raycasting import RaycastingScene
from .scene import Scene
from .trimesh_ray import RayMeshIntersector
from .user_geometry import user_hit_dtype

_number = _loaded.kiwami_version()
__version__ = f"{_number // 1000000}.{_number // 1000 % 1000}.{_number % 1000}"

# The constants of the C interface that scenes are given: kiwami.PARAMETER_BVH_WIDTH and so on.
globals().update(
    {
        name.removeprefix("KIWAMI_"): value
        for name, value in vars(_native).items()
        if name.startswith(
            (
                "KIWAMI_PARAMETER_",
                "KIWAMI_BUILDER_",
                "KIWAMI_OPTIMIZER_",
                "KIWAMI_CONTRACTION_",
                "KIWAMI_QUALITY_",
                "KIWAMI_LIGHT_",
                "KIWAMI_FILTER_",
            )
        )
    }
)

__all__ = [
    "CallbackError",
    "CancelledError",
    "CapacityError",
    "Device",
    "Hits",
    "INVALID_ID",
    "InvalidArgumentError",
    "InvalidFileError",
    "InvalidStateError",
    "IoError",
    "KiwamiError",
    "OutOfMemoryError",
    "LightTree",
    "RayMeshIntersector",
    "RaycastingScene",
    "Scene",
    "TooLargeError",
    "UnsupportedIsaError",
    "ValidationError",
    "default_device",
    "hit_dtype",
    "light_dtype",
    "light_receiver_dtype",
    "make_rays",
    "ray_dtype",
    "user_hit_dtype",
]

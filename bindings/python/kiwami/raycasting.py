# SPDX-License-Identifier: Apache-2.0
"""A scene in the shape of Open3D's RaycastingScene, with NumPy arrays in place of tensors."""

import numpy as np

from .arrays import INVALID_ID
from .device import Device
from .scene import Scene


def _array(values):
    """Tensors of Open3D (and of others) know how to become arrays."""
    return values.numpy() if hasattr(values, "numpy") else np.asarray(values)


def _rays(rays):
    rays = _array(rays)
    if rays.ndim == 0 or rays.shape[-1] != 6:
        raise ValueError(f"rays has shape {rays.shape}, expected (..., 6)")
    return rays


class RaycastingScene:
    """Open3D's calls over a kiwami Scene (``scene``).

    Rays are (..., 6): origin and direction. nthreads is the number of threads of the whole scene,
    so it is given here, and not to each call.
    """

    INVALID_ID = INVALID_ID

    def __init__(self, nthreads=0, device=None):
        self.scene = Scene(device=device or (Device(threads=nthreads) if nthreads else None))

    def add_triangles(self, vertex_positions, triangle_indices=None):
        """Adds a mesh, given by arrays or as an object with vertex and triangle tables, and
        returns its number."""
        if triangle_indices is None:
            mesh = vertex_positions
            vertex_positions = mesh.vertex["positions"]
            triangle_indices = mesh.triangle["indices"]
        return self.scene.add(_array(vertex_positions), _array(triangle_indices))

    def cast_rays(self, rays):
        """The closest hits: a dict of t_hit, geometry_ids, primitive_ids, primitive_uvs and
        primitive_normals (of length 1; 0 for misses)."""
        hits = self.scene.closest(_rays(rays))
        return {
            "t_hit": hits.t,
            "geometry_ids": hits.geometry_id,
            "primitive_ids": hits.primitive_id,
            "primitive_uvs": _uvs(hits),
            "primitive_normals": _unit(hits.normal),
        }

    def test_occlusions(self, rays, tnear=0.0, tfar=np.inf):
        """Whether each ray meets anything between tnear and tfar."""
        return self.scene.any(_rays(rays), tmin=tnear, tmax=tfar)

    def count_intersections(self, rays):
        """How many triangles each ray meets."""
        return self.scene.count(_rays(rays)).astype(np.int32)

    def list_intersections(self, rays):
        """All hits of all rays: a dict of ray_splits (where the hits of each ray begin, and the
        end), ray_ids, t_hit, geometry_ids, primitive_ids and primitive_uvs."""
        rays = _rays(rays)
        hits, offsets = self.scene.multi_hit(rays)
        counts = np.diff(offsets)
        return {
            "ray_splits": offsets.astype(np.int64),
            "ray_ids": np.repeat(np.arange(len(counts)), counts),
            "t_hit": hits.t,
            "geometry_ids": hits.geometry_id,
            "primitive_ids": hits.primitive_id,
            "primitive_uvs": _uvs(hits),
        }


def _uvs(hits):
    """u and v beside each other in the records: a view."""
    records = hits.records
    return np.ndarray(
        (*records.shape, 2), np.float32, records, offset=4, strides=(*records.strides, 4)
    )


def _unit(normals):
    """Normals of length 1. Lengths in double: the square of a float may be out of its range."""
    normals = np.ascontiguousarray(normals)
    x, y, z = (normals[..., axis].astype(np.float64) for axis in range(3))
    length = np.sqrt(x * x + y * y + z * z)
    inverse = np.divide(1.0, length, out=np.zeros_like(length), where=length > 0)
    return (normals * inverse[..., None]).astype(np.float32)

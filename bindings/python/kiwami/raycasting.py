# SPDX-License-Identifier: Apache-2.0
"""A scene in the shape of Open3D's RaycastingScene, with NumPy arrays in place of tensors."""

import numpy as np

from .arrays import INVALID_ID
from .device import Device
from .rays import RayBatch
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
        self.scene._prepare()
        batch = RayBatch(_rays(rays))
        count, shape = batch.count, batch.shape
        t = np.empty(count, np.float32)
        geometry_ids, primitive_ids = np.empty((2, count), np.uint32)
        uvs, normals = np.empty((count, 2), np.float32), np.empty((count, 3), np.float32)
        columns = {"t": t, "geometry_id": geometry_ids, "primitive_id": primitive_ids}
        columns.update(zip(("u", "v"), uvs.T))
        columns.update(zip(("normal_x", "normal_y", "normal_z"), normals.T))
        batch.closest_columns(self.scene, columns)
        _normalize(normals)
        return {
            "t_hit": t.reshape(shape),
            "geometry_ids": geometry_ids.reshape(shape),
            "primitive_ids": primitive_ids.reshape(shape),
            "primitive_uvs": uvs.reshape(*shape, 2),
            "primitive_normals": normals.reshape(*shape, 3),
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


#: Rows that are normalised at once: what they need stays in the processor's caches.
_BLOCK = 8192


def _normalize(rows):
    """Gives each row of three floats the length 1, where it lies; 0 stays 0. Lengths in double: the
    square of a float may be out of its range, but no square of a double that was a float is."""
    for first in range(0, len(rows), _BLOCK):
        block = rows[first : first + _BLOCK]
        exact = block.astype(np.float64)
        x, y, z = exact.T
        scale = x * x
        scale += y * y
        scale += z * z
        np.maximum(scale, 1e-300, out=scale)  # below the square of any float but 0
        np.sqrt(scale, out=scale)
        np.divide(1.0, scale, out=scale)
        exact *= scale[:, None]
        block[:] = exact

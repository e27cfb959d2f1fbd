# SPDX-License-Identifier: Apache-2.0
"""The ray interface that meshes of trimesh have: the same calls, over a kiwami Scene."""

import numpy as np

from .scene import Scene


class RayMeshIntersector:
    """Rays against one mesh, with the calls of trimesh's ``mesh.ray``.

    geometry  a trimesh.Trimesh, or any object with ``vertices`` (V, 3) and ``faces`` (F, 3)

    Put it in place of a mesh's own with ``mesh.ray = kiwami.RayMeshIntersector(mesh)``.
    """

    def __init__(self, geometry, device=None):
        self.mesh = geometry
        self.scene = Scene(geometry.vertices, geometry.faces, device=device)

    def intersects_first(self, ray_origins, ray_directions):
        """The number of the first triangle that each ray meets, or -1; (n,) int."""
        return _numbers(self.scene.closest(ray_origins, ray_directions))

    def intersects_any(self, ray_origins, ray_directions):
        """Whether each ray meets the mesh; (n,) bool."""
        return self.scene.any(ray_origins, ray_directions)

    def intersects_id(
        self,
        ray_origins,
        ray_directions,
        multiple_hits=True,
        max_hits=20,
        return_locations=False,
    ):
        """Triangles that rays meet, each with its ray: index_tri (h,), index_ray (h,), and
        locations (h, 3) if they are asked for. Hits of a ray follow each other by distance.

        multiple_hits  False: only the first of each ray
        max_hits       at most so many of each ray
        """
        index_tri, index_ray, t = self._hits(
            ray_origins, ray_directions, max_hits if multiple_hits else 1
        )
        if not return_locations:
            return index_tri, index_ray
        return index_tri, index_ray, _locations(ray_origins, ray_directions, index_ray, t)

    def intersects_location(self, ray_origins, ray_directions, multiple_hits=True):
        """Where rays meet the mesh: locations (h, 3), index_ray (h,), index_tri (h,)."""
        index_tri, index_ray, t = self._hits(
            ray_origins, ray_directions, 0 if multiple_hits else 1
        )
        return _locations(ray_origins, ray_directions, index_ray, t), index_ray, index_tri

    def contains_points(self, points):
        """Which points are inside, for a closed mesh: a ray from there leaves it an odd number of
        times. No ray passes between triangles or counts an edge twice, so one ray decides."""
        points = np.asarray(points, np.float64).reshape(-1, 3)
        inside = np.all((self.scene.bounds[0] <= points) & (points <= self.scene.bounds[1]), axis=1)
        if inside.any():
            counts = self.scene.count(points[inside], np.array([0.4395, 0.1824, 0.8795]))
            inside[inside] = counts % 2 == 1
        return inside

    def _hits(self, origins, directions, max_hits):
        if max_hits == 1:
            hits = self.scene.closest(origins, directions)
            index_ray = np.flatnonzero(hits.is_hit)
            hits = hits[index_ray]
        else:
            hits, offsets = self.scene.multi_hit(origins, directions, max_hits=max_hits)
            index_ray = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
        return _numbers(hits), index_ray, hits.t


def _numbers(hits):
    """Triangles as signed numbers, -1 for misses."""
    return np.where(hits.is_hit, hits.primitive_id, -1).astype(np.int64)


def _locations(origins, directions, index_ray, t):
    origins = np.asarray(origins, np.float64)[index_ray]
    return origins + t.astype(np.float64)[:, None] * np.asarray(directions, np.float64)[index_ray]

# SPDX-License-Identifier: Apache-2.0
"""What scenes are made of."""

import ctypes

import numpy as np

from . import _native
from ._library import Handle, check, descriptor, library
from .arrays import as_dense_rows, as_index_column, as_indices, as_positions
from .errors import InvalidArgumentError, KiwamiError
from .user_geometry import register


class _Geometry(Handle):
    _release = staticmethod(library.kiwami_geometry_release)


class Geometries:
    """The part of a Scene that holds its geometries."""

    def _hold_nothing(self):
        self._geometries = {}
        self._vertex_counts = {}
        self._shared = set()
        self._shown = {}
        self._buffers = []

    def add(self, vertices, faces=None, *, mask=0xFFFFFFFF, share=False):
        """Adds a mesh and returns its number, which hits report as geometry_id.

        share  the library reads float32 and uint32 arrays where they lie instead of copying them;
               they may not change while the scene lives.
        """
        desc = descriptor(
            _native.kiwami_triangle_mesh_desc, library.kiwami_triangle_mesh_desc_init
        )
        positions = as_positions(vertices, "vertices")
        desc.vertices, desc.vertex_count = positions.ctypes.data, positions.shape[0]
        desc.vertex_stride = positions.strides[0] if positions.shape[0] > 1 else 12
        indices = None
        if faces is None:
            desc.triangle_count = positions.shape[0] // 3
        else:
            indices = as_indices(faces, positions.shape[0], "faces")
            desc.indices, desc.triangle_count = indices.ctypes.data, indices.shape[0]
            desc.index_stride = indices.strides[0] if indices.shape[0] > 1 else 12
        desc.mask = mask
        desc.flags = _native.KIWAMI_MESH_SHARE_BUFFERS if share else 0
        number = self._attach(
            library.kiwami_triangle_mesh_create, desc, (positions, indices) if share else None
        )
        self._vertex_counts[number] = len(positions)
        self._shared.discard(number)
        if share:
            self._shared.add(number)
        return number

    def _attach(self, create, desc, buffers=None):
        """Makes a geometry, attaches it, and keeps the arrays that it shares."""
        address = ctypes.c_void_p()
        check(create(self._device, ctypes.byref(desc), ctypes.byref(address)), self._device)
        geometry = _Geometry(address.value)
        number = ctypes.c_uint32()
        try:
            check(library.kiwami_scene_attach(self, geometry, ctypes.byref(number)), self._device)
        except KiwamiError:
            geometry.close()
            raise
        self._geometries[number.value] = geometry
        # What was committed may still read the arrays of a geometry that was removed.
        if buffers is not None:
            self._buffers.append(buffers)
        self._changed = True
        return number.value

    def add_spheres(self, points, *, mask=0xFFFFFFFF):
        """Adds spheres: (N, 4) of x, y, z and radius. Returns their number as of add()."""
        desc = descriptor(_native.kiwami_spheres_desc, library.kiwami_spheres_desc_init)
        rows = as_dense_rows(points, 4, "points")
        desc.points, desc.sphere_count, desc.mask = rows.ctypes.data, len(rows), mask
        return self._attach(library.kiwami_spheres_create, desc)

    def add_discs(self, points, normals, *, mask=0xFFFFFFFF):
        """Adds flat discs: (N, 4) of x, y, z and radius, and (N, 3) normals."""
        desc = descriptor(_native.kiwami_discs_desc, library.kiwami_discs_desc_init)
        rows = as_dense_rows(points, 4, "points")
        directions = as_dense_rows(normals, 3, "normals")
        if len(rows) != len(directions):
            raise ValueError(f"normals has {len(directions)} rows, expected {len(rows)}")
        desc.points, desc.normals = rows.ctypes.data, directions.ctypes.data
        desc.disc_count, desc.mask = len(rows), mask
        return self._attach(library.kiwami_discs_create, desc)

    def add_curves(self, points, segments=None, *, mask=0xFFFFFFFF):
        """Adds round curve segments: (N, 4) of x, y, z and radius; segment i joins the points
        segments[i] and segments[i] + 1, or, without segments, i and i + 1."""
        desc = descriptor(_native.kiwami_curves_desc, library.kiwami_curves_desc_init)
        rows = as_dense_rows(points, 4, "points")
        desc.points, desc.point_count, desc.mask = rows.ctypes.data, len(rows), mask
        if segments is None:
            desc.segment_count = max(len(rows) - 1, 0)
        else:
            indices = as_index_column(segments, len(rows) - 1, "segments")
            desc.indices, desc.segment_count = indices.ctypes.data, len(indices)
        return self._attach(library.kiwami_curves_create, desc)

    def add_moving_mesh(self, vertices, faces=None, *, times=(0.0, 1.0), mask=0xFFFFFFFF):
        """Adds a mesh whose vertices move: (S, V, 3), at S times in equal steps from times[0] to
        times[1]. Rays meet it as it is at their time. Returns its number as add() does."""
        array = np.asarray(vertices)
        if array.ndim != 3:
            raise ValueError(f"vertices has shape {array.shape}, expected (steps, vertices, 3)")
        steps, count = array.shape[:2]
        desc = descriptor(_native.kiwami_moving_mesh_desc, library.kiwami_moving_mesh_desc_init)
        rows = as_dense_rows(array.reshape(steps * count, -1), 3, "vertices")
        desc.vertices, desc.vertex_count, desc.step_count = rows.ctypes.data, count, steps
        if faces is None:
            desc.triangle_count = count // 3
        else:
            indices = as_indices(faces, count, "faces")
            desc.indices, desc.triangle_count = indices.ctypes.data, indices.shape[0]
            desc.index_stride = indices.strides[0] if indices.shape[0] > 1 else 12
        desc.time_begin, desc.time_end = times
        desc.mask = mask
        return self._attach(library.kiwami_moving_mesh_create, desc)

    def add_instances(
        self, scenes, transforms, *, scene_indices=None, masks=None, mask=0xFFFFFFFF
    ):
        """Adds instances: scenes (one, or a sequence of them) at other places. Hits name them as
        instance_id, numbered through all instances of the scene.

        transforms     (N, 3, 4) or (N, 4, 4): rows, from the scene's space to this one's
        scene_indices  (N,) which of the scenes each shows; None: the first
        masks          (N,) a ray enters an instance only if (its mask & mask & this) is not 0

        A commit() shows what the scenes hold by then; no other thread may commit them meanwhile.
        """
        shown = [scenes] if isinstance(scenes, Geometries) else list(scenes)
        addresses = (ctypes.c_void_p * max(len(shown), 1))(
            *(scene._as_parameter_.value for scene in shown)
        )
        matrices = np.asarray(transforms)
        if matrices.ndim == 2:
            matrices = matrices[None]
        if matrices.ndim != 3 or matrices.shape[1:] not in ((3, 4), (4, 4)):
            raise ValueError(
                f"transforms has shape {matrices.shape}, expected (N, 3, 4) or (N, 4, 4)"
            )
        count = len(matrices)
        rows = as_dense_rows(matrices[:, :3].reshape(count, 12), 12, "transforms")
        desc = descriptor(_native.kiwami_instances_desc, library.kiwami_instances_desc_init)
        desc.scenes, desc.scene_count = ctypes.addressof(addresses), len(shown)
        desc.transforms, desc.count, desc.mask = rows.ctypes.data, count, mask
        if scene_indices is not None:
            indices = _one_each(scene_indices, len(shown), count, "scene_indices")
            desc.scene_indices = indices.ctypes.data
        if masks is not None:
            own = _one_each(masks, 2**32, count, "masks")
            desc.masks = own.ctypes.data
        # What the scenes share with the caller must live as long as this one.
        number = self._attach(library.kiwami_instances_create, desc, tuple(shown))
        self._shown[number] = shown
        return number

    def _prepare_shown(self):
        for scenes in self._shown.values():
            for scene in scenes:
                if scene._address is not None:
                    scene._prepare()

    def add_user_geometry(self, count, bounds, intersect, *, mask=0xFFFFFFFF):
        """Adds primitives of one's own kind. Returns their number as add() does.

        bounds     called with (first, count) during commits; gives the boxes of the primitives
                   first .. first + count: (count, 6), the lower x, y, z and the upper ones
        intersect  called with (ray, primitive_ids) during queries: a record of ray_dtype, in the
                   geometry's space, and the numbers of primitives that it may meet. Gives the hits:
                   records of user_hit_dtype, or tuples (t, u, v, normal, primitive_id), at most
                   four a primitive; None: none. Those that ray["tmin"] and ray["tmax"] leave out
                   are ignored. The hits of a primitive must depend on the ray and the primitive
                   alone, and lie in its box

        Both are called from any thread, and kept until no scene uses the geometry any more. Where
        one raises, the call that runs it raises CallbackError from it.
        """
        desc = descriptor(
            _native.kiwami_user_geometry_desc, library.kiwami_user_geometry_desc_init
        )
        desc.count, desc.mask = count, mask
        with register(bounds, intersect, desc):
            return self._attach(library.kiwami_user_geometry_create, desc)

    def _geometry(self, geometry_id):
        if geometry_id not in self._geometries:
            raise InvalidArgumentError(
                f"geometry_id is {geometry_id}, expected the number of a mesh that add() gave"
            )
        return self._geometries[geometry_id]

    def remove(self, geometry_id):
        """Removes a geometry; its number becomes free."""
        check(library.kiwami_scene_detach(self, geometry_id), self._device)
        geometry = self._geometries.pop(geometry_id, None)
        if geometry is not None:
            geometry.close()
        self._shown.pop(geometry_id, None)
        self._changed = True

    def enable(self, geometry_id, is_enabled=True):
        """Takes a geometry in again, or leaves it out, under its number."""
        check(library.kiwami_scene_enable(self, geometry_id, int(is_enabled)), self._device)
        self._changed = True

    def move(self, geometry_id, vertices):
        """Gives a mesh other vertices, as many as before; refit() or commit() shows them."""
        positions = as_positions(vertices, "vertices")
        geometry = self._geometry(geometry_id)
        expected = self._vertex_counts.get(geometry_id)
        if expected is not None and len(positions) != expected:
            raise ValueError(f"vertices has {len(positions)} rows, expected {expected}")
        stride = positions.strides[0] if len(positions) > 1 else 12
        check(
            library.kiwami_triangle_mesh_update_vertices(
                geometry, positions.ctypes.data, 0, stride
            ),
            self._device,
        )
        if geometry_id in self._shared:
            self._buffers.append((positions,))
        self._changed = True

    def close(self):
        """Lets go of the scene and its geometries at once. Closing twice is allowed."""
        super().close()
        for geometry in getattr(self, "_geometries", {}).values():
            geometry.close()


def _one_each(values, limit, count, name):
    column = as_index_column(values, limit, name)
    if len(column) != count:
        raise ValueError(f"{name} has length {len(column)}, expected {count}")
    return column

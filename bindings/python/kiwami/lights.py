# SPDX-License-Identifier: Apache-2.0
"""Many lights: which of them a point should ask."""

import ctypes

import numpy as np

from . import _native
from ._library import Handle, check, descriptor, library
from .arrays import as_dense_rows, as_indices, as_positions
from .device import default_device

#: A light, as kiwami_light of light.h: fields type, flags, points, direction, radius, ...
light_dtype = np.dtype(_native.kiwami_light)
#: Who asks for a light, as kiwami_light_receiver of light.h: position, normal, segment, flags, ...
light_receiver_dtype = np.dtype(_native.kiwami_light_receiver)
#: What sample() gives: light_id, instance_id, user_id, probability, random.
choice_dtype = np.dtype(_native.kiwami_light_choice)
_name_dtype = np.dtype(_native.kiwami_light_name)

BUILDERS = {
    "saoh": _native.KIWAMI_LIGHT_BUILDER_SAOH,
    "octants": _native.KIWAMI_LIGHT_BUILDER_OCTANTS,
}


class LightTree(Handle):
    """A set of lights, among which points choose in proportion to what may reach them.

        lights = kiwami.LightTree()
        lights.add_mesh(vertices, faces, radiance=3.0)
        choices = lights.sample(points, normals)
        choices["light_id"], choices["probability"]

    Changes take effect with commit(), or with the next call of sample() or pdf().
    """

    _release = staticmethod(library.kiwami_light_tree_release)

    def __init__(self, device=None, *, width=0, builder="saoh", distant_probability=0.0):
        if builder not in BUILDERS:
            raise ValueError(f"builder is {builder!r}, expected one of {', '.join(BUILDERS)}")
        self._device = device or default_device()
        self._changed = True
        desc = descriptor(_native.kiwami_light_tree_desc, library.kiwami_light_tree_desc_init)
        desc.width, desc.builder = width, BUILDERS[builder]
        desc.distant_probability = distant_probability
        address = ctypes.c_void_p()
        self._check(
            library.kiwami_light_tree_create(
                self._device, ctypes.byref(desc), ctypes.byref(address)
            )
        )
        super().__init__(address.value)

    def _check(self, result):
        check(result, self._device)

    def add_lights(self, lights):
        """Adds records of light_dtype; returns the number of the first."""
        records = np.ascontiguousarray(lights, light_dtype).reshape(-1)
        first = ctypes.c_uint32()
        self._check(
            library.kiwami_light_tree_add_lights(
                self, records.ctypes.data, 0, len(records), ctypes.byref(first)
            )
        )
        self._changed = True
        return first.value

    def add_mesh(self, vertices, faces=None, *, radiance=1.0, two_sided=False, link_mask=2**64 - 1):
        """Makes a light of each triangle; returns the number of the first. radiance is one number,
        or one a triangle."""
        desc = descriptor(_native.kiwami_light_mesh_desc, library.kiwami_light_mesh_desc_init)
        positions = as_positions(vertices, "vertices")
        desc.vertices, desc.vertex_count = positions.ctypes.data, len(positions)
        desc.vertex_stride = positions.strides[0] if len(positions) > 1 else 12
        desc.triangle_count = len(positions) // 3
        if faces is not None:
            indices = as_indices(faces, len(positions), "faces")
            desc.indices, desc.triangle_count = indices.ctypes.data, len(indices)
            desc.index_stride = indices.strides[0] if len(indices) > 1 else 12
        radiances = np.asarray(radiance, np.float32, order="C")
        if radiances.ndim:
            if radiances.shape != (desc.triangle_count,):
                raise ValueError(
                    f"radiance has shape {radiances.shape}, expected ({desc.triangle_count},)"
                )
            desc.radiances = radiances.ctypes.data
        else:
            desc.radiance = float(radiances)
        desc.link_mask = link_mask
        desc.flags = _native.KIWAMI_LIGHT_TWO_SIDED if two_sided else 0
        first = ctypes.c_uint32()
        self._check(
            library.kiwami_light_tree_add_mesh(self, ctypes.byref(desc), ctypes.byref(first))
        )
        self._changed = True
        return first.value

    def set_powers(self, first, powers):
        """Gives the lights from first on other powers; refit() or commit() makes them count."""
        values = np.ascontiguousarray(powers, np.float32).reshape(-1)
        self._check(
            library.kiwami_light_tree_set_powers(self, first, values.ctypes.data, 0, len(values))
        )
        self._changed = True

    def commit(self):
        """Builds the tree over all lights."""
        self._check(library.kiwami_light_tree_commit(self))
        self._changed = False

    def refit(self):
        """As commit(), but keeps the shape of the tree."""
        self._check(library.kiwami_light_tree_refit(self))
        self._changed = False

    def _prepare(self):
        self._require_open()
        if self._changed:
            self.commit()

    @property
    def info(self):
        """The numbers of the committed tree, as a dict; see kiwami_light_tree_info."""
        self._prepare()
        kind = _native.kiwami_light_tree_info
        info = kind(struct_size=ctypes.sizeof(kind))
        self._check(library.kiwami_light_tree_get_info(self, ctypes.byref(info)))
        return {name: getattr(info, name) for name, _ in kind._fields_ if name != "struct_size"}

    def _receivers(self, points, normals, random, link_mask, segments):
        if isinstance(points, np.ndarray) and points.dtype == light_receiver_dtype:
            if normals is not None or segments is not None:
                raise TypeError("normals or segments are given beside receivers that have theirs")
            return np.ascontiguousarray(points).reshape(-1)
        positions = as_dense_rows(points, 3, "points")
        receivers = np.zeros(len(positions), light_receiver_dtype)
        receivers["position"] = positions
        if normals is not None:
            receivers["normal"] = as_dense_rows(np.broadcast_to(normals, positions.shape), 3,
                                                "normals")
        if segments is not None:
            receivers["segment"] = as_dense_rows(np.broadcast_to(segments, positions.shape), 3,
                                                 "segments")
        if random is None:
            random = np.random.default_rng().random(len(receivers))
        receivers["link_mask"], receivers["random"] = link_mask, random
        return receivers

    def sample(self, points, normals=None, random=None, *, link_mask=2**64 - 1, segments=None):
        """Lets each point choose a light: records of light_id, instance_id, user_id, probability
        and random (a new number from 0 to 1, for a point on the light).

        points    (N, 3), or records of light_receiver_dtype, which have all of the others
        normals   (N, 3), or None: points in a volume
        random    (N,) from 0 to 1, 1 excluded; None: drawn here
        segments  (N, 3) from each point to the other end of a segment, or None
        """
        self._prepare()
        receivers = self._receivers(points, normals, random, link_mask, segments)
        choices = np.empty(len(receivers), choice_dtype)
        self._check(
            library.kiwami_light_sample(
                self, receivers.ctypes.data, 0, choices.ctypes.data, 0, len(receivers), None
            )
        )
        return choices

    def pdf(self, points, normals, light_id, instance_id=_native.KIWAMI_INVALID_ID, *,
            link_mask=2**64 - 1, segments=None):
        """The probability with which sample() lets each point choose a light: (N,) float32."""
        self._prepare()
        receivers = self._receivers(points, normals, 0.0, link_mask, segments)
        names = np.empty(len(receivers), _name_dtype)
        names["light_id"], names["instance_id"] = light_id, instance_id
        probabilities = np.empty(len(receivers), np.float32)
        self._check(
            library.kiwami_light_pdf(
                self,
                receivers.ctypes.data,
                0,
                names.ctypes.data,
                0,
                probabilities.ctypes.data,
                0,
                len(receivers),
                None,
            )
        )
        return probabilities

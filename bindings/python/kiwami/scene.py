# SPDX-License-Identifier: Apache-2.0
"""Scenes: meshes under one acceleration structure, and rays against them."""

import ctypes
import os

import numpy as np

from . import _native
from ._library import Handle, check, descriptor, library
from .callbacks import PlainQuery
from .device import default_device
from .geometries import Geometries
from .hits import Hits, hits_for
from .rays import RayBatch

QUALITIES = {
    "fast": _native.KIWAMI_QUALITY_FAST,
    "balanced": _native.KIWAMI_QUALITY_BALANCED,
    "best": _native.KIWAMI_QUALITY_BEST,
}


class Scene(Geometries, Handle):
    """Geometries under one acceleration structure.

        scene = kiwami.Scene(vertices, faces)
        hits = scene.closest(origins, directions)

    vertices  (V, 3) of numbers; float32 whose rows lie together is read where it lies
    faces     (F, 3) of any integers; None: vertices 3i, 3i + 1, 3i + 2 make triangle i
    device    a Device; None: the default one
    quality   "fast", "balanced" or "best"

    Changes take effect with commit(), or with the next query. Queries may come from any number of
    threads at once once the scene is committed; the GIL is released while the library works.
    """

    _release = staticmethod(library.kiwami_scene_release)

    def __init__(self, vertices=None, faces=None, *, device=None, mask=0xFFFFFFFF, quality=None):
        self._device = device or default_device()
        self._changed = True
        self._hold_nothing()
        address = ctypes.c_void_p()
        check(library.kiwami_scene_create(self._device, ctypes.byref(address)), self._device)
        super().__init__(address.value)
        if quality is not None:
            if quality not in QUALITIES:
                raise ValueError(f"quality is {quality!r}, expected one of {', '.join(QUALITIES)}")
            self.set_parameter(_native.KIWAMI_PARAMETER_QUALITY, QUALITIES[quality])
        if vertices is not None:
            self.add(vertices, faces, mask=mask)
            self.commit()
        elif faces is not None:
            raise TypeError("faces are given without vertices")

    @property
    def device(self):
        return self._device

    def refit(self, progress=None):
        """As commit(), but keeps the tree where only vertices moved: quicker to make, and, the
        further they moved, slower to trace. The answers are the same."""
        self._build(library.kiwami_scene_refit, progress)

    def set_parameter(self, parameter, value):
        """Sets one of kiwami.PARAMETER_*; see the C header scene.h."""
        check(library.kiwami_scene_set_parameter(self, parameter, value), self._device)
        self._changed = True

    def commit(self, progress=None):
        """Builds the acceleration structure of what the scene holds now.

        progress  called with a fraction from 0 to 1, which never falls, from any thread; where it
                  returns something true, or raises, the commit ends: CancelledError, or what was
                  raised. The structure that was committed before stays in use.
        """
        self._build(library.kiwami_scene_commit, progress)

    def _build(self, build, progress):
        self._prepare_shown()
        raised = []

        def report(_, fraction):
            try:
                return 1 if progress(fraction) else 0
            except BaseException as error:  # an exception may not cross C
                raised.append(error)
                return 1

        callback = _native.kiwami_progress(report) if progress else None
        if callback:
            check(library.kiwami_scene_set_progress(self, callback, None), self._device)
        with PlainQuery(self._device) as query:
            try:
                result = build(self)
            finally:
                if callback:
                    library.kiwami_scene_set_progress(self, None, None)
            if raised:
                raise raised[0]
            query.check(result)
        self._changed = False

    def save(self, path):
        """Saves the committed structure to a file; what is there stays whole until all is written.

        Every float and number is kept: the loaded scene gives the same answers, to the bit.
        """
        self._save(path=os.fspath(path))

    def to_bytes(self):
        """The same as bytes; from_bytes() makes a scene of them. Scenes are pickled so."""
        data = np.empty(self._save(), np.uint8)
        self._save(data=data)
        return data.tobytes()

    def _save(self, path=None, data=None):
        self._prepare()
        desc = descriptor(_native.kiwami_save_desc, library.kiwami_save_desc_init)
        name = None if path is None else ctypes.create_string_buffer(os.fsencode(path))
        desc.path = ctypes.addressof(name) if name else None
        if data is not None:
            desc.data, desc.capacity = data.ctypes.data, data.size
        size = ctypes.c_uint64()
        check(library.kiwami_scene_save(self, ctypes.byref(desc), ctypes.byref(size)), self._device)
        return size.value

    @classmethod
    def load(cls, path, *, map=False, trusted=False, device=None):
        """Loads a scene that save() wrote.

        map      use the file where it lies, without a copy; it may not change meanwhile
        trusted  check nothing: only for files that nobody else could change
        """
        name = ctypes.create_string_buffer(os.fsencode(path))
        flags = _native.KIWAMI_LOAD_MAP if map else 0
        flags |= _native.KIWAMI_LOAD_TRUSTED if trusted else 0
        return cls._load(device, flags=flags, path=ctypes.addressof(name))

    @classmethod
    def from_bytes(cls, data, *, device=None):
        """A scene from what to_bytes() gave; damaged bytes are an error."""
        array = np.frombuffer(data, np.uint8)
        return cls._load(device, data=array.ctypes.data, size=array.size)

    @classmethod
    def _load(cls, device, **fields):
        scene = cls.__new__(cls)
        scene._device = device or default_device()
        scene._changed = False
        scene._hold_nothing()
        desc = descriptor(_native.kiwami_load_desc, library.kiwami_load_desc_init)
        for name, value in fields.items():
            setattr(desc, name, value)
        address = ctypes.c_void_p()
        check(
            library.kiwami_scene_load(scene._device, ctypes.byref(desc), ctypes.byref(address)),
            scene._device,
        )
        Handle.__init__(scene, address.value)
        return scene

    def __reduce__(self):
        return type(self).from_bytes, (self.to_bytes(),)

    def _prepare(self):
        self._require_open()
        if self._changed:
            self.commit()

    @property
    def info(self):
        """What the committed structure is made of, as a dict; see kiwami_scene_info."""
        self._prepare()
        info = _native.kiwami_scene_info(struct_size=ctypes.sizeof(_native.kiwami_scene_info))
        check(library.kiwami_scene_get_info(self, ctypes.byref(info)), self._device)
        values = {name: getattr(info, name) for name, _ in info._fields_ if name != "struct_size"}
        for name in ("bounds_min", "bounds_max"):
            values[name] = np.array(values[name], np.float32)
        return values

    @property
    def bounds(self):
        """The least and the greatest corner, (2, 3)."""
        info = self.info
        return np.stack([info["bounds_min"], info["bounds_max"]])

    def closest(
        self,
        rays,
        directions=None,
        *,
        tmin=0.0,
        tmax=np.inf,
        time=0.0,
        mask=0xFFFFFFFF,
        cull=None,
        filter=None,
        out=None,
    ):
        """The closest hit of each ray, as Hits.

        rays        (..., 3) origins with directions (..., 3); or (..., 6), both in one; or records
                    of ray_dtype (make_rays), which are the quickest. float32 is read where it
                    lies, whatever its strides; other numbers are converted.
        tmin, tmax, time, mask
                    one number, or one each
        cull        "back" or "front": triangles seen from there are not met
        filter      called with a candidate (its ray's number ``ray``, ``hit``, ``depth`` and
                    ``instance_path``), from any thread; says whether the hit counts: true or
                    false, or FILTER_ACCEPT_AND_STOP, which ends the search along the ray. Where it
                    raises, the call raises CallbackError from it
        out         where the hits go: an array of hit_dtype, or earlier Hits
        """
        self._prepare()
        batch = RayBatch(rays, directions, tmin, tmax, time, mask, cull, filter)
        records = hits_for(batch.shape, out)
        batch.trace(self, "closest_hit", records.reshape(-1))
        return Hits(records)

    def any(
        self,
        rays,
        directions=None,
        *,
        tmin=0.0,
        tmax=np.inf,
        time=0.0,
        mask=0xFFFFFFFF,
        cull=None,
        filter=None,
        out=None,
    ):
        """Whether each ray hits anything: an array of bool. Arguments as of closest()."""
        self._prepare()
        batch = RayBatch(rays, directions, tmin, tmax, time, mask, cull, filter)
        occluded = _flags_for(batch.shape, out)
        batch.trace(self, "any_hit", occluded.reshape(-1))
        return occluded

    def multi_hit(
        self,
        rays,
        directions=None,
        *,
        max_hits=0,
        tmin=0.0,
        tmax=np.inf,
        time=0.0,
        mask=0xFFFFFFFF,
        cull=None,
        filter=None,
    ):
        """The nearest max_hits hits of each ray, or all of them (0), by rising distance.

        Returns hits and offsets: the hits of ray i are hits[offsets[i]:offsets[i + 1]]. Each
        triangle that a ray crosses is one hit. Other arguments as of closest().
        """
        self._prepare()
        batch = RayBatch(rays, directions, tmin, tmax, time, mask, cull, filter)
        records, offsets = batch.trace_several(self, max_hits)
        return Hits(records), offsets

    def count(
        self,
        rays,
        directions=None,
        *,
        tmin=0.0,
        tmax=np.inf,
        time=0.0,
        mask=0xFFFFFFFF,
        cull=None,
        filter=None,
    ):
        """How many hits each ray has; uint32. Arguments as of closest()."""
        self._prepare()
        batch = RayBatch(rays, directions, tmin, tmax, time, mask, cull, filter)
        counts = np.empty(batch.shape, np.uint32)
        batch.trace(self, "count_hits", counts.reshape(-1))
        return counts

    def __repr__(self):
        if self._address is None:
            return "<kiwami.Scene, closed>"
        if self._changed:
            return "<kiwami.Scene, not committed>"
        return f"<kiwami.Scene of {self.info['triangle_count']} triangles>"


def _flags_for(shape, out):
    if out is None:
        return np.empty(shape, bool)
    if out.dtype != bool or out.shape != shape or not out.flags.c_contiguous:
        raise ValueError(
            f"out has dtype {out.dtype} and shape {out.shape}, expected contiguous bool of {shape}"
        )
    return out

# SPDX-License-Identifier: Apache-2.0
"""Batches of rays on their way through the library."""

import ctypes

import numpy as np

from . import _native
from ._library import descriptor, library
from .arrays import as_column, as_float_rows, hit_dtype, ray_dtype, set_input
from .callbacks import FilteredQuery, PlainQuery

_CULL = {
    None: 0,
    "back": _native.KIWAMI_RAY_CULL_BACK_FACES,
    "front": _native.KIWAMI_RAY_CULL_FRONT_FACES,
}


class RayBatch:
    """Rays on their way to the library: records of ray_dtype, or fields that lie apart.

    Holds every array that the library is about to read.
    """

    def __init__(
        self,
        rays,
        directions=None,
        tmin=0.0,
        tmax=np.inf,
        time=0.0,
        mask=0xFFFFFFFF,
        cull=None,
        filter=None,
    ):
        if cull not in _CULL:
            raise ValueError(f"cull is {cull!r}, expected None, 'back' or 'front'")
        self._filter = filter
        if isinstance(rays, np.ndarray) and rays.dtype == ray_dtype:
            self._take_records(rays, directions)
        else:
            self._take_fields(rays, directions, tmin, tmax, time, mask, _CULL[cull])

    def _take_records(self, rays, directions):
        if directions is not None:
            raise TypeError("directions are given beside rays that have theirs, expected None")
        self.shape, self.count = rays.shape, rays.size
        self.records = rays.reshape(-1)
        if not self.records.flags.aligned or self.records.strides[0] < ray_dtype.itemsize:
            self.records = np.ascontiguousarray(self.records)

    def _take_fields(self, rays, directions, tmin, tmax, time, mask, flags):
        self.records = None
        if directions is None:
            rows, shape = as_float_rows(rays, 6, "rays")
            origins, directions = rows[:, :3], rows[:, 3:]
        else:
            origins, first = as_float_rows(rays, 3, "origins")
            directions, second = as_float_rows(directions, 3, "directions")
            shape = np.broadcast_shapes(first, second)
            count = int(np.prod(shape, dtype=np.int64))
            if origins.shape[0] != count:
                origins, _ = as_float_rows(
                    np.broadcast_to(origins.reshape(*first, 3), (*shape, 3)), 3, "origins"
                )
            if directions.shape[0] != count:
                directions, _ = as_float_rows(
                    np.broadcast_to(directions.reshape(*second, 3), (*shape, 3)), 3, "directions"
                )
        self.shape, self.count = shape, origins.shape[0]
        columns = {
            "tmin": as_column(tmin, self.count, shape, np.float32, "tmin"),
            "tmax": as_column(tmax, self.count, shape, np.float32, "tmax"),
            "time": as_column(time, self.count, shape, np.float32, "time"),
            "mask": as_column(mask, self.count, shape, np.uint32, "mask"),
            "flags": as_column(flags, self.count, shape, np.uint32, "flags"),
        }
        for axis, name in enumerate("xyz"):
            columns[f"origin_{name}"] = origins[:, axis]
            columns[f"direction_{name}"] = directions[:, axis]
        self.columns = columns
        self.fields = descriptor(_native.kiwami_ray_fields, library.kiwami_ray_fields_init)
        for name, column in columns.items():
            set_input(getattr(self.fields, name), column)

    def trace(self, scene, call, answers):
        """One answer a ray, into a contiguous array; call is the C function's name in the middle."""
        with _query(scene, self._filter) as query:
            if self.records is not None:
                result = getattr(library, f"kiwami_{call}")(
                    scene,
                    self.records.ctypes.data,
                    self.records.strides[0],
                    answers.ctypes.data,
                    answers.itemsize,
                    self.count,
                    query.address,
                )
            else:
                result = getattr(library, f"kiwami_{call}_fields")(
                    scene,
                    ctypes.byref(self.fields),
                    ctypes.byref(_fields_of(answers)),
                    self.count,
                    query.address,
                )
            query.check(result)

    def closest_columns(self, scene, columns):
        """The closest hits, each field of kiwami_hit that is named into a column of its own: arrays
        (count,) of any stride. For rays whose fields lie apart."""
        hits = descriptor(_native.kiwami_hit_fields, library.kiwami_hit_fields_init)
        for name, column in columns.items():
            field = getattr(hits, name)
            field.data, field.stride = column.ctypes.data, column.strides[0]
        with _query(scene, self._filter) as query:
            query.check(
                library.kiwami_closest_hit_fields(
                    scene,
                    ctypes.byref(self.fields),
                    ctypes.byref(hits),
                    self.count,
                    query.address,
                )
            )

    def trace_several(self, scene, max_hits):
        """Several hits a ray: the hits and where those of each ray begin."""
        offsets = np.empty(self.count + 1, np.int64)
        records = np.empty(self.count, hit_dtype)
        while True:
            with _query(scene, self._filter) as query:
                result = self._trace_several(scene, max_hits, records, offsets, query.address)
                if result != _native.KIWAMI_ERROR_CAPACITY:
                    query.check(result)
                    return records[: offsets[-1]], offsets
            records = np.empty(offsets[-1], hit_dtype)

    def _trace_several(self, scene, max_hits, records, offsets, query):
        where = offsets.ctypes.data
        if self.records is not None:
            return library.kiwami_multi_hit(
                scene,
                self.records.ctypes.data,
                self.records.strides[0],
                self.count,
                max_hits,
                records.ctypes.data,
                len(records),
                where,
                query,
            )
        return library.kiwami_multi_hit_fields(
            scene,
            ctypes.byref(self.fields),
            self.count,
            max_hits,
            ctypes.byref(_hit_fields(records)),
            len(records),
            where,
            query,
        )


def _query(scene, function):
    """What one call of the library is told beyond the rays."""
    return FilteredQuery(scene.device, function) if function else PlainQuery(scene.device)


def _fields_of(answers):
    if answers.dtype == hit_dtype:
        return _hit_fields(answers)
    return _native.kiwami_output_field(answers.ctypes.data, answers.itemsize)


def _hit_fields(records):
    """The fields of an array of hits, as the library fills them."""
    fields = descriptor(_native.kiwami_hit_fields, library.kiwami_hit_fields_init)
    names = [name for name, _ in _native.kiwami_hit._fields_]
    for name in names:
        field = getattr(fields, name)
        field.data = records.ctypes.data + getattr(_native.kiwami_hit, name).offset
        field.stride = records.strides[0] if records.ndim and records.size else 36
    return fields

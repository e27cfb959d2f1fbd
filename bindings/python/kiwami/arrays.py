# SPDX-License-Identifier: Apache-2.0
"""NumPy arrays at the border: what can be passed where it lies is; the rest is converted."""

import numpy as np

from . import _native

#: A ray, as the library reads it: arrays of these are traced where they lie.
ray_dtype = np.dtype(
    {
        "names": ["origin", "tmin", "direction", "tmax", "time", "mask", "flags", "id"],
        "formats": ["3f4", "f4", "3f4", "f4", "f4", "u4", "u4", "u4"],
        "offsets": [0, 12, 16, 28, 32, 36, 40, 44],
        "itemsize": 48,
    }
)
#: A hit, as the library writes it.
hit_dtype = np.dtype(
    {
        "names": ["t", "u", "v", "normal", "primitive_id", "geometry_id", "instance_id"],
        "formats": ["f4", "f4", "f4", "3f4", "u4", "u4", "u4"],
        "offsets": [0, 4, 8, 12, 24, 28, 32],
        "itemsize": 36,
    }
)
INVALID_ID = _native.KIWAMI_INVALID_ID


def make_rays(origins, directions, tmin=0.0, tmax=np.inf, time=0.0, mask=0xFFFFFFFF, flags=0):
    """An array of ray_dtype: the form that is traced quickest, since nothing is gathered."""
    origins, directions = np.asarray(origins), np.asarray(directions)
    shape = np.broadcast_shapes(origins.shape[:-1], directions.shape[:-1])
    rays = np.zeros(shape, ray_dtype)
    rays["origin"], rays["direction"] = origins, directions
    rays["tmin"], rays["tmax"], rays["time"] = tmin, tmax, time
    rays["mask"], rays["flags"] = mask, flags
    return rays


def _rows(array, width, name):
    """A (count, width) view or copy of an array (..., width), and its leading shape."""
    if array.ndim == 0 or array.shape[-1] != width:
        raise ValueError(f"{name} has shape {array.shape}, expected (..., {width})")
    return array.reshape(-1, width), array.shape[:-1]


def as_float_rows(values, width, name):
    """float32 (count, width) with strides that the library takes; a copy only where it must be."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has dtype {array.dtype}, expected numbers")
    rows, shape = _rows(array.astype(np.float32, copy=False), width, name)
    if min(rows.strides) < 0:
        rows = np.ascontiguousarray(rows)
    return rows, shape


def as_positions(values, name):
    """float32 (count, 3) whose three numbers lie together, as meshes want them."""
    array = np.asarray(values)
    rows, _ = as_float_rows(array.reshape(-1, 3) if array.size == 0 else array, 3, name)
    if rows.size and (rows.strides[1] != 4 or rows.strides[0] < 12):
        rows = np.ascontiguousarray(rows)
    return rows


def as_dense_rows(values, width, name):
    """float32 (count, width) without gaps."""
    array = np.asarray(values)
    rows, _ = as_float_rows(array.reshape(-1, width) if array.size == 0 else array, width, name)
    return np.ascontiguousarray(rows)


def as_index_column(values, limit, name):
    """uint32 (count,) without gaps, each checked to be in 0 .. limit - 1."""
    array = np.asarray(values)
    if array.ndim != 1 or (array.size and array.dtype.kind not in "iu"):
        raise TypeError(f"{name} is {array.dtype} of shape {array.shape}, expected (N,) integers")
    if array.size and (array.min() < 0 or array.max() >= limit):
        bad = array.min() if array.min() < 0 else array.max()
        raise ValueError(f"{name} holds {bad}, expected numbers from 0 to {limit - 1}")
    return np.ascontiguousarray(array, np.uint32)


def as_indices(values, limit, name):
    """uint32 (count, 3) of any integers, each checked to be in 0 .. limit - 1."""
    array = np.asarray(values)
    if array.size == 0:
        array = array.reshape(-1, 3).astype(np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name} has dtype {array.dtype}, expected integers")
    rows, _ = _rows(array, 3, name)
    if rows.size and (rows.min() < 0 or rows.max() >= limit):
        bad = rows.min() if rows.min() < 0 else rows.max()
        raise ValueError(f"{name} holds {bad}, expected numbers from 0 to {limit - 1}")
    rows = rows.astype(np.uint32, copy=False)
    if rows.size and (rows.strides[1] != 4 or rows.strides[0] < 12):
        rows = np.ascontiguousarray(rows)
    return rows


def as_column(value, count, shape, dtype, name):
    """One number for all rays, or one each; a (count,) array, possibly of stride 0."""
    array = np.asarray(value)
    if np.dtype(dtype).kind == "u" and array.dtype.kind not in "iu":
        raise TypeError(f"{name} has dtype {array.dtype}, expected integers")
    if array.ndim:
        array = np.broadcast_to(array, shape).reshape(count)
        array = array.astype(dtype, copy=False)
        return array if not array.size or array.strides[0] >= 0 else array.copy()
    return np.broadcast_to(array.astype(dtype), (count,))


def set_input(field, array, offset=0):
    """Points a kiwami_input_field at a column."""
    field.data = array.ctypes.data + offset
    field.stride = array.strides[0] if array.shape[0] > 1 else 0

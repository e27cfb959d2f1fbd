# SPDX-License-Identifier: Apache-2.0
"""Primitives of the caller's own kind: functions that the library calls while it has them."""

import contextlib
import ctypes
import itertools
import threading

import numpy as np

from . import _native
from .arrays import ray_dtype

#: A hit of a user geometry, as its intersect function gives it.
user_hit_dtype = np.dtype(
    {
        "names": ["t", "u", "v", "normal", "primitive_id"],
        "formats": ["f4", "f4", "f4", "3f4", "u4"],
        "offsets": [0, 4, 8, 12, 24],
        "itemsize": 32,
    }
)

_keys = itertools.count(1)
_registered: dict = {}


class RaisedInCalls:
    """What user geometries raise. The library does not say for which call they run, so it is kept
    for all calls that do: one that fails has the first since it began."""

    def __init__(self):
        self._lock = threading.Lock()
        self._running = 0
        self._clock = self._last_begin = 0
        self._kept = []

    def keep(self, error):
        with self._lock:
            if not self._kept or self._kept[-1][0] < self._last_begin:
                self._clock += 1
                self._kept.append((self._clock, error))

    def begin(self):
        """A call begins; None where no user geometry lives."""
        if not _registered:
            return None
        with self._lock:
            self._running += 1
            self._clock += 1
            self._last_begin = self._clock
            return self._clock

    def since(self, begin):
        """What was raised since a call began: a list."""
        if begin is None:
            return []
        with self._lock:
            return [error for when, error in self._kept if when > begin]

    def end(self, begin):
        if begin is None:
            return
        with self._lock:
            self._running -= 1
            if self._running == 0:
                self._kept = []


raised_in_calls = RaisedInCalls()


def _guarded(function):
    """No exception may cross C."""

    def call(*arguments):
        try:
            function(*arguments)
            return 0
        except BaseException as error:
            raised_in_calls.keep(error)
            return -1

    return call


def _array_at(address, count, dtype):
    """What lies in C's memory, for the length of a call."""
    size = count * np.dtype(dtype).itemsize
    return np.frombuffer((ctypes.c_char * size).from_address(address), dtype)


@_guarded
def _bounds(key, first, count, address):
    boxes = np.asarray(_registered[key][0](first, count), np.float32)
    if boxes.shape != (count, 6):
        raise ValueError(f"bounds gave shape {boxes.shape}, expected ({count}, 6)")
    _array_at(address, count * 6, np.float32)[:] = boxes.reshape(-1)


@_guarded
def _intersect(key, address):
    asked = _native.kiwami_user_intersection.from_address(address)
    # Copies: what the function is given may be kept by it, and ends in C with this call.
    ray = _array_at(asked.ray, 1, ray_dtype).copy()[0]
    primitive_ids = _array_at(asked.primitive_ids, asked.primitive_count, np.uint32).copy()
    hits = _registered[key][1](ray, primitive_ids)
    if hits is None:
        return
    records = np.asarray(hits, user_hit_dtype).reshape(-1)
    if len(records) > asked.hit_capacity:
        raise ValueError(
            f"intersect gave {len(records)} hits, expected at most {asked.hit_capacity}: four a "
            "primitive"
        )
    if len(records):
        _array_at(asked.hits, len(records), user_hit_dtype)[:] = records
    asked.hit_count = len(records)


def _destroy(key):
    _registered.pop(key, None)


# The library may hold these for longer than any object of Python's lives: they never end.
_BOUNDS = _native.kiwami_user_bounds_function(_bounds)
_INTERSECT = _native.kiwami_user_intersect_function(_intersect)
_DESTROY = _native.kiwami_user_destroy_function(_destroy)


@contextlib.contextmanager
def register(bounds, intersect, desc):
    """Has a descriptor call these functions. They are kept until the library lets go of them, or, on
    an error, no longer than the statement."""
    key = next(_keys)
    _registered[key] = bounds, intersect
    desc.user = key
    desc.bounds = ctypes.cast(_BOUNDS, ctypes.c_void_p)
    desc.intersect = ctypes.cast(_INTERSECT, ctypes.c_void_p)
    desc.destroy = ctypes.cast(_DESTROY, ctypes.c_void_p)
    try:
        yield
    except BaseException:
        _registered.pop(key, None)
        raise

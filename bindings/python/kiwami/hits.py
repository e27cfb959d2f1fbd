# SPDX-License-Identifier: Apache-2.0
"""Answers to rays."""

import numpy as np

from .arrays import INVALID_ID, hit_dtype


class Hits:
    """Hits by field, over one array of hit_dtype (``records``); the fields are views of it.

    A miss has t = inf and ids of INVALID_ID.
    """

    def __init__(self, records):
        self.records = records

    @property
    def t(self):
        """Distance in units of the direction's length."""
        return self.records["t"]

    @property
    def u(self):
        """The point is (1 - u - v) a + u b + v c."""
        return self.records["u"]

    @property
    def v(self):
        return self.records["v"]

    @property
    def normal(self):
        """(b - a) x (c - a), not normalised; (..., 3)."""
        return self.records["normal"]

    @property
    def primitive_id(self):
        return self.records["primitive_id"]

    @property
    def geometry_id(self):
        return self.records["geometry_id"]

    @property
    def instance_id(self):
        return self.records["instance_id"]

    @property
    def is_hit(self):
        """Which rays hit anything."""
        return self.records["primitive_id"] != INVALID_ID

    def points(self, origins, directions):
        """origin + t * direction of each hit, in double; NaN for misses."""
        t = np.where(self.is_hit, self.t, np.nan).astype(np.float64)
        return np.asarray(origins, np.float64) + t[..., None] * np.asarray(directions, np.float64)

    def __len__(self):
        return len(self.records)

    def __getitem__(self, index):
        return Hits(self.records[index])

    def __repr__(self):
        return f"<kiwami.Hits of {self.records.size} rays, {int(self.is_hit.sum())} hit>"


def hits_for(shape, out):
    """Where answers of this shape go: a new array, or the caller's."""
    if out is None:
        return np.empty(shape, hit_dtype)
    records = out.records if isinstance(out, Hits) else out
    if records.dtype != hit_dtype or records.shape != shape:
        raise ValueError(
            f"out has dtype {records.dtype} and shape {records.shape}, expected hit_dtype and "
            f"{shape}"
        )
    if not records.flags.c_contiguous or not records.flags.writeable:
        raise ValueError("out is not contiguous and writable, expected an array that is both")
    return records

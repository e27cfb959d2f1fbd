# SPDX-License-Identifier: Apache-2.0
"""Python functions that the library calls back: no exception may cross C."""

import ctypes

from . import _native
from ._library import check, descriptor, library
from .errors import CallbackError
from .user_geometry import raised_in_calls


def check_callbacks(result, device, raised):
    """As check(), with what a callback has raised as the cause of its failure."""
    try:
        check(result, device)
    except CallbackError as error:
        if not raised:
            raise
        failure = CallbackError(f"{error}: {raised[0]!r}")
        failure.result = error.result
        raise failure from raised[0]


class PlainQuery:
    """The defaults, for one call. What user geometries raise meanwhile is the cause of its error."""

    address = None

    def __init__(self, device):
        self._device = device

    def __enter__(self):
        self._begin = raised_in_calls.begin()
        return self

    def __exit__(self, *_):
        raised_in_calls.end(self._begin)

    def check(self, result):
        if result != _native.KIWAMI_OK:
            check_callbacks(result, self._device, raised_in_calls.since(self._begin))


class FilteredQuery(PlainQuery):
    """A filter for one call, which keeps the function alive until the call has returned."""

    def __init__(self, device, function):
        super().__init__(device)
        self._raised = []
        self._desc = descriptor(_native.kiwami_query, library.kiwami_query_init)
        self._callback = _native.kiwami_filter_function(_guarded(function, self._raised))
        self._desc.filter = ctypes.cast(self._callback, ctypes.c_void_p)
        self.address = ctypes.byref(self._desc)

    def __exit__(self, *_):
        super().__exit__()
        # The callback and what it refers to end here, not with the next run of the collector.
        self._desc = self._callback = self.address = self._raised = None

    def check(self, result):
        if self._raised:
            check_callbacks(result, self._device, self._raised)
        super().check(result)


def _guarded(function, raised):
    kind = _native.kiwami_filter_candidate

    def call(_, address):
        try:
            # A copy: the candidate itself ends with this call, and the function may keep it.
            size = ctypes.sizeof(kind)
            candidate = kind.from_buffer_copy(ctypes.string_at(address, size))
            return int(function(candidate))
        except BaseException as error:  # an exception may not cross C
            raised.append(error)
            return -1

    return call

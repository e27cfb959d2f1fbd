# SPDX-License-Identifier: Apache-2.0
"""Finds and loads the shared library, and turns its results into exceptions."""

import ctypes
import ctypes.util
import os
import pathlib
from typing import Any

from . import _native
from .errors import error_of

_FILES = ("libkiwami.so.0", "libkiwami.so", "libkiwami.0.dylib", "libkiwami.dylib", "kiwami.dll")


def _find():
    """KIWAMI_LIBRARY, then the copy in this package, then the system's."""
    chosen = os.environ.get("KIWAMI_LIBRARY")
    if chosen:
        return chosen
    for name in _FILES:
        path = pathlib.Path(__file__).with_name(name)
        if path.exists():
            return str(path)
    found = ctypes.util.find_library("kiwami")
    if found:
        return found
    raise ImportError(
        "the Kiwami library was not found: set KIWAMI_LIBRARY to the path of libkiwami.so.0"
    )


def _load():
    # A wheel has the oneTBB that the library is linked with beside it: once that is there, the
    # loader takes it by its name.
    for companion in sorted(pathlib.Path(__file__).parent.glob("libtbb.so*")):
        ctypes.CDLL(str(companion))
    loaded = ctypes.CDLL(_find())  # lets go of the GIL during each call
    _native.declare(loaded)
    found = loaded.kiwami_abi_version()
    if found != _native.KIWAMI_ABI_VERSION:
        raise ImportError(
            f"the Kiwami library has ABI version {found}, expected {_native.KIWAMI_ABI_VERSION}"
        )
    return loaded


library = _load()


def check(result, device=None):
    """Raises what a result stands for, unless it is success."""
    if result == _native.KIWAMI_OK:
        return
    text = ctypes.create_string_buffer(1024)
    library.kiwami_last_error(device, text, len(text))
    name = library.kiwami_result_name(result).decode()
    raise error_of(result, text.value.decode("utf-8", "replace") or name)


def descriptor(kind, init):
    """A descriptor with the library's defaults."""
    made = kind()
    check(init(ctypes.byref(made), ctypes.sizeof(made)))
    return made


class Handle:
    """Owns one reference to an object of the library; ends it on close() or with the object."""

    _release: Any = None

    def __init__(self, address):
        self._address = address

    def _require_open(self):
        if self._address is None:
            raise ValueError(f"this {type(self).__name__} is closed")

    @property
    def _as_parameter_(self):
        self._require_open()
        return ctypes.c_void_p(self._address)

    def close(self):
        """Lets go of the object at once. Closing twice is allowed."""
        address, self._address = getattr(self, "_address", None), None
        if address is not None:
            self._release(address)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __del__(self):
        self.close()

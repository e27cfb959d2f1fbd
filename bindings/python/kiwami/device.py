# SPDX-License-Identifier: Apache-2.0
"""Devices: a set of kernels and the threads that run them."""

import ctypes

from . import _native
from ._library import Handle, check, descriptor, library

ISAS = {
    "auto": _native.KIWAMI_ISA_AUTO,
    "scalar": _native.KIWAMI_ISA_SCALAR,
    "sse": _native.KIWAMI_ISA_SSE,
    "avx2": _native.KIWAMI_ISA_AVX2,
    "avx512": _native.KIWAMI_ISA_AVX512,
}


class Device(Handle):
    """Kernels of one instruction set and the threads that builds and batches use.

    isa       "auto", "scalar", "sse", "avx2" or "avx512"
    threads   how many threads at once; 0: one per processor
    validate  check the arguments of the trace calls in the library too

    Scenes hold their device, so it may be closed before them.
    """

    _release = staticmethod(library.kiwami_device_release)

    def __init__(self, isa="auto", threads=0, validate=False):
        if isa not in ISAS:
            raise ValueError(f"isa is {isa!r}, expected one of {', '.join(ISAS)}")
        desc = descriptor(_native.kiwami_device_desc, library.kiwami_device_desc_init)
        desc.isa = ISAS[isa]
        desc.thread_count = threads
        desc.flags = _native.KIWAMI_DEVICE_VALIDATE if validate else 0
        address = ctypes.c_void_p()
        check(library.kiwami_device_create(ctypes.byref(desc), ctypes.byref(address)))
        super().__init__(address.value)

    def _info(self):
        info = _native.kiwami_device_info(struct_size=ctypes.sizeof(_native.kiwami_device_info))
        check(library.kiwami_device_get_info(self, ctypes.byref(info)), self)
        return info

    @property
    def isa(self):
        """The instruction set whose kernels this device runs."""
        return library.kiwami_isa_name(self._info().isa).decode()

    @property
    def available_isas(self):
        """The names of all that can run here."""
        mask = self._info().isa_available
        return [name for name, number in ISAS.items() if number and mask >> number & 1]

    @property
    def threads(self):
        """Threads that builds and batches use at once."""
        return self._info().thread_count

    @property
    def bvh_width(self):
        """The children of a node in scenes that do not choose."""
        return self._info().default_bvh_width

    def __repr__(self):
        return f"<kiwami.Device {self.isa}, {self.threads} threads>"


_default = None


def default_device():
    """The device of scenes that are given none: made when it is first needed."""
    global _default
    if _default is None:
        _default = Device()
    return _default

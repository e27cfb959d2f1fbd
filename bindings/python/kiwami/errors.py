# SPDX-License-Identifier: Apache-2.0
"""What the library's results become: exceptions, each also of the built-in kind that fits."""

from typing import Optional

from . import _native


class KiwamiError(Exception):
    """An error of the library. ``result`` is its number, the text is the library's sentence."""

    result: Optional[int] = None


class InvalidArgumentError(KiwamiError, ValueError):
    """An argument is outside what its description allows."""

    result = _native.KIWAMI_ERROR_INVALID_ARGUMENT


class InvalidStateError(KiwamiError, RuntimeError):
    """The call does not fit the object's state."""

    result = _native.KIWAMI_ERROR_INVALID_STATE


class OutOfMemoryError(KiwamiError, MemoryError):
    """An allocation failed; the objects stay as they were."""

    result = _native.KIWAMI_ERROR_OUT_OF_MEMORY


class UnsupportedIsaError(KiwamiError, RuntimeError):
    """The processor, its operating system or this build lacks the instruction set."""

    result = _native.KIWAMI_ERROR_UNSUPPORTED_ISA


class TooLargeError(KiwamiError, ValueError):
    """The input exceeds a documented limit of the library."""

    result = _native.KIWAMI_ERROR_TOO_LARGE


class CallbackError(KiwamiError, RuntimeError):
    """A callback reported failure; where it raised, ``__cause__`` is what it raised."""

    result = _native.KIWAMI_ERROR_CALLBACK


class ValidationError(KiwamiError, RuntimeError):
    """A tree breaks one of its invariants."""

    result = _native.KIWAMI_ERROR_VALIDATION


class CapacityError(KiwamiError, ValueError):
    """An output is too small for the answers; nothing is lost, what is needed is known."""

    result = _native.KIWAMI_ERROR_CAPACITY


class IoError(KiwamiError, OSError):
    """A file could not be read or written."""

    result = _native.KIWAMI_ERROR_IO


class InvalidFileError(KiwamiError, ValueError):
    """A file is none of the library's, of a newer one, or damaged."""

    result = _native.KIWAMI_ERROR_INVALID_FILE


class CancelledError(KiwamiError, RuntimeError):
    """A progress function ended a commit; what was committed before stays in use."""

    result = _native.KIWAMI_ERROR_CANCELLED


_BY_RESULT = {kind.result: kind for kind in KiwamiError.__subclasses__()}


def error_of(result, sentence):
    """The exception for a result other than 0."""
    error = _BY_RESULT.get(result, KiwamiError)(sentence)
    error.result = result
    return error

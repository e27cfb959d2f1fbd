/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: what every other header needs: versions, result codes, the last error.
 *
 * Thread tags used in all headers:
 *   [any thread]               may be called from any thread at any time;
 *   [one thread per object]    calls that name the same object must not overlap;
 *   [any thread after commit]  may be called from any number of threads at once, as long as no
 *                              [one thread per object] call on the same object overlaps.
 */
#ifndef KIWAMI_BASE_H
#define KIWAMI_BASE_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#if defined(KIWAMI_BUILDING_SHARED)
#define KIWAMI_API __declspec(dllexport)
#elif defined(KIWAMI_USING_SHARED)
#define KIWAMI_API __declspec(dllimport)
#else
#define KIWAMI_API
#endif
#elif defined(__GNUC__)
#define KIWAMI_API __attribute__((visibility("default")))
#else
#define KIWAMI_API
#endif

#define KIWAMI_VERSION_MAJOR 0
#define KIWAMI_VERSION_MINOR 1
#define KIWAMI_VERSION_PATCH 0

/* The number of the binary interface; the shared library's SOVERSION. */
#define KIWAMI_ABI_VERSION 0

/* The value of an id field that names nothing (a miss, no instance). */
#define KIWAMI_INVALID_ID 0xFFFFFFFFu

/* Coordinates, origins and distances beyond 2^60 are out of range: a vertex out of range removes
 * its triangle, an origin out of range makes its ray a miss. */
#define KIWAMI_MAX_COORDINATE 1152921504606846976.0f

#ifdef __cplusplus
extern "C" {
#endif

/* What every fallible call returns: 0 is success, a negative number is one of the errors below.
 * The numbers are pinned for ever. */
typedef int32_t kiwami_result;

enum {
  KIWAMI_OK = 0,
  KIWAMI_ERROR_INVALID_ARGUMENT = -1, /* an argument is outside what its description allows */
  KIWAMI_ERROR_INVALID_STATE = -2,    /* the call does not fit the object's state (not committed) */
  KIWAMI_ERROR_OUT_OF_MEMORY = -3,    /* an allocation failed; the objects stay as they were */
  KIWAMI_ERROR_UNSUPPORTED_ISA = -4, /* the CPU, its operating system or this build lacks the ISA */
  KIWAMI_ERROR_TOO_LARGE = -5,       /* the input exceeds a documented limit of the library */
  KIWAMI_ERROR_CALLBACK = -6,        /* a callback of the caller reported failure */
  KIWAMI_ERROR_VALIDATION = -7,      /* a tree breaks one of its invariants (validator calls) */
  KIWAMI_ERROR_INTERNAL = -8,        /* a defect of the library; please report it */
  KIWAMI_ERROR_CAPACITY = -9,        /* the caller's array is too small: it holds what fits, and the
                                      * call tells what it needs */
  KIWAMI_ERROR_INVALID_FILE = -10,   /* a file is none of this library's, or is damaged */
  KIWAMI_ERROR_IO = -11,             /* the operating system could not read or write a file */
  KIWAMI_ERROR_CANCELLED = -12       /* the caller's progress function asked to cancel */
};

/* See device.h. */
typedef struct kiwami_device kiwami_device;

/* The version of the library that runs, as major * 1000000 + minor * 1000 + patch.
 * [any thread]; since 0.1 */
KIWAMI_API uint32_t kiwami_version(void);

/* The KIWAMI_ABI_VERSION that the running library was built with. [any thread]; since 0.1 */
KIWAMI_API uint32_t kiwami_abi_version(void);

/* A short English name of a result, such as "invalid argument"; "unknown result" for a number that
 * is none. The text is static: it lives as long as the library. [any thread]; since 0.1 */
KIWAMI_API const char* kiwami_result_name(kiwami_result result);

/* Copies the sentence of the last error that a call on this thread returned, or "" when there was
 * none. The sentence names the argument, its value and what was expected. A successful call does
 * not clear it.
 *   device    only an error that concerned this device; NULL: the last error whatever its device.
 *             It is compared, never read, so a released handle does no harm.
 *   text      capacity bytes, filled with a NUL-terminated UTF-8 sentence, cut to fit;
 *             NULL only with capacity 0
 *   returns   the bytes that the whole sentence needs, its NUL included
 * [any thread]; since 0.1 */
KIWAMI_API size_t kiwami_last_error(const kiwami_device* device, char* text, size_t capacity);

#ifdef __cplusplus
}
#endif

#endif

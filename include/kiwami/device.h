/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: the device: which kernels run, on which threads, with whose memory.
 */
#ifndef KIWAMI_DEVICE_H
#define KIWAMI_DEVICE_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* kiwami_device, declared in base.h, is a reference-counted handle. Geometries and scenes hold
 * their device, so a device may be released as soon as nothing new is to be made from it. */

/* Instruction sets. On processors other than x86, KIWAMI_ISA_SSE names the 4-wide kernels built
 * for that processor's own vectors. Results are equal to the bit on all of them. */
enum {
  KIWAMI_ISA_AUTO = 0,   /* the best that the processor, its operating system and the build have */
  KIWAMI_ISA_SCALAR = 1, /* portable C++, widths 4, 8 and 16 */
  KIWAMI_ISA_SSE = 2,    /* SSE4.1, width 4 */
  KIWAMI_ISA_AVX2 = 3,   /* AVX2 and FMA, widths 4 and 8 */
  KIWAMI_ISA_AVX512 = 4  /* AVX-512 F, CD, BW, DQ, VL; widths 8 and 16 */
};

enum {
  /* Check the arguments of the trace calls too, which otherwise trust the caller. */
  KIWAMI_DEVICE_VALIDATE = 1u << 0
};

/* One unit of parallel work; index is below the count given to the runner. */
typedef void (*kiwami_parallel_task)(void* task_data, size_t index);

/* The caller's own way to run parallel work. It must call task(task_data, i) exactly once for each
 * i below count, on any threads and in any order, and return after all calls have returned. It may
 * be called from several threads at once, and from within a task. It returns 0, or any other number
 * when it could not run all tasks (reported as KIWAMI_ERROR_CALLBACK). */
typedef int32_t (*kiwami_parallel_runner)(void* user, size_t count, kiwami_parallel_task task,
                                          void* task_data);

/* The caller's memory. allocate returns size bytes at a multiple of alignment (a power of two, at
 * most 4096), or NULL, which makes the call that needed it return KIWAMI_ERROR_OUT_OF_MEMORY.
 * deallocate is given the same size and alignment. Both may be called from any thread. */
typedef void* (*kiwami_allocate)(void* user, size_t size, size_t alignment);
typedef void (*kiwami_deallocate)(void* user, void* memory, size_t size, size_t alignment);

/* Receives one sentence a call: errors as they are returned, and notes (skipped triangles). The
 * text is valid during the call only. May be called from any thread that calls the library. */
typedef void (*kiwami_log)(void* user, kiwami_result severity, const char* sentence);

/* How a device is to be made. Fill it with kiwami_device_desc_init, then change what differs. */
typedef struct kiwami_device_desc {
  uint32_t struct_size;  /* bytes of this struct, set by kiwami_device_desc_init */
  uint32_t isa;          /* KIWAMI_ISA_*; AUTO also obeys the environment variable KIWAMI_ISA
                          * (auto, scalar, sse, avx2, avx512), any other value overrides it */
  uint32_t thread_count; /* threads that builds and batches use at once; 0, or more than there are
                          * processors: one per processor.
                          * Ignored with a runner. */
  uint32_t flags;        /* KIWAMI_DEVICE_* */
  kiwami_parallel_runner runner; /* NULL: the library's own tasks */
  void* runner_user;
  uint32_t runner_width;    /* how many tasks the runner runs at once (a hint); 0: unknown */
  uint32_t reserved;        /* 0 */
  kiwami_allocate allocate; /* NULL: the C++ runtime's; set both or none */
  kiwami_deallocate deallocate;
  void* allocator_user;
  kiwami_log log; /* NULL: silence */
  void* log_user;
  uint64_t memory_limit; /* bytes that the device and all that is made from it may hold at once; 0:
                          * no limit. A call that needs more returns KIWAMI_ERROR_OUT_OF_MEMORY, as
                          * if the allocator had failed. Files that are mapped and buffers that are
                          * shared do not count. */
} kiwami_device_desc;

/* What a device turned out to be. */
typedef struct kiwami_device_info {
  uint32_t struct_size;       /* set by the caller to sizeof(kiwami_device_info) */
  uint32_t isa;               /* the KIWAMI_ISA_* whose kernels this device runs */
  uint32_t isa_available;     /* bit (1 << KIWAMI_ISA_x) for each ISA that can run here */
  uint32_t isa_built;         /* the same, for each ISA that this library contains */
  uint32_t native_widths;     /* bit (1 << 4 | 1 << 8 | 1 << 16) of widths with kernels of this ISA;
                               * the other widths run on scalar kernels */
  uint32_t default_bvh_width; /* the width of scenes that do not choose one */
  uint32_t thread_count;      /* threads that builds and batches use at once */
  uint32_t reserved;          /* 0 */
  uint64_t memory_bytes;      /* that the device and all that was made from it hold now */
  uint64_t memory_peak_bytes; /* the most that they held at once */
  uint64_t memory_limit;      /* as in kiwami_device_desc */
} kiwami_device_info;

/* Fills *desc with the defaults: automatic ISA, one thread per processor, the library's own tasks
 * and memory, no log.
 *   desc, size   the struct and sizeof(kiwami_device_desc) as the caller knows it
 *   errors       INVALID_ARGUMENT: desc is NULL, or size is below 16
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_device_desc_init(kiwami_device_desc* desc, size_t size);

/* Makes a device.
 *   desc      NULL for the defaults; copied
 *   device    receives the handle, with one reference, or NULL on error
 *   errors    INVALID_ARGUMENT: a field of desc, or the variable KIWAMI_ISA;
 *             UNSUPPORTED_ISA: the ISA asked for cannot run here; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_device_create(const kiwami_device_desc* desc,
                                              kiwami_device** device);

/* Adds a reference. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_device_retain(kiwami_device* device);

/* Drops a reference; the last one ends the device. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_device_release(kiwami_device* device);

/* Says what a device is.
 *   info      struct_size set by the caller; the fields that fit are filled
 *   errors    INVALID_ARGUMENT: device or info is NULL, or struct_size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_device_get_info(const kiwami_device* device,
                                                kiwami_device_info* info);

/* The lower-case name of an ISA ("avx2"); "unknown" for a number that is none. Static text.
 * [any thread]; since 0.1 */
KIWAMI_API const char* kiwami_isa_name(uint32_t isa);

#ifdef __cplusplus
}
#endif

#endif

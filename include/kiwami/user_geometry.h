/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: user geometries: primitives of the caller's own kind, which callbacks bound and
 * intersect.
 */
#ifndef KIWAMI_USER_GEOMETRY_H
#define KIWAMI_USER_GEOMETRY_H

#include "geometry.h"

#ifdef __cplusplus
extern "C" {
#endif

/* See trace.h. */
struct kiwami_ray;

/* Bounds primitives: writes for each of the primitives first .. first + count the lower x, y, z and
 * the upper x, y, z of a box around it to bounds, six floats each. Called during commits, from
 * several threads at once where the device has them. A primitive whose box has a number that is NaN
 * or beyond KIWAMI_MAX_COORDINATE, or a lower bound above the upper one, is skipped: it is never
 * hit. Returns 0, or a negative number to have the commit fail with KIWAMI_ERROR_CALLBACK. It must
 * not throw, nor call into the scene that is committed. */
typedef int32_t (*kiwami_user_bounds_function)(void* user, uint32_t first, uint32_t count,
                                               float* bounds);

/* A point where a ray meets a user primitive. 32 bytes. */
typedef struct kiwami_user_hit {
  float t;                            /* the distance along the ray that was given */
  float u, v;                         /* whatever the primitive's kind makes of them */
  float normal_x, normal_y, normal_z; /* outward; need not have length 1 */
  uint32_t primitive_id;              /* one of those that were asked for */
  uint32_t reserved;                  /* not read */
} kiwami_user_hit;

/* What an intersect callback is asked, and its answer. */
typedef struct kiwami_user_intersection {
  uint32_t struct_size;          /* bytes of this struct as the library knows it */
  uint32_t primitive_count;      /* at least 1 */
  const uint32_t* primitive_ids; /* primitive_count of them, each once */
  const struct kiwami_ray* ray;  /* in the geometry's space: inside an instance, its ray */
  uint32_t geometry_id;          /* the geometry's number in its scene */
  uint32_t hit_capacity;         /* KIWAMI_USER_HITS_PER_PRIMITIVE times primitive_count */
  kiwami_user_hit* hits;         /* room for hit_capacity hits, to be written from the first on */
  uint32_t hit_count;            /* how many were written; 0 at the call */
  uint32_t reserved;             /* 0 */
} kiwami_user_intersection;

enum {
  /* A ray can meet a primitive as often. */
  KIWAMI_USER_HITS_PER_PRIMITIVE = 4
};

/* Intersects one ray with some primitives: writes the hits with ray->tmin <= t <= ray->tmax, in any
 * order; others are ignored, so a primitive need not test that. ray->tmax may be nearer than the
 * traced ray's, where something nearer has been found. The hits of a primitive must depend on the
 * ray and the primitive alone, and lie in its box: a hit outside may be lost. A hit is seen from
 * its front where its normal points against the ray. Called during trace calls, from several
 * threads at once where the device has them and for many rays, in the default floating-point state.
 * Returns 0, or a negative number to have the trace call fail with KIWAMI_ERROR_CALLBACK: rays for
 * which no call failed are answered all the same. It must not throw. */
typedef int32_t (*kiwami_user_intersect_function)(void* user,
                                                  kiwami_user_intersection* intersection);

/* Called with the user pointer when the last reference to the geometry is gone. */
typedef void (*kiwami_user_destroy_function)(void* user);

typedef struct kiwami_user_geometry_desc {
  uint32_t struct_size; /* bytes of this struct, set by kiwami_user_geometry_desc_init */
  uint32_t flags;       /* 0 */
  uint64_t count;       /* of primitives, at most 2^31 - 1 */
  kiwami_user_bounds_function bounds;
  kiwami_user_intersect_function intersect;
  kiwami_user_destroy_function destroy; /* may be NULL */
  void* user;                           /* given to each of these; may be NULL */
  uint32_t mask;     /* a ray meets them only if (ray.mask & mask) != 0; all ones */
  uint32_t reserved; /* 0 */
} kiwami_user_geometry_desc;

/* Fills *desc with the defaults: no primitives, no callbacks, a mask of all ones.
 *   size      sizeof the struct as the caller knows it
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_user_geometry_desc_init(kiwami_user_geometry_desc* desc,
                                                        size_t size);

/* Makes a user geometry.
 *   geometry   receives the handle, with one reference, or NULL on error: then destroy is not
 *              called
 *   errors     INVALID_ARGUMENT: a NULL pointer, a callback missing, an unknown flag; TOO_LARGE: a
 *              count beyond its limit; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_user_geometry_create(kiwami_device* device,
                                                     const kiwami_user_geometry_desc* desc,
                                                     kiwami_geometry** geometry);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: spheres, oriented discs and round curve segments: geometries for point clouds and hair.
 *
 * Results are the same to the bit on every ISA, node width and thread count, as those of triangles
 * are: they come from the formulas given here, in double precision, out of + - * / and square roots
 * that are each rounded on their own, from the floats of ray and shape; t, u, v and the normal are
 * rounded to float once, at the end. The formulas in full are in docs/scenes.md.
 *
 * A ray crosses the surface of a sphere or a curve segment where it enters and where it leaves; a
 * disc it crosses once. Each crossing is a hit of its own: a ray that begins inside hits the far
 * side, and kiwami_count_hits counts both. Where both distances round to the same float, the second
 * is the next greater float. Rays that only graze a surface do not cross it. Entries are front
 * faces and exits back faces for KIWAMI_RAY_CULL_*; a disc shows its front to rays that run against
 * its normal.
 */
#ifndef KIWAMI_SHAPES_H
#define KIWAMI_SHAPES_H

#include "geometry.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  /* The library keeps the pointers instead of copying the buffers. They must stay readable and
   * unchanged until the last reference to the geometry is gone: scenes hold one. */
  KIWAMI_SHAPES_SHARE_BUFFERS = 1u << 0
};

/* Spheres in the caller's memory: four floats each, the centre's x, y, z and the radius. No byte
 * outside points + point_offset + i * point_stride .. + 16 (i < sphere_count) is read, and no
 * alignment is asked for.
 * A hit's u and v are 0; its normal is the hit point less the centre, outward, as long as the
 * radius. A sphere with a number that is NaN or infinite, with a negative radius, or that reaches
 * beyond KIWAMI_MAX_COORDINATE is skipped: it is never hit, and the others keep their numbers. */
typedef struct kiwami_spheres_desc {
  uint32_t struct_size;  /* bytes of this struct, set by kiwami_spheres_desc_init */
  uint32_t flags;        /* KIWAMI_SHAPES_* */
  const void* points;    /* may be NULL when sphere_count is 0 */
  uint64_t point_offset; /* bytes before the first sphere */
  uint64_t point_stride; /* bytes from one sphere to the next, at least 16; 0: 16 */
  uint64_t sphere_count; /* at most 2^31 - 1 */
  uint32_t mask;         /* a ray meets them only if (ray.mask & mask) != 0; all ones */
  uint32_t reserved;     /* 0 */
} kiwami_spheres_desc;

/* Flat discs in the caller's memory: points as those of spheres, and a normal of three floats each,
 * which need not have length 1. The rim is not part of a disc, and a ray within its plane misses.
 * A hit's u is the squared part of the radius at which it lies, 0 in the centre to 1; v is 0; its
 * normal is the disc's as given. Discs are skipped as spheres are, and where the normal is 0. */
typedef struct kiwami_discs_desc {
  uint32_t struct_size;   /* bytes of this struct, set by kiwami_discs_desc_init */
  uint32_t flags;         /* KIWAMI_SHAPES_* */
  const void* points;     /* may be NULL when disc_count is 0 */
  uint64_t point_offset;  /* bytes before the first centre */
  uint64_t point_stride;  /* bytes from one centre to the next, at least 16; 0: 16 */
  const void* normals;    /* may be NULL when disc_count is 0 */
  uint64_t normal_offset; /* bytes before the first normal */
  uint64_t normal_stride; /* bytes from one normal to the next, at least 12; 0: 12 */
  uint64_t disc_count;    /* at most 2^31 - 1 */
  uint32_t mask;          /* as of spheres */
  uint32_t reserved;      /* 0 */
} kiwami_discs_desc;

/* Round curve segments in the caller's memory: each is the union of all spheres between those of
 * two points that follow each other, centre and radius interpolated linearly (a cone with round
 * ends). A hit's u tells on which of these spheres it lies, 0 on the first to 1 on the second; v is
 * 0; its normal is the hit point less the sphere's centre, outward. Segments are solid, also where
 * they join: a ray through a joint of a strand crosses both. Segments with a point that would be
 * skipped as a sphere are skipped. */
typedef struct kiwami_curves_desc {
  uint32_t struct_size;   /* bytes of this struct, set by kiwami_curves_desc_init */
  uint32_t flags;         /* KIWAMI_SHAPES_* */
  const void* points;     /* four floats each: x, y, z, radius; NULL only when point_count is 0 */
  uint64_t point_offset;  /* bytes before the first point */
  uint64_t point_stride;  /* bytes from one point to the next, at least 16; 0: 16 */
  uint64_t point_count;   /* at most 2^32 - 1 */
  const void* indices;    /* a uint32 each: segment i joins the points of this index and the next;
                           * each below point_count - 1; NULL: segment i joins points i and i + 1 */
  uint64_t index_offset;  /* bytes before the first index */
  uint64_t index_stride;  /* bytes from one index to the next, at least 4; 0: 4 */
  uint64_t segment_count; /* at most 2^31 - 1 */
  uint32_t mask;          /* as of spheres */
  uint32_t reserved;      /* 0 */
} kiwami_curves_desc;

/* Fill *desc with the defaults: no shapes, copied buffers, a mask of all ones.
 *   size      sizeof the struct as the caller knows it
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_spheres_desc_init(kiwami_spheres_desc* desc, size_t size);
KIWAMI_API kiwami_result kiwami_discs_desc_init(kiwami_discs_desc* desc, size_t size);
KIWAMI_API kiwami_result kiwami_curves_desc_init(kiwami_curves_desc* desc, size_t size);

/* Make spheres, discs, or curve segments: each call one geometry, whose shapes are its primitives.
 *   geometry   receives the handle, with one reference, or NULL on error
 *   errors     INVALID_ARGUMENT: a NULL pointer, a stride too small, an extent that overflows, an
 *              index at or beyond point_count - 1, an unknown flag; TOO_LARGE: a count beyond its
 *              limit; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_spheres_create(kiwami_device* device,
                                               const kiwami_spheres_desc* desc,
                                               kiwami_geometry** geometry);
KIWAMI_API kiwami_result kiwami_discs_create(kiwami_device* device, const kiwami_discs_desc* desc,
                                             kiwami_geometry** geometry);
KIWAMI_API kiwami_result kiwami_curves_create(kiwami_device* device, const kiwami_curves_desc* desc,
                                              kiwami_geometry** geometry);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: what surfaces are like where rays hit them: attributes of the mesh, the point with its
 * error, and origins for rays that leave it.
 */
#ifndef KIWAMI_SURFACE_H
#define KIWAMI_SURFACE_H

#include "trace.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An attribute of a mesh (normals, texture coordinates, colours), where it is wanted, and what
 * receives it. No byte outside
 *   attributes + attribute_offset + i * attribute_stride .. + 4 * channels   (i < attribute_count)
 * and the elements of the index buffer is read, and no alignment is asked for. */
typedef struct kiwami_interpolation {
  uint32_t struct_size;      /* bytes of this struct, set by kiwami_interpolation_init */
  uint32_t channels;         /* floats of one attribute, 1 to 1024; 3 */
  const void* attributes;    /* channels floats each; may be NULL when attribute_count is 0 */
  uint64_t attribute_offset; /* bytes before the first attribute */
  uint64_t attribute_stride; /* bytes from one to the next, at least 4 * channels; 0: just that */
  uint64_t attribute_count;
  const void* indices;   /* three uint32 a triangle, numbers of its corners' attributes; NULL:
                          * the numbers of its vertices */
  uint64_t index_offset; /* bytes before the first triangle's */
  uint64_t index_stride; /* bytes from one triangle to the next, at least 12; 0: 12 */
  /* Where: all of the same number of elements. Those of an array of hits are
   * {&hits->primitive_id, sizeof *hits} and so on. */
  kiwami_input_field primitive_id; /* uint32; KIWAMI_INVALID_ID: a miss */
  kiwami_input_field u, v;         /* float */
  kiwami_input_field geometry_id;  /* uint32; data NULL: every element is of this mesh */
  uint32_t geometry;               /* the number of this mesh; other elements are left alone */
  uint32_t reserved;               /* 0 */
  void* values;                    /* channels floats an element; NULL: not wanted */
  uint64_t value_stride;           /* bytes, at least 4 * channels; 0: just that */
  void* derivatives_u;             /* the same, by u: b - a; NULL: not wanted */
  uint64_t derivative_u_stride;
  void* derivatives_v; /* by v: c - a */
  uint64_t derivative_v_stride;
} kiwami_interpolation;

/* Fills *interpolation with the defaults: nothing, of three channels.
 *   errors    INVALID_ARGUMENT: the pointer is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_interpolation_init(kiwami_interpolation* interpolation,
                                                   size_t size);

/* Interpolates an attribute over the triangles of a mesh: ((1 - u) - v) a + u b + v c, in single
 * precision, from left to right, nothing fused: the same to the bit everywhere. A miss has zeros.
 *   mesh      a triangle mesh
 *   count     elements
 *   errors    INVALID_ARGUMENT: NULL, no triangle mesh, channels out of range, a primitive_id that
 *             is no triangle of the mesh, the number of an attribute that is not there, a stride
 *             too small, an extent that overflows; what was written before is not told
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_interpolate(const kiwami_geometry* mesh,
                                            const kiwami_interpolation* interpolation,
                                            size_t count);

/* Tells the point of each hit, (1 - u - v) a + u b + v c, and how far it may be off.
 *   hits      count hits of the committed scene, hit_stride bytes apart (0: sizeof(kiwami_hit)), on
 *             triangle meshes outside of instances, or misses; NULL only if count is 0
 *   points    receives three floats each, point_stride bytes apart (0: 12): the point rounded to
 *             the nearest floats; NaN for a miss, so that rays from there miss. NULL: not wanted
 *   errors    receives three floats each, error_stride bytes apart (0: 12): along no axis is the
 *             exact point farther from the one told. NULL: not wanted
 * Returns INVALID_STATE: the scene was never committed; INVALID_ARGUMENT: NULL; a hit whose numbers
 * are not in the scene, which is in an instance, or not on a triangle mesh.
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_hit_points(const kiwami_scene* scene, const kiwami_hit* hits,
                                           size_t hit_stride, size_t count, float* points,
                                           size_t point_stride, float* errors, size_t error_stride);

/* Tells an origin for a ray that leaves each hit: beside the hit's point, on that side of the
 * triangle to which the direction points, and so far from it that a ray from there does not meet
 * the triangle at any t >= 0. That is a promise, not a habit: docs/queries.md has its proof.
 *   directions   three floats each, direction_stride bytes apart (0: 12): that of the ray to come,
 *                which may differ from the one that is traced as long as that points to the same
 *                side, or from it by no more than 2^-22 of its length
 *   origins      receives three floats each, origin_stride bytes apart (0: 12); NaN for a miss
 * A triangle so thin that its plane cannot be told in double precision (the sine between its two
 * shorter sides is below 2^-28) has no sides: its origin is the point itself. kiwami_query has
 * exclusions, which keep off any triangle. Otherwise as kiwami_hit_points.
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_offset_origins(const kiwami_scene* scene, const kiwami_hit* hits,
                                               size_t hit_stride, const float* directions,
                                               size_t direction_stride, size_t count,
                                               float* origins, size_t origin_stride);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: triangle meshes that move: motion blur.
 */
#ifndef KIWAMI_MOVING_MESH_H
#define KIWAMI_MOVING_MESH_H

#include "geometry.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  /* The library keeps the pointers instead of copying the buffers. They must stay readable and
   * unchanged until the last reference to the geometry is gone: scenes hold one. */
  KIWAMI_MOVING_MESH_SHARE_BUFFERS = 1u << 0
};

/* The most time steps of a moving mesh. */
enum { KIWAMI_MAX_TIME_STEPS = 129 };

/* A triangle mesh whose vertices are given at several times, in equal steps from time_begin to
 * time_end. A ray meets it as it is at the ray's time, and not at all where that lies outside of
 * this range, or is NaN. Between two steps a and b, at the part f of the way from one to the other,
 * a vertex is (1 - f) * a + f * b, each operation rounded to float: so a ray meets just what it
 * meets in a mesh that does not move and has these vertices. With time t and n = step_count - 1,
 * s = (t - time_begin) / (time_end - time_begin) * n in this order, the step is the whole part of
 * s, at most n - 1, and f the rest. Meshes are watertight at every time, also where two with the
 * same steps and range meet. Vertex i of step k is the three floats at vertices + vertex_offset + k
 * * step_stride + i * vertex_stride. No other bytes are read, and no alignment is asked for. A
 * triangle with a vertex that is NaN, infinite or beyond KIWAMI_MAX_COORDINATE at any step is
 * skipped. */
typedef struct kiwami_moving_mesh_desc {
  uint32_t struct_size;    /* bytes of this struct, set by kiwami_moving_mesh_desc_init */
  uint32_t flags;          /* KIWAMI_MOVING_MESH_* */
  const void* vertices;    /* may be NULL when vertex_count is 0 */
  uint64_t vertex_offset;  /* bytes before the first vertex */
  uint64_t vertex_stride;  /* bytes from one vertex to the next, at least 12; 0: 12 */
  uint64_t vertex_count;   /* of one step, at most 2^32 - 1 */
  uint64_t step_stride;    /* bytes from one step to the next; 0: vertex_count * vertex_stride */
  const void* indices;     /* as of kiwami_triangle_mesh_desc, the same at all times */
  uint64_t index_offset;   /* bytes before the first index */
  uint64_t index_stride;   /* bytes from one triangle to the next, at least 12; 0: 12 */
  uint64_t triangle_count; /* at most 2^31 - 1 */
  uint32_t step_count;     /* 2 to KIWAMI_MAX_TIME_STEPS */
  float time_begin;        /* of the first step; 0 */
  float time_end;          /* of the last step, later than time_begin; 1 */
  uint32_t mask;           /* a ray meets the mesh only if (ray.mask & mask) != 0; all ones */
} kiwami_moving_mesh_desc;

/* Fills *desc with the defaults: no vertices, no triangles, copied buffers, two steps from 0 to 1,
 * a mask of all ones.
 *   size      sizeof the struct as the caller knows it
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_moving_mesh_desc_init(kiwami_moving_mesh_desc* desc, size_t size);

/* Makes a moving triangle mesh.
 *   geometry   receives the handle, with one reference, or NULL on error
 *   errors     INVALID_ARGUMENT: a NULL pointer, a stride too small, an extent that overflows, an
 *              index at or beyond vertex_count, an unknown flag, a time that is not finite, a
 *              time_end that is not later than time_begin, a step_count out of range; TOO_LARGE: a
 *              count beyond its limit; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_moving_mesh_create(kiwami_device* device,
                                                   const kiwami_moving_mesh_desc* desc,
                                                   kiwami_geometry** geometry);

#ifdef __cplusplus
}
#endif

#endif

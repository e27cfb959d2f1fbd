/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: geometries: what a scene is made of.
 */
#ifndef KIWAMI_GEOMETRY_H
#define KIWAMI_GEOMETRY_H

#include "device.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A reference-counted handle. A geometry can be attached to any number of scenes of its device. */
typedef struct kiwami_geometry kiwami_geometry;

enum {
  /* The library keeps the pointers instead of copying the buffers. They must stay readable until
   * the last reference to the geometry is gone: scenes hold one. They may change (vertices see
   * kiwami_triangle_mesh_update_vertices) while no commit, trace, validation or measurement of a
   * scene of theirs runs, and such a scene has to be committed or refitted before it is used again.
   */
  KIWAMI_MESH_SHARE_BUFFERS = 1u << 0
};

/* A triangle mesh in the caller's memory. No byte outside
 *   vertices + vertex_offset + i * vertex_stride .. + 12   (i < vertex_count) and
 *   indices  + index_offset  + i * index_stride  .. + 12   (i < triangle_count)
 * is read, and no alignment is asked for.
 * A triangle with a vertex that is NaN, infinite or beyond KIWAMI_MAX_COORDINATE is skipped: it is
 * never hit, and the others keep their numbers. */
typedef struct kiwami_triangle_mesh_desc {
  uint32_t struct_size;    /* bytes of this struct, set by kiwami_triangle_mesh_desc_init */
  uint32_t flags;          /* KIWAMI_MESH_* */
  const void* vertices;    /* three floats a vertex; may be NULL when vertex_count is 0 */
  uint64_t vertex_offset;  /* bytes before the first vertex */
  uint64_t vertex_stride;  /* bytes from one vertex to the next, at least 12; 0: 12 */
  uint64_t vertex_count;   /* at most 2^32 - 1 */
  const void* indices;     /* three uint32 a triangle, each below vertex_count; NULL: triangle i is
                            * made of the vertices 3i, 3i + 1, 3i + 2 */
  uint64_t index_offset;   /* bytes before the first index */
  uint64_t index_stride;   /* bytes from one triangle to the next, at least 12; 0: 12 */
  uint64_t triangle_count; /* at most 2^31 - 1 */
  uint32_t mask;           /* a ray meets the mesh only if (ray.mask & mask) != 0; all ones */
  uint32_t reserved;       /* 0 */
} kiwami_triangle_mesh_desc;

/* Fills *desc with the defaults: no vertices, no triangles, copied buffers, a mask of all ones.
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_triangle_mesh_desc_init(kiwami_triangle_mesh_desc* desc,
                                                        size_t size);

/* Makes a triangle mesh.
 *   geometry   receives the handle, with one reference, or NULL on error
 *   errors     INVALID_ARGUMENT: a NULL pointer, a stride below 12, an extent that overflows, an
 *              index at or beyond vertex_count, an unknown flag; TOO_LARGE: a count beyond its
 *              limit; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_triangle_mesh_create(kiwami_device* device,
                                                     const kiwami_triangle_mesh_desc* desc,
                                                     kiwami_geometry** geometry);

/* Gives a mesh other vertices, as many as it has. Takes effect with the next commit or refit
 * (kiwami_scene_refit) of each scene that the mesh is attached to; until then what was committed
 * keeps the vertices that it was committed with.
 *   vertices        vertex_count vertices of three floats, the first one vertex_offset bytes from
 *                   vertices on, vertex_stride bytes apart (0: 12), at any address. Copied buffers:
 *                   copied; from the first call on the mesh holds two copies. Shared buffers: kept
 *                   in place of the old ones, and NULL says that the old ones have changed where
 *                   they are (then offset and stride are ignored). NULL else only if there are no
 *                   vertices
 *   errors          INVALID_ARGUMENT: geometry is NULL or no triangle mesh, vertices is NULL, a
 *                   stride below 12, an extent that overflows; OUT_OF_MEMORY; CALLBACK: the runner
 *                   failed. Then nothing has changed
 * [one thread per object], and not during a commit of a scene that the mesh is attached to; since
 * 0.1 */
KIWAMI_API kiwami_result kiwami_triangle_mesh_update_vertices(kiwami_geometry* geometry,
                                                              const void* vertices,
                                                              uint64_t vertex_offset,
                                                              uint64_t vertex_stride);

/* Changes the mask of a geometry: a ray meets it only if (ray.mask & mask) != 0. Takes effect with
 * the next commit or refit of each scene that it is attached to.
 *   errors          INVALID_ARGUMENT: geometry is NULL
 * [one thread per object], and not during a commit of a scene that it is attached to; since 0.1 */
KIWAMI_API kiwami_result kiwami_geometry_set_mask(kiwami_geometry* geometry, uint32_t mask);

/* Adds a reference. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_geometry_retain(kiwami_geometry* geometry);

/* Drops a reference; the last one ends the geometry. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_geometry_release(kiwami_geometry* geometry);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: in which tetrahedron of a mesh a point lies, and where in it: for volumes, fields of
 * simulations, and deformations by a coarse mesh. See docs/tetrahedra.md.
 *
 * Whether a tetrahedron contains a point is decided exactly, for the floats as they are given. So
 * the answers are the same to the bit on every ISA and for every number of threads, and no point
 * is lost between neighbours.
 */
#ifndef KIWAMI_TETRAHEDRA_H
#define KIWAMI_TETRAHEDRA_H

#include "device.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A reference-counted handle of a tetrahedral mesh, which never changes. It holds its device. */
typedef struct kiwami_tetrahedra kiwami_tetrahedra;

enum {
  /* A tree of the tetrahedra's boxes: those whose box holds the point are tested. */
  KIWAMI_TETRAHEDRA_BOXES = 0,
  /* A ray is traced from the point to the nearest face, each of which is there once and knows the
   * tetrahedra on its two sides. Points outside, and on faces, are looked for in the boxes, too. */
  KIWAMI_TETRAHEDRA_FACES = 1
};

/* A mesh. Read during kiwami_tetrahedra_create only. */
typedef struct kiwami_tetrahedra_desc {
  uint32_t struct_size;   /* bytes of this struct, set by kiwami_tetrahedra_desc_init */
  uint32_t method;        /* KIWAMI_TETRAHEDRA_*; BOXES */
  const void* vertices;   /* three floats a vertex, at any address; NULL only if there is none */
  uint64_t vertex_stride; /* bytes from one vertex to the next, at least 12; 0: 12 */
  uint64_t vertex_count;  /* at most 2^32 - 2 */
  const void* indices;    /* four uint32 a tetrahedron, each below vertex_count, in either
                               * orientation; NULL only if there is none */
  uint64_t index_stride;  /* bytes from one tetrahedron to the next, at least 16; 0: 16 */
  uint64_t tetrahedron_count; /* at most 2^28 */
} kiwami_tetrahedra_desc;

/* The numbers of a mesh. */
typedef struct kiwami_tetrahedra_info {
  uint32_t struct_size;         /* set by the caller to sizeof(kiwami_tetrahedra_info) */
  uint32_t method;              /* KIWAMI_TETRAHEDRA_* */
  uint64_t tetrahedron_count;   /* as they were given */
  uint64_t skipped_count;       /* those that contain no point: of no volume, or with a vertex that
                                 * is NaN, infinite or beyond KIWAMI_MAX_COORDINATE */
  uint64_t inverted_count;      /* those whose fourth vertex is not on the side to which the normal
                                 * (v1 - v0) x (v2 - v0) of the others points; skipped ones excluded */
  uint64_t face_count;          /* of FACES: different faces; 0 with BOXES */
  uint64_t boundary_face_count; /* of FACES: those with one tetrahedron */
  uint64_t crowded_face_count; /* of FACES: those with several tetrahedra on one side, which overlap
                                 * then */
  uint64_t bytes;              /* memory of the handle */
  double build_seconds;        /* wall-clock time of kiwami_tetrahedra_create */
} kiwami_tetrahedra_info;

/* Where a point lies. 20 bytes, at any address. */
typedef struct kiwami_tetrahedron_location {
  uint32_t tetrahedron_id; /* KIWAMI_INVALID_ID: in none */
  float weights[4]; /* of its vertices, in their order, 0 to 1: the point is the sum of weight
                            * times vertex. Each is right to 2^-22 of itself, but at least 2^-126, and
                            * 0 exactly where the point lies on the face opposite of the vertex.
                            * All 0: in none */
} kiwami_tetrahedron_location;

/* Fills *desc with the defaults: no tetrahedra.
 *   size      sizeof the struct as the caller knows it
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_tetrahedra_desc_init(kiwami_tetrahedra_desc* desc, size_t size);

/* Makes a mesh, on the device's threads.
 *   tetrahedra   receives the handle, with one reference, or NULL on error
 *   errors       INVALID_ARGUMENT: NULL, a field of desc, an index at or beyond vertex_count (the
 *                sentence names the tetrahedron); TOO_LARGE: a count beyond its limit;
 *                OUT_OF_MEMORY; CALLBACK: the runner failed
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_tetrahedra_create(kiwami_device* device,
                                                  const kiwami_tetrahedra_desc* desc,
                                                  kiwami_tetrahedra** tetrahedra);

/* Adds a reference. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_tetrahedra_retain(kiwami_tetrahedra* tetrahedra);

/* Drops a reference; the last one ends the mesh. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_tetrahedra_release(kiwami_tetrahedra* tetrahedra);

/* Says what a mesh is.
 *   info      struct_size set by the caller; the fields that fit are filled
 *   errors    INVALID_ARGUMENT: NULL, or struct_size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_tetrahedra_get_info(const kiwami_tetrahedra* tetrahedra,
                                                    kiwami_tetrahedra_info* info);

/* Finds the tetrahedron that contains each point, its border included. Of those that share the
 * face, edge or vertex that a point lies on, it is the one of the lowest number. Of tetrahedra that
 * overlap, it is one of them, always the same for a mesh and a method.
 *   points      count points of three floats, point_stride bytes apart (0: 12); NULL only if count
 *               is 0. One that is not finite is in no tetrahedron.
 *   locations   receives count locations, location_stride bytes apart (0:
 *               sizeof(kiwami_tetrahedron_location)). May not overlap the points.
 * Large batches run on the device's threads. Nothing is allocated. Points that follow each other
 * are found quicker where they are near each other.
 *   errors      INVALID_ARGUMENT: tetrahedra is NULL; CALLBACK: the runner failed. With
 *               KIWAMI_DEVICE_VALIDATE also INVALID_ARGUMENT: NULL, a stride too small, an extent
 *               that overflows
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_tetrahedra_locate(const kiwami_tetrahedra* tetrahedra,
                                                  const void* points, size_t point_stride,
                                                  kiwami_tetrahedron_location* locations,
                                                  size_t location_stride, size_t count);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: instances: scenes as parts of scenes.
 */
#ifndef KIWAMI_INSTANCES_H
#define KIWAMI_INSTANCES_H

#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The most instances, each in the scene of the one before, that lead to a hit. */
#define KIWAMI_MAX_INSTANCE_DEPTH 8

enum {
  /* The library keeps the pointers to scene_indices, transforms and masks instead of copying what
   * they point to. It must stay readable until the last reference to the geometry is gone. It is
   * read by the commits of scenes that the geometry is attached to, and may change between them. */
  KIWAMI_INSTANCES_SHARE_BUFFERS = 1u << 0
};

/* An array of instances: each shows one of the scenes, moved by an affine transform.
 *
 * Rays are carried into a scene by the inverse of the transform, which is rounded to floats. Their
 * directions are not normalised there, so a hit's t means the same as outside. What is said of a
 * hit is said in the space of its scene: the normal, and which side of a triangle is its front (a
 * transform that mirrors shows fronts whose vertices run clockwise in the outer space).
 *
 * A commit captures what the scenes have committed by then: what they commit later is seen from the
 * next commit of the outer scene on. */
typedef struct kiwami_instances_desc {
  uint32_t struct_size;        /* bytes of this struct, set by kiwami_instances_desc_init */
  uint32_t flags;              /* KIWAMI_INSTANCES_* */
  kiwami_scene* const* scenes; /* scene_count scenes of the device; the geometry holds references */
  uint64_t scene_count;        /* at least 1, at most 2^31 - 1 */
  const void* scene_indices; /* count uint32, each below scene_count: which scene an instance shows;
                              * NULL: the first one */
  uint64_t scene_index_stride; /* bytes from one to the next, at least 4; 0: 4 */
  const void* transforms;      /* count matrices of 12 floats, three rows of four: from the scene's
                                * space to the outer one */
  uint64_t transform_stride;   /* bytes from one to the next, at least 48; 0: 48 */
  uint64_t count;              /* instances, at least 1, at most 2^31 - 1 */
  const void* masks;           /* count uint32; NULL: all ones */
  uint64_t mask_stride;        /* bytes from one to the next, at least 4; 0: 4 */
  uint32_t mask;     /* a ray enters an instance only if (ray.mask & mask & its own mask) is
                      * not 0, and inside it the masks there count as well; all ones */
  uint32_t reserved; /* 0 */
} kiwami_instances_desc;

/* Fills *desc with the defaults: no scenes, no instances, copied buffers, a mask of all ones.
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_instances_desc_init(kiwami_instances_desc* desc, size_t size);

/* Makes an array of instances, to be attached to a scene like any geometry. The instances of a
 * scene are numbered through, by the numbers of their geometries and then by their indices in the
 * arrays: a hit names this number.
 *   geometry   receives the handle, with one reference, or NULL on error
 *   errors     INVALID_ARGUMENT: a NULL pointer, a scene of another device, an index at or beyond
 *              scene_count, a stride too small, an extent that overflows, an unknown flag, a
 *              transform that is not finite or singular: one whose condition number, in the norm of
 *              the greatest row sum, is above 2^20, or that scales by more than 2^60 or less than
 *              2^-60 (the sentence names the instance); TOO_LARGE: a count beyond its limit;
 *              OUT_OF_MEMORY
 * The commit of the outer scene also fails with INVALID_ARGUMENT where shared buffers have become
 * wrong by then, or where a shown scene has another BVH width; INVALID_STATE: a shown scene was
 * never committed; TOO_LARGE: paths of more than KIWAMI_MAX_INSTANCE_DEPTH instances, or more than
 * 2^32 - 2 instances. It reads the shown scenes: their commits must not overlap with it.
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_instances_create(kiwami_device* device,
                                                 const kiwami_instances_desc* desc,
                                                 kiwami_geometry** geometry);

#ifdef __cplusplus
}
#endif

#endif

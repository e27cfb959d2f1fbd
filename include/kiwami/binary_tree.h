/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: a binary tree of kiwami_bvh_build that rays are traced through as it is, in one of two
 * layouts: for what has no room for a wide tree, and to compare with. Scenes are quicker.
 */
#ifndef KIWAMI_BINARY_TREE_H
#define KIWAMI_BINARY_TREE_H

#include "bvh.h"
#include "trace.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A reference-counted handle of a tree, which never changes. It holds its device, the mesh, and the
 * vertices that the mesh had. */
typedef struct kiwami_binary_tree kiwami_binary_tree;

enum {
  /* The box of each node: 32 bytes a node. */
  KIWAMI_BINARY_LAYOUT_BOXES = 0,
  /* Of each node the planes alone that its parent's box does not have: a dual-split tree (Lin,
   * Shkurko, Mallett & Yuksel 2019). 12 bytes a node, of which there are some more. */
  KIWAMI_BINARY_LAYOUT_DUAL_SPLIT = 1
};

/* The numbers of a tree. */
typedef struct kiwami_binary_tree_info {
  uint32_t struct_size;     /* set by the caller to sizeof(kiwami_binary_tree_info) */
  uint32_t layout;          /* KIWAMI_BINARY_LAYOUT_* */
  uint64_t node_count;      /* of all kinds */
  uint64_t split_count;     /* of those, with two children */
  uint64_t carve_count;     /* of those, with planes that cut off what is empty, and one child */
  uint64_t leaf_count;      /* of those, with triangles */
  uint64_t primitive_count; /* places of triangles in leaves */
  uint64_t node_bytes;      /* of all nodes */
  uint64_t bytes;           /* of the handle, the triangles' numbers included, without the mesh */
} kiwami_binary_tree_info;

/* What rays met on their way. */
typedef struct kiwami_binary_visits {
  uint32_t struct_size; /* set by the caller to sizeof(kiwami_binary_visits) */
  uint32_t reserved;    /* 0 */
  uint64_t node_visits; /* nodes other than leaves */
  uint64_t plane_tests; /* planes that a ray was compared with, six a box */
  uint64_t leaf_visits;
} kiwami_binary_visits;

/* Makes a tree in a layout.
 *   bvh       a tree of kiwami_bvh_build over a mesh, of width 2, with at most four triangles a
 *             leaf (the default)
 *   layout    KIWAMI_BINARY_LAYOUT_*
 *   tree      receives the handle, with one reference, or NULL on error
 *   errors    INVALID_ARGUMENT: NULL, an unknown layout, a tree of another kind; TOO_LARGE: more
 *             than 2^28 nodes, or 2^24 leaves; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_binary_tree_create(const kiwami_bvh* bvh, uint32_t layout,
                                                   kiwami_binary_tree** tree);

/* Adds a reference. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_binary_tree_retain(kiwami_binary_tree* tree);

/* Drops a reference; the last one ends the tree. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_binary_tree_release(kiwami_binary_tree* tree);

/* Says what a tree is.
 *   info      struct_size set by the caller; the fields that fit are filled
 *   errors    INVALID_ARGUMENT: NULL, or struct_size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_binary_tree_get_info(const kiwami_binary_tree* tree,
                                                     kiwami_binary_tree_info* info);

/* Checks every invariant of a tree: that nodes follow each other as they say, that what the planes
 * leave of space holds the triangles of each leaf, and that each triangle is there.
 *   errors    INVALID_ARGUMENT: tree is NULL; VALIDATION: the sentence of kiwami_last_error names
 *             the node; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_binary_tree_validate(const kiwami_binary_tree* tree);

/* Finds the closest hit of each ray: to the bit that of a scene with the mesh as its geometry 0.
 *   rays      count rays, ray_stride bytes apart (0: sizeof(kiwami_ray)); NULL only if count is 0
 *   hits      receives count hits, hit_stride bytes apart (0: sizeof(kiwami_hit)). May not overlap
 *             the rays.
 *   visits    struct_size set by the caller; the fields that fit are filled. May be NULL.
 * Rays go one by one. Large batches run on the device's threads.
 *   errors    INVALID_ARGUMENT: tree is NULL, struct_size below 8; CALLBACK: the runner failed. With
 *             KIWAMI_DEVICE_VALIDATE also INVALID_ARGUMENT: NULL, a stride too small, an extent that
 *             overflows
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_binary_tree_closest_hit(const kiwami_binary_tree* tree,
                                                        const kiwami_ray* rays, size_t ray_stride,
                                                        kiwami_hit* hits, size_t hit_stride,
                                                        size_t count, kiwami_binary_visits* visits);

#ifdef __cplusplus
}
#endif

#endif

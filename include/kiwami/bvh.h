/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: trees to look at: the nodes and primitives of an acceleration structure as plain arrays.
 */
#ifndef KIWAMI_BVH_H
#define KIWAMI_BVH_H

#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A reference-counted handle of a tree. It never changes, and holds its device. */
typedef struct kiwami_bvh kiwami_bvh;

/* A node, or a leaf. Nodes are numbered breadth first: node 0 is the root, the children of a node
 * stand side by side, after it, in the order of its slots. Where several parents share one stored
 * node or leaf block (KIWAMI_PARAMETER_MERGE_LEAVES), each part that one parent owns is a node of
 * its own here, so that every node has one parent. 56 bytes, at any address. */
typedef struct kiwami_bvh_node {
  float lower[3], upper[3]; /* its box, in the coordinates of the primitives. It lies within the box
                             * of its parent and contains the boxes of its primitives. The stored
                             * boxes are rounded outwards: it may be larger than needed by a few
                             * units in the last place of the scene's extent. */
  uint32_t parent;          /* KIWAMI_INVALID_ID for the root */
  uint32_t depth;           /* how many ancestors it has; 0 for the root */
  uint32_t first_child;     /* its children are first_child .. first_child + child_count - 1; */
  uint32_t child_count;     /* both 0 for a leaf */
  uint32_t first_primitive; /* the primitives at and below it are first_primitive .. first_primitive
                             * + primitive_count - 1 of kiwami_bvh_get_primitives */
  uint32_t primitive_count;
  uint32_t storage_index; /* the number of the stored node, or of a leaf's block of primitives, */
  uint32_t storage_mask;  /* and bit (1 << i) for each of its slots (lanes) i that it owns */
} kiwami_bvh_node;

/* Names a primitive as hits do. 8 bytes, at any address. */
typedef struct kiwami_bvh_primitive {
  uint32_t geometry_id;
  uint32_t primitive_id;
} kiwami_bvh_primitive;

/* The numbers of a tree. */
typedef struct kiwami_bvh_info {
  uint32_t struct_size;     /* set by the caller to sizeof(kiwami_bvh_info) */
  uint32_t width;           /* the most children that a node may have */
  uint32_t leaf_width;      /* the most primitives that a leaf may own */
  uint32_t depth;           /* the greatest depth of a node */
  uint32_t node_count;      /* nodes and leaves; 0 for a tree of nothing */
  uint32_t leaf_count;      /* how many of them are leaves */
  uint32_t primitive_count; /* entries of kiwami_bvh_get_primitives */
  uint32_t reserved;        /* 0 */
  uint64_t bytes;           /* memory that the handle holds */
} kiwami_bvh_info;

/* Gives the wide tree of a committed scene, as the kernels traverse it.
 *   bvh       receives a handle, with one reference, or NULL on error. It shows the tree of the
 *             last commit, also after the scene has gone or was committed again.
 *   errors    INVALID_ARGUMENT: NULL; INVALID_STATE: never committed; TOO_LARGE: more than
 *             2^32 - 2 nodes; OUT_OF_MEMORY
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_get_bvh(const kiwami_scene* scene, kiwami_bvh** bvh);

/* Adds a reference. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_bvh_retain(kiwami_bvh* bvh);

/* Drops a reference; the last one ends the tree. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_bvh_release(kiwami_bvh* bvh);

/* Says what a tree is made of.
 *   info      struct_size set by the caller; the fields that fit are filled
 *   errors    INVALID_ARGUMENT: bvh or info is NULL, or struct_size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_get_info(const kiwami_bvh* bvh, kiwami_bvh_info* info);

/* Copies nodes.
 *   first     the number of the first node
 *   count     how many; first + count is at most the node_count of the tree
 *   nodes     receives count nodes, stride bytes apart (0: sizeof(kiwami_bvh_node)); NULL only if
 *             count is 0
 *   errors    INVALID_ARGUMENT: NULL, nodes that the tree does not have, a stride too small, an
 *             extent that overflows
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_get_nodes(const kiwami_bvh* bvh, size_t first, size_t count,
                                              kiwami_bvh_node* nodes, size_t stride);

/* Copies names of primitives, in the order of the tree: those of a node follow each other.
 *   first       the number of the first one
 *   count       how many; first + count is at most the primitive_count of the tree
 *   primitives  receives count names, stride bytes apart (0: sizeof(kiwami_bvh_primitive)); NULL
 *               only if count is 0
 *   errors      as kiwami_bvh_get_nodes
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_get_primitives(const kiwami_bvh* bvh, size_t first,
                                                   size_t count, kiwami_bvh_primitive* primitives,
                                                   size_t stride);

#ifdef __cplusplus
}
#endif

#endif

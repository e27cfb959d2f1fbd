/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: trees to look at, of scenes and over boxes or triangles of the caller: nodes and
 * primitives as plain arrays, what they cost by the metrics of the field, and how many of them rays
 * visit.
 */
#ifndef KIWAMI_BVH_H
#define KIWAMI_BVH_H

#include "trace.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A reference-counted handle of a tree. It holds its device. Only kiwami_bvh_refit changes it. */
typedef struct kiwami_bvh kiwami_bvh;

/* A node, or a leaf. Nodes are numbered breadth first: node 0 is the root, the children of a node
 * stand side by side, after it, in the order of its slots. Where several parents share one stored
 * node or leaf block (KIWAMI_PARAMETER_MERGE_LEAVES), each part that one parent owns is a node of
 * its own here, so that every node has one parent. 56 bytes, at any address. */
typedef struct kiwami_bvh_node {
  float lower[3], upper[3]; /* its box, in the coordinates of the primitives. It lies within the box
                             * of its parent and contains the boxes of its primitives; of those that
                             * stand in several leaves (spatial splits) the parts that it is there
                             * for. The stored boxes of scenes are rounded outwards: they may be
                             * larger than needed by a few units in the last place of the scene's
                             * extent. */
  uint32_t parent;          /* KIWAMI_INVALID_ID for the root */
  uint32_t depth;           /* how many ancestors it has; 0 for the root */
  uint32_t first_child;     /* its children are first_child .. first_child + child_count - 1; */
  uint32_t child_count;     /* both 0 for a leaf */
  uint32_t first_primitive; /* the primitives at and below it are first_primitive .. first_primitive
                             * + primitive_count - 1 of kiwami_bvh_get_primitives */
  uint32_t primitive_count;
  uint32_t storage_index; /* the number of the stored node, or of a leaf's block of primitives, */
  uint32_t storage_mask;  /* and bit (1 << i) for each of its slots (lanes) i that it owns. In trees
                           * of kiwami_bvh_build, which share nothing: its number among the nodes
                           * with children (the leaves), and as many bits as it has children
                           * (primitives). */
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
  uint64_t skipped_count;   /* primitives left out for a coordinate that is NaN, infinite or out of
                             * range, or a lower bound above the upper one */
  double build_seconds;     /* wall-clock time of the build (of the scene's commit) */
} kiwami_bvh_info;

/* The value of one of KIWAMI_PARAMETER_* (scene.h). */
typedef struct kiwami_parameter_value {
  uint32_t parameter;
  uint32_t reserved; /* 0 */
  double value;
} kiwami_parameter_value;

/* What kiwami_bvh_build is to build: a tree over boxes, or over the triangles of a mesh. */
typedef struct kiwami_bvh_desc {
  uint32_t struct_size; /* bytes of this struct, set by kiwami_bvh_desc_init */
  uint32_t width;       /* the most children of a node: 2 (the binary tree that builders make and
                         * optimisers change), 4, 8 or 16; 0: the device's default */
  const void* boxes;    /* six floats a box: the lower x, y, z, the upper x, y, z; at any address.
                         * Box i is primitive i of geometry 0. NULL only if box_count is 0. Copied. */
  uint64_t box_stride;  /* bytes from one box to the next, at least 24; 0: 24 */
  uint64_t box_count;   /* at most 2^31 - 1 */
  kiwami_geometry* geometry; /* in place of boxes: a mesh of the device, which the tree holds as its
                              * geometry 0. NULL: boxes */
  /* How to build: builder, contraction, leaf size, bins and costs, with the bounds and defaults of
   * kiwami_parameter_bounds; what is not named has its default. Not BVH_WIDTH, for which there is
   * width. A MAX_LEAF_SIZE of 0 is 4 in binary trees; parameters of merging mean nothing here.
   * QUALITY sets the builder and the contraction alone: the optimisers are those named below.
   * Copied; NULL only if parameter_count is 0. */
  const kiwami_parameter_value* parameters;
  uint64_t parameter_count;
  const uint32_t* optimizers; /* KIWAMI_OPTIMIZER_*, run in this order on the binary tree. Copied;
                               * NULL only if optimizer_count is 0. Those that order the wide tree
                               * for any-hit rays have no effect here. */
  uint64_t optimizer_count;   /* at most KIWAMI_MAX_OPTIMIZERS */
} kiwami_bvh_desc;

/* What kiwami_bvh_measure may be told. */
typedef struct kiwami_bvh_measure_desc {
  uint32_t struct_size; /* bytes of this struct, set by kiwami_bvh_measure_desc_init */
  uint32_t flags;       /* KIWAMI_MEASURE_* */
  double node_cost;     /* of visiting a node, 0 to 1e6; 1 */
  double leaf_cost;     /* of one test of a block of primitives, 0 to 1e6; 1 */
  uint32_t block_size;  /* primitives that one test takes at once; 0: the tree's leaf_width, so that
                         * each leaf is one test */
  uint32_t reserved;    /* 0 */
} kiwami_bvh_measure_desc;

enum {
  /* Leave out the end-point overlap, the one metric that is not cheap. */
  KIWAMI_MEASURE_WITHOUT_EPO = 1u << 0
};

/* The cost of a tree. C is the cost of a node: node_cost, or leaf_cost times the tests of a leaf.
 */
typedef struct kiwami_bvh_measures {
  uint32_t struct_size; /* set by the caller to sizeof(kiwami_bvh_measures) */
  uint32_t reserved;    /* 0 */
  double sah;       /* the surface area heuristic: the sum of C * area of the node's box, over the
                     * area of the root's box; the plain sum of C if that has none. The cost of
                     * a random line that meets the root. */
  double epo;       /* the end-point overlap: the sum of C * surface of other primitives within
                     * the node's box, over all surface. What rays pay to end among boxes that
                     * overlap. 0 if it was left out, and for trees without triangles. */
  double node_area; /* the sum of the areas of the nodes that have children, over the root's; their
                     * number if the root has none */
  double leaf_area; /* the same of the leaves */
  double surface_area; /* of all triangles; 0 if the end-point overlap was left out */
} kiwami_bvh_measures;

/* What one node adds. The sums over all nodes are those of kiwami_bvh_measures. 24 bytes, at any
 * address. */
typedef struct kiwami_bvh_node_measures {
  double area; /* of its box */
  double sah;
  double epo;
} kiwami_bvh_node_measures;

/* What rays visited. */
typedef struct kiwami_visits {
  uint32_t struct_size;          /* set by the caller to sizeof(kiwami_visits) */
  uint32_t reserved;             /* 0 */
  uint64_t ray_count;            /* rays that were traced, bad ones included */
  uint64_t hit_count;            /* rays that hit something */
  uint64_t node_visits;          /* wide nodes, of all rays */
  uint64_t leaf_visits;          /* leaf blocks, of all rays */
  double leaf_count_variability; /* the standard deviation of the leaf blocks that a ray visits */
} kiwami_visits;

/* What one ray visited. 8 bytes, at any address. */
typedef struct kiwami_ray_visits {
  uint32_t node_visits;
  uint32_t leaf_visits;
} kiwami_ray_visits;

/* What rays look for while they are counted. */
enum { KIWAMI_COUNT_CLOSEST_HIT = 0, KIWAMI_COUNT_ANY_HIT = 1 };

/* Gives the wide tree of a committed scene, as the kernels traverse it.
 *   bvh       receives a handle, with one reference, or NULL on error. It shows the tree of the
 *             last commit, also after the scene has gone or was committed again.
 *   errors    INVALID_ARGUMENT: NULL; INVALID_STATE: never committed; TOO_LARGE: more than
 *             2^32 - 2 nodes; OUT_OF_MEMORY
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_get_bvh(const kiwami_scene* scene, kiwami_bvh** bvh);

/* Fills *desc with the defaults: no boxes, no geometry, the device's width and the defaults of all
 * parameters.
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_desc_init(kiwami_bvh_desc* desc, size_t size);

/* Builds a tree, on the device's threads. The tree does not depend on their number. Primitives with
 * a coordinate that is NaN, infinite or beyond KIWAMI_MAX_COORDINATE, and boxes with a lower bound
 * above the upper one, are left out and counted.
 *   bvh       receives the handle, with one reference, or NULL on error
 *   errors    INVALID_ARGUMENT: NULL, a field of desc, a parameter or its value, an optimizer, a
 *             geometry of another device, boxes and a geometry at once, a builder or an optimizer
 *             that needs triangles or a binary tree that there is not; TOO_LARGE: a count beyond
 *             its limit; OUT_OF_MEMORY; CALLBACK: the runner failed; VALIDATION:
 *             KIWAMI_PARAMETER_VALIDATE_BUILD found a broken invariant
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_build(kiwami_device* device, const kiwami_bvh_desc* desc,
                                          kiwami_bvh** bvh);

/* Moves the boxes of a tree after its primitives have moved; its shape stays. Primitives that stand
 * in several leaves (spatial splits) get their whole box in each.
 *   boxes     the boxes of all primitives, as many and in the order of kiwami_bvh_build, those that
 *             were left out then included; stride bytes apart (0: 24). NULL for a tree over a mesh,
 *             whose vertices are read anew (see kiwami_triangle_mesh_update_vertices).
 *   count     the number of boxes; 0 for a tree over a mesh
 *   errors    INVALID_ARGUMENT: NULL, a wrong count, a stride too small, a primitive of the tree
 *             that is out of range now (the tree stays as it was); INVALID_STATE: a tree of a
 *             scene; OUT_OF_MEMORY; CALLBACK: the runner failed
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_refit(kiwami_bvh* bvh, const void* boxes, size_t stride,
                                          size_t count);

/* Checks every invariant of a tree: parents, children and depths, runs of primitives, boxes around
 * all that is below them, each primitive in a leaf.
 *   errors    INVALID_ARGUMENT: bvh is NULL; VALIDATION: the sentence of kiwami_last_error names
 *             the node; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_validate(const kiwami_bvh* bvh);

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

/* Fills *desc with the defaults: costs of 1, one test a leaf, all metrics.
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_measure_desc_init(kiwami_bvh_measure_desc* desc, size_t size);

/* Measures a tree, on the device's threads. The numbers do not depend on how many there are.
 *   desc      NULL for the defaults
 *   measures  struct_size set by the caller; the fields that fit are filled. May be NULL.
 *   nodes     receives what each node adds, node_count elements stride bytes apart (0:
 *             sizeof(kiwami_bvh_node_measures)), in the order of kiwami_bvh_get_nodes. May be NULL.
 *   errors    INVALID_ARGUMENT: bvh is NULL, a field of desc, struct_size below 8, a stride too
 *             small; OUT_OF_MEMORY; CALLBACK: the runner failed
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_measure(const kiwami_bvh* bvh,
                                            const kiwami_bvh_measure_desc* desc,
                                            kiwami_bvh_measures* measures,
                                            kiwami_bvh_node_measures* nodes, size_t stride);

/* Traces rays by kernels that count, each ray alone, on the device's threads. The answers are those
 * of kiwami_closest_hit (kiwami_any_hit), but the visits are not the same on every ISA, and packets
 * of rays make fewer.
 *   rays      count rays, ray_stride bytes apart (0: sizeof(kiwami_ray)); NULL only if count is 0
 *   query     KIWAMI_COUNT_*
 *   visits    struct_size set by the caller; the fields that fit are filled. May be NULL.
 *   each      receives what each ray visited, count elements each_stride bytes apart (0:
 *             sizeof(kiwami_ray_visits)). May be NULL.
 *   errors    INVALID_ARGUMENT: NULL, an unknown query, struct_size below 8, a stride too small;
 *             INVALID_STATE: never committed; OUT_OF_MEMORY; CALLBACK: the runner failed
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_count_visits(const kiwami_scene* scene,
                                                   const kiwami_ray* rays, size_t ray_stride,
                                                   size_t count, uint32_t query,
                                                   kiwami_visits* visits, kiwami_ray_visits* each,
                                                   size_t each_stride);

#ifdef __cplusplus
}
#endif

#endif

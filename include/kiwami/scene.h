/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: scenes: geometries under one acceleration structure.
 */
#ifndef KIWAMI_SCENE_H
#define KIWAMI_SCENE_H

#include "geometry.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A reference-counted handle. It holds its device and its attached geometries. */
typedef struct kiwami_scene kiwami_scene;

/* See trace.h. */
struct kiwami_ray;

/* Tells how far a commit is: a fraction from 0 to 1, an estimate that never falls; 0 comes first
 * and, where the commit succeeds, 1 last. Called by the thread that commits and by the device's
 * threads (those of its runner), never by two at a time; the others go on meanwhile. It may call
 * anything but what names the scene that is being committed.
 *   user      as it was given to kiwami_scene_set_progress
 *   returns   0 to go on, any other number to cancel */
typedef int32_t (*kiwami_progress)(void* user, double fraction);

/* What can be tuned, by kiwami_scene_set_parameter. The numbers are pinned; new ones are added,
 * with gaps between them. */
enum {
  KIWAMI_PARAMETER_BVH_WIDTH = 1,      /* 4, 8 or 16 children a node; 0: the device's default */
  KIWAMI_PARAMETER_MERGE_LEAVES = 2,   /* 1: bottom nodes and leaf blocks are shared by masks; 0 */
  KIWAMI_PARAMETER_MERGE_RING = 3,     /* how many open nodes the merging chooses among, 1 to 64 */
  KIWAMI_PARAMETER_BIN_COUNT = 4,      /* bins of the surface area heuristic, 4 to 32 */
  KIWAMI_PARAMETER_MAX_LEAF_SIZE = 5,  /* triangles a leaf, 1 to 16; 0: one full leaf block */
  KIWAMI_PARAMETER_NODE_COST = 6,      /* cost of visiting a node, 0.01 to 100 */
  KIWAMI_PARAMETER_LEAF_COST = 7,      /* cost of testing a leaf block, 0.01 to 100 */
  KIWAMI_PARAMETER_VALIDATE_BUILD = 8, /* 1: commit runs the validator after each stage; 0 */
  KIWAMI_PARAMETER_CONTRACTION = 9,    /* how nodes of two children become wide:
                                        * KIWAMI_CONTRACTION_* */
  KIWAMI_PARAMETER_BUILDER = 10,       /* how the tree of two children a node is made:
                                        * KIWAMI_BUILDER_* */
  KIWAMI_PARAMETER_SPLIT_BUDGET = 11,  /* spatial splits: places in leaves beyond one a triangle, at
                                        * most this part of the triangles, 0 to 4 */
  KIWAMI_PARAMETER_SPLIT_ALPHA = 12,   /* spatial splits: only where boxes overlap by more than this
                                        * part of the root's area, 0 to 1 */
  KIWAMI_PARAMETER_BIN_HALVING = 13,   /* binned SAH: every so many levels the bins are halved, down
                                        * to 8, 1 to 32; 0: never */
  KIWAMI_PARAMETER_REASSIGN = 14,    /* binned SAH: 1: what a split's plane cuts goes to the cheaper
                                      * side; 0: to that of its centroid */
  KIWAMI_PARAMETER_AAC_QUALITY = 17, /* KIWAMI_BUILDER_AAC: 1: high, in larger cells; 0: fast */
  KIWAMI_PARAMETER_CURVE_CODE = 18,  /* LBVH, PLOC, AAC, WIDE_BOTTOM_UP: 0: plain Morton codes; 1:
                                      * extended ones, by the shape of the scene and the size of
                                      * boxes */
  KIWAMI_PARAMETER_LBVH_DELTA = 19,  /* neighbours are parted 0: by codes; 1: by surface area */
  KIWAMI_PARAMETER_LBVH_CHUNK_SIZE = 20, /* neighbours that a leaf begins with at most, 1 to 16 */
  KIWAMI_PARAMETER_LAYOUT = 21,          /* what leaves hold of triangles: KIWAMI_LAYOUT_* */
  KIWAMI_PARAMETER_QUALITY = 30, /* KIWAMI_QUALITY_*: sets builder, optimisers and contraction at
                                  * once; what is set after it replaces its part */
  KIWAMI_PARAMETER_REBRAID = 40, /* whether the tree over instances holds parts of them:
                                  * KIWAMI_REBRAID_* */
  KIWAMI_PARAMETER_REBRAID_BUDGET = 41, /* re-braiding: places in leaves beyond one an instance, at
                                         * most this part of the instances, 0 to 64 */
  KIWAMI_PARAMETER_TWO_LEVEL = 42, /* 1: each mesh has a tree of its own, under a tree over these; a
                                    * commit builds (a refit moves) the trees of meshes that have
                                    * changed, alone, as kiwami_triangle_mesh_update_vertices,
                                    * kiwami_geometry_set_mask and kiwami_scene_replace tell. The
                                    * answers are the same; they come more slowly. 0: one tree */
  KIWAMI_PARAMETER_DIVIDE_TIME = 43 /* 1: what moves has boxes for the halves of a segment of time
                                     * where that pays (the default); 0: for whole segments alone */
};

/* Re-braiding: where instances overlap, their scenes' trees are opened, so that the tree over the
 * instances keeps apart what is below. It decides how quickly rays are traced, never an answer. */
enum {
  KIWAMI_REBRAID_OFF = 0,  /* the default */
  KIWAMI_REBRAID_FULL = 1, /* as deep as the budget allows */
  KIWAMI_REBRAID_ROOTS = 2 /* the roots of the trees alone */
};

/* What the leaves of a committed scene hold of its triangle meshes, by KIWAMI_PARAMETER_LAYOUT. The
 * answers are the same. */
enum {
  KIWAMI_LAYOUT_FAST = 0,   /* vertices and numbers, 40 bytes a triangle; the default */
  KIWAMI_LAYOUT_COMPACT = 1 /* numbers alone, 4 bytes a triangle: rays read the meshes' buffers,
                             * shared or copied */
};

/* The stages of a build that have several methods. */
enum {
  KIWAMI_STAGE_BUILDER = 1,    /* primitives to a binary tree, by KIWAMI_PARAMETER_BUILDER */
  KIWAMI_STAGE_OPTIMIZER = 2,  /* changes to the binary or the wide tree, by
                                * kiwami_scene_set_optimizers */
  KIWAMI_STAGE_CONTRACTION = 3 /* binary tree to wide tree, by KIWAMI_PARAMETER_CONTRACTION */
};

/* Named points of the pipeline, by KIWAMI_PARAMETER_QUALITY; kiwami_quality_methods tells what they
 * stand for. */
enum {
  KIWAMI_QUALITY_BALANCED = 0, /* the default: a good tree soon */
  KIWAMI_QUALITY_FAST = 1,     /* the soonest */
  KIWAMI_QUALITY_BEST = 2      /* for scenes that are built once and traced for long */
};

/* Methods by stage. The numbers are pinned; kiwami_method_name gives the name of each. */
enum {
  KIWAMI_BUILDER_BINNED_SAH = 0,     /* top-down by the surface area heuristic over bins */
  KIWAMI_BUILDER_LBVH = 1,           /* along a Morton curve, by the cells that codes share */
  KIWAMI_BUILDER_PLOC = 2,           /* along a Morton curve, nearest neighbours join */
  KIWAMI_BUILDER_SWEEP_SAH = 3,      /* top-down by the surface area heuristic over all positions */
  KIWAMI_BUILDER_SPATIAL_SPLIT = 4,  /* binned, and triangles are cut where boxes would overlap */
  KIWAMI_BUILDER_AGGLOMERATIVE = 5,  /* of all pairs of clusters the nearest one joins first */
  KIWAMI_BUILDER_AAC = 6,            /* the same within the cells of a Morton curve */
  KIWAMI_BUILDER_MINI_TREE = 7,      /* small trees by sweeping, and one over all of them */
  KIWAMI_BUILDER_OIBVH = 8,          /* the complete tree along a Morton curve */
  KIWAMI_BUILDER_WIDE_BOTTOM_UP = 9, /* as PLOC within blocks, straight to the wide tree: there is
                                      * no binary tree to optimise, and contractions have no say */
  KIWAMI_BUILDER_STR = 10,   /* the tiles of a sort along each axis, as R-trees are packed */
  KIWAMI_BUILDER_TRBVH = 11, /* LBVH, its treelets restructured */
  KIWAMI_BUILDER_WIDE_TOP_DOWN = 12, /* as BINNED_SAH, but straight to the wide tree, unless an
                                      * optimiser of binary trees or another contraction than
                                      * OPTIMAL asks for a binary one */
  KIWAMI_BUILDER_WIDE_LINEAR = 13,   /* as LBVH by extended codes, straight to the wide tree, unless
                                      * the same; the quickest of all */
  KIWAMI_BUILDER_TRIAL = 14          /* BINNED_SAH and PLOC, with the optimisers of binary trees;
                                      * the tree stays that representative rays visit less */
};
enum {
  KIWAMI_OPTIMIZER_PARALLEL_REINSERTION = 1,  /* subtrees move to where the area shrinks most */
  KIWAMI_OPTIMIZER_ROTATION = 2,              /* near relatives change places */
  KIWAMI_OPTIMIZER_TREELET = 3,               /* the tops of subtrees get the shape of least cost */
  KIWAMI_OPTIMIZER_AGGLOMERATIVE_TREELET = 4, /* larger tops, joined from the nearest parts */
  KIWAMI_OPTIMIZER_REINSERTION = 5,  /* wasteful nodes one by one, the best place for each */
  KIWAMI_OPTIMIZER_REORDER_SATO = 6, /* for any-hit rays: large children first */
  KIWAMI_OPTIMIZER_REORDER_NARY = 7  /* for any-hit rays: children first that stop most rays
                                      * for their cost */
};
enum {
  KIWAMI_CONTRACTION_SURFACE_AREA = 0,    /* the largest child is opened first */
  KIWAMI_CONTRACTION_OPTIMAL = 1,         /* the least cost of the whole tree */
  KIWAMI_CONTRACTION_RAY_DISTRIBUTION = 2 /* the least visits of representative rays */
};

enum { KIWAMI_MAX_OPTIMIZERS = 8 };

/* What a committed scene is made of. Counts are of the acceleration structure of the triangles that
 * are not in instances, unless they say otherwise; what instances show belongs to other scenes. */
typedef struct kiwami_scene_info {
  uint32_t struct_size;      /* set by the caller to sizeof(kiwami_scene_info) */
  uint32_t bvh_width;        /* children a node */
  uint32_t leaf_width;       /* triangles a leaf block */
  uint32_t bvh_depth;        /* nodes on the longest path from the root to a leaf */
  uint64_t triangle_count;   /* triangles that can be hit */
  uint64_t skipped_count;    /* triangles removed for a NaN, infinite or out-of-range vertex */
  uint64_t node_count;       /* wide nodes */
  uint64_t leaf_block_count; /* leaf blocks */
  uint64_t node_bytes;
  uint64_t leaf_bytes;
  uint64_t total_bytes;      /* everything the committed structure holds, the caller's shared
                              * buffers aside, copied buffers included */
  uint64_t peak_build_bytes; /* the most that the last commit held at once, total_bytes included */
  double node_fill;          /* used node slots / all node slots, 0 to 1 */
  double leaf_fill;          /* used leaf lanes / all leaf lanes, 0 to 1 */
  double sah_cost;           /* surface area heuristic of the wide tree, relative to the root */
  double build_seconds;      /* wall-clock time of the last commit */
  float bounds_min[3]; /* of all that can be hit, also in instances; +inf when there are none */
  float bounds_max[3]; /* -inf when there are none */
  uint64_t reference_count;     /* places of triangles in leaves: triangle_count, or more where a
                                 * builder divides space or triangles have vanished since the build */
  uint64_t refit_count;         /* commits since the last build that kept its tree */
  uint64_t instance_count;      /* instances of all geometries */
  uint64_t instance_tree_bytes; /* of the tree over the instances, in total_bytes as well */
  uint32_t instance_depth;      /* instances on the longest path to a triangle; 0: none */
  uint32_t reserved;            /* 0 */
} kiwami_scene_info;

/* Makes an empty scene, which must be committed before it is traced.
 *   scene     receives the handle, with one reference, or NULL on error
 *   errors    INVALID_ARGUMENT: device or scene is NULL; OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_create(kiwami_device* device, kiwami_scene** scene);

/* Adds a reference. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_scene_retain(kiwami_scene* scene);

/* Drops a reference; the last one ends the scene. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_scene_release(kiwami_scene* scene);

/* Attaches a geometry; the scene holds a reference to it. Takes effect with the next commit.
 *   geometry_id   receives the number that hits report: the lowest that is free. May be NULL.
 *   errors        INVALID_ARGUMENT: NULL, a geometry of another device, or instances that show the
 *                 scene itself, directly or through others; OUT_OF_MEMORY
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_attach(kiwami_scene* scene, kiwami_geometry* geometry,
                                             uint32_t* geometry_id);

/* Detaches a geometry and frees its number. Takes effect with the next commit; until then the
 * committed scene still holds it and hits still report it.
 *   errors    INVALID_ARGUMENT: no geometry has this number
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_detach(kiwami_scene* scene, uint32_t geometry_id);

/* Puts another geometry in the place of an attached one, under the same number. Takes effect with
 * the next commit, or refit where it has as many triangles.
 *   errors    as of kiwami_scene_attach; INVALID_ARGUMENT: no geometry has this number
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_replace(kiwami_scene* scene, uint32_t geometry_id,
                                              kiwami_geometry* geometry);

/* Leaves a geometry out of the next commits (is_enabled 0) or takes it in again (any other number;
 * so are all at first). It stays attached and keeps its number.
 *   errors    INVALID_ARGUMENT: scene is NULL, or no geometry has this number
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_enable(kiwami_scene* scene, uint32_t geometry_id,
                                             int32_t is_enabled);

/* Sets one of KIWAMI_PARAMETER_*. Takes effect with the next commit.
 *   errors    INVALID_ARGUMENT: scene is NULL, an unknown parameter, a value outside its bounds
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_set_parameter(kiwami_scene* scene, uint32_t parameter,
                                                    double value);

/* The bounds (both allowed) and the default of one of KIWAMI_PARAMETER_*. Each pointer may be NULL.
 *   errors    INVALID_ARGUMENT: an unknown parameter
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_parameter_bounds(uint32_t parameter, double* lowest,
                                                 double* highest, double* preset);

/* Sets rays that stand for those which the scene will be asked for. The next commits use them where
 * a method goes by rays: KIWAMI_OPTIMIZER_REORDER_NARY, which takes them as rays that look for any
 * hit, and KIWAMI_CONTRACTION_RAY_DISTRIBUTION, which takes them as rays that look for the closest
 * hit. Without any, rays from surfaces are sampled. Some ten thousand are enough. They decide how
 * quickly a tree is traced, never an answer.
 *   rays      count rays, stride bytes apart (0: sizeof(kiwami_ray)), copied; NULL only if count is
 *             0. Their origins, directions, tmin and tmax are used; those that can hit nothing (see
 *             trace.h) are left out
 *   count     0: none, the default
 *   errors    INVALID_ARGUMENT: scene or rays is NULL, or stride is too small; OUT_OF_MEMORY
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_set_representative_rays(kiwami_scene* scene,
                                                              const struct kiwami_ray* rays,
                                                              size_t stride, size_t count);

/* Sets which optimisers the next commit runs: those that act on the binary tree one after the
 * other, and, when it has become wide, those that act on the wide tree.
 *   methods   count numbers of KIWAMI_OPTIMIZER_*, copied; NULL only if count is 0
 *   count     at most KIWAMI_MAX_OPTIMIZERS; 0: none. Those of KIWAMI_QUALITY_BALANCED are set
 *             before the first call
 *   errors    INVALID_ARGUMENT: scene or methods is NULL, count is too large, or a number is no
 *             optimiser's
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_set_optimizers(kiwami_scene* scene, const uint32_t* methods,
                                                     size_t count);

/* The methods that a KIWAMI_QUALITY_* stands for. Each pointer may be NULL.
 *   optimizers        receives at most KIWAMI_MAX_OPTIMIZERS numbers, in their order
 *   optimizer_count   receives how many there are
 *   errors            INVALID_ARGUMENT: an unknown quality
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_quality_methods(uint32_t quality, uint32_t* builder,
                                                uint32_t* optimizers, size_t* optimizer_count,
                                                uint32_t* contraction);

/* The lower-case name of a method of one KIWAMI_STAGE_* ("binned_sah"), or NULL where no method has
 * the number. Numbers are below 256. Static text. [any thread]; since 0.1 */
KIWAMI_API const char* kiwami_method_name(uint32_t stage, uint32_t method);

/* Sets who is told how far the next commits and refits of the scene are, and may cancel them. A
 * commit that is cancelled returns KIWAMI_ERROR_CANCELLED, soon: no task begins any more; a method
 * that runs on one thread (such as KIWAMI_OPTIMIZER_REINSERTION) ends first. As after every error,
 * the last committed structure stays in use, the scene can be edited, and nothing is left of the
 * commit.
 *   function   NULL: nobody, the default
 *   user       handed to function as it is
 *   errors     INVALID_ARGUMENT: scene is NULL
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_set_progress(kiwami_scene* scene, kiwami_progress function,
                                                   void* user);

/* Builds the acceleration structure over the attached geometries, on the device's threads. On
 * error the last committed structure stays in use.
 *   errors    INVALID_ARGUMENT: a shared index buffer now holds an index at or beyond its vertex
 *             count; TOO_LARGE: more than 2^32 - 2 triangles; OUT_OF_MEMORY; CALLBACK: the runner
 *             failed; VALIDATION: KIWAMI_PARAMETER_VALIDATE_BUILD found a broken invariant
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_commit(kiwami_scene* scene);

/* Commits the scene as kiwami_scene_commit does, but keeps the tree where it can: it moves the
 * boxes of the last committed one, which is much sooner done than a build. The answers are those of
 * a build; the further things have moved against each other, the slower they come (sah_cost tells).
 *
 * It can where the tree was built (not loaded), all attached and enabled geometries are triangle
 * meshes that have the numbers and the triangle counts of the last commit, and no triangle can be
 * hit that could not be hit when the tree was built (nor, where leaves hold ids alone, the other
 * way round); else it builds. Vertices, indices and masks may be others; parameters that have
 * changed wait for the next commit. Triangles that can not be hit any more vanish, and come back when they
 * can. Primitives that stand in several leaves (spatial splits) get their whole box in each.
 *
 * From the first refit until the next commit the scene keeps the structure before the last one, to
 * write the next into it.
 *   errors    as kiwami_scene_commit; on error the last committed structure stays in use
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_refit(kiwami_scene* scene);

/* Says what the last commit made.
 *   info      struct_size set by the caller; the fields that fit are filled
 *   errors    INVALID_ARGUMENT: NULL, or struct_size below 8; INVALID_STATE: never committed
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_get_info(const kiwami_scene* scene, kiwami_scene_info* info);

/* Checks every invariant of the committed structure: each triangle in exactly one leaf (or, where a
 * builder divides space, in leaves that together cover it), each box
 * around all that is below it, each slot and lane owned once, references and depth in range.
 *   errors    INVALID_ARGUMENT: scene is NULL; INVALID_STATE: never committed; VALIDATION: the
 *             sentence of kiwami_last_error names the node; OUT_OF_MEMORY
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_scene_validate(const kiwami_scene* scene);

#ifdef __cplusplus
}
#endif

#endif

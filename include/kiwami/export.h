/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: trees for other tracers: nodes in the layouts that programs for CPUs and GPUs read.
 *
 * A tree of bvh.h becomes two arrays: nodes of one of the formats below, and the names of the
 * primitives in the order in which the leaves refer to them. Node 0 is the root. Numbers are in the
 * byte order of the machine. All boxes are in the coordinates of the primitives.
 */
#ifndef KIWAMI_EXPORT_H
#define KIWAMI_EXPORT_H

#include "bvh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Formats of nodes. The numbers and the layouts are pinned. */
enum {
  KIWAMI_EXPORT_BINARY = 1,     /* kiwami_binary_node: trees of width 2 */
  KIWAMI_EXPORT_WIDE4 = 2,      /* kiwami_wide4_node: trees of width 2 and 4 */
  KIWAMI_EXPORT_WIDE8 = 3,      /* kiwami_wide8_node: trees of width 2, 4 and 8 */
  KIWAMI_EXPORT_COMPRESSED8 = 4 /* kiwami_compressed8_node: the same, with leaves of at most 3 */
};

/* A node of two children, or a leaf. 32 bytes. */
typedef struct kiwami_binary_node {
  float lower[3];
  uint32_t first; /* count 0: the children are the nodes first and first + 1; otherwise the leaf's
                   * primitives are first .. first + count - 1 */
  float upper[3];
  uint32_t count;
} kiwami_binary_node;

/* The boxes of up to four children, by coordinate. 128 bytes. */
typedef struct kiwami_wide4_node {
  float lower_x[4], lower_y[4], lower_z[4];
  float upper_x[4], upper_y[4], upper_z[4]; /* of an empty slot: lower +inf, upper -inf */
  uint32_t child[4]; /* count 0: the number of a node, KIWAMI_INVALID_ID in an empty slot; otherwise
                      * the first primitive of a leaf */
  uint32_t count[4]; /* primitives of a leaf */
} kiwami_wide4_node;

/* The same for up to eight children. 256 bytes. */
typedef struct kiwami_wide8_node {
  float lower_x[8], lower_y[8], lower_z[8];
  float upper_x[8], upper_y[8], upper_z[8];
  uint32_t child[8];
  uint32_t count[8];
} kiwami_wide8_node;

/* Up to eight children whose boxes are counted in steps from the node's own corner: H. Ylitie, T.
 * Karras, S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG
 * 2017. 80 bytes.
 *
 * The lower x of the child in slot i is origin[0] + lower_x[i] * 2^(exponent[0] - 127), and so on:
 * the step's float has the bits exponent[0] << 23. Boxes are rounded outwards: what is decoded
 * contains the child's box, in real numbers and in floats, fused or not.
 *
 * Slots are in the order of octants: for a ray whose direction has the sign bits o = 4 * (x < 0) +
 * 2 * (y < 0) + (z < 0), the slots i by rising (i XOR o) are about in the order of distance. */
typedef struct kiwami_compressed8_node {
  float origin[3];         /* the lower corner of the node's box */
  uint8_t exponent[3];     /* of the step on each axis, biased by 127; at least 1 */
  uint8_t inner_mask;      /* bit (1 << i): the child in slot i is a node */
  uint32_t child_base;     /* its number: child_base + the number of bits of inner_mask below i */
  uint32_t primitive_base; /* where the primitives of this node's leaves begin */
  uint8_t meta[8];         /* 0: an empty slot; a node: 0x20 + 24 + i; a leaf: its offset from
                            * primitive_base in the lower five bits, and as many of the upper three
                            * bits, from the lowest, as it has primitives */
  uint8_t lower_x[8], lower_y[8], lower_z[8];
  uint8_t upper_x[8], upper_y[8], upper_z[8]; /* of an empty slot: lower 255, upper 0 */
} kiwami_compressed8_node;

/* How many nodes and primitives kiwami_bvh_export writes. A tree of nothing has none; a root that
 * is a leaf becomes the one child of a node in the wide formats. Each pointer may be NULL.
 *   errors    INVALID_ARGUMENT: bvh is NULL, an unknown format, a tree that does not fit into it:
 *             too wide, too many primitives in a leaf
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_export_counts(const kiwami_bvh* bvh, uint32_t format,
                                                  size_t* node_count, size_t* primitive_count);

/* Writes a tree in one of the formats.
 *   nodes            receives the nodes one after the other, at any address. NULL only if there are
 *                    none
 *   node_bytes       bytes that nodes has, at least those of all nodes
 *   primitives       receives the names of the primitives, at any address. NULL only if there are
 *                    none
 *   primitive_count  names that primitives has room for, at least as many as there are
 *   errors           as kiwami_bvh_export_counts; also INVALID_ARGUMENT: NULL, too little room;
 *                    OUT_OF_MEMORY
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_bvh_export(const kiwami_bvh* bvh, uint32_t format, void* nodes,
                                           size_t node_bytes, kiwami_bvh_primitive* primitives,
                                           size_t primitive_count);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: opacity micromaps: which parts of triangles rays pass through (leaves, hair cards,
 * fences), without a callback.
 */
#ifndef KIWAMI_OPACITY_H
#define KIWAMI_OPACITY_H

#include "geometry.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a micro-triangle is. */
enum {
  KIWAMI_OPACITY_TRANSPARENT = 0, /* no ray meets it */
  KIWAMI_OPACITY_OPAQUE = 1,      /* every ray does, and no filter is asked */
  /* The query's filter is asked; where it has none, it counts by its name. */
  KIWAMI_OPACITY_UNKNOWN_TRANSPARENT = 2,
  KIWAMI_OPACITY_UNKNOWN_OPAQUE = 3
};

/* How a map holds them. */
enum {
  KIWAMI_OPACITY_2_STATES = 1, /* one bit each: transparent or opaque */
  KIWAMI_OPACITY_4_STATES = 2  /* two bits each */
};

enum {
  KIWAMI_OPACITY_MAX_LEVEL = 6 /* 4096 micro-triangles */
};

/* In place of the number of a map: the whole triangle is in one state. */
#define KIWAMI_OPACITY_ALL_TRANSPARENT 0xFFFFFFFCu
#define KIWAMI_OPACITY_ALL_OPAQUE 0xFFFFFFFDu
#define KIWAMI_OPACITY_ALL_UNKNOWN_TRANSPARENT 0xFFFFFFFEu
#define KIWAMI_OPACITY_ALL_UNKNOWN_OPAQUE 0xFFFFFFFFu

/* clang-format off */
/* The maps of a mesh, each of 4^level micro-triangles. Lines at u, v and 1 - u - v = multiples of
 * 1/n, n = 2^level, divide a triangle abc into them. They are numbered by rows of rising v, and in
 * each row by rising u, upright ones and turned ones by turns. Level 1:
 *
 *      c
 *      |\           Row r has n - r upright ones, of which column i has the number 2i of the row,
 *      | \          and n - r - 1 turned ones, with the numbers 2i + 1. The rows before it hold
 *      |3 \         r (2n - r) together. So with r and i the whole parts of n v and n u, and f and g
 *      |---\        the rest, the micro-triangle at (u, v) is r (2n - r) + 2i + (f + g > 1 ? 1 : 0).
 *      |\ 1|\       What lies on a line belongs to the upper row, to the right column, to the upright
 *      |0\ |2\      one. kiwami_opacity_micro_triangle computes it.
 *      a-------b    Level 2: row 0 has 0 to 6, row 1 7 to 11, row 2 12 to 14, row 3 15.
 *
 * Micro-triangle m has the bits m * format to m * format + format - 1 of its map, from the lowest
 * bit of the first byte on. No alignment is asked for. */
/* clang-format on */
typedef struct kiwami_opacity_desc {
  uint32_t struct_size; /* bytes of this struct, set by kiwami_opacity_desc_init */
  uint32_t format;      /* KIWAMI_OPACITY_2_STATES or KIWAMI_OPACITY_4_STATES */
  uint32_t level;       /* 0 to KIWAMI_OPACITY_MAX_LEVEL */
  uint32_t reserved;    /* 0 */
  const void* maps;     /* may be NULL when map_count is 0 */
  uint64_t map_stride; /* bytes from one map to the next; 0: the bytes of one, 4^level * format / 8,
                        * at least 1 */
  uint64_t map_count;  /* at most 2^32 - 5 */
  const void* indices; /* uint32 for each triangle of the mesh: the number of its map, or one of
                        * KIWAMI_OPACITY_ALL_*; NULL: triangle i has map i */
  uint64_t index_stride; /* bytes from one to the next, at least 4; 0: 4 */
} kiwami_opacity_desc;

/* Fills *desc with the defaults: two states, level 0, no maps.
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_opacity_desc_init(kiwami_opacity_desc* desc, size_t size);

/* Gives a mesh opacity micromaps, of which it makes copies, or takes them away again. Scenes see it
 * with their next commit; until then they trace what they committed.
 *   mesh      a triangle mesh
 *   desc      NULL: no micromaps, all is opaque and subject to filters
 *   errors    INVALID_ARGUMENT: NULL, no triangle mesh, an unknown format or level, a stride too
 *             small, an index that is no map, an extent that overflows; TOO_LARGE: map_count;
 *             OUT_OF_MEMORY. The mesh stays as it was.
 * [one thread per object]; since 0.1 */
KIWAMI_API kiwami_result kiwami_triangle_mesh_set_opacity(kiwami_geometry* mesh,
                                                          const kiwami_opacity_desc* desc);

/* The number of the micro-triangle at (u, v), for those who fill maps or read them: as the library
 * finds it for a hit. What lies outside of the triangle goes to the nearest in its row; a level
 * beyond the greatest counts as that. [any thread]; since 0.1 */
KIWAMI_API uint32_t kiwami_opacity_micro_triangle(float u, float v, uint32_t level);

#ifdef __cplusplus
}
#endif

#endif

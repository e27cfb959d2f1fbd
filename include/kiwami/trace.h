/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: rays against a committed scene, in batches.
 *
 * Results are exact and the same to the bit on every ISA, node width and thread count:
 * - a hit counts when tmin <= t <= tmax; a distance beyond the greatest float is none;
 * - the closest hit is the least (t, instance, geometry, primitive);
 * - of two triangles that share an edge, exactly one owns it: no ray slips between neighbours, and
 *   none meets both;
 * - any hit is true exactly when there is a closest hit;
 * - a NaN in origin, direction, tmin or tmax, a zero or infinite direction, tmin > tmax, or an
 *   origin beyond KIWAMI_MAX_COORDINATE is a miss.
 */
#ifndef KIWAMI_TRACE_H
#define KIWAMI_TRACE_H

#include "instances.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  /* Ignore triangles seen from behind. A triangle is seen from its front when its vertices run
   * counter-clockwise: when its normal (b - a) x (c - a) points against the ray. */
  KIWAMI_RAY_CULL_BACK_FACES = 1u << 0,
  /* Ignore triangles seen from the front. */
  KIWAMI_RAY_CULL_FRONT_FACES = 1u << 1
};

/* A ray: the points origin + t * direction with tmin <= t <= tmax. The direction need not have
 * length 1. 48 bytes, at any address. */
typedef struct kiwami_ray {
  float origin_x, origin_y, origin_z;
  float tmin;
  float direction_x, direction_y, direction_z;
  float tmax;     /* may be infinite */
  float time;     /* 0 to 1; for geometries that move */
  uint32_t mask;  /* compared with the geometry's mask; a ray with mask 0 meets nothing */
  uint32_t flags; /* KIWAMI_RAY_* */
  uint32_t id;    /* the caller's own; not read */
} kiwami_ray;

/* The answer to a ray. 36 bytes, at any address. A miss has t = +inf, ids of KIWAMI_INVALID_ID and
 * zeros elsewhere. */
typedef struct kiwami_hit {
  float t;                            /* distance in units of the direction's length */
  float u, v;                         /* the point is (1 - u - v) a + u b + v c */
  float normal_x, normal_y, normal_z; /* (b - a) x (c - a), not normalised */
  uint32_t primitive_id;              /* the triangle's number in its mesh */
  uint32_t geometry_id;               /* the mesh's number in its scene */
  uint32_t instance_id;               /* KIWAMI_INVALID_ID outside instances */
} kiwami_hit;

/* One field of an array of rays: element i is at data + i * stride. A stride of 0 gives all rays
 * the same value. */
typedef struct kiwami_input_field {
  const void* data;
  uint64_t stride;
} kiwami_input_field;

/* One field of an array of answers: element i goes to data + i * stride, stride at least 4 when
 * there are several rays. data may be NULL: the field is not wanted. */
typedef struct kiwami_output_field {
  void* data;
  uint64_t stride;
} kiwami_output_field;

/* Rays whose fields lie apart (a struct of arrays, a NumPy array, columns of the caller's own
 * struct). */
typedef struct kiwami_ray_fields {
  uint32_t struct_size; /* bytes of this struct, set by kiwami_ray_fields_init */
  uint32_t reserved;    /* 0 */
  kiwami_input_field origin_x, origin_y, origin_z;          /* float */
  kiwami_input_field direction_x, direction_y, direction_z; /* float */
  kiwami_input_field tmin;                                  /* float; data NULL: 0 */
  kiwami_input_field tmax;                                  /* float; data NULL: +inf */
  kiwami_input_field time;                                  /* float; data NULL: 0 */
  kiwami_input_field mask;                                  /* uint32; data NULL: all ones */
  kiwami_input_field flags;                                 /* uint32; data NULL: 0 */
} kiwami_ray_fields;

/* Answers whose fields go apart; each may be left out. */
typedef struct kiwami_hit_fields {
  uint32_t struct_size;        /* bytes of this struct, set by kiwami_hit_fields_init */
  uint32_t reserved;           /* 0 */
  kiwami_output_field t, u, v; /* float */
  kiwami_output_field normal_x, normal_y, normal_z;           /* float */
  kiwami_output_field primitive_id, geometry_id, instance_id; /* uint32 */
} kiwami_hit_fields;

/* What a ray is not to meet: one triangle (or other primitive), such as the one that it leaves.
 * Laid out as the end of a kiwami_hit, so that {&hits->primitive_id, sizeof *hits} excludes what
 * was hit before. 12 bytes, at any address. */
typedef struct kiwami_exclusion {
  uint32_t primitive_id; /* KIWAMI_INVALID_ID: nothing is excluded */
  uint32_t geometry_id;
  uint32_t instance_id; /* the outermost instance; KIWAMI_INVALID_ID outside instances */
} kiwami_exclusion;

/* What a filter is asked about: a hit between tmin and tmax that masks, sides and exclusions leave.
 * It lives until the filter returns. */
typedef struct kiwami_filter_candidate {
  uint32_t struct_size; /* bytes of this struct, as the library knows it */
  uint32_t depth;       /* instances that lead to the hit */
  uint64_t ray;         /* the number of the ray in the call */
  kiwami_hit hit;
  uint32_t reserved;                                 /* 0 */
  uint32_t instance_path[KIWAMI_MAX_INSTANCE_DEPTH]; /* KIWAMI_INVALID_ID beyond the depth */
} kiwami_filter_candidate;

enum {
  KIWAMI_FILTER_REJECT = 0, /* the hit is none */
  KIWAMI_FILTER_ACCEPT = 1,
  KIWAMI_FILTER_ACCEPT_AND_STOP = 2 /* and nothing more is looked for along this ray */
};

/* Decides whether hits count: returns one of KIWAMI_FILTER_*, or a negative number when it failed:
 * the call then returns KIWAMI_ERROR_CALLBACK, as for any other number, and traces no further rays.
 * It is called on the thread that traces the ray: the caller's own, or those of the device, of
 * which several call it at once unless KIWAMI_QUERY_CALLING_THREAD is set. It must not throw, nor
 * change the floating-point state; it may trace rays, with KIWAMI_QUERY_CALLING_THREAD. */
typedef int32_t (*kiwami_filter_function)(void* user, const kiwami_filter_candidate* candidate);

/* What a trace call may be told beyond the rays. */
typedef struct kiwami_query {
  uint32_t struct_size; /* bytes of this struct, set by kiwami_query_init */
  uint32_t flags;       /* KIWAMI_QUERY_* */
  /* Receives the whole path of each closest hit: KIWAMI_MAX_INSTANCE_DEPTH uint32 a ray, the
   * numbers of the instances from the outermost on, KIWAMI_INVALID_ID beyond the depth of the hit
   * and for a miss. NULL: not wanted. With kiwami_multi_hit it has a path for each of the
   * hit_capacity hits. Not used by kiwami_any_hit nor kiwami_count_hits. */
  uint32_t* instance_paths;
  uint64_t instance_path_stride; /* bytes from one ray's path to the next; 0: 32 */
  /* What each ray is not to meet, exclusion_stride bytes apart (0: 12). NULL: nothing. */
  const kiwami_exclusion* exclusions;
  uint64_t exclusion_stride;
  /* The whole paths to what the rays are not to meet, as in instance_paths; then the instance_id of
   * an exclusion is not read. NULL: every path whose outermost instance it is. */
  const uint32_t* exclusion_paths;
  uint64_t exclusion_path_stride; /* 0: 32 */
  /* Decides whether hits count; NULL: all do. It is called at most once for each crossing of a ray
   * and a surface. A closest hit is the least one that the filter accepts, if what it says depends
   * on the candidate alone; which others it is asked about, and in which order, is not told. Calls
   * that find several hits ask it from front to back, about no more than it takes. */
  kiwami_filter_function filter;
  void* filter_user; /* handed to the filter */
} kiwami_query;

enum {
  /* Trace on the calling thread alone, however many rays there are. */
  KIWAMI_QUERY_CALLING_THREAD = 1u << 0
};

/* Fill a struct with its defaults: no fields; no flags, nothing more than the answers.
 *   size      sizeof the struct as the caller knows it
 *   errors    INVALID_ARGUMENT: the pointer is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_ray_fields_init(kiwami_ray_fields* rays, size_t size);
KIWAMI_API kiwami_result kiwami_hit_fields_init(kiwami_hit_fields* hits, size_t size);
KIWAMI_API kiwami_result kiwami_query_init(kiwami_query* query, size_t size);

/* Finds the closest hit of each ray.
 *   rays        count rays, ray_stride bytes apart (0: sizeof(kiwami_ray)); NULL only if count is 0
 *   hits        receives count answers, hit_stride bytes apart (0: sizeof(kiwami_hit)); may not
 *               overlap the rays
 *   query       NULL for the defaults
 * Large batches run on the device's threads, each ray's answer being the same as alone.
 *   errors      INVALID_STATE: the scene was never committed; INVALID_ARGUMENT: an unknown query
 *               flag; CALLBACK: the runner or the filter failed. With KIWAMI_DEVICE_VALIDATE also
 *               INVALID_ARGUMENT: NULL, a stride too small, an extent that overflows.
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_closest_hit(const kiwami_scene* scene, const kiwami_ray* rays,
                                            size_t ray_stride, kiwami_hit* hits, size_t hit_stride,
                                            size_t count, const kiwami_query* query);

/* Finds out of each ray whether it has a hit.
 *   occluded    receives count bytes, stride bytes apart (0: 1): 1 for a hit, 0 for none
 * Otherwise as kiwami_closest_hit. [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_any_hit(const kiwami_scene* scene, const kiwami_ray* rays,
                                        size_t ray_stride, uint8_t* occluded, size_t stride,
                                        size_t count, const kiwami_query* query);

/* As kiwami_closest_hit and kiwami_any_hit, with the fields of rays and answers apart.
 *   errors      also INVALID_ARGUMENT: the data of an origin or a direction is NULL with count > 0
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_closest_hit_fields(const kiwami_scene* scene,
                                                   const kiwami_ray_fields* rays,
                                                   const kiwami_hit_fields* hits, size_t count,
                                                   const kiwami_query* query);
KIWAMI_API kiwami_result kiwami_any_hit_fields(const kiwami_scene* scene,
                                               const kiwami_ray_fields* rays,
                                               const kiwami_output_field* occluded, size_t count,
                                               const kiwami_query* query);

/* Finds several hits of each ray, by rising (t, instance, geometry, primitive). A triangle that a
 * ray crosses is one hit, whatever tree the scene has; a segment with both ends outside of a closed
 * mesh has an even number of them.
 *   rays          count rays, ray_stride bytes apart (0: sizeof(kiwami_ray)); NULL only if count
 *                 is 0
 *   max_hits      of each ray, the nearest so many; 0: all
 *   hits          receives the hits of ray i at offsets[i] to offsets[i + 1] - 1, as far as they
 *                 fit: hit_capacity hits, tightly packed; may not overlap the rays; NULL only with
 *                 hit_capacity 0, when hits are only counted
 *   offsets       receives count + 1 numbers; the last one is the number of all hits
 *   query         NULL for the defaults
 * Large batches run on the device's threads; the answer does not depend on their number. Hits pass
 * through memory of the device, at most those of 16384 rays at a time.
 *   errors        CAPACITY: hit_capacity is below offsets[count] and not 0 with hits NULL; all
 *                 offsets, and all hits below hit_capacity, are written. OUT_OF_MEMORY: neither is
 *                 complete. INVALID_ARGUMENT: offsets is NULL, or hits with a hit_capacity;
 *                 otherwise as kiwami_closest_hit.
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_multi_hit(const kiwami_scene* scene, const kiwami_ray* rays,
                                          size_t ray_stride, size_t count, uint32_t max_hits,
                                          kiwami_hit* hits, uint64_t hit_capacity,
                                          uint64_t* offsets, const kiwami_query* query);

/* Counts the hits of each ray: as many as kiwami_multi_hit finds with max_hits 0.
 *   counts      receives count numbers, stride bytes apart (0: 4), at any address
 * Otherwise as kiwami_closest_hit. [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_count_hits(const kiwami_scene* scene, const kiwami_ray* rays,
                                           size_t ray_stride, uint32_t* counts, size_t stride,
                                           size_t count, const kiwami_query* query);

/* As kiwami_multi_hit and kiwami_count_hits, with the fields of rays and answers apart.
 *   hits        fields with room for hit_capacity hits; NULL only with hit_capacity 0
 *   errors      also INVALID_ARGUMENT: the data of an origin or a direction is NULL with count > 0
 * [any thread after commit]; since 0.1 */
KIWAMI_API kiwami_result kiwami_multi_hit_fields(const kiwami_scene* scene,
                                                 const kiwami_ray_fields* rays, size_t count,
                                                 uint32_t max_hits, const kiwami_hit_fields* hits,
                                                 uint64_t hit_capacity, uint64_t* offsets,
                                                 const kiwami_query* query);
KIWAMI_API kiwami_result kiwami_count_hits_fields(const kiwami_scene* scene,
                                                  const kiwami_ray_fields* rays,
                                                  const kiwami_output_field* counts, size_t count,
                                                  const kiwami_query* query);

#ifdef __cplusplus
}
#endif

#endif

/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: instances that move: motion blur of whole scenes.
 */
#ifndef KIWAMI_MOVING_INSTANCES_H
#define KIWAMI_MOVING_INSTANCES_H

#include "instances.h"
#include "moving_mesh.h" /* KIWAMI_MAX_TIME_STEPS */

#ifdef __cplusplus
extern "C" {
#endif

/* What a transform of a step is. */
typedef enum kiwami_transform_format {
  /* 12 floats, three rows of four. */
  KIWAMI_TRANSFORM_MATRIX = 0,
  /* A kiwami_quaternion_transform. */
  KIWAMI_TRANSFORM_QUATERNION = 1
} kiwami_transform_format;

/* A transform taken apart into a translation T, a rotation R and the rest S, so that a rotation
 * stays one between two steps. A point p of the scene goes to T + R (S p), with
 *       ( scale_x  skew_xy  skew_xz  shift_x )
 *   S = ( 0        scale_y  skew_yz  shift_y )   applied to (p, 1), and
 *       ( 0        0        scale_z  shift_z )
 *       ( 1 - s (jj + kk)  s (ij - kr)      s (ik + jr)     )
 *   R = ( s (ij + kr)      1 - s (ii + kk)  s (jk - ir)     )   with s = 2 / (rr + ii + jj + kk)
 *       ( s (ik - jr)      s (jk + ir)      1 - s (ii + jj) )
 * of the quaternion r + i I + j J + k K. */
typedef struct kiwami_quaternion_transform {
  float scale_x, scale_y, scale_z;
  float skew_xy, skew_xz, skew_yz;
  float shift_x, shift_y, shift_z;
  float quaternion_r, quaternion_i, quaternion_j, quaternion_k; /* of any length but 0 */
  float translation_x, translation_y, translation_z;
} kiwami_quaternion_transform;

/* An array of instances whose transforms are given at several times, in equal steps from time_begin
 * to time_end. A ray meets an instance as it is at the ray's time, and not at all where that lies
 * outside of this range, or is NaN. All else is as with kiwami_instances_desc; the instances of a
 * scene, moving or not, are numbered through together.
 *
 * Between two steps a and b, at the part f of the way from one to the other (both as in
 * kiwami_moving_mesh_desc), each entry of a matrix is (1 - f) * a + f * b, each operation rounded to
 * float. So are, in double precision, the entries of a kiwami_quaternion_transform but for the
 * quaternion, which is first divided by its length, and replaced by its negative where its dot
 * product with that of the step before is negative. It goes from a to b along the shorter arc at
 * constant speed: the direction of sin((1 - f) w) a + sin(f w) b, w being the angle between a and b.
 * The matrix of it all is rounded to float; kiwami_instances_transform tells it. Whatever the form, a
 * ray meets just what it meets in an instance that does not move and has the matrix of its time, to
 * the bit. At times at which that matrix is singular (as kiwami_instances_create understands it), the
 * instance is not there: halfway between two matrices of which one is turned by 180 degrees, say. */
typedef struct kiwami_moving_instances_desc {
  uint32_t struct_size;        /* bytes of this struct, set by kiwami_moving_instances_desc_init */
  uint32_t flags;              /* KIWAMI_INSTANCES_* */
  kiwami_scene* const* scenes; /* scene_count scenes of the device; the geometry holds references */
  uint64_t scene_count;        /* at least 1, at most 2^31 - 1 */
  const void* scene_indices; /* count uint32, each below scene_count: which scene an instance shows;
                              * NULL: the first one */
  uint64_t scene_index_stride; /* bytes from one to the next, at least 4; 0: 4 */
  const void* transforms;      /* that of instance i at step k begins at transforms + i *
                                * transform_stride + k * step_stride; no alignment is asked for */
  uint64_t transform_stride;   /* bytes from one instance to the next, at least the size of a
                                * transform (48 or 64); 0: step_count * the stride of steps */
  uint64_t step_stride;        /* bytes from one step to the next, at least the size of a transform;
                                * 0: that size */
  uint64_t count;              /* instances, at least 1, at most 2^31 - 1 */
  const void* masks;           /* count uint32; NULL: all ones */
  uint64_t mask_stride;        /* bytes from one to the next, at least 4; 0: 4 */
  uint32_t format;             /* a kiwami_transform_format; KIWAMI_TRANSFORM_MATRIX */
  uint32_t step_count;         /* 2 to KIWAMI_MAX_TIME_STEPS */
  float time_begin;            /* of the first step; 0 */
  float time_end;              /* of the last step, later than time_begin; 1 */
  uint32_t mask;               /* as of kiwami_instances_desc; all ones */
  uint32_t reserved;           /* 0 */
} kiwami_moving_instances_desc;

/* Fills *desc with the defaults: no scenes, no instances, copied buffers, matrices at two steps
 * from 0 to 1, a mask of all ones.
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_moving_instances_desc_init(kiwami_moving_instances_desc* desc,
                                                           size_t size);

/* Makes an array of moving instances, to be attached to a scene like any geometry.
 *   geometry   receives the handle, with one reference, or NULL on error
 *   errors     those of kiwami_instances_create, also of the commit; a transform may be singular at
 *              no step; INVALID_ARGUMENT: a format, a step_count or a time out of range
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_moving_instances_create(kiwami_device* device,
                                                        const kiwami_moving_instances_desc* desc,
                                                        kiwami_geometry** geometry);

/* Tells the matrix of an instance at a time: what carries a hit's normal or point out of the space
 * of its scene.
 *   instances  made by kiwami_instances_create or kiwami_moving_instances_create
 *   instance   its index in the array
 *   time       not looked at where the instance does not move
 *   transform  receives 12 floats, three rows of four
 *   errors     INVALID_ARGUMENT: a NULL pointer, another kind of geometry, an index at or beyond
 *              the count, a time outside of the instances' own range
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_instances_transform(const kiwami_geometry* instances,
                                                    uint64_t instance, float time,
                                                    float* transform);

#ifdef __cplusplus
}
#endif

#endif

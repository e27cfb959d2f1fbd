/* SPDX-License-Identifier: Apache-2.0 */
/* The layout of every public struct is frozen: other languages have it written down. */
#include "struct_layout.h"

#include <stdio.h>

static int failures = 0;

void expect(const char* what, size_t actual, size_t expected) {
  if (actual == expected) return;
  printf("%s is %lu, expected %lu\n", what, (unsigned long)actual, (unsigned long)expected);
  ++failures;
}

static void check_ray_and_hit(void) {
  SIZE(kiwami_ray, 48);
  FIELD(kiwami_ray, origin_x, 0);
  FIELD(kiwami_ray, origin_y, 4);
  FIELD(kiwami_ray, origin_z, 8);
  FIELD(kiwami_ray, tmin, 12);
  FIELD(kiwami_ray, direction_x, 16);
  FIELD(kiwami_ray, direction_y, 20);
  FIELD(kiwami_ray, direction_z, 24);
  FIELD(kiwami_ray, tmax, 28);
  FIELD(kiwami_ray, time, 32);
  FIELD(kiwami_ray, mask, 36);
  FIELD(kiwami_ray, flags, 40);
  FIELD(kiwami_ray, id, 44);

  SIZE(kiwami_hit, 36);
  FIELD(kiwami_hit, t, 0);
  FIELD(kiwami_hit, u, 4);
  FIELD(kiwami_hit, v, 8);
  FIELD(kiwami_hit, normal_x, 12);
  FIELD(kiwami_hit, normal_y, 16);
  FIELD(kiwami_hit, normal_z, 20);
  FIELD(kiwami_hit, primitive_id, 24);
  FIELD(kiwami_hit, geometry_id, 28);
  FIELD(kiwami_hit, instance_id, 32);
}

/* Geometries that are no triangles. */
static void check_shapes(void) {
  SIZE(kiwami_spheres_desc, 48);
  FIELD(kiwami_spheres_desc, struct_size, 0);
  FIELD(kiwami_spheres_desc, flags, 4);
  FIELD(kiwami_spheres_desc, points, 8);
  FIELD(kiwami_spheres_desc, point_offset, 16);
  FIELD(kiwami_spheres_desc, point_stride, 24);
  FIELD(kiwami_spheres_desc, sphere_count, 32);
  FIELD(kiwami_spheres_desc, mask, 40);
  FIELD(kiwami_spheres_desc, reserved, 44);

  SIZE(kiwami_discs_desc, 72);
  FIELD(kiwami_discs_desc, struct_size, 0);
  FIELD(kiwami_discs_desc, flags, 4);
  FIELD(kiwami_discs_desc, points, 8);
  FIELD(kiwami_discs_desc, point_offset, 16);
  FIELD(kiwami_discs_desc, point_stride, 24);
  FIELD(kiwami_discs_desc, normals, 32);
  FIELD(kiwami_discs_desc, normal_offset, 40);
  FIELD(kiwami_discs_desc, normal_stride, 48);
  FIELD(kiwami_discs_desc, disc_count, 56);
  FIELD(kiwami_discs_desc, mask, 64);
  FIELD(kiwami_discs_desc, reserved, 68);

  SIZE(kiwami_curves_desc, 80);
  FIELD(kiwami_curves_desc, struct_size, 0);
  FIELD(kiwami_curves_desc, flags, 4);
  FIELD(kiwami_curves_desc, points, 8);
  FIELD(kiwami_curves_desc, point_offset, 16);
  FIELD(kiwami_curves_desc, point_stride, 24);
  FIELD(kiwami_curves_desc, point_count, 32);
  FIELD(kiwami_curves_desc, indices, 40);
  FIELD(kiwami_curves_desc, index_offset, 48);
  FIELD(kiwami_curves_desc, index_stride, 56);
  FIELD(kiwami_curves_desc, segment_count, 64);
  FIELD(kiwami_curves_desc, mask, 72);
  FIELD(kiwami_curves_desc, reserved, 76);
}

static void check_moving_mesh(void) {
  SIZE(kiwami_moving_mesh_desc, 96);
  FIELD(kiwami_moving_mesh_desc, struct_size, 0);
  FIELD(kiwami_moving_mesh_desc, flags, 4);
  FIELD(kiwami_moving_mesh_desc, vertices, 8);
  FIELD(kiwami_moving_mesh_desc, vertex_offset, 16);
  FIELD(kiwami_moving_mesh_desc, vertex_stride, 24);
  FIELD(kiwami_moving_mesh_desc, vertex_count, 32);
  FIELD(kiwami_moving_mesh_desc, step_stride, 40);
  FIELD(kiwami_moving_mesh_desc, indices, 48);
  FIELD(kiwami_moving_mesh_desc, index_offset, 56);
  FIELD(kiwami_moving_mesh_desc, index_stride, 64);
  FIELD(kiwami_moving_mesh_desc, triangle_count, 72);
  FIELD(kiwami_moving_mesh_desc, step_count, 80);
  FIELD(kiwami_moving_mesh_desc, time_begin, 84);
  FIELD(kiwami_moving_mesh_desc, time_end, 88);
  FIELD(kiwami_moving_mesh_desc, mask, 92);
}

static void check_moving_instances(void) {
  SIZE(kiwami_quaternion_transform, 64);
  FIELD(kiwami_quaternion_transform, scale_x, 0);
  FIELD(kiwami_quaternion_transform, scale_y, 4);
  FIELD(kiwami_quaternion_transform, scale_z, 8);
  FIELD(kiwami_quaternion_transform, skew_xy, 12);
  FIELD(kiwami_quaternion_transform, skew_xz, 16);
  FIELD(kiwami_quaternion_transform, skew_yz, 20);
  FIELD(kiwami_quaternion_transform, shift_x, 24);
  FIELD(kiwami_quaternion_transform, shift_y, 28);
  FIELD(kiwami_quaternion_transform, shift_z, 32);
  FIELD(kiwami_quaternion_transform, quaternion_r, 36);
  FIELD(kiwami_quaternion_transform, quaternion_i, 40);
  FIELD(kiwami_quaternion_transform, quaternion_j, 44);
  FIELD(kiwami_quaternion_transform, quaternion_k, 48);
  FIELD(kiwami_quaternion_transform, translation_x, 52);
  FIELD(kiwami_quaternion_transform, translation_y, 56);
  FIELD(kiwami_quaternion_transform, translation_z, 60);
  SIZE(kiwami_moving_instances_desc, 112);
  FIELD(kiwami_moving_instances_desc, struct_size, 0);
  FIELD(kiwami_moving_instances_desc, flags, 4);
  FIELD(kiwami_moving_instances_desc, scenes, 8);
  FIELD(kiwami_moving_instances_desc, scene_count, 16);
  FIELD(kiwami_moving_instances_desc, scene_indices, 24);
  FIELD(kiwami_moving_instances_desc, scene_index_stride, 32);
  FIELD(kiwami_moving_instances_desc, transforms, 40);
  FIELD(kiwami_moving_instances_desc, transform_stride, 48);
  FIELD(kiwami_moving_instances_desc, step_stride, 56);
  FIELD(kiwami_moving_instances_desc, count, 64);
  FIELD(kiwami_moving_instances_desc, masks, 72);
  FIELD(kiwami_moving_instances_desc, mask_stride, 80);
  FIELD(kiwami_moving_instances_desc, format, 88);
  FIELD(kiwami_moving_instances_desc, step_count, 92);
  FIELD(kiwami_moving_instances_desc, time_begin, 96);
  FIELD(kiwami_moving_instances_desc, time_end, 100);
  FIELD(kiwami_moving_instances_desc, mask, 104);
  FIELD(kiwami_moving_instances_desc, reserved, 108);
}

static void check_user_geometry(void) {
  SIZE(kiwami_user_hit, 32);
  FIELD(kiwami_user_hit, t, 0);
  FIELD(kiwami_user_hit, u, 4);
  FIELD(kiwami_user_hit, v, 8);
  FIELD(kiwami_user_hit, normal_x, 12);
  FIELD(kiwami_user_hit, normal_y, 16);
  FIELD(kiwami_user_hit, normal_z, 20);
  FIELD(kiwami_user_hit, primitive_id, 24);
  FIELD(kiwami_user_hit, reserved, 28);

  SIZE(kiwami_user_intersection, 48);
  FIELD(kiwami_user_intersection, struct_size, 0);
  FIELD(kiwami_user_intersection, primitive_count, 4);
  FIELD(kiwami_user_intersection, primitive_ids, 8);
  FIELD(kiwami_user_intersection, ray, 16);
  FIELD(kiwami_user_intersection, geometry_id, 24);
  FIELD(kiwami_user_intersection, hit_capacity, 28);
  FIELD(kiwami_user_intersection, hits, 32);
  FIELD(kiwami_user_intersection, hit_count, 40);
  FIELD(kiwami_user_intersection, reserved, 44);

  SIZE(kiwami_user_geometry_desc, 56);
  FIELD(kiwami_user_geometry_desc, struct_size, 0);
  FIELD(kiwami_user_geometry_desc, flags, 4);
  FIELD(kiwami_user_geometry_desc, count, 8);
  FIELD(kiwami_user_geometry_desc, bounds, 16);
  FIELD(kiwami_user_geometry_desc, intersect, 24);
  FIELD(kiwami_user_geometry_desc, destroy, 32);
  FIELD(kiwami_user_geometry_desc, user, 40);
  FIELD(kiwami_user_geometry_desc, mask, 48);
  FIELD(kiwami_user_geometry_desc, reserved, 52);
}

/* The structs that hold pointers: their layout is that of 64-bit machines. */
static void check_instances(void) {
  SIZE(kiwami_instances_desc, 88);
  FIELD(kiwami_instances_desc, struct_size, 0);
  FIELD(kiwami_instances_desc, flags, 4);
  FIELD(kiwami_instances_desc, scenes, 8);
  FIELD(kiwami_instances_desc, scene_count, 16);
  FIELD(kiwami_instances_desc, scene_indices, 24);
  FIELD(kiwami_instances_desc, scene_index_stride, 32);
  FIELD(kiwami_instances_desc, transforms, 40);
  FIELD(kiwami_instances_desc, transform_stride, 48);
  FIELD(kiwami_instances_desc, count, 56);
  FIELD(kiwami_instances_desc, masks, 64);
  FIELD(kiwami_instances_desc, mask_stride, 72);
  FIELD(kiwami_instances_desc, mask, 80);
  FIELD(kiwami_instances_desc, reserved, 84);
}

static void check_device_and_mesh(void) {
  SIZE(kiwami_device_desc, 88);
  FIELD(kiwami_device_desc, struct_size, 0);
  FIELD(kiwami_device_desc, isa, 4);
  FIELD(kiwami_device_desc, thread_count, 8);
  FIELD(kiwami_device_desc, flags, 12);
  FIELD(kiwami_device_desc, runner, 16);
  FIELD(kiwami_device_desc, runner_user, 24);
  FIELD(kiwami_device_desc, runner_width, 32);
  FIELD(kiwami_device_desc, reserved, 36);
  FIELD(kiwami_device_desc, allocate, 40);
  FIELD(kiwami_device_desc, deallocate, 48);
  FIELD(kiwami_device_desc, allocator_user, 56);
  FIELD(kiwami_device_desc, log, 64);
  FIELD(kiwami_device_desc, log_user, 72);
  FIELD(kiwami_device_desc, memory_limit, 80);

  SIZE(kiwami_triangle_mesh_desc, 80);
  FIELD(kiwami_triangle_mesh_desc, struct_size, 0);
  FIELD(kiwami_triangle_mesh_desc, flags, 4);
  FIELD(kiwami_triangle_mesh_desc, vertices, 8);
  FIELD(kiwami_triangle_mesh_desc, vertex_offset, 16);
  FIELD(kiwami_triangle_mesh_desc, vertex_stride, 24);
  FIELD(kiwami_triangle_mesh_desc, vertex_count, 32);
  FIELD(kiwami_triangle_mesh_desc, indices, 40);
  FIELD(kiwami_triangle_mesh_desc, index_offset, 48);
  FIELD(kiwami_triangle_mesh_desc, index_stride, 56);
  FIELD(kiwami_triangle_mesh_desc, triangle_count, 64);
  FIELD(kiwami_triangle_mesh_desc, mask, 72);
  FIELD(kiwami_triangle_mesh_desc, reserved, 76);
}

static void check_fields(void) {
  SIZE(kiwami_input_field, 16);
  FIELD(kiwami_input_field, data, 0);
  FIELD(kiwami_input_field, stride, 8);
  SIZE(kiwami_output_field, 16);
  FIELD(kiwami_output_field, data, 0);
  FIELD(kiwami_output_field, stride, 8);

  SIZE(kiwami_ray_fields, 184);
  FIELD(kiwami_ray_fields, struct_size, 0);
  FIELD(kiwami_ray_fields, reserved, 4);
  FIELD(kiwami_ray_fields, origin_x, 8);
  FIELD(kiwami_ray_fields, origin_y, 24);
  FIELD(kiwami_ray_fields, origin_z, 40);
  FIELD(kiwami_ray_fields, direction_x, 56);
  FIELD(kiwami_ray_fields, direction_y, 72);
  FIELD(kiwami_ray_fields, direction_z, 88);
  FIELD(kiwami_ray_fields, tmin, 104);
  FIELD(kiwami_ray_fields, tmax, 120);
  FIELD(kiwami_ray_fields, time, 136);
  FIELD(kiwami_ray_fields, mask, 152);
  FIELD(kiwami_ray_fields, flags, 168);

  SIZE(kiwami_hit_fields, 152);
  FIELD(kiwami_hit_fields, struct_size, 0);
  FIELD(kiwami_hit_fields, reserved, 4);
  FIELD(kiwami_hit_fields, t, 8);
  FIELD(kiwami_hit_fields, u, 24);
  FIELD(kiwami_hit_fields, v, 40);
  FIELD(kiwami_hit_fields, normal_x, 56);
  FIELD(kiwami_hit_fields, normal_y, 72);
  FIELD(kiwami_hit_fields, normal_z, 88);
  FIELD(kiwami_hit_fields, primitive_id, 104);
  FIELD(kiwami_hit_fields, geometry_id, 120);
  FIELD(kiwami_hit_fields, instance_id, 136);
}

static void check_infos_and_query(void) {
  SIZE(kiwami_device_info, 56);
  FIELD(kiwami_device_info, struct_size, 0);
  FIELD(kiwami_device_info, isa, 4);
  FIELD(kiwami_device_info, isa_available, 8);
  FIELD(kiwami_device_info, isa_built, 12);
  FIELD(kiwami_device_info, native_widths, 16);
  FIELD(kiwami_device_info, default_bvh_width, 20);
  FIELD(kiwami_device_info, thread_count, 24);
  FIELD(kiwami_device_info, reserved, 28);
  FIELD(kiwami_device_info, memory_bytes, 32);
  FIELD(kiwami_device_info, memory_peak_bytes, 40);
  FIELD(kiwami_device_info, memory_limit, 48);

  SIZE(kiwami_scene_info, 176);
  FIELD(kiwami_scene_info, struct_size, 0);
  FIELD(kiwami_scene_info, bvh_width, 4);
  FIELD(kiwami_scene_info, leaf_width, 8);
  FIELD(kiwami_scene_info, bvh_depth, 12);
  FIELD(kiwami_scene_info, triangle_count, 16);
  FIELD(kiwami_scene_info, skipped_count, 24);
  FIELD(kiwami_scene_info, node_count, 32);
  FIELD(kiwami_scene_info, leaf_block_count, 40);
  FIELD(kiwami_scene_info, node_bytes, 48);
  FIELD(kiwami_scene_info, leaf_bytes, 56);
  FIELD(kiwami_scene_info, total_bytes, 64);
  FIELD(kiwami_scene_info, peak_build_bytes, 72);
  FIELD(kiwami_scene_info, node_fill, 80);
  FIELD(kiwami_scene_info, leaf_fill, 88);
  FIELD(kiwami_scene_info, sah_cost, 96);
  FIELD(kiwami_scene_info, build_seconds, 104);
  FIELD(kiwami_scene_info, bounds_min, 112);
  FIELD(kiwami_scene_info, bounds_max, 124);
  FIELD(kiwami_scene_info, reference_count, 136);
  FIELD(kiwami_scene_info, refit_count, 144);
  FIELD(kiwami_scene_info, instance_count, 152);
  FIELD(kiwami_scene_info, instance_tree_bytes, 160);
  FIELD(kiwami_scene_info, instance_depth, 168);
  FIELD(kiwami_scene_info, reserved, 172);

  SIZE(kiwami_exclusion, 12);
  FIELD(kiwami_exclusion, primitive_id, 0);
  FIELD(kiwami_exclusion, geometry_id, 4);
  FIELD(kiwami_exclusion, instance_id, 8);

  SIZE(kiwami_filter_candidate, 88);
  FIELD(kiwami_filter_candidate, struct_size, 0);
  FIELD(kiwami_filter_candidate, depth, 4);
  FIELD(kiwami_filter_candidate, ray, 8);
  FIELD(kiwami_filter_candidate, hit, 16);
  FIELD(kiwami_filter_candidate, reserved, 52);
  FIELD(kiwami_filter_candidate, instance_path, 56);

  SIZE(kiwami_query, 72);
  FIELD(kiwami_query, exclusions, 24);
  FIELD(kiwami_query, exclusion_stride, 32);
  FIELD(kiwami_query, exclusion_paths, 40);
  FIELD(kiwami_query, exclusion_path_stride, 48);
  FIELD(kiwami_query, filter, 56);
  FIELD(kiwami_query, filter_user, 64);
  FIELD(kiwami_query, struct_size, 0);
  FIELD(kiwami_query, flags, 4);
  FIELD(kiwami_query, instance_paths, 8);
  FIELD(kiwami_query, instance_path_stride, 16);
}

static void check_opacity_desc(void) {
  SIZE(kiwami_opacity_desc, 56);
  FIELD(kiwami_opacity_desc, struct_size, 0);
  FIELD(kiwami_opacity_desc, format, 4);
  FIELD(kiwami_opacity_desc, level, 8);
  FIELD(kiwami_opacity_desc, reserved, 12);
  FIELD(kiwami_opacity_desc, maps, 16);
  FIELD(kiwami_opacity_desc, map_stride, 24);
  FIELD(kiwami_opacity_desc, map_count, 32);
  FIELD(kiwami_opacity_desc, indices, 40);
  FIELD(kiwami_opacity_desc, index_stride, 48);
}

static void check_interpolation(void) {
  SIZE(kiwami_interpolation, 184);
  FIELD(kiwami_interpolation, struct_size, 0);
  FIELD(kiwami_interpolation, channels, 4);
  FIELD(kiwami_interpolation, attributes, 8);
  FIELD(kiwami_interpolation, attribute_offset, 16);
  FIELD(kiwami_interpolation, attribute_stride, 24);
  FIELD(kiwami_interpolation, attribute_count, 32);
  FIELD(kiwami_interpolation, indices, 40);
  FIELD(kiwami_interpolation, index_offset, 48);
  FIELD(kiwami_interpolation, index_stride, 56);
  FIELD(kiwami_interpolation, primitive_id, 64);
  FIELD(kiwami_interpolation, u, 80);
  FIELD(kiwami_interpolation, v, 96);
  FIELD(kiwami_interpolation, geometry_id, 112);
  FIELD(kiwami_interpolation, geometry, 128);
  FIELD(kiwami_interpolation, reserved, 132);
  FIELD(kiwami_interpolation, values, 136);
  FIELD(kiwami_interpolation, value_stride, 144);
  FIELD(kiwami_interpolation, derivatives_u, 152);
  FIELD(kiwami_interpolation, derivative_u_stride, 160);
  FIELD(kiwami_interpolation, derivatives_v, 168);
  FIELD(kiwami_interpolation, derivative_v_stride, 176);
}

static void check_numbers(void) {
  expect("KIWAMI_ERROR_INVALID_ARGUMENT", (size_t)-KIWAMI_ERROR_INVALID_ARGUMENT, 1);
  expect("KIWAMI_ERROR_INVALID_STATE", (size_t)-KIWAMI_ERROR_INVALID_STATE, 2);
  expect("KIWAMI_ERROR_OUT_OF_MEMORY", (size_t)-KIWAMI_ERROR_OUT_OF_MEMORY, 3);
  expect("KIWAMI_ERROR_UNSUPPORTED_ISA", (size_t)-KIWAMI_ERROR_UNSUPPORTED_ISA, 4);
  expect("KIWAMI_ERROR_TOO_LARGE", (size_t)-KIWAMI_ERROR_TOO_LARGE, 5);
  expect("KIWAMI_ERROR_CALLBACK", (size_t)-KIWAMI_ERROR_CALLBACK, 6);
  expect("KIWAMI_ERROR_VALIDATION", (size_t)-KIWAMI_ERROR_VALIDATION, 7);
  expect("KIWAMI_ERROR_INTERNAL", (size_t)-KIWAMI_ERROR_INTERNAL, 8);
  expect("KIWAMI_ERROR_CAPACITY", (size_t)-KIWAMI_ERROR_CAPACITY, 9);
  expect("KIWAMI_ERROR_INVALID_FILE", (size_t)-KIWAMI_ERROR_INVALID_FILE, 10);
  expect("KIWAMI_ERROR_IO", (size_t)-KIWAMI_ERROR_IO, 11);
  expect("KIWAMI_LOAD_TRUSTED", KIWAMI_LOAD_TRUSTED, 2);
  expect("KIWAMI_FILE_BVH", KIWAMI_FILE_BVH, 2);
  expect("KIWAMI_FILE_LIGHTS", KIWAMI_FILE_LIGHTS, 3);
  expect("KIWAMI_FIT_NONE", KIWAMI_FIT_NONE, 2);
  expect("KIWAMI_FILTER_ACCEPT", KIWAMI_FILTER_ACCEPT, 1);
  expect("KIWAMI_FILTER_ACCEPT_AND_STOP", KIWAMI_FILTER_ACCEPT_AND_STOP, 2);
  expect("KIWAMI_OPACITY_OPAQUE", KIWAMI_OPACITY_OPAQUE, 1);
  expect("KIWAMI_OPACITY_UNKNOWN_TRANSPARENT", KIWAMI_OPACITY_UNKNOWN_TRANSPARENT, 2);
  expect("KIWAMI_OPACITY_UNKNOWN_OPAQUE", KIWAMI_OPACITY_UNKNOWN_OPAQUE, 3);
  expect("KIWAMI_OPACITY_4_STATES", KIWAMI_OPACITY_4_STATES, 2);
  expect("KIWAMI_ISA_AVX512", KIWAMI_ISA_AVX512, 4);
  expect("KIWAMI_PARAMETER_BVH_WIDTH", KIWAMI_PARAMETER_BVH_WIDTH, 1);
  expect("KIWAMI_PARAMETER_MERGE_LEAVES", KIWAMI_PARAMETER_MERGE_LEAVES, 2);
  expect("KIWAMI_PARAMETER_MERGE_RING", KIWAMI_PARAMETER_MERGE_RING, 3);
  expect("KIWAMI_PARAMETER_BIN_COUNT", KIWAMI_PARAMETER_BIN_COUNT, 4);
  expect("KIWAMI_PARAMETER_MAX_LEAF_SIZE", KIWAMI_PARAMETER_MAX_LEAF_SIZE, 5);
  expect("KIWAMI_PARAMETER_NODE_COST", KIWAMI_PARAMETER_NODE_COST, 6);
  expect("KIWAMI_PARAMETER_LEAF_COST", KIWAMI_PARAMETER_LEAF_COST, 7);
  expect("KIWAMI_PARAMETER_VALIDATE_BUILD", KIWAMI_PARAMETER_VALIDATE_BUILD, 8);
  expect("KIWAMI_PARAMETER_CONTRACTION", KIWAMI_PARAMETER_CONTRACTION, 9);
  expect("KIWAMI_PARAMETER_BUILDER", KIWAMI_PARAMETER_BUILDER, 10);
  expect("KIWAMI_PARAMETER_SPLIT_BUDGET", KIWAMI_PARAMETER_SPLIT_BUDGET, 11);
  expect("KIWAMI_PARAMETER_SPLIT_ALPHA", KIWAMI_PARAMETER_SPLIT_ALPHA, 12);
  expect("KIWAMI_PARAMETER_BIN_HALVING", KIWAMI_PARAMETER_BIN_HALVING, 13);
  expect("KIWAMI_PARAMETER_REASSIGN", KIWAMI_PARAMETER_REASSIGN, 14);
  expect("KIWAMI_PARAMETER_AAC_QUALITY", KIWAMI_PARAMETER_AAC_QUALITY, 17);
  expect("KIWAMI_PARAMETER_CURVE_CODE", KIWAMI_PARAMETER_CURVE_CODE, 18);
  expect("KIWAMI_PARAMETER_LBVH_DELTA", KIWAMI_PARAMETER_LBVH_DELTA, 19);
  expect("KIWAMI_PARAMETER_LBVH_CHUNK_SIZE", KIWAMI_PARAMETER_LBVH_CHUNK_SIZE, 20);
  expect("KIWAMI_PARAMETER_LAYOUT", KIWAMI_PARAMETER_LAYOUT, 21);
  expect("KIWAMI_PARAMETER_REBRAID", KIWAMI_PARAMETER_REBRAID, 40);
  expect("KIWAMI_PARAMETER_REBRAID_BUDGET", KIWAMI_PARAMETER_REBRAID_BUDGET, 41);
  expect("KIWAMI_PARAMETER_DIVIDE_TIME", KIWAMI_PARAMETER_DIVIDE_TIME, 43);
  expect("KIWAMI_TRANSFORM_MATRIX", KIWAMI_TRANSFORM_MATRIX, 0);
  expect("KIWAMI_TRANSFORM_QUATERNION", KIWAMI_TRANSFORM_QUATERNION, 1);
  expect("KIWAMI_REBRAID_OFF", KIWAMI_REBRAID_OFF, 0);
  expect("KIWAMI_REBRAID_FULL", KIWAMI_REBRAID_FULL, 1);
  expect("KIWAMI_REBRAID_ROOTS", KIWAMI_REBRAID_ROOTS, 2);
  expect("KIWAMI_INSTANCES_SHARE_BUFFERS", KIWAMI_INSTANCES_SHARE_BUFFERS, 1);
  expect("KIWAMI_MAX_INSTANCE_DEPTH", KIWAMI_MAX_INSTANCE_DEPTH, 8);
  expect("KIWAMI_LAYOUT_FAST", KIWAMI_LAYOUT_FAST, 0);
  expect("KIWAMI_LAYOUT_COMPACT", KIWAMI_LAYOUT_COMPACT, 1);
  expect("KIWAMI_LIGHT_POINT", KIWAMI_LIGHT_POINT, 0);
  expect("KIWAMI_LIGHT_SPOT", KIWAMI_LIGHT_SPOT, 1);
  expect("KIWAMI_LIGHT_TRIANGLE", KIWAMI_LIGHT_TRIANGLE, 2);
  expect("KIWAMI_LIGHT_QUAD", KIWAMI_LIGHT_QUAD, 3);
  expect("KIWAMI_LIGHT_SPHERE", KIWAMI_LIGHT_SPHERE, 4);
  expect("KIWAMI_LIGHT_DISC", KIWAMI_LIGHT_DISC, 5);
  expect("KIWAMI_LIGHT_DISTANT", KIWAMI_LIGHT_DISTANT, 6);
  expect("KIWAMI_LIGHT_ENVIRONMENT", KIWAMI_LIGHT_ENVIRONMENT, 7);
  expect("KIWAMI_LIGHT_TWO_SIDED", KIWAMI_LIGHT_TWO_SIDED, 1);
  expect("KIWAMI_LIGHT_BUILDER_OCTANTS", KIWAMI_LIGHT_BUILDER_OCTANTS, 1);
  expect("KIWAMI_LIGHT_METHOD_TREE", KIWAMI_LIGHT_METHOD_TREE, 0);
  expect("KIWAMI_LIGHT_METHOD_POWER", KIWAMI_LIGHT_METHOD_POWER, 1);
  expect("KIWAMI_LIGHT_METHOD_TREE_SPLITTING", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 2);
  expect("KIWAMI_LIGHT_METHOD_LIGHTCUTS", KIWAMI_LIGHT_METHOD_LIGHTCUTS, 3);
  expect("KIWAMI_LIGHT_METHOD_LAZY_ROULETTE", KIWAMI_LIGHT_METHOD_LAZY_ROULETTE, 4);
  expect("KIWAMI_LIGHT_METHOD_CULLING", KIWAMI_LIGHT_METHOD_CULLING, 5);
  expect("KIWAMI_LIGHT_METHOD_ROULETTE", KIWAMI_LIGHT_METHOD_ROULETTE, 6);
  expect("KIWAMI_LIGHT_LOBE_COSINE", KIWAMI_LIGHT_LOBE_COSINE, 0);
  expect("KIWAMI_LIGHT_LOBE_TANGENT_SPHERE", KIWAMI_LIGHT_LOBE_TANGENT_SPHERE, 1);
  expect("KIWAMI_LIGHT_LOBE_GLOSSY", KIWAMI_LIGHT_LOBE_GLOSSY, 2);
  expect("KIWAMI_LIGHT_ORDER_XOR", KIWAMI_LIGHT_ORDER_XOR, 0);
  expect("KIWAMI_LIGHT_ORDER_SCRAMBLED", KIWAMI_LIGHT_ORDER_SCRAMBLED, 1);
  expect("KIWAMI_LIGHT_TREE_WITH_ROULETTE", KIWAMI_LIGHT_TREE_WITH_ROULETTE, 1);
  expect("KIWAMI_LIGHT_MAX_CHOICES", KIWAMI_LIGHT_MAX_CHOICES, 64);
  expect("KIWAMI_RECEIVER_BOTH_SIDES", KIWAMI_RECEIVER_BOTH_SIDES, 1);
}

int main(void) {
  check_ray_and_hit();
  if (sizeof(void*) == 8) {
    check_instances();
    check_device_and_mesh();
    check_shapes();
    check_user_geometry();
    check_moving_mesh();
    check_moving_instances();
    check_fields();
    check_interpolation();
    check_opacity_desc();
  }
  check_infos_and_query();
  check_numbers();
  check_tree_layouts();
  check_light_layouts();
  return failures != 0;
}

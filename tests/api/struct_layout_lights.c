/* SPDX-License-Identifier: Apache-2.0 */
/* The layouts and numbers of lights and distributions. */
#include "struct_layout.h"

static void check_distributions(void) {
  SIZE(kiwami_distribution_info, 48);
  FIELD(kiwami_distribution_info, struct_size, 0);
  FIELD(kiwami_distribution_info, method, 4);
  FIELD(kiwami_distribution_info, weight_count, 8);
  FIELD(kiwami_distribution_info, bytes, 16);
  FIELD(kiwami_distribution_info, total, 24);
  FIELD(kiwami_distribution_info, mean_steps, 32);
  FIELD(kiwami_distribution_info, most_steps, 40);
  FIELD(kiwami_distribution_info, reserved, 44);
  SIZE(kiwami_draw, 16);
  FIELD(kiwami_draw, index, 0);
  FIELD(kiwami_draw, probability, 4);
  FIELD(kiwami_draw, random, 8);
}

static void check_distribution_desc(void) {
  SIZE(kiwami_distribution_desc, 32);
  FIELD(kiwami_distribution_desc, struct_size, 0);
  FIELD(kiwami_distribution_desc, method, 4);
  FIELD(kiwami_distribution_desc, weights, 8);
  FIELD(kiwami_distribution_desc, weight_stride, 16);
  FIELD(kiwami_distribution_desc, weight_count, 24);
}

static void check_lights(void) {
  SIZE(kiwami_light, 96);
  FIELD(kiwami_light, type, 0);
  FIELD(kiwami_light, flags, 4);
  FIELD(kiwami_light, points, 8);
  FIELD(kiwami_light, direction, 56);
  FIELD(kiwami_light, radius, 68);
  FIELD(kiwami_light, cos_inner, 72);
  FIELD(kiwami_light, cos_outer, 76);
  FIELD(kiwami_light, power, 80);
  FIELD(kiwami_light, user_id, 84);
  FIELD(kiwami_light, link_mask, 88);
  SIZE(kiwami_light_tree_desc, 24);
  FIELD(kiwami_light_tree_desc, struct_size, 0);
  FIELD(kiwami_light_tree_desc, width, 4);
  FIELD(kiwami_light_tree_desc, builder, 8);
  FIELD(kiwami_light_tree_desc, distant_probability, 12);
  FIELD(kiwami_light_tree_desc, flags, 16);
  FIELD(kiwami_light_tree_desc, reserved, 20);
  SIZE(kiwami_light_tree_info, 64);
  FIELD(kiwami_light_tree_info, struct_size, 0);
  FIELD(kiwami_light_tree_info, width, 4);
  FIELD(kiwami_light_tree_info, light_count, 8);
  FIELD(kiwami_light_tree_info, instance_count, 12);
  FIELD(kiwami_light_tree_info, distant_count, 16);
  FIELD(kiwami_light_tree_info, node_count, 20);
  FIELD(kiwami_light_tree_info, depth, 24);
  FIELD(kiwami_light_tree_info, reserved, 28);
  FIELD(kiwami_light_tree_info, bytes, 32);
  FIELD(kiwami_light_tree_info, power, 40);
  FIELD(kiwami_light_tree_info, cost, 48);
  FIELD(kiwami_light_tree_info, build_seconds, 56);
  SIZE(kiwami_light_receiver, 56);
  FIELD(kiwami_light_receiver, position, 0);
  FIELD(kiwami_light_receiver, normal, 12);
  FIELD(kiwami_light_receiver, segment, 24);
  FIELD(kiwami_light_receiver, flags, 36);
  FIELD(kiwami_light_receiver, link_mask, 40);
  FIELD(kiwami_light_receiver, random, 48);
  SIZE(kiwami_light_choice, 24);
  FIELD(kiwami_light_choice, light_id, 0);
  FIELD(kiwami_light_choice, instance_id, 4);
  FIELD(kiwami_light_choice, user_id, 8);
  FIELD(kiwami_light_choice, probability, 12);
  FIELD(kiwami_light_choice, random, 16);
  SIZE(kiwami_light_name, 8);
  FIELD(kiwami_light_name, light_id, 0);
  FIELD(kiwami_light_name, instance_id, 4);
  SIZE(kiwami_light_query, 48);
  FIELD(kiwami_light_query, struct_size, 0);
  FIELD(kiwami_light_query, flags, 4);
  FIELD(kiwami_light_query, method, 8);
  FIELD(kiwami_light_query, max_choices, 12);
  FIELD(kiwami_light_query, threshold, 16);
  FIELD(kiwami_light_query, lobe, 20);
  FIELD(kiwami_light_query, order, 24);
  FIELD(kiwami_light_query, reach, 28);
  FIELD(kiwami_light_query, lobes, 32);
  FIELD(kiwami_light_query, lobe_stride, 40);
  SIZE(kiwami_light_lobe, 16);
  FIELD(kiwami_light_lobe, axis, 0);
  FIELD(kiwami_light_lobe, roughness, 12);
}

static void check_light_descs(void) {
  SIZE(kiwami_light_mesh_desc, 96);
  FIELD(kiwami_light_mesh_desc, struct_size, 0);
  FIELD(kiwami_light_mesh_desc, flags, 4);
  FIELD(kiwami_light_mesh_desc, vertices, 8);
  FIELD(kiwami_light_mesh_desc, vertex_stride, 16);
  FIELD(kiwami_light_mesh_desc, vertex_count, 24);
  FIELD(kiwami_light_mesh_desc, indices, 32);
  FIELD(kiwami_light_mesh_desc, index_stride, 40);
  FIELD(kiwami_light_mesh_desc, triangle_count, 48);
  FIELD(kiwami_light_mesh_desc, radiances, 56);
  FIELD(kiwami_light_mesh_desc, radiance_stride, 64);
  FIELD(kiwami_light_mesh_desc, link_mask, 72);
  FIELD(kiwami_light_mesh_desc, radiance, 80);
  FIELD(kiwami_light_mesh_desc, user_id, 84);
  FIELD(kiwami_light_mesh_desc, user_id_step, 88);
  FIELD(kiwami_light_mesh_desc, reserved, 92);
  SIZE(kiwami_light_instance_desc, 72);
  FIELD(kiwami_light_instance_desc, struct_size, 0);
  FIELD(kiwami_light_instance_desc, power_scale, 4);
  FIELD(kiwami_light_instance_desc, tree, 8);
  FIELD(kiwami_light_instance_desc, local_to_world, 16);
  FIELD(kiwami_light_instance_desc, link_mask, 64);
}

static void check_numbers(void) {
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

void check_light_layouts(void) {
  /* They hold pointers: their layout is that of 64-bit machines. */
  if (sizeof(void*) == 8) {
    check_light_descs();
    check_distribution_desc();
  }
  check_distributions();
  check_lights();
  check_numbers();
}

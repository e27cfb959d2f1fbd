/* SPDX-License-Identifier: Apache-2.0 */
/* The layouts of trees, what is measured of them, exported nodes, and files. */
#include "struct_layout.h"

static void check_bvh(void) {
  SIZE(kiwami_bvh_node, 56);
  FIELD(kiwami_bvh_node, lower, 0);
  FIELD(kiwami_bvh_node, upper, 12);
  FIELD(kiwami_bvh_node, parent, 24);
  FIELD(kiwami_bvh_node, depth, 28);
  FIELD(kiwami_bvh_node, first_child, 32);
  FIELD(kiwami_bvh_node, child_count, 36);
  FIELD(kiwami_bvh_node, first_primitive, 40);
  FIELD(kiwami_bvh_node, primitive_count, 44);
  FIELD(kiwami_bvh_node, storage_index, 48);
  FIELD(kiwami_bvh_node, storage_mask, 52);

  SIZE(kiwami_bvh_primitive, 8);
  FIELD(kiwami_bvh_primitive, geometry_id, 0);
  FIELD(kiwami_bvh_primitive, primitive_id, 4);

  SIZE(kiwami_bvh_info, 56);
  FIELD(kiwami_bvh_info, struct_size, 0);
  FIELD(kiwami_bvh_info, width, 4);
  FIELD(kiwami_bvh_info, leaf_width, 8);
  FIELD(kiwami_bvh_info, depth, 12);
  FIELD(kiwami_bvh_info, node_count, 16);
  FIELD(kiwami_bvh_info, leaf_count, 20);
  FIELD(kiwami_bvh_info, primitive_count, 24);
  FIELD(kiwami_bvh_info, reserved, 28);
  FIELD(kiwami_bvh_info, bytes, 32);
  FIELD(kiwami_bvh_info, skipped_count, 40);
  FIELD(kiwami_bvh_info, build_seconds, 48);

  SIZE(kiwami_parameter_value, 16);
  FIELD(kiwami_parameter_value, parameter, 0);
  FIELD(kiwami_parameter_value, reserved, 4);
  FIELD(kiwami_parameter_value, value, 8);
}

static void check_exported_nodes(void) {
  SIZE(kiwami_binary_node, 32);
  FIELD(kiwami_binary_node, lower, 0);
  FIELD(kiwami_binary_node, first, 12);
  FIELD(kiwami_binary_node, upper, 16);
  FIELD(kiwami_binary_node, count, 28);

  SIZE(kiwami_wide4_node, 128);
  FIELD(kiwami_wide4_node, lower_x, 0);
  FIELD(kiwami_wide4_node, lower_y, 16);
  FIELD(kiwami_wide4_node, lower_z, 32);
  FIELD(kiwami_wide4_node, upper_x, 48);
  FIELD(kiwami_wide4_node, upper_y, 64);
  FIELD(kiwami_wide4_node, upper_z, 80);
  FIELD(kiwami_wide4_node, child, 96);
  FIELD(kiwami_wide4_node, count, 112);

  SIZE(kiwami_wide8_node, 256);
  FIELD(kiwami_wide8_node, lower_x, 0);
  FIELD(kiwami_wide8_node, lower_y, 32);
  FIELD(kiwami_wide8_node, lower_z, 64);
  FIELD(kiwami_wide8_node, upper_x, 96);
  FIELD(kiwami_wide8_node, upper_y, 128);
  FIELD(kiwami_wide8_node, upper_z, 160);
  FIELD(kiwami_wide8_node, child, 192);
  FIELD(kiwami_wide8_node, count, 224);

  SIZE(kiwami_compressed8_node, 80);
  FIELD(kiwami_compressed8_node, origin, 0);
  FIELD(kiwami_compressed8_node, exponent, 12);
  FIELD(kiwami_compressed8_node, inner_mask, 15);
  FIELD(kiwami_compressed8_node, child_base, 16);
  FIELD(kiwami_compressed8_node, primitive_base, 20);
  FIELD(kiwami_compressed8_node, meta, 24);
  FIELD(kiwami_compressed8_node, lower_x, 32);
  FIELD(kiwami_compressed8_node, lower_y, 40);
  FIELD(kiwami_compressed8_node, lower_z, 48);
  FIELD(kiwami_compressed8_node, upper_x, 56);
  FIELD(kiwami_compressed8_node, upper_y, 64);
  FIELD(kiwami_compressed8_node, upper_z, 72);
}

static void check_bvh_desc(void) {
  SIZE(kiwami_bvh_desc, 72);
  FIELD(kiwami_bvh_desc, struct_size, 0);
  FIELD(kiwami_bvh_desc, width, 4);
  FIELD(kiwami_bvh_desc, boxes, 8);
  FIELD(kiwami_bvh_desc, box_stride, 16);
  FIELD(kiwami_bvh_desc, box_count, 24);
  FIELD(kiwami_bvh_desc, geometry, 32);
  FIELD(kiwami_bvh_desc, parameters, 40);
  FIELD(kiwami_bvh_desc, parameter_count, 48);
  FIELD(kiwami_bvh_desc, optimizers, 56);
  FIELD(kiwami_bvh_desc, optimizer_count, 64);
}

static void check_measures(void) {
  SIZE(kiwami_bvh_measure_desc, 32);
  FIELD(kiwami_bvh_measure_desc, struct_size, 0);
  FIELD(kiwami_bvh_measure_desc, flags, 4);
  FIELD(kiwami_bvh_measure_desc, node_cost, 8);
  FIELD(kiwami_bvh_measure_desc, leaf_cost, 16);
  FIELD(kiwami_bvh_measure_desc, block_size, 24);
  FIELD(kiwami_bvh_measure_desc, reserved, 28);

  SIZE(kiwami_bvh_measures, 48);
  FIELD(kiwami_bvh_measures, struct_size, 0);
  FIELD(kiwami_bvh_measures, reserved, 4);
  FIELD(kiwami_bvh_measures, sah, 8);
  FIELD(kiwami_bvh_measures, epo, 16);
  FIELD(kiwami_bvh_measures, node_area, 24);
  FIELD(kiwami_bvh_measures, leaf_area, 32);
  FIELD(kiwami_bvh_measures, surface_area, 40);

  SIZE(kiwami_bvh_node_measures, 24);
  FIELD(kiwami_bvh_node_measures, area, 0);
  FIELD(kiwami_bvh_node_measures, sah, 8);
  FIELD(kiwami_bvh_node_measures, epo, 16);

  SIZE(kiwami_visits, 48);
  FIELD(kiwami_visits, struct_size, 0);
  FIELD(kiwami_visits, reserved, 4);
  FIELD(kiwami_visits, ray_count, 8);
  FIELD(kiwami_visits, hit_count, 16);
  FIELD(kiwami_visits, node_visits, 24);
  FIELD(kiwami_visits, leaf_visits, 32);
  FIELD(kiwami_visits, leaf_count_variability, 40);

  SIZE(kiwami_ray_visits, 8);
  FIELD(kiwami_ray_visits, node_visits, 0);
  FIELD(kiwami_ray_visits, leaf_visits, 4);
}

static void check_files(void) {
  if (sizeof(void*) == 8) {
    SIZE(kiwami_save_desc, 48);
    FIELD(kiwami_save_desc, struct_size, 0);
    FIELD(kiwami_save_desc, flags, 4);
    FIELD(kiwami_save_desc, path, 8);
    FIELD(kiwami_save_desc, write, 16);
    FIELD(kiwami_save_desc, write_user, 24);
    FIELD(kiwami_save_desc, data, 32);
    FIELD(kiwami_save_desc, capacity, 40);

    SIZE(kiwami_load_desc, 56);
    FIELD(kiwami_load_desc, struct_size, 0);
    FIELD(kiwami_load_desc, flags, 4);
    FIELD(kiwami_load_desc, path, 8);
    FIELD(kiwami_load_desc, read, 16);
    FIELD(kiwami_load_desc, read_user, 24);
    FIELD(kiwami_load_desc, data, 32);
    FIELD(kiwami_load_desc, size, 40);
    FIELD(kiwami_load_desc, bvh_width, 48);
    FIELD(kiwami_load_desc, reserved, 52);
  }

  SIZE(kiwami_file_info, 56);
  FIELD(kiwami_file_info, struct_size, 0);
  FIELD(kiwami_file_info, kind, 4);
  FIELD(kiwami_file_info, fit, 8);
  FIELD(kiwami_file_info, format_version, 12);
  FIELD(kiwami_file_info, library_version, 16);
  FIELD(kiwami_file_info, bvh_width, 20);
  FIELD(kiwami_file_info, section_count, 24);
  FIELD(kiwami_file_info, reserved, 28);
  FIELD(kiwami_file_info, file_bytes, 32);
  FIELD(kiwami_file_info, triangle_count, 40);
  FIELD(kiwami_file_info, node_count, 48);
}

void check_tree_layouts(void) {
  /* They hold pointers: their layout is that of 64-bit machines. */
  if (sizeof(void*) == 8) {
    check_bvh_desc();
  }
  check_bvh();
  check_exported_nodes();
  check_measures();
  check_files();
}

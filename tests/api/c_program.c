/* SPDX-License-Identifier: Apache-2.0 */
/* Every function of the interface, called from C with its own arithmetic to judge the answers. */
#include <kiwami/kiwami.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPECT(condition) expect((condition) != 0, #condition, __LINE__)

static void expect(int condition, const char* text, int line) {
  if (condition) return;
  printf("line %d: expected %s\n", line, text);
  exit(1);
}

static const float square[4][3] = {{-1, -1, 5}, {1, -1, 5}, {1, 1, 5}, {-1, 1, 5}};
static const uint32_t halves[2][3] = {{0, 1, 2}, {0, 2, 3}};

static kiwami_geometry* make_square(kiwami_device* device) {
  kiwami_geometry* mesh = NULL;
  kiwami_triangle_mesh_desc desc;
  EXPECT(kiwami_triangle_mesh_desc_init(&desc, sizeof desc) == KIWAMI_OK);
  desc.vertices = square;
  desc.vertex_count = 4;
  desc.indices = halves;
  desc.triangle_count = 2;
  EXPECT(kiwami_triangle_mesh_create(device, &desc, &mesh) == KIWAMI_OK);
  kiwami_geometry_retain(mesh);
  kiwami_geometry_release(mesh);
  return mesh;
}

static kiwami_scene* make_scene(kiwami_device* device, kiwami_geometry* mesh) {
  kiwami_scene* scene = NULL;
  kiwami_scene_info info;
  double lowest, highest, preset;
  uint32_t id = 99;
  EXPECT(kiwami_scene_create(device, &scene) == KIWAMI_OK);
  kiwami_scene_retain(scene);
  kiwami_scene_release(scene);
  EXPECT(kiwami_scene_attach(scene, mesh, &id) == KIWAMI_OK && id == 0);
  EXPECT(kiwami_scene_attach(scene, mesh, &id) == KIWAMI_OK && id == 1);
  EXPECT(kiwami_scene_detach(scene, 1) == KIWAMI_OK);
  EXPECT(kiwami_parameter_bounds(KIWAMI_PARAMETER_BIN_COUNT, &lowest, &highest, &preset) ==
         KIWAMI_OK);
  EXPECT(lowest <= preset && preset <= highest);
  EXPECT(kiwami_scene_set_parameter(scene, KIWAMI_PARAMETER_BIN_COUNT, highest) == KIWAMI_OK);
  EXPECT(kiwami_scene_commit(scene) == KIWAMI_OK);
  EXPECT(kiwami_scene_validate(scene) == KIWAMI_OK);
  info.struct_size = sizeof info;
  EXPECT(kiwami_scene_get_info(scene, &info) == KIWAMI_OK);
  EXPECT(info.triangle_count == 2 && info.skipped_count == 0);
  EXPECT(info.bounds_min[0] == -1 && info.bounds_max[2] == 5);
  return scene;
}

static void look_at_the_tree(const kiwami_scene* scene) {
  kiwami_bvh* bvh = NULL;
  kiwami_bvh_info info;
  kiwami_bvh_node root;
  kiwami_bvh_primitive primitives[2];
  kiwami_bvh_measure_desc desc;
  kiwami_bvh_measures measures;
  EXPECT(kiwami_scene_get_bvh(scene, &bvh) == KIWAMI_OK);
  kiwami_bvh_retain(bvh);
  kiwami_bvh_release(bvh);
  info.struct_size = sizeof info;
  EXPECT(kiwami_bvh_get_info(bvh, &info) == KIWAMI_OK);
  EXPECT(info.primitive_count == 2 && info.leaf_count >= 1);
  EXPECT(kiwami_bvh_get_nodes(bvh, 0, 1, &root, 0) == KIWAMI_OK);
  EXPECT(root.lower[0] == -1 && root.upper[2] == 5 && root.primitive_count == 2);
  EXPECT(kiwami_bvh_get_primitives(bvh, 0, 2, primitives, 0) == KIWAMI_OK);
  EXPECT(primitives[0].primitive_id + primitives[1].primitive_id == 1);
  EXPECT(kiwami_bvh_measure_desc_init(&desc, sizeof desc) == KIWAMI_OK);
  desc.leaf_cost = 2;
  measures.struct_size = sizeof measures;
  EXPECT(kiwami_bvh_measure(bvh, &desc, &measures, NULL, 0) == KIWAMI_OK);
  EXPECT(measures.sah >= 2 && measures.surface_area == 4);
  kiwami_bvh_release(bvh);
}

/* A ray along +z through (x, y) meets the square at t = 5, or passes by. */
static kiwami_ray ray_at(float x, float y) {
  kiwami_ray ray;
  memset(&ray, 0, sizeof ray);
  ray.origin_x = x;
  ray.origin_y = y;
  ray.direction_z = 1;
  ray.tmax = INFINITY;
  ray.mask = 1;
  return ray;
}

static void trace_arrays(const kiwami_scene* scene) {
  kiwami_ray rays[2];
  kiwami_hit hits[2];
  uint8_t occluded[2] = {7, 7};
  kiwami_query query;
  EXPECT(kiwami_query_init(&query, sizeof query) == KIWAMI_OK);
  query.flags = KIWAMI_QUERY_CALLING_THREAD;
  rays[0] = ray_at(0.5f, 0.25f);
  rays[1] = ray_at(3, 0);
  EXPECT(kiwami_closest_hit(scene, rays, 0, hits, 0, 2, &query) == KIWAMI_OK);
  EXPECT(hits[0].t == 5 && hits[0].primitive_id == 0 && hits[0].geometry_id == 0);
  EXPECT(hits[0].u == 0.125f && hits[0].v == 0.625f);
  EXPECT(hits[0].normal_x == 0 && hits[0].normal_y == 0 && hits[0].normal_z == 4);
  EXPECT(hits[0].instance_id == KIWAMI_INVALID_ID);
  EXPECT(isinf(hits[1].t) && hits[1].primitive_id == KIWAMI_INVALID_ID);
  EXPECT(hits[1].geometry_id == KIWAMI_INVALID_ID && hits[1].u == 0 && hits[1].normal_z == 0);
  EXPECT(kiwami_any_hit(scene, rays, 0, occluded, 0, 2, NULL) == KIWAMI_OK);
  EXPECT(occluded[0] == 1 && occluded[1] == 0);
}

static void build_a_tree(kiwami_device* device) {
  float boxes[3][6] = {{0, 0, 0, 1, 1, 1}, {4, 0, 0, 5, 1, 1}, {9, 0, 0, 10, 1, 1}};
  const kiwami_parameter_value leaf_size = {KIWAMI_PARAMETER_MAX_LEAF_SIZE, 0, 1};
  kiwami_bvh* bvh = NULL;
  kiwami_bvh_desc desc;
  kiwami_bvh_node root;
  kiwami_binary_node nodes[5];
  kiwami_bvh_primitive primitives[3];
  size_t node_count = 0;
  EXPECT(kiwami_bvh_desc_init(&desc, sizeof desc) == KIWAMI_OK);
  desc.width = 2;
  desc.boxes = boxes;
  desc.box_count = 3;
  desc.parameters = &leaf_size;
  desc.parameter_count = 1;
  EXPECT(kiwami_bvh_build(device, &desc, &bvh) == KIWAMI_OK);
  EXPECT(kiwami_bvh_export_counts(bvh, KIWAMI_EXPORT_BINARY, &node_count, NULL) == KIWAMI_OK);
  EXPECT(node_count == 5);
  EXPECT(kiwami_bvh_export(bvh, KIWAMI_EXPORT_BINARY, nodes, sizeof nodes, primitives, 3) ==
         KIWAMI_OK);
  EXPECT(nodes[0].first == 1 && nodes[0].count == 0 && nodes[0].upper[0] == 10);
  boxes[2][3] = 12;
  EXPECT(kiwami_bvh_refit(bvh, boxes, 0, 3) == KIWAMI_OK);
  EXPECT(kiwami_bvh_validate(bvh) == KIWAMI_OK);
  EXPECT(kiwami_bvh_get_nodes(bvh, 0, 1, &root, 0) == KIWAMI_OK);
  EXPECT(root.child_count == 2 && root.lower[0] == 0 && root.upper[0] == 12);
  kiwami_bvh_release(bvh);
}

static void count_visits(const kiwami_scene* scene) {
  const kiwami_ray ray = ray_at(0.5f, 0.25f);
  kiwami_visits visits;
  visits.struct_size = sizeof visits;
  EXPECT(kiwami_scene_count_visits(scene, &ray, 0, 1, KIWAMI_COUNT_ANY_HIT, &visits, NULL, 0) ==
         KIWAMI_OK);
  EXPECT(visits.ray_count == 1 && visits.hit_count == 1 && visits.leaf_visits >= 1);
}

static void trace_fields(const kiwami_scene* scene) {
  const float x[2] = {-0.5f, 3}, zero = 0, one = 1;
  float t[2];
  uint8_t occluded[2] = {7, 7};
  kiwami_ray_fields rays;
  kiwami_hit_fields hits;
  kiwami_output_field answers;
  EXPECT(kiwami_ray_fields_init(&rays, sizeof rays) == KIWAMI_OK);
  EXPECT(kiwami_hit_fields_init(&hits, sizeof hits) == KIWAMI_OK);
  rays.origin_x.data = x;
  rays.origin_x.stride = sizeof x[0];
  rays.origin_y.data = rays.origin_z.data = &zero;
  rays.direction_x.data = rays.direction_y.data = &zero;
  rays.direction_z.data = &one;
  hits.t.data = t;
  hits.t.stride = sizeof t[0];
  EXPECT(kiwami_closest_hit_fields(scene, &rays, &hits, 2, NULL) == KIWAMI_OK);
  EXPECT(t[0] == 5 && isinf(t[1]));
  answers.data = occluded;
  answers.stride = 1;
  EXPECT(kiwami_any_hit_fields(scene, &rays, &answers, 2, NULL) == KIWAMI_OK);
  EXPECT(occluded[0] == 1 && occluded[1] == 0);
}

int main(void) {
  kiwami_device* device = NULL;
  kiwami_geometry* mesh;
  kiwami_scene* scene;
  kiwami_device_desc desc;
  kiwami_device_info info;
  char text[8] = "";
  EXPECT(kiwami_version() ==
         1000000 * KIWAMI_VERSION_MAJOR + 1000 * KIWAMI_VERSION_MINOR + KIWAMI_VERSION_PATCH);
  EXPECT(kiwami_abi_version() == KIWAMI_ABI_VERSION);
  EXPECT(strcmp(kiwami_result_name(KIWAMI_ERROR_INVALID_STATE), "invalid state") == 0);
  EXPECT(strcmp(kiwami_isa_name(KIWAMI_ISA_AVX2), "avx2") == 0);
  EXPECT(kiwami_device_desc_init(&desc, sizeof desc) == KIWAMI_OK);
  EXPECT(kiwami_device_create(&desc, &device) == KIWAMI_OK);
  kiwami_device_retain(device);
  kiwami_device_release(device);
  info.struct_size = sizeof info;
  EXPECT(kiwami_device_get_info(device, &info) == KIWAMI_OK);
  EXPECT((info.isa_available >> info.isa & 1) != 0 && info.thread_count >= 1);
  EXPECT(kiwami_scene_commit(NULL) == KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT(kiwami_last_error(NULL, text, sizeof text) > sizeof text && strlen(text) == 7);

  build_a_tree(device);
  mesh = make_square(device);
  scene = make_scene(device, mesh);
  kiwami_geometry_release(mesh);
  kiwami_device_release(device); /* the scene holds both */
  look_at_the_tree(scene);
  trace_arrays(scene);
  trace_fields(scene);
  count_visits(scene);
  kiwami_scene_release(scene);
  return 0;
}

/* SPDX-License-Identifier: Apache-2.0
 *
 * Writes the conformance vectors: scenes, rays, and what the library answers, to the bit. Every
 * binding must give the same. The scalar kernels answer, which are the oracle of all others.
 *
 *   make_vectors triangles [FILE] > vectors.txt
 *   make_vectors shapes | moving_meshes | instances | changes | lights > FEATURE.txt
 *
 * FILE receives the scene of several meshes as kiwami_scene_save writes it.
 *
 * The format is explained in README.md. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "record.h"

static void save_scene(kiwami_scene* scene, const char* path) {
  kiwami_save_desc desc;
  require(kiwami_save_desc_init(&desc, sizeof(desc)), "save");
  desc.path = path;
  require(kiwami_scene_save(scene, &desc, NULL), "save");
}

/* path: where to save the scene, or NULL. is_file: whether it is the one that is saved. */
static void print_scene(kiwami_device* device, const char* name, const mesh* meshes, int count,
                        int is_file, const char* path) {
  recorder to;
  kiwami_ray rays[kRayCount];
  begin_scene(&to, device, name);
  for (int i = 0; i < count; ++i) record_mesh(&to, &meshes[i]);
  record_commit(&to);
  make_rays(meshes[0].vertices, meshes[0].vertex_count, rays);
  record_answers(&to, rays);
  if (is_file) printf("file scene.kiwami\n");
  if (is_file && path) save_scene(to.scene, path);
  end_scene(&to);
}

/* Prints what a call that must fail says. */
static void print_error(kiwami_device* device, const char* name, kiwami_result result) {
  char sentence[512];
  kiwami_last_error(device, sentence, sizeof(sentence));
  printf("error %s %" PRId32 " %s\n", name, result, sentence);
}

static void print_errors(kiwami_device* device) {
  static const float vertices[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  static const uint32_t triangle[3] = {0, 1, 3};
  kiwami_triangle_mesh_desc desc;
  kiwami_geometry* geometry;
  kiwami_scene* scene;
  kiwami_hit hit;
  kiwami_ray ray;
  memset(&ray, 0, sizeof(ray));
  require(kiwami_triangle_mesh_desc_init(&desc, sizeof(desc)), "mesh");
  desc.vertices = vertices;
  desc.vertex_count = 3;
  desc.indices = triangle;
  desc.triangle_count = 1;
  print_error(device, "index_beyond_vertices",
              kiwami_triangle_mesh_create(device, &desc, &geometry));
  require(kiwami_scene_create(device, &scene), "scene");
  print_error(device, "unknown_geometry", kiwami_scene_detach(scene, 5));
  print_error(device, "parameter_out_of_bounds",
              kiwami_scene_set_parameter(scene, KIWAMI_PARAMETER_BIN_COUNT, 1000.0));
  print_error(device, "not_committed", kiwami_closest_hit(scene, &ray, 0, &hit, 0, 1, NULL));
  kiwami_scene_release(scene);
}

void print_triangles(kiwami_device* device, const char* path) {
  static mesh meshes[2];
  make_box(&meshes[0], 1.0f, ~0u);
  print_scene(device, "box", meshes, 1, 0, NULL);
  make_soup(&meshes[1], 128, 2u);
  print_scene(device, "box_and_soup", meshes, 2, 1, path);
  meshes[0].triangle_count = 0;
  print_scene(device, "empty", meshes, 1, 0, NULL);
  print_errors(device);
}

int main(int argument_count, char** arguments) {
  const char* const feature = argument_count > 1 ? arguments[1] : "";
  kiwami_device_desc desc;
  kiwami_device* device;
  require(kiwami_device_desc_init(&desc, sizeof(desc)), "device");
  desc.isa = KIWAMI_ISA_SCALAR;
  require(kiwami_device_create(&desc, &device), "device");
  printf("kiwami-conformance 1\n");
  seed_random(2019);
  if (strcmp(feature, "triangles") == 0) {
    print_triangles(device, argument_count > 2 ? arguments[2] : NULL);
  } else if (strcmp(feature, "shapes") == 0) {
    print_shapes(device);
  } else if (strcmp(feature, "moving_meshes") == 0) {
    print_moving_meshes(device);
  } else if (strcmp(feature, "instances") == 0) {
    print_instances(device);
  } else if (strcmp(feature, "changes") == 0) {
    print_changes(device);
  } else if (strcmp(feature, "lights") == 0) {
    print_lights(device);
  } else {
    fprintf(stderr,
            "make_vectors: the feature is '%s', expected triangles, shapes, "
            "moving_meshes, instances, changes or lights\n",
            feature);
    return 2;
  }
  kiwami_device_release(device);
  return 0;
}

/* SPDX-License-Identifier: Apache-2.0
 *
 * Scenes of what is not a mesh at rest. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "record.h"

enum { kShapeCount = 48, kStepCount = 4, kInstanceCount = 12 };

/* Points of random places; radii from 1/16 to a half, and one that makes its shapes none. */
static void make_points(float (*points)[4], float (*centers)[3]) {
  for (int i = 0; i < kShapeCount; ++i) {
    for (int axis = 0; axis < 3; ++axis) centers[i][axis] = random_number();
    memcpy(points[i], centers[i], sizeof(centers[i]));
    points[i][3] = i == 20 ? -1.0f : (float)(1 + random_bits() % 8) / 16.0f;
  }
}

static void record_spheres(recorder* to, float (*points)[4], uint32_t mask) {
  kiwami_spheres_desc desc;
  kiwami_geometry* geometry;
  printf("spheres %" PRIu32 " %d\n", mask, kShapeCount);
  print_words(points, kShapeCount, 4);
  require(kiwami_spheres_desc_init(&desc, sizeof(desc)), "spheres");
  desc.points = points;
  desc.sphere_count = kShapeCount;
  desc.mask = mask;
  require(kiwami_spheres_create(to->device, &desc, &geometry), "spheres");
  attach(to, geometry);
}

static void record_discs(recorder* to, float (*points)[4], float (*normals)[3], uint32_t mask) {
  kiwami_discs_desc desc;
  kiwami_geometry* geometry;
  printf("discs %" PRIu32 " %d\n", mask, kShapeCount);
  print_words(points, kShapeCount, 4);
  print_words(normals, kShapeCount, 3);
  require(kiwami_discs_desc_init(&desc, sizeof(desc)), "discs");
  desc.points = points;
  desc.normals = normals;
  desc.disc_count = kShapeCount;
  desc.mask = mask;
  require(kiwami_discs_create(to->device, &desc, &geometry), "discs");
  attach(to, geometry);
}

static void record_curves(recorder* to, float (*points)[4], const uint32_t* segments,
                          uint32_t segment_count, uint32_t mask) {
  kiwami_curves_desc desc;
  kiwami_geometry* geometry;
  printf("curves %" PRIu32 " %d %" PRIu32 "\n", mask, kShapeCount, segment_count);
  print_words(points, kShapeCount, 4);
  print_words(segments, segment_count, 1);
  require(kiwami_curves_desc_init(&desc, sizeof(desc)), "curves");
  desc.points = points;
  desc.point_count = kShapeCount;
  desc.indices = segments;
  desc.segment_count = segment_count;
  desc.mask = mask;
  require(kiwami_curves_create(to->device, &desc, &geometry), "curves");
  attach(to, geometry);
}

void print_shapes(kiwami_device* device) {
  static float points[kShapeCount][4], centers[kShapeCount][3], normals[kShapeCount][3];
  uint32_t segments[kShapeCount / 2];
  kiwami_ray rays[kRayCount];
  recorder to;
  make_points(points, centers);
  for (int i = 0; i < kShapeCount; ++i) {
    for (int axis = 0; axis < 3; ++axis) normals[i][axis] = random_number();
  }
  for (uint32_t i = 0; i < kShapeCount / 2; ++i) segments[i] = 2 * i;
  make_rays(centers, kShapeCount, rays);
  begin_scene(&to, device, "spheres");
  record_spheres(&to, points, ~0u);
  record_commit(&to);
  record_answers(&to, rays);
  end_scene(&to);
  begin_scene(&to, device, "spheres_discs_and_curves");
  record_spheres(&to, points, 1u);
  record_discs(&to, points, normals, 2u);
  record_curves(&to, points, segments, kShapeCount / 2, 3u);
  record_commit(&to);
  record_answers(&to, rays);
  end_scene(&to);
}

/* Each step lies a little beside the one before. */
static void record_moving_mesh(recorder* to, const mesh* made, float time_begin, float time_end) {
  static float vertices[kStepCount * kMaxVertices][3];
  const uint32_t count = made->vertex_count;
  kiwami_moving_mesh_desc desc;
  kiwami_geometry* geometry;
  for (uint32_t i = 0; i < kStepCount * count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const float before = i < count ? made->vertices[i][axis] : vertices[i - count][axis];
      vertices[i][axis] = before + random_number() / 4.0f;
    }
  }
  printf("moving_mesh %" PRIu32 " %d %" PRIu32 " %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", made->mask,
         kStepCount, bits_of(time_begin), bits_of(time_end), count, made->triangle_count);
  print_words(vertices, (size_t)kStepCount * count, 3);
  print_words(made->triangles, made->triangle_count, 3);
  require(kiwami_moving_mesh_desc_init(&desc, sizeof(desc)), "moving mesh");
  desc.vertices = vertices;
  desc.vertex_count = count;
  desc.indices = made->triangles;
  desc.triangle_count = made->triangle_count;
  desc.step_count = kStepCount;
  desc.time_begin = time_begin;
  desc.time_end = time_end;
  desc.mask = made->mask;
  require(kiwami_moving_mesh_create(to->device, &desc, &geometry), "moving mesh");
  attach(to, geometry);
}

void print_moving_meshes(kiwami_device* device) {
  static mesh box, soup;
  kiwami_ray rays[kRayCount];
  recorder to;
  make_box(&box, 1.0f, ~0u);
  make_soup(&soup, 32, 2u);
  make_rays(box.vertices, box.vertex_count, rays);
  begin_scene(&to, device, "moving_box");
  record_moving_mesh(&to, &box, 0.0f, 1.0f);
  record_commit(&to);
  record_answers(&to, rays);
  end_scene(&to);
  begin_scene(&to, device, "moving_and_resting");
  record_moving_mesh(&to, &box, 0.25f, 0.75f);
  record_moving_mesh(&to, &soup, 0.0f, 1.0f);
  record_mesh(&to, &soup);
  record_commit(&to);
  record_answers(&to, rays);
  end_scene(&to);
}

/* Instances of these scenes in turn, each moved, turned and sheared, every third one masked. */
static void record_instances(recorder* to, kiwami_scene* const* scenes, const char* const* names,
                             uint32_t scene_count, float scale) {
  static float transforms[kInstanceCount][12];
  uint32_t indices[kInstanceCount], masks[kInstanceCount];
  kiwami_instances_desc desc;
  kiwami_geometry* geometry;
  printf("instances %" PRIu32 " %" PRIu32 " %d\n", ~(uint32_t)0, scene_count, kInstanceCount);
  for (uint32_t i = 0; i < scene_count; ++i) printf("%s\n", names[i]);
  for (uint32_t i = 0; i < kInstanceCount; ++i) {
    indices[i] = i % scene_count;
    masks[i] = i % 3 == 2 ? 2u : ~(uint32_t)0;
    for (int k = 0; k < 12; ++k) {
      const float number = random_number();
      transforms[i][k] = k % 4 == 3 ? number : number / 8.0f + (k % 5 == 0 ? scale : 0.0f);
    }
    printf("%" PRIu32 " %" PRIu32 " ", indices[i], masks[i]);
    print_words(transforms[i], 1, 12);
  }
  require(kiwami_instances_desc_init(&desc, sizeof(desc)), "instances");
  desc.scenes = scenes;
  desc.scene_count = scene_count;
  desc.scene_indices = indices;
  desc.transforms = transforms;
  desc.masks = masks;
  desc.count = kInstanceCount;
  require(kiwami_instances_create(to->device, &desc, &geometry), "instances");
  attach(to, geometry);
}

void print_instances(kiwami_device* device) {
  static mesh box, soup;
  static const char* const names[] = {"box", "soup", "several"};
  kiwami_scene* scenes[3];
  kiwami_ray rays[kRayCount];
  recorder to[4];
  make_box(&box, 1.0f, ~0u);
  make_soup(&soup, 32, 3u);
  make_rays(box.vertices, box.vertex_count, rays);
  begin_scene(&to[0], device, names[0]);
  record_mesh(&to[0], &box);
  record_commit(&to[0]);
  printf("end\n");
  begin_scene(&to[1], device, names[1]);
  record_mesh(&to[1], &soup);
  record_commit(&to[1]);
  printf("end\n");
  scenes[0] = to[0].scene;
  scenes[1] = to[1].scene;
  begin_scene(&to[2], device, names[2]);
  record_instances(&to[2], scenes, names, 2, 0.5f);
  record_commit(&to[2]);
  record_answers(&to[2], rays);
  printf("end\n");
  scenes[2] = to[2].scene;
  begin_scene(&to[3], device, "nested");
  record_mesh(&to[3], &box);
  record_instances(&to[3], scenes, names, 3, 0.75f);
  record_commit(&to[3]);
  record_answers(&to[3], rays);
  printf("end\n");
  for (int i = 0; i < 4; ++i) kiwami_scene_release(to[i].scene);
}

void print_changes(kiwami_device* device) {
  static mesh box, soup;
  kiwami_ray rays[kRayCount];
  kiwami_geometry* moved;
  recorder to;
  make_box(&box, 1.0f, ~0u);
  make_soup(&soup, 48, 3u);
  make_rays(box.vertices, box.vertex_count, rays);
  begin_scene(&to, device, "changes");
  record_mesh(&to, &box);
  printf("mesh %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", soup.mask, soup.vertex_count,
         soup.triangle_count);
  print_words(soup.vertices, soup.vertex_count, 3);
  print_words(soup.triangles, soup.triangle_count, 3);
  moved = create_mesh(device, &soup);
  require(kiwami_scene_attach(to.scene, moved, NULL), "attach");
  record_commit(&to);
  record_answers(&to, rays);
  for (uint32_t i = 0; i < soup.vertex_count; ++i) soup.vertices[i][0] += random_number() / 8.0f;
  record_vertices(&to, moved, 1, &soup);
  record_refit(&to);
  record_answers(&to, rays);
  record_enable(&to, 0, 0);
  record_commit(&to);
  record_answers(&to, rays);
  record_enable(&to, 0, 1);
  record_remove(&to, 1);
  record_commit(&to);
  record_answers(&to, rays);
  kiwami_geometry_release(moved);
  end_scene(&to);
}

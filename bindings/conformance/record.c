/* SPDX-License-Identifier: Apache-2.0 */
#include "record.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kMaxHits = 3 };

void require(kiwami_result result, const char* what) {
  char sentence[512];
  if (result == KIWAMI_OK) return;
  kiwami_last_error(NULL, sentence, sizeof(sentence));
  fprintf(stderr, "make_vectors: %s: %s\n", what, sentence);
  exit(1);
}

uint32_t bits_of(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof(bits));
  return bits;
}

/* PCG XSH RR (O'Neill, 2014). */
static uint64_t random_state;

void seed_random(uint64_t seed) { random_state = seed; }

uint32_t random_bits(void) {
  const uint64_t old = random_state;
  const uint32_t mixed = (uint32_t)(((old >> 18) ^ old) >> 27);
  const uint32_t turn = (uint32_t)(old >> 59);
  random_state = old * 6364136223846793005u + 1442695040888963407u;
  return (mixed >> turn) | (mixed << (-turn & 31u));
}

float random_number(void) { return (float)((int32_t)(random_bits() >> 20) - 2048) / 1024.0f; }

static void add_vertex(mesh* made, float x, float y, float z) {
  float* const vertex = made->vertices[made->vertex_count++];
  vertex[0] = x;
  vertex[1] = y;
  vertex[2] = z;
}

static void add_triangle(mesh* made, uint32_t a, uint32_t b, uint32_t c) {
  uint32_t* const triangle = made->triangles[made->triangle_count++];
  triangle[0] = a;
  triangle[1] = b;
  triangle[2] = c;
}

void make_box(mesh* made, float s, uint32_t mask) {
  static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  memset(made, 0, sizeof(*made));
  made->mask = mask;
  for (int i = 0; i < 8; ++i) {
    add_vertex(made, i & 1 ? s : -s, i & 2 ? s : -s, i & 4 ? s : -s);
  }
  for (int i = 0; i < 6; ++i) {
    add_triangle(made, quads[i][0], quads[i][1], quads[i][2]);
    add_triangle(made, quads[i][0], quads[i][2], quads[i][3]);
  }
}

void make_soup(mesh* made, uint32_t count, uint32_t mask) {
  memset(made, 0, sizeof(*made));
  made->mask = mask;
  for (uint32_t i = 0; i < count; ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      const float x = random_number(), y = random_number(), z = random_number();
      add_vertex(made, x, y, z);
    }
    if (i % 8 == 7) {
      const uint32_t nan_bits = 0x7FC00000u;
      memcpy(&made->vertices[3 * i][1], &nan_bits, sizeof(nan_bits));
    }
    add_triangle(made, 3 * i, 3 * i + 1, 3 * i + 2);
  }
}

void make_rays(const float (*aims)[3], uint32_t aim_count, kiwami_ray* rays) {
  memset(rays, 0, kRayCount * sizeof(*rays));
  for (uint32_t i = 0; i < kRayCount; ++i) {
    kiwami_ray* const ray = &rays[i];
    const float* const aim = aims[random_bits() % aim_count];
    ray->origin_x = random_number() * 2.0f;
    ray->origin_y = random_number() * 2.0f;
    ray->origin_z = random_number() * 2.0f;
    ray->direction_x = i % 3 == 0 ? random_number() : aim[0] - ray->origin_x;
    ray->direction_y = i % 3 == 0 ? random_number() : aim[1] - ray->origin_y;
    ray->direction_z = i % 3 == 0 ? random_number() : aim[2] - ray->origin_z;
    ray->tmin = i % 5 == 0 ? 0.5f : 0.0f;
    ray->tmax = i % 7 == 0 ? 1.0f : 1e30f;
    ray->time = (float)(i % 9) / 8.0f;
    ray->mask = i % 4 == 0 ? 1u : ~0u;
    ray->flags = i % 6 == 0 ? KIWAMI_RAY_CULL_BACK_FACES : 0u;
    ray->id = i;
  }
  rays[10].direction_x = rays[10].direction_y = rays[10].direction_z = 0.0f;
  rays[11].tmax = -1.0f;
  rays[12].mask = 0;
}

void print_words(const void* words, size_t rows, size_t columns) {
  const unsigned char* from = (const unsigned char*)words;
  for (size_t row = 0; row < rows; ++row) {
    for (size_t column = 0; column < columns; ++column, from += sizeof(uint32_t)) {
      uint32_t word;
      memcpy(&word, from, sizeof(word));
      printf("%" PRIu32 "%c", word, column + 1 < columns ? ' ' : '\n');
    }
  }
}

void begin_scene(recorder* to, kiwami_device* device, const char* name) {
  printf("scene %s\n", name);
  to->device = device;
  require(kiwami_scene_create(device, &to->scene), "scene");
}

void attach(recorder* to, kiwami_geometry* geometry) {
  require(kiwami_scene_attach(to->scene, geometry, NULL), "attach");
  kiwami_geometry_release(geometry);
}

kiwami_geometry* create_mesh(kiwami_device* device, const mesh* made) {
  kiwami_triangle_mesh_desc desc;
  kiwami_geometry* geometry;
  require(kiwami_triangle_mesh_desc_init(&desc, sizeof(desc)), "mesh");
  desc.vertices = made->vertices;
  desc.vertex_count = made->vertex_count;
  desc.indices = made->triangles;
  desc.triangle_count = made->triangle_count;
  desc.mask = made->mask;
  require(kiwami_triangle_mesh_create(device, &desc, &geometry), "mesh");
  return geometry;
}

void record_mesh(recorder* to, const mesh* made) {
  printf("mesh %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", made->mask, made->vertex_count,
         made->triangle_count);
  print_words(made->vertices, made->vertex_count, 3);
  print_words(made->triangles, made->triangle_count, 3);
  attach(to, create_mesh(to->device, made));
}

void record_vertices(recorder* to, kiwami_geometry* geometry, uint32_t number, const mesh* made) {
  (void)to;
  printf("vertices %" PRIu32 " %" PRIu32 "\n", number, made->vertex_count);
  print_words(made->vertices, made->vertex_count, 3);
  require(kiwami_triangle_mesh_update_vertices(geometry, made->vertices, 0, 0), "vertices");
}

void record_enable(recorder* to, uint32_t number, int is_enabled) {
  printf("enable %" PRIu32 " %d\n", number, is_enabled);
  require(kiwami_scene_enable(to->scene, number, is_enabled), "enable");
}

void record_remove(recorder* to, uint32_t number) {
  printf("remove %" PRIu32 "\n", number);
  require(kiwami_scene_detach(to->scene, number), "remove");
}

void record_commit(recorder* to) {
  printf("commit\n");
  require(kiwami_scene_commit(to->scene), "commit");
}

void record_refit(recorder* to) {
  printf("refit\n");
  require(kiwami_scene_refit(to->scene), "refit");
}

static void print_multi_hits(kiwami_scene* scene, const kiwami_ray* rays, uint32_t max_hits) {
  static kiwami_hit hits[kRayCount * kMaxTriangles];
  uint64_t offsets[kRayCount + 1];
  require(kiwami_multi_hit(scene, rays, 0, kRayCount, max_hits, hits,
                           sizeof(hits) / sizeof(hits[0]), offsets, NULL),
          "multi hit");
  printf("multi_hit %" PRIu32 " %" PRIu64 "\n", max_hits, offsets[kRayCount]);
  for (int i = 0; i <= kRayCount; ++i) printf("%" PRIu64 "\n", offsets[i]);
  print_words(hits, (size_t)offsets[kRayCount], sizeof(kiwami_hit) / sizeof(uint32_t));
}

void record_answers(recorder* to, const kiwami_ray* rays) {
  kiwami_hit hits[kRayCount];
  uint8_t occluded[kRayCount];
  printf("rays %d\n", kRayCount);
  print_words(rays, kRayCount, sizeof(kiwami_ray) / sizeof(uint32_t));
  require(kiwami_closest_hit(to->scene, rays, 0, hits, 0, kRayCount, NULL), "closest hit");
  printf("closest_hit\n");
  print_words(hits, kRayCount, sizeof(kiwami_hit) / sizeof(uint32_t));
  require(kiwami_any_hit(to->scene, rays, 0, occluded, 0, kRayCount, NULL), "any hit");
  printf("any_hit\n");
  for (int i = 0; i < kRayCount; ++i) printf("%d\n", occluded[i]);
  print_multi_hits(to->scene, rays, kMaxHits);
  print_multi_hits(to->scene, rays, 0);
}

void end_scene(recorder* to) {
  printf("end\n");
  kiwami_scene_release(to->scene);
}

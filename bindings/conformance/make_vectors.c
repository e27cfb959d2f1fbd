/* SPDX-License-Identifier: Apache-2.0
 *
 * Writes the conformance vectors: scenes, rays, and what the library answers, to the bit. Every
 * binding must give the same. The scalar kernels answer, which are the oracle of all others.
 *
 *   make_vectors [FILE] > vectors.txt
 *
 * FILE receives the scene of several meshes as kiwami_scene_save writes it.
 *
 * The format is explained in README.md. */
#include <inttypes.h>
#include <kiwami/kiwami.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kMaxVertices = 1024, kMaxTriangles = 2048, kRayCount = 64, kMaxHits = 3 };

typedef struct mesh {
  uint32_t mask, vertex_count, triangle_count;
  float vertices[kMaxVertices][3];
  uint32_t triangles[kMaxTriangles][3];
} mesh;

static void require(kiwami_result result, const char* what) {
  char sentence[512];
  if (result == KIWAMI_OK) return;
  kiwami_last_error(NULL, sentence, sizeof(sentence));
  fprintf(stderr, "make_vectors: %s: %s\n", what, sentence);
  exit(1);
}

static uint32_t bits_of(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof(bits));
  return bits;
}

/* Random numbers that every C library gives alike: PCG XSH RR (O'Neill, 2014). */
static uint64_t random_state;

static uint32_t random_bits(void) {
  const uint64_t old = random_state;
  const uint32_t mixed = (uint32_t)(((old >> 18) ^ old) >> 27);
  const uint32_t turn = (uint32_t)(old >> 59);
  random_state = old * 6364136223846793005u + 1442695040888963407u;
  return (mixed >> turn) | (mixed << (-turn & 31u));
}

/* A multiple of 2^-10 in [-2, 2). */
static float random_number(void) {
  return (float)((int32_t)(random_bits() >> 20) - 2048) / 1024.0f;
}

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

/* A box from (-s, -s, -s) to (s, s, s), its normals outwards. */
static void make_box(mesh* made, float s, uint32_t mask) {
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

/* Loose triangles, every eighth with a vertex that is not a number: it is never hit. */
static void make_soup(mesh* made, uint32_t count, uint32_t mask) {
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

/* Rays at random, at corners and along edges, with bounds, masks and flags, and bad ones. */
static void make_rays(const mesh* target, kiwami_ray* rays) {
  memset(rays, 0, kRayCount * sizeof(*rays));
  for (uint32_t i = 0; i < kRayCount; ++i) {
    kiwami_ray* const ray = &rays[i];
    const float* const aim = target->vertices[random_bits() % target->vertex_count];
    ray->origin_x = random_number() * 2.0f;
    ray->origin_y = random_number() * 2.0f;
    ray->origin_z = random_number() * 2.0f;
    ray->direction_x = i % 3 == 0 ? random_number() : aim[0] - ray->origin_x;
    ray->direction_y = i % 3 == 0 ? random_number() : aim[1] - ray->origin_y;
    ray->direction_z = i % 3 == 0 ? random_number() : aim[2] - ray->origin_z;
    ray->tmin = i % 5 == 0 ? 0.5f : 0.0f;
    ray->tmax = i % 7 == 0 ? 1.0f : 1e30f;
    ray->mask = i % 4 == 0 ? 1u : ~0u;
    ray->flags = i % 6 == 0 ? KIWAMI_RAY_CULL_BACK_FACES : 0u;
    ray->id = i;
  }
  rays[10].direction_x = rays[10].direction_y = rays[10].direction_z = 0.0f;
  rays[11].tmax = -1.0f;
  rays[12].mask = 0;
}

static void print_mesh(const mesh* made) {
  printf("mesh %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", made->mask, made->vertex_count,
         made->triangle_count);
  for (uint32_t i = 0; i < made->vertex_count; ++i) {
    printf("%" PRIu32 " %" PRIu32 " %" PRIu32 "\n", bits_of(made->vertices[i][0]),
           bits_of(made->vertices[i][1]), bits_of(made->vertices[i][2]));
  }
  for (uint32_t i = 0; i < made->triangle_count; ++i) {
    printf("%" PRIu32 " %" PRIu32 " %" PRIu32 "\n", made->triangles[i][0], made->triangles[i][1],
           made->triangles[i][2]);
  }
}

/* Rays and hits are words of 32 bits one after the other; so they are printed. */
static void print_words(const void* words, size_t rows, size_t columns) {
  const unsigned char* from = (const unsigned char*)words;
  for (size_t row = 0; row < rows; ++row) {
    for (size_t column = 0; column < columns; ++column, from += sizeof(uint32_t)) {
      uint32_t word;
      memcpy(&word, from, sizeof(word));
      printf("%" PRIu32 "%c", word, column + 1 < columns ? ' ' : '\n');
    }
  }
}

static void attach_mesh(kiwami_device* device, kiwami_scene* scene, const mesh* made) {
  kiwami_triangle_mesh_desc desc;
  kiwami_geometry* geometry;
  require(kiwami_triangle_mesh_desc_init(&desc, sizeof(desc)), "mesh");
  desc.vertices = made->vertices;
  desc.vertex_count = made->vertex_count;
  desc.indices = made->triangles;
  desc.triangle_count = made->triangle_count;
  desc.mask = made->mask;
  require(kiwami_triangle_mesh_create(device, &desc, &geometry), "mesh");
  require(kiwami_scene_attach(scene, geometry, NULL), "attach");
  kiwami_geometry_release(geometry);
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

static void save_scene(kiwami_scene* scene, const char* path) {
  kiwami_save_desc desc;
  require(kiwami_save_desc_init(&desc, sizeof(desc)), "save");
  desc.path = path;
  require(kiwami_scene_save(scene, &desc, NULL), "save");
}

/* path: where to save the scene, or NULL. is_file: whether it is the one that is saved. */
static void print_scene(kiwami_device* device, const char* name, const mesh* meshes, int count,
                        int is_file, const char* path) {
  kiwami_scene* scene;
  kiwami_ray rays[kRayCount];
  kiwami_hit hits[kRayCount];
  uint8_t occluded[kRayCount];
  printf("scene %s\n", name);
  require(kiwami_scene_create(device, &scene), "scene");
  for (int i = 0; i < count; ++i) {
    print_mesh(&meshes[i]);
    attach_mesh(device, scene, &meshes[i]);
  }
  require(kiwami_scene_commit(scene), "commit");
  make_rays(&meshes[0], rays);
  printf("rays %d\n", kRayCount);
  print_words(rays, kRayCount, sizeof(kiwami_ray) / sizeof(uint32_t));
  require(kiwami_closest_hit(scene, rays, 0, hits, 0, kRayCount, NULL), "closest hit");
  printf("closest_hit\n");
  print_words(hits, kRayCount, sizeof(kiwami_hit) / sizeof(uint32_t));
  require(kiwami_any_hit(scene, rays, 0, occluded, 0, kRayCount, NULL), "any hit");
  printf("any_hit\n");
  for (int i = 0; i < kRayCount; ++i) printf("%d\n", occluded[i]);
  print_multi_hits(scene, rays, kMaxHits);
  print_multi_hits(scene, rays, 0);
  if (is_file) printf("file scene.kiwami\n");
  if (is_file && path) save_scene(scene, path);
  printf("end\n");
  kiwami_scene_release(scene);
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

int main(int argument_count, char** arguments) {
  static mesh meshes[2];
  kiwami_device_desc desc;
  kiwami_device* device;
  require(kiwami_device_desc_init(&desc, sizeof(desc)), "device");
  desc.isa = KIWAMI_ISA_SCALAR;
  require(kiwami_device_create(&desc, &device), "device");
  printf("kiwami-conformance 1\n");
  random_state = 2019;
  make_box(&meshes[0], 1.0f, ~0u);
  print_scene(device, "box", meshes, 1, 0, NULL);
  make_soup(&meshes[1], 128, 2u);
  print_scene(device, "box_and_soup", meshes, 2, 1, argument_count > 1 ? arguments[1] : NULL);
  meshes[0].triangle_count = 0;
  print_scene(device, "empty", meshes, 1, 0, NULL);
  print_errors(device);
  kiwami_device_release(device);
  return 0;
}

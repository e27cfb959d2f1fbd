/* SPDX-License-Identifier: Apache-2.0
 *
 * Scenes of the conformance vectors: each call does what it says and prints it, in the form that
 * README.md explains. */
#ifndef KIWAMI_CONFORMANCE_RECORD_H
#define KIWAMI_CONFORMANCE_RECORD_H

#include <kiwami/kiwami.h>

enum { kMaxVertices = 1024, kMaxTriangles = 2048, kRayCount = 64 };

typedef struct mesh {
  uint32_t mask, vertex_count, triangle_count;
  float vertices[kMaxVertices][3];
  uint32_t triangles[kMaxTriangles][3];
} mesh;

/* A scene while it is recorded. */
typedef struct recorder {
  kiwami_device* device;
  kiwami_scene* scene;
} recorder;

/* Ends the program with the sentence of the last error, unless result is success. */
void require(kiwami_result result, const char* what);

/* Random numbers that every C library gives alike, from this seed on. */
void seed_random(uint64_t seed);
uint32_t random_bits(void);
/* A multiple of 2^-10 in [-2, 2). */
float random_number(void);

/* A box from (-s, -s, -s) to (s, s, s), its normals outwards. */
void make_box(mesh* made, float s, uint32_t mask);
/* Loose triangles, every eighth with a vertex that is not a number: it is never hit. */
void make_soup(mesh* made, uint32_t count, uint32_t mask);
/* kRayCount rays at random, at these points and along lines between them, with bounds, masks, times
 * and flags, and bad ones. */
void make_rays(const float (*aims)[3], uint32_t aim_count, kiwami_ray* rays);

void begin_scene(recorder* to, kiwami_device* device, const char* name);
void record_mesh(recorder* to, const mesh* made);
void record_vertices(recorder* to, kiwami_geometry* geometry, uint32_t number, const mesh* made);
void record_enable(recorder* to, uint32_t number, int is_enabled);
void record_remove(recorder* to, uint32_t number);
void record_commit(recorder* to);
void record_refit(recorder* to);
/* Rays, and every kind of answer to them. */
void record_answers(recorder* to, const kiwami_ray* rays);
void end_scene(recorder* to);

/* Attaches a geometry and drops the caller's reference. */
void attach(recorder* to, kiwami_geometry* geometry);
kiwami_geometry* create_mesh(kiwami_device* device, const mesh* made);
/* Numbers of 32 bits, rows of so many columns. */
void print_words(const void* words, size_t rows, size_t columns);
uint32_t bits_of(float value);

/* What each file has; path: where to save the scene of several meshes, or NULL. */
void print_triangles(kiwami_device* device, const char* path);
void print_shapes(kiwami_device* device);
void print_moving_meshes(kiwami_device* device);
void print_instances(kiwami_device* device);
void print_changes(kiwami_device* device);
void print_lights(kiwami_device* device);

#endif

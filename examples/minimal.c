/* SPDX-License-Identifier: Apache-2.0 */
/* The smallest whole program: one mesh, three rays, the hits. */
#include <kiwami/kiwami.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void check(kiwami_result result) {
  char text[512];
  if (result == KIWAMI_OK) return;
  kiwami_last_error(NULL, text, sizeof text);
  fprintf(stderr, "%s: %s\n", kiwami_result_name(result), text);
  exit(1);
}

int main(void) {
  const float vertices[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const uint32_t indices[2][3] = {{0, 1, 2}, {0, 2, 3}};
  kiwami_device* device;
  check(kiwami_device_create(NULL, &device)); /* the best kernels of this machine */

  kiwami_triangle_mesh_desc desc;
  check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc));
  desc.vertices = vertices;
  desc.vertex_count = 4;
  desc.indices = indices;
  desc.triangle_count = 2;
  kiwami_geometry* mesh;
  check(kiwami_triangle_mesh_create(device, &desc, &mesh));

  kiwami_scene* scene;
  check(kiwami_scene_create(device, &scene));
  check(kiwami_scene_attach(scene, mesh, NULL));
  check(kiwami_scene_commit(scene));

  kiwami_ray rays[3];
  kiwami_hit hits[3];
  for (int i = 0; i < 3; ++i) { /* from z = 2 downwards; the third passes by */
    rays[i] = (kiwami_ray){0.25f + 0.5f * i, 0.5f, 2, 0, 0, 0, -1, INFINITY, 0, ~0u, 0, 0};
  }
  check(kiwami_closest_hit(scene, rays, 0, hits, 0, 3, NULL));
  for (int i = 0; i < 3; ++i) {
    if (hits[i].primitive_id == KIWAMI_INVALID_ID) {
      printf("ray %d misses\n", i);
    } else {
      printf("ray %d hits triangle %u at t = %g\n", i, (unsigned)hits[i].primitive_id, hits[i].t);
    }
  }
  kiwami_scene_release(scene);
  kiwami_geometry_release(mesh);
  kiwami_device_release(device);
  return 0;
}

/* SPDX-License-Identifier: Apache-2.0 */
#include <kiwami/kiwami.h>
#include <stdio.h>

int main(void) {
  const float triangle[9] = {-1, -1, 2, 1, -1, 2, 0, 1, 2};
  const kiwami_ray ray = {0, 0, 0, 0, 0, 0, 1, 100, 0, 1, 0, 0};
  kiwami_hit hit;
  kiwami_device* device;
  kiwami_geometry* mesh;
  kiwami_scene* scene;
  kiwami_triangle_mesh_desc desc;
  if (kiwami_triangle_mesh_desc_init(&desc, sizeof desc)) return 1;
  desc.vertices = triangle;
  desc.vertex_count = 3;
  desc.triangle_count = 1;
  if (kiwami_device_create(NULL, &device)) return 1;
  if (kiwami_triangle_mesh_create(device, &desc, &mesh)) return 1;
  if (kiwami_scene_create(device, &scene)) return 1;
  if (kiwami_scene_attach(scene, mesh, NULL)) return 1;
  if (kiwami_scene_commit(scene)) return 1;
  if (kiwami_closest_hit(scene, &ray, 0, &hit, 0, 1, NULL)) return 1;
  printf("hit at %g\n", hit.t);
  kiwami_scene_release(scene);
  kiwami_geometry_release(mesh);
  kiwami_device_release(device);
  return 0;
}

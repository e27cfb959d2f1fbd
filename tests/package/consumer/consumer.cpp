// SPDX-License-Identifier: Apache-2.0
#include <kiwami/kiwami.h>

#include <iostream>
#include <memory>

int main() {
  kiwami_device* handle = nullptr;
  if (kiwami_device_create(nullptr, &handle)) return 1;
  const std::unique_ptr<kiwami_device, void (*)(kiwami_device*)> device(handle,
                                                                        kiwami_device_release);
  const float triangle[9] = {-1, -1, 2, 1, -1, 2, 0, 1, 2};
  kiwami_triangle_mesh_desc desc;
  if (kiwami_triangle_mesh_desc_init(&desc, sizeof desc)) return 1;
  desc.vertices = triangle;
  desc.vertex_count = 3;
  desc.triangle_count = 1;
  kiwami_geometry* mesh = nullptr;
  kiwami_scene* scene = nullptr;
  if (kiwami_triangle_mesh_create(device.get(), &desc, &mesh)) return 1;
  if (kiwami_scene_create(device.get(), &scene)) return 1;
  if (kiwami_scene_attach(scene, mesh, nullptr) || kiwami_scene_commit(scene)) return 1;
  const kiwami_ray ray = {0, 0, 0, 0, 0, 0, 1, 100, 0, 1, 0, 0};
  kiwami_hit hit;
  if (kiwami_closest_hit(scene, &ray, 0, &hit, 0, 1, nullptr)) return 1;
  std::cout << "hit at " << hit.t << "\n";
  kiwami_scene_release(scene);
  kiwami_geometry_release(mesh);
  return 0;
}

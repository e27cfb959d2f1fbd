// SPDX-License-Identifier: Apache-2.0
#include "measure/file_geometries.h"

#include "measure/leaf_mask.h"
#include "measure/library.h"

namespace kiwami::tools {
namespace {

kiwami_triangle_mesh_desc desc_of(const Mesh& mesh) {
  kiwami_triangle_mesh_desc desc;
  throw_on_error(kiwami_triangle_mesh_desc_init(&desc, sizeof desc), nullptr);
  desc.flags = KIWAMI_MESH_SHARE_BUFFERS;
  desc.vertices = mesh.vertices.data();
  desc.vertex_count = mesh.vertex_count();
  desc.indices = mesh.indices.data();
  desc.triangle_count = mesh.triangle_count();
  return desc;
}

/// A mesh at two times.
kiwami_geometry* make_moving(kiwami_device* device, const Mesh& mesh) {
  std::vector<float> vertices = mesh.vertices;
  vertices.insert(vertices.end(), mesh.moved.begin(), mesh.moved.end());
  kiwami_moving_mesh_desc desc;
  throw_on_error(kiwami_moving_mesh_desc_init(&desc, sizeof desc), device);
  desc.vertices = vertices.data();
  desc.vertex_count = mesh.vertex_count();
  desc.indices = mesh.indices.data();
  desc.triangle_count = mesh.triangle_count();
  kiwami_geometry* geometry = nullptr;
  throw_on_error(kiwami_moving_mesh_create(device, &desc, &geometry), device);
  return geometry;
}

/// One array of all instances of a file.
kiwami_geometry* make_resting_instances(kiwami_device* device, const SceneFile& file,
                                        const std::vector<kiwami_scene*>& scenes) {
  kiwami_instances_desc desc;
  throw_on_error(kiwami_instances_desc_init(&desc, sizeof desc), device);
  desc.scenes = scenes.data();
  desc.scene_count = scenes.size();
  desc.scene_indices = &file.instances[0].mesh;
  desc.transforms = file.instances[0].transform.data();
  desc.scene_index_stride = desc.transform_stride = sizeof(Instance);
  desc.count = file.instances.size();
  kiwami_geometry* geometry = nullptr;
  throw_on_error(kiwami_instances_create(device, &desc, &geometry), device);
  return geometry;
}

/// The same at two times.
kiwami_geometry* make_moving_instances(kiwami_device* device, const SceneFile& file,
                                       const std::vector<kiwami_scene*>& scenes) {
  std::vector<std::array<float, 12>> steps;
  for (size_t i = 0; i < file.instances.size(); ++i) {
    steps.push_back(file.instances[i].transform);
    steps.push_back(file.moved_transforms[i]);
  }
  kiwami_moving_instances_desc desc;
  throw_on_error(kiwami_moving_instances_desc_init(&desc, sizeof desc), device);
  desc.scenes = scenes.data();
  desc.scene_count = scenes.size();
  desc.scene_indices = &file.instances[0].mesh;
  desc.scene_index_stride = sizeof(Instance);
  desc.transforms = steps.data();
  desc.count = file.instances.size();
  kiwami_geometry* geometry = nullptr;
  throw_on_error(kiwami_moving_instances_create(device, &desc, &geometry), device);
  return geometry;
}

}  // namespace

kiwami_geometry* make_geometry(kiwami_device* device, const Mesh& mesh) {
  if (!mesh.moved.empty()) return make_moving(device, mesh);
  const kiwami_triangle_mesh_desc desc = desc_of(mesh);
  kiwami_geometry* geometry = nullptr;
  throw_on_error(kiwami_triangle_mesh_create(device, &desc, &geometry), device);
  return geometry;
}

kiwami_geometry* make_instances(kiwami_device* device, const SceneFile& file,
                                const std::vector<kiwami_scene*>& scenes) {
  return file.moved_transforms.empty() ? make_resting_instances(device, file, scenes)
                                       : make_moving_instances(device, file, scenes);
}

void set_leaf_mask(kiwami_device* device, kiwami_geometry* geometry, const Mesh& mesh,
                   uint32_t level) {
  const std::vector<unsigned char> map = leaf_map(level);
  const std::vector<uint32_t> indices(mesh.triangle_count(), 0);
  kiwami_opacity_desc opacity;
  throw_on_error(kiwami_opacity_desc_init(&opacity, sizeof opacity), device);
  opacity.level = level;
  opacity.maps = map.data();
  opacity.map_count = 1;
  opacity.indices = indices.data();
  throw_on_error(kiwami_triangle_mesh_set_opacity(geometry, &opacity), device);
}

void move_to_world(const std::array<float, 12>& m, kiwami_hit& hit) {
  const auto cofactor = [&](size_t i, size_t j) {
    const size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return m[i1 * 4 + j1] * m[i2 * 4 + j2] - m[i1 * 4 + j2] * m[i2 * 4 + j1];
  };
  const float x = hit.normal_x, y = hit.normal_y, z = hit.normal_z;
  const auto row = [&](size_t i) {
    return cofactor(i, 0) * x + cofactor(i, 1) * y + cofactor(i, 2) * z;
  };
  hit.normal_x = row(0);
  hit.normal_y = row(1);
  hit.normal_z = row(2);
  hit.geometry_id = hit.instance_id;
  hit.instance_id = KIWAMI_INVALID_ID;
}

}  // namespace kiwami::tools

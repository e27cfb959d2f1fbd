// SPDX-License-Identifier: Apache-2.0
#include "support/library.h"

#include <stdexcept>

namespace kiwami_tests {
namespace {

std::unique_ptr<kiwami_geometry, Release> make_geometry(kiwami_device* device, const Mesh& mesh) {
  kiwami_triangle_mesh_desc desc;
  check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc));
  desc.vertices = mesh.vertices.data();
  desc.vertex_stride = sizeof(Point);
  desc.vertex_count = mesh.vertices.size();
  desc.indices = mesh.triangles.data();
  desc.index_stride = sizeof mesh.triangles[0];
  desc.triangle_count = mesh.triangles.size();
  desc.mask = mesh.mask;
  kiwami_geometry* geometry = nullptr;
  check(kiwami_triangle_mesh_create(device, &desc, &geometry));
  return std::unique_ptr<kiwami_geometry, Release>(geometry);
}

kiwami_ray_fields fields_of(const std::vector<kiwami_ray>& rays) {
  kiwami_ray_fields fields;
  check(kiwami_ray_fields_init(&fields, sizeof fields));
  const kiwami_ray* ray = rays.data();
  const auto field = [](const void* data) { return kiwami_input_field{data, sizeof(kiwami_ray)}; };
  fields.origin_x = field(&ray->origin_x);
  fields.origin_y = field(&ray->origin_y);
  fields.origin_z = field(&ray->origin_z);
  fields.direction_x = field(&ray->direction_x);
  fields.direction_y = field(&ray->direction_y);
  fields.direction_z = field(&ray->direction_z);
  fields.tmin = field(&ray->tmin);
  fields.tmax = field(&ray->tmax);
  fields.time = field(&ray->time);
  fields.mask = field(&ray->mask);
  fields.flags = field(&ray->flags);
  return fields;
}

}  // namespace

void check(kiwami_result result) {
  if (result == KIWAMI_OK) return;
  char sentence[512];
  kiwami_last_error(nullptr, sentence, sizeof sentence);
  throw std::runtime_error(std::string(kiwami_result_name(result)) + ": " + sentence);
}

DeviceHandle make_device(uint32_t isa, uint32_t thread_count) {
  kiwami_device_desc desc;
  check(kiwami_device_desc_init(&desc, sizeof desc));
  desc.isa = isa;
  desc.thread_count = thread_count;
  kiwami_device* device = nullptr;
  check(kiwami_device_create(&desc, &device));
  return DeviceHandle(device);
}

kiwami_device_info info_of(const kiwami_device* device) {
  kiwami_device_info info{};
  info.struct_size = sizeof info;
  check(kiwami_device_get_info(device, &info));
  return info;
}

kiwami_scene_info info_of(const kiwami_scene* scene) {
  kiwami_scene_info info{};
  info.struct_size = sizeof info;
  check(kiwami_scene_get_info(scene, &info));
  return info;
}

std::vector<uint32_t> available_isas() {
  const uint32_t available = info_of(make_device(KIWAMI_ISA_SCALAR, 1).get()).isa_available;
  const uint32_t built = info_of(make_device(KIWAMI_ISA_SCALAR, 1).get()).isa_built;
  std::vector<uint32_t> isas;
  for (uint32_t isa = KIWAMI_ISA_SCALAR; isa <= KIWAMI_ISA_AVX512; ++isa) {
    if (available & built & (1u << isa)) isas.push_back(isa);
  }
  return isas;
}

SceneHandle make_scene(kiwami_device* device, const Scene& scene, const BuildOptions& options) {
  kiwami_scene* made = nullptr;
  check(kiwami_scene_create(device, &made));
  SceneHandle handle(made);
  for (const Mesh& mesh : scene.meshes) {
    check(kiwami_scene_attach(made, make_geometry(device, mesh).get(), nullptr));
  }
  const auto set = [&](uint32_t parameter, double value) {
    check(kiwami_scene_set_parameter(made, parameter, value));
  };
  set(KIWAMI_PARAMETER_BVH_WIDTH, options.width);
  set(KIWAMI_PARAMETER_MERGE_LEAVES, options.merges_leaves ? 1.0 : 0.0);
  set(KIWAMI_PARAMETER_MAX_LEAF_SIZE, options.max_leaf_size);
  set(KIWAMI_PARAMETER_VALIDATE_BUILD, options.validates ? 1.0 : 0.0);
  for (const auto& [parameter, value] : options.parameters) set(parameter, value);
  if (options.optimizers) {
    check(
        kiwami_scene_set_optimizers(made, options.optimizers->data(), options.optimizers->size()));
  }
  const std::vector<kiwami_ray>& rays = options.representative_rays;
  if (!rays.empty()) {
    check(kiwami_scene_set_representative_rays(made, rays.data(), 0, rays.size()));
  }
  check(kiwami_scene_commit(made));
  return handle;
}

std::vector<kiwami_hit> closest_hits(const kiwami_scene* scene,
                                     const std::vector<kiwami_ray>& rays) {
  std::vector<kiwami_hit> hits(rays.size());
  check(kiwami_closest_hit(scene, rays.data(), 0, hits.data(), 0, rays.size(), nullptr));
  return hits;
}

std::vector<kiwami_hit> closest_hits_by_fields(const kiwami_scene* scene,
                                               const std::vector<kiwami_ray>& rays) {
  std::vector<kiwami_hit> hits(rays.size());
  kiwami_hit_fields fields;
  check(kiwami_hit_fields_init(&fields, sizeof fields));
  kiwami_hit* hit = hits.data();
  const auto field = [](void* data) { return kiwami_output_field{data, sizeof(kiwami_hit)}; };
  fields.t = field(&hit->t);
  fields.u = field(&hit->u);
  fields.v = field(&hit->v);
  fields.normal_x = field(&hit->normal_x);
  fields.normal_y = field(&hit->normal_y);
  fields.normal_z = field(&hit->normal_z);
  fields.primitive_id = field(&hit->primitive_id);
  fields.geometry_id = field(&hit->geometry_id);
  fields.instance_id = field(&hit->instance_id);
  const kiwami_ray_fields given = fields_of(rays);
  check(kiwami_closest_hit_fields(scene, &given, &fields, rays.size(), nullptr));
  return hits;
}

std::vector<uint8_t> any_hits(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays) {
  std::vector<uint8_t> hits(rays.size(), 0xFF);
  check(kiwami_any_hit(scene, rays.data(), 0, hits.data(), 0, rays.size(), nullptr));
  return hits;
}

std::vector<uint8_t> any_hits_by_fields(const kiwami_scene* scene,
                                        const std::vector<kiwami_ray>& rays) {
  std::vector<uint8_t> hits(rays.size(), 0xFF);
  const kiwami_ray_fields given = fields_of(rays);
  const kiwami_output_field occluded{hits.data(), 1};
  check(kiwami_any_hit_fields(scene, &given, &occluded, rays.size(), nullptr));
  return hits;
}

}  // namespace kiwami_tests

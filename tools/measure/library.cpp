// SPDX-License-Identifier: Apache-2.0
#include "measure/library.h"

namespace kiwami::tools {
namespace {

constexpr uint32_t kIsas[] = {KIWAMI_ISA_SCALAR, KIWAMI_ISA_SSE, KIWAMI_ISA_AVX2,
                              KIWAMI_ISA_AVX512};

void check(kiwami_result result, const kiwami_device* device) {
  if (result == KIWAMI_OK) return;
  std::string sentence(kiwami_last_error(device, nullptr, 0), '\0');
  kiwami_last_error(device, sentence.data(), sentence.size());
  while (!sentence.empty() && (sentence.back() == '\0' || sentence.back() == '.')) {
    sentence.pop_back();
  }
  throw LibraryError(result, sentence.empty() ? kiwami_result_name(result) : sentence);
}

/// Holds the reference to a geometry until the scene has its own.
class Geometry {
 public:
  Geometry(kiwami_device* device, const kiwami_triangle_mesh_desc& desc) {
    check(kiwami_triangle_mesh_create(device, &desc, &geometry_), device);
  }
  ~Geometry() { kiwami_geometry_release(geometry_); }
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;
  kiwami_geometry* get() const { return geometry_; }

 private:
  kiwami_geometry* geometry_ = nullptr;
};

}  // namespace

Device::Device(uint32_t isa, uint32_t thread_count) {
  kiwami_device_desc desc;
  check(kiwami_device_desc_init(&desc, sizeof desc), nullptr);
  desc.isa = isa;
  desc.thread_count = thread_count;
  check(kiwami_device_create(&desc, &device_), nullptr);
  info_.struct_size = sizeof info_;
  const kiwami_result result = kiwami_device_get_info(device_, &info_);
  if (result != KIWAMI_OK) kiwami_device_release(device_);
  check(result, nullptr);
}

BuiltScene::BuiltScene(const Device& device, const SceneFile& file, const BuildOptions& options) {
  check(kiwami_scene_create(device.get(), &scene_), device.get());
  try {
    check(kiwami_scene_set_parameter(scene_, KIWAMI_PARAMETER_BVH_WIDTH, options.bvh_width),
          device.get());
    check(kiwami_scene_set_parameter(scene_, KIWAMI_PARAMETER_MERGE_LEAVES,
                                     options.merge_leaves ? 1.0 : 0.0),
          device.get());
    for (const Mesh& mesh : file.meshes) attach(device.get(), mesh);
    commit();
  } catch (...) {
    kiwami_scene_release(scene_);
    throw;
  }
}

void BuiltScene::attach(kiwami_device* device, const Mesh& mesh) {
  kiwami_triangle_mesh_desc desc;
  check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc), device);
  desc.flags = KIWAMI_MESH_SHARE_BUFFERS;
  desc.vertices = mesh.vertices.data();
  desc.vertex_count = mesh.vertex_count();
  desc.indices = mesh.indices.data();
  desc.triangle_count = mesh.triangle_count();
  const Geometry geometry(device, desc);
  check(kiwami_scene_attach(scene_, geometry.get(), nullptr), device);
}

void BuiltScene::commit() {
  check(kiwami_scene_commit(scene_), nullptr);
  info_.struct_size = sizeof info_;
  check(kiwami_scene_get_info(scene_, &info_), nullptr);
}

void BuiltScene::closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const {
  check(kiwami_closest_hit(scene_, rays.data(), 0, hits.data(), 0, rays.size(), nullptr), nullptr);
}

void BuiltScene::any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) const {
  check(kiwami_any_hit(scene_, rays.data(), 0, occluded.data(), 0, rays.size(), nullptr), nullptr);
}

std::vector<uint32_t> available_isas() {
  const uint32_t available = Device(KIWAMI_ISA_SCALAR, 1).info().isa_available;
  std::vector<uint32_t> isas;
  for (const uint32_t isa : kIsas) {
    if ((available & (1u << isa)) != 0) isas.push_back(isa);
  }
  return isas;
}

uint32_t isa_of_name(const std::string& name) {
  if (name == "auto") return KIWAMI_ISA_AUTO;
  for (const uint32_t isa : kIsas) {
    if (name == kiwami_isa_name(isa)) return isa;
  }
  throw LibraryError(KIWAMI_ERROR_INVALID_ARGUMENT,
                     "the ISA is '" + name + "', expected auto, scalar, sse, avx2 or avx512");
}

}  // namespace kiwami::tools

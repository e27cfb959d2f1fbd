// SPDX-License-Identifier: Apache-2.0
#include "lights/light_tree.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "dispatch/dispatch.h"

namespace kiwami {
namespace {

template <typename T>
T read(const unsigned char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

float checked_amount(float value, const char* name, size_t index) {
  if (value >= 0.0f && value <= std::numeric_limits<float>::max()) return value;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "%s[%zu] is %g, expected 0 or more, finite", name,
              index, static_cast<double>(value));
}

/// Throws unless the transform can be undone, and leaves all lights within range.
void check(const LightInstance& instance) {
  double size = 0.0;
  for (const float entry : instance.local_to_world) {
    if (!(std::fabs(entry) <= KIWAMI_MAX_COORDINATE)) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "desc.local_to_world holds %g, expected at most 2^60 in size",
                  static_cast<double>(entry));
    }
    size = std::max(size, std::fabs(static_cast<double>(entry)));
  }
  const auto at = [&](int row, int column) {
    return static_cast<double>(instance.local_to_world[4 * row + column]);
  };
  const double determinant = at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) -
                             at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
                             at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0));
  if (!(std::fabs(determinant) > 0x1p-120)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.local_to_world has the determinant %g, expected more than 2^-120 in size: "
                "an invertible transform",
                determinant);
  }
  const InstanceLeaf& lights = instance.lights->summary();
  if (lights.light_count == 0) return;
  const Bounds box = transformed(lights.record, instance.local_to_world, 1.0f, 0).box;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(box.lower[axis] >= -KIWAMI_MAX_COORDINATE && box.upper[axis] <= KIWAMI_MAX_COORDINATE)) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "desc.local_to_world takes a light to %g, expected at most 2^60 in size",
                  static_cast<double>(box.upper[axis]));
    }
  }
}

LightRecord triangle_of(const LightMesh& mesh, size_t triangle) {
  Vec3f corners[3];
  for (uint32_t i = 0; i < 3; ++i) {
    uint32_t vertex = static_cast<uint32_t>(3 * triangle) + i;
    if (mesh.indices) {
      vertex = read<uint32_t>(mesh.indices + triangle * mesh.index_stride + i * sizeof(uint32_t));
    }
    if (vertex >= mesh.vertex_count) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "triangle %zu of desc has the vertex %u, expected one below vertex_count %u",
                  triangle, vertex, mesh.vertex_count);
    }
    corners[i] = read<Vec3f>(mesh.vertices + vertex * mesh.vertex_stride);
  }
  const float radiance =
      mesh.radiances ? checked_amount(read<float>(mesh.radiances + triangle * mesh.radiance_stride),
                                      "desc.radiances", triangle)
                     : mesh.radiance;
  return record_of_triangle(corners, radiance, mesh.is_two_sided, mesh.link_mask);
}

}  // namespace

LightTree* LightTree::create(Device& device, const kiwami_light_tree_desc& desc) {
  return make_object<LightTree>(device.memory(), device, desc);
}

void LightTree::destroy(LightTree* tree) noexcept {
  const Reference<Device> device = tree->device_;
  destroy_object(device->memory(), tree);
}

LightTree::LightTree(Device& device, const kiwami_light_tree_desc& desc)
    : device_(device),
      width_(desc.width ? desc.width : default_width_of(device.isa())),
      builder_(desc.builder),
      flags_(desc.flags),
      distant_probability_(desc.distant_probability),
      kernels_(light_kernels_of(device.isa(), width_)),
      set_(LightSet::create(device)) {}

/// The set, to be changed: a copy where what was committed holds it.
LightSet& LightTree::own_set(size_t more_lights, size_t more_instances) {
  if (set_->is_shared()) {
    set_ = LightSet::copy_of(*set_, more_lights, more_instances);
  } else {
    set_->lights.reserve(set_->lights.size() + more_lights);
    set_->user_ids.reserve(set_->user_ids.size() + more_lights);
    set_->instances.reserve(set_->instances.size() + more_instances);
  }
  return *set_;
}

void LightTree::check_new(size_t count) const {
  if (count > kMaxLightCount - set_->lights.size()) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "%zu lights are added to %zu, expected at most 2^26 in all",
                count, set_->lights.size());
  }
}

void LightTree::check_present(uint32_t first, size_t count) const {
  if (first > set_->lights.size() || count > set_->lights.size() - first) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "first is %u and count is %zu, expected lights of the %zu that were added", first,
                count, set_->lights.size());
  }
}

uint32_t LightTree::add_lights(const unsigned char* lights, size_t stride, size_t count) {
  check_new(count);
  for (size_t i = 0; i < count; ++i) record_of(read<kiwami_light>(lights + i * stride), i);
  LightSet& set = own_set(count, 0);
  const auto first = static_cast<uint32_t>(set.lights.size());
  for (size_t i = 0; i < count; ++i) {
    const auto light = read<kiwami_light>(lights + i * stride);
    set.lights.push_back(record_of(light, i));
    set.user_ids.push_back(light.user_id);
  }
  return first;
}

uint32_t LightTree::add_mesh(const LightMesh& mesh) {
  check_new(mesh.triangle_count);
  for (size_t i = 0; i < mesh.triangle_count; ++i) triangle_of(mesh, i);
  LightSet& set = own_set(mesh.triangle_count, 0);
  const auto first = static_cast<uint32_t>(set.lights.size());
  for (uint32_t i = 0; i < mesh.triangle_count; ++i) {
    set.lights.push_back(triangle_of(mesh, i));
    set.user_ids.push_back(mesh.user_id + i * mesh.user_id_step);
  }
  return first;
}

uint32_t LightTree::add_instance(const LightInstance& instance) {
  if (set_->instances.size() == kMaxInstanceCount) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "the set has %zu instances, expected fewer than 2^20",
                set_->instances.size());
  }
  check(instance);
  LightSet& set = own_set(0, 1);
  set.instances.push_back(instance);
  instance.lights->retain();
  return static_cast<uint32_t>(set.instances.size() - 1);
}

void LightTree::set_lights(uint32_t first, const unsigned char* lights, size_t stride,
                           size_t count) {
  check_present(first, count);
  for (size_t i = 0; i < count; ++i) record_of(read<kiwami_light>(lights + i * stride), i);
  LightSet& set = own_set(0, 0);
  for (size_t i = 0; i < count; ++i) {
    const auto light = read<kiwami_light>(lights + i * stride);
    set.lights[first + i] = record_of(light, i);
    set.user_ids[first + i] = light.user_id;
  }
}

void LightTree::set_powers(uint32_t first, const unsigned char* powers, size_t stride,
                           size_t count) {
  check_present(first, count);
  for (size_t i = 0; i < count; ++i) {
    checked_amount(read<float>(powers + i * stride), "powers", i);
  }
  LightSet& set = own_set(0, 0);
  for (size_t i = 0; i < count; ++i) {
    set.lights[first + i].power = read<float>(powers + i * stride);
  }
}

void LightTree::set_instance(uint32_t number, const LightInstance& instance) {
  if (number >= set_->instances.size()) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "instance_id is %u, expected one below %zu", number,
                set_->instances.size());
  }
  check(instance);
  LightSet& set = own_set(0, 0);
  instance.lights->retain();
  set.instances[number].lights->release();
  set.instances[number] = instance;
}

LightInput LightTree::input() const {
  return {*set_, width_, builder_, distant_probability_,
          (flags_ & KIWAMI_LIGHT_TREE_WITH_ROULETTE) != 0};
}

kiwami_light_tree_desc LightTree::desc() const {
  kiwami_light_tree_desc desc{};
  desc.struct_size = sizeof desc;
  desc.width = width_;
  desc.builder = builder_;
  desc.distant_probability = distant_probability_;
  desc.flags = flags_;
  return desc;
}

void LightTree::restore_lights(std::span<const LightRecord> lights,
                               std::span<const uint32_t> user_ids) {
  check_new(lights.size());
  LightSet& set = own_set(lights.size(), 0);
  for (size_t i = 0; i < lights.size(); ++i) {
    set.lights.push_back(lights[i]);
    set.user_ids.push_back(user_ids[i]);
  }
}

void LightTree::restore(const LightShape& shape, double build_seconds) {
  committed_ = Reference<CommittedLights>::adopt(CommittedLights::create(*device_, input(), shape));
  committed_->set_build_seconds(build_seconds);
}

void LightTree::commit() {
  committed_ = Reference<CommittedLights>::adopt(CommittedLights::create(*device_, input()));
}

void LightTree::refit() {
  if (!committed_.get()) {
    throw Error(KIWAMI_ERROR_INVALID_STATE,
                "tree was never committed, expected a successful kiwami_light_tree_commit before");
  }
  committed_ = Reference<CommittedLights>::adopt(
      CommittedLights::create(*device_, input(), committed_->shape()));
}

kiwami_light_tree_info LightTree::info() const {
  kiwami_light_tree_info info = committed_->info();
  info.bytes += sizeof(*this) + set_->bytes();
  if (set_.get() != &committed_->set()) info.bytes += committed_->set().bytes();
  return info;
}

}  // namespace kiwami

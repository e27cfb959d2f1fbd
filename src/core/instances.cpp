// SPDX-License-Identifier: Apache-2.0
#include "core/instances.h"

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/scene.h"
#include "core/strided_buffer.h"

namespace kiwami {
namespace {

/// Instances that one task looks at.
constexpr size_t kBlockSize = 4096;
constexpr size_t kMatrixSize = 12 * sizeof(float);
constexpr uint64_t kMaxCount = std::numeric_limits<int32_t>::max();

/// Beyond these an inverse in floats says little of the matrix, and margins cover scenes.
constexpr double kMaxCondition = 0x1p20;
constexpr double kMaxScale = 0x1p60;

using ull = unsigned long long;

void check_count(const char* name, uint64_t count) {
  if (count == 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.%s is 0, expected at least 1", name);
  }
  if (count > kMaxCount) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.%s is %llu, expected at most %llu", name, ull{count},
                ull{kMaxCount});
  }
}

void check_fields(const kiwami_instances_desc& desc) {
  if (desc.flags & ~uint32_t{KIWAMI_INSTANCES_SHARE_BUFFERS}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.flags is 0x%x, expected KIWAMI_INSTANCES_* bits", desc.flags);
  }
  if (desc.reserved != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.reserved is %u, expected 0", desc.reserved);
  }
  if (!desc.scenes) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.scenes is NULL, expected the scenes");
  }
  if (!desc.transforms) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.transforms is NULL, expected the matrices");
  }
  check_count("scene_count", desc.scene_count);
  check_count("count", desc.count);
}

/// The scenes that a description names, which must be of the device.
Array<Scene*> read_scenes(const kiwami_instances_desc& desc, Device& device) {
  const auto count = static_cast<size_t>(desc.scene_count);
  check_extent("scenes", desc.scenes, 0, sizeof(void*), count, sizeof(void*));
  Array<Scene*> scenes(device.memory(), count);
  for (size_t i = 0; i < count; ++i) {
    scenes[i] = reinterpret_cast<Scene*>(desc.scenes[i]);
    if (!scenes[i]) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.scenes[%zu] is NULL, expected a scene", i);
    }
    if (&scenes[i]->device() != &device) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "desc.scenes[%zu] is of another device, expected one of device", i);
    }
  }
  return scenes;
}

bool is_finite(const Affine& map) {
  bool is = true;
  for (const auto& column : map.column) {
    for (const double entry : column) is = is && std::isfinite(entry);
  }
  return is;
}

bool is_in_range(double norm) { return 1.0 / kMaxScale <= norm && norm <= kMaxScale; }

}  // namespace

InstanceTransform transform_of(const float (&inverse)[4][3]) {
  InstanceTransform transform;
  Affine map;
  for (int k = 0; k < 4; ++k) {
    for (int row = 0; row < 3; ++row) {
      transform.inverse[k][row] = inverse[k][row];
      map.column[k][row] = inverse[k][row];
    }
  }
  transform.forward = inverse_of(map);
  transform.inverse_norm = row_sum_norm(map);
  transform.forward_norm = row_sum_norm(transform.forward);
  return transform;
}

Instances* Instances::create(Device& device, const kiwami_instances_desc& desc) {
  check_fields(desc);
  return make_object<Instances>(device.memory(), device, desc);
}

Instances::Instances(Device& device, const kiwami_instances_desc& desc)
    : Geometry(device, GeometryKind::kInstances, desc.mask),
      count_(static_cast<uint32_t>(desc.count)) {
  const bool is_shared = (desc.flags & KIWAMI_INSTANCES_SHARE_BUFFERS) != 0;
  indices_ = elements_of("scene_indices", "scene_index_stride", desc.scene_indices,
                         desc.scene_index_stride, sizeof(uint32_t), is_shared);
  transforms_ = elements_of("transforms", "transform_stride", desc.transforms,
                            desc.transform_stride, kMatrixSize, is_shared);
  masks_ = elements_of("masks", "mask_stride", desc.masks, desc.mask_stride, sizeof(uint32_t),
                       is_shared);
  scenes_ = read_scenes(desc, device);
  check_instances();
  // The last step, which the destructor undoes.
  for (Scene* scene : scenes_) scene->retain();
}

Instances::~Instances() {
  for (Scene* scene : scenes_) scene->release();
}

Instances::Elements Instances::elements_of(const char* name, const char* stride_name,
                                           const void* data, uint64_t stride, size_t element_size,
                                           bool is_shared) {
  Elements elements;
  check_stride(stride_name, stride, element_size);
  if (!data) return elements;
  elements.stride = stride != 0 ? static_cast<size_t>(stride) : element_size;
  check_extent(name, data, 0, elements.stride, count_, element_size);
  elements.first = static_cast<const unsigned char*>(data);
  if (is_shared) return elements;
  elements.copy = packed_copy(elements.first, elements.stride, count_, element_size, device());
  elements.first = elements.copy.data();
  elements.stride = element_size;
  return elements;
}

uint32_t Instances::scene_index(uint32_t instance) const {
  uint32_t index = 0;
  if (indices_.first) std::memcpy(&index, indices_.at(instance), sizeof index);
  return index;
}

uint32_t Instances::instance_mask(uint32_t instance) const {
  uint32_t mask = ~uint32_t{0};
  if (masks_.first) std::memcpy(&mask, masks_.at(instance), sizeof mask);
  return mask;
}

bool Instances::invert(uint32_t instance, InstanceTransform& transform) const {
  float rows[3][4];
  std::memcpy(rows, transforms_.at(instance), sizeof rows);
  Affine map;
  for (int k = 0; k < 4; ++k) {
    for (int row = 0; row < 3; ++row) map.column[k][row] = rows[row][k];
  }
  if (!is_finite(map) || !is_in_range(row_sum_norm(map))) return false;
  const Affine inverse = inverse_of(map);
  if (!is_finite(inverse) || !is_in_range(row_sum_norm(inverse))) return false;
  float rounded[4][3];
  for (int k = 0; k < 4; ++k) {
    for (int row = 0; row < 3; ++row) {
      if (std::fabs(inverse.column[k][row]) > std::numeric_limits<float>::max()) return false;
      rounded[k][row] = static_cast<float>(inverse.column[k][row]);
    }
  }
  transform = transform_of(rounded);
  return is_finite(transform.forward) &&
         transform.inverse_norm * transform.forward_norm <= kMaxCondition;
}

bool Instances::is_valid(uint32_t instance) const {
  InstanceTransform transform;
  return scene_index(instance) < scene_count() && invert(instance, transform);
}

void Instances::check_instances() const {
  // The lowest faulty instance is reported, whichever thread finds one first.
  std::atomic<uint32_t> faulty{count_};
  device().parallel().for_blocks(count_, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto instance = static_cast<uint32_t>(i);
      if (is_valid(instance)) continue;
      uint32_t lowest = faulty.load(std::memory_order_relaxed);
      while (instance < lowest && !faulty.compare_exchange_weak(lowest, instance)) {
      }
      return;
    }
  });
  const uint32_t instance = faulty.load();
  if (instance == count_) return;
  if (scene_index(instance) >= scene_count()) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "the scene index of instance %u is %u, expected less than desc.scene_count, which "
                "is %u",
                instance, scene_index(instance), scene_count());
  }
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
              "the transform of instance %u is singular or not finite, expected a condition number "
              "of at most 2^20 and scales from 2^-60 to 2^60",
              instance);
}

}  // namespace kiwami

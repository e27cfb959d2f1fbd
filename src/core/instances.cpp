// SPDX-License-Identifier: Apache-2.0
#include "core/instances.h"

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/mesh_buffers.h"
#include "core/scene.h"
#include "core/strided_buffer.h"

namespace kiwami {
namespace {

/// Instances that one task looks at.
constexpr size_t kBlockSize = 4096;
constexpr uint64_t kMaxCount = std::numeric_limits<int32_t>::max();
/// Terms of the series of the squared arc sine: each is at most half of the one before.
constexpr int kArcTerms = 50;

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

void check_fields(const kiwami_moving_instances_desc& desc) {
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
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.transforms is NULL, expected the %s",
                desc.format == KIWAMI_TRANSFORM_MATRIX ? "matrices" : "transforms");
  }
  check_count("scene_count", desc.scene_count);
  check_count("count", desc.count);
}

/// As a description of one step, of no time.
kiwami_moving_instances_desc resting(const kiwami_instances_desc& desc) {
  kiwami_moving_instances_desc resting{};
  resting.flags = desc.flags;
  resting.scenes = desc.scenes;
  resting.scene_count = desc.scene_count;
  resting.scene_indices = desc.scene_indices;
  resting.scene_index_stride = desc.scene_index_stride;
  resting.transforms = desc.transforms;
  resting.transform_stride = desc.transform_stride;
  resting.count = desc.count;
  resting.masks = desc.masks;
  resting.mask_stride = desc.mask_stride;
  resting.format = KIWAMI_TRANSFORM_MATRIX;
  resting.step_count = 1;
  resting.mask = desc.mask;
  resting.reserved = desc.reserved;
  return resting;
}

/// Divides the quaternion of a step by its length.
void normalise(float* step) {
  double sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    sum += double{step[kQuaternion + i]} * double{step[kQuaternion + i]};
  }
  const double length = std::sqrt(sum);
  for (int i = 0; i < 4; ++i) {
    step[kQuaternion + i] = static_cast<float>(double{step[kQuaternion + i]} / length);
  }
}

/// Turns the second of two quaternions to the shorter way from the first, and puts the square of
/// the angle between them into the first step: with x = |b - a|^2 = 4 sin(angle / 2)^2, it is 4
/// asin(sqrt(x) / 2)^2 = the sum of 2 x^n / (n^2 (2n over n)).
void join(float* first, float* second) {
  double dot = 0.0;
  for (int i = 0; i < 4; ++i) {
    dot += double{first[kQuaternion + i]} * double{second[kQuaternion + i]};
  }
  double x = 0.0;
  for (int i = 0; i < 4; ++i) {
    float& entry = second[kQuaternion + i];
    if (dot < 0.0) entry = -entry;
    const double difference = double{entry} - double{first[kQuaternion + i]};
    x += difference * difference;
  }
  double term = x, sum = x;
  for (int n = 1; n < kArcTerms; ++n) {
    term *= x * (n * n) / ((2.0 * n + 2.0) * (2.0 * n + 1.0));
    sum += term;
  }
  first[kSquaredAngle] = static_cast<float>(sum);
}

/// The scenes that a description names, which must be of the device.
Array<Scene*> read_scenes(const kiwami_moving_instances_desc& desc, Device& device) {
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

/// Of count elements in a file, at so many steps.
Instances::Elements borrowed(const unsigned char* data, size_t count, size_t element_size,
                             size_t step_count = 1) {
  Instances::Elements elements;
  if (!data) return elements;
  elements.copy = Array<unsigned char>::borrow(const_cast<unsigned char*>(data),
                                               step_count * count * element_size);
  elements.first = data;
  elements.stride = element_size;
  return elements;
}

}  // namespace

size_t transform_bytes(TransformFormat format) {
  return format == TransformFormat::kMatrix ? 12 * sizeof(float)
                                            : sizeof(kiwami_quaternion_transform);
}

bool is_usable(const InstanceTransform& transform) {
  return is_finite(map_of(transform.inverse)) && is_finite(transform.forward) &&
         transform.inverse_norm * transform.forward_norm <= kMaxCondition;
}

InstanceTransform transform_of(const float (&inverse)[4][3]) {
  InstanceTransform transform;
  std::memcpy(transform.inverse, inverse, sizeof inverse);
  const Affine map = map_of(inverse);
  transform.forward = inverse_of(map);
  transform.inverse_norm = row_sum_norm(map);
  transform.forward_norm = row_sum_norm(transform.forward);
  return transform;
}

Instances* Instances::create(Device& device, const kiwami_instances_desc& desc) {
  const kiwami_moving_instances_desc full = resting(desc);
  check_fields(full);
  return make_object<Instances>(device.memory(), device, full);
}

Instances* Instances::create(Device& device, const kiwami_moving_instances_desc& desc) {
  check_fields(desc);
  if (desc.format > KIWAMI_TRANSFORM_QUATERNION) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.format is %u, expected a kiwami_transform_format", desc.format);
  }
  check_time_steps(desc.step_count, desc.time_begin, desc.time_end);
  return make_object<Instances>(device.memory(), device, desc);
}

Instances::Instances(Device& device, const kiwami_moving_instances_desc& desc)
    : Geometry(device, GeometryKind::kInstances, desc.mask),
      count_(static_cast<uint32_t>(desc.count)),
      format_(static_cast<TransformFormat>(desc.format)),
      time_{desc.time_begin, desc.time_end, desc.step_count - 1} {
  const bool is_shared = (desc.flags & KIWAMI_INSTANCES_SHARE_BUFFERS) != 0;
  indices_ = elements_of("scene_indices", "scene_index_stride", desc.scene_indices,
                         desc.scene_index_stride, sizeof(uint32_t), is_shared);
  take_transforms(desc, is_shared);
  masks_ = elements_of("masks", "mask_stride", desc.masks, desc.mask_stride, sizeof(uint32_t),
                       is_shared);
  scenes_ = read_scenes(desc, device);
  check_instances();
  // The last step, which the destructor undoes.
  for (Scene* scene : scenes_) scene->retain();
}

Instances::Instances(Device& device, FileImage& image, const SavedBuffers& buffers,
                     Array<Scene*> scenes, bool is_trusted)
    : Geometry(device, image, GeometryKind::kInstances, buffers.mask),
      count_(buffers.count),
      format_(buffers.format),
      time_(buffers.time),
      step_stride_(buffers.count * transform_bytes(format_)),
      scenes_(std::move(scenes)),
      indices_(borrowed(buffers.indices, buffers.count, sizeof(uint32_t))),
      transforms_(borrowed(buffers.transforms, buffers.count, transform_bytes(format_),
                           time_.segment_count + 1)),
      masks_(borrowed(buffers.masks, buffers.count, sizeof(uint32_t))) {
  if (is_moving()) check_time_steps(time_.segment_count + 1, time_.begin, time_.end);
  if (!is_trusted) check_instances();
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

void Instances::take_transforms(const kiwami_moving_instances_desc& desc, bool is_shared) {
  const size_t size = transform_bytes(format_);
  const uint32_t step_count = time_.segment_count + 1;
  check_stride("step_stride", desc.step_stride, size);
  check_stride("transform_stride", desc.transform_stride, size);
  step_stride_ = desc.step_stride != 0 ? static_cast<size_t>(desc.step_stride) : size;
  check_extent("steps of a transform", desc.transforms, 0, step_stride_, step_count, size);
  size_t stride = static_cast<size_t>(desc.transform_stride);
  if (stride == 0 && __builtin_mul_overflow(step_stride_, step_count, &stride)) {
    stride = std::numeric_limits<size_t>::max();
  }
  check_extent("transforms", desc.transforms, 0, stride, count_,
               (step_count - 1) * step_stride_ + size);
  transforms_.first = static_cast<const unsigned char*>(desc.transforms);
  transforms_.stride = stride;
  if (is_shared) return;
  Elements packed;
  packed.stride = step_count * size;
  packed.copy = Array<unsigned char>(device().memory(), count_ * packed.stride);
  packed.first = packed.copy.data();
  device().parallel().for_blocks(count_, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const unsigned char* const source = transforms_.at(static_cast<uint32_t>(i));
      unsigned char* const target = packed.copy.data() + i * packed.stride;
      for (uint32_t step = 0; step < step_count; ++step) {
        std::memcpy(target + step * size, source + step * step_stride_, size);
      }
    }
  });
  transforms_ = std::move(packed);
  step_stride_ = size;
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

void Instances::read_step(uint32_t instance, uint32_t step, float* target) const {
  std::memcpy(target, transforms_.at(instance) + step * step_stride_, transform_bytes(format_));
}

bool Instances::invert(uint32_t instance, float (&inverse)[4][3]) const {
  float rows[12];
  read_step(instance, 0, rows);
  return invert_for_rays(rows, inverse);
}

bool Instances::read_steps(uint32_t instance, float* steps) const {
  const uint32_t size = step_size_of(format_);
  for (uint32_t step = 0; step <= time_.segment_count; ++step) {
    float* const at = steps + size_t{step} * size;
    read_step(instance, step, at);
    if (format_ == TransformFormat::kQuaternion) {
      normalise(at);
      at[kSquaredAngle] = 0.0f;
      if (step != 0) join(at - size, at);
    }
    float rows[12], inverse[4][3];
    matrix_of_step(at, format_, rows);
    if (!invert_for_rays(rows, inverse)) return false;
  }
  return true;
}

void Instances::read_transform(uint64_t instance, float time, float (&rows)[12]) const {
  if (instance >= count_) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "instance is %llu, expected less than %u",
                ull{instance}, count_);
  }
  const auto number = static_cast<uint32_t>(instance);
  if (!is_moving()) {
    read_step(number, 0, rows);
    return;
  }
  TimePlace place;
  if (!place_in_time(time_, time, place)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "time is %g, expected %g to %g", double{time},
                double{time_.begin}, double{time_.end});
  }
  float steps[KIWAMI_MAX_TIME_STEPS * step_size_of(TransformFormat::kQuaternion)];
  if (!read_steps(number, steps)) check_instances();
  matrix_between(steps + size_t{place.segment} * step_size_of(format_), format_, place.fraction,
                 rows);
}

bool Instances::is_valid(uint32_t instance) const {
  if (scene_index(instance) >= scene_count()) return false;
  if (is_moving()) {
    float steps[KIWAMI_MAX_TIME_STEPS * step_size_of(TransformFormat::kQuaternion)];
    return read_steps(instance, steps);
  }
  float inverse[4][3];
  return invert(instance, inverse);
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
              "the transform of instance %u is singular or not finite%s, expected a condition "
              "number of at most 2^20 and scales from 2^-60 to 2^60",
              instance, is_moving() ? " at a step" : "");
}

}  // namespace kiwami

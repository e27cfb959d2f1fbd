// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/geometry.h"
#include "kiwami/moving_instances.h"
#include "math/affine.h"
#include "wide/instance_transform.h"
#include "wide/time_steps.h"

namespace kiwami {

class Scene;

/// Both ways between the space of an instanced scene and the one that it stands in.
struct InstanceTransform {
  /// Into the instanced scene, as kernels apply it: rounded to floats.
  float inverse[4][3];
  /// The inverse of that: what is nearest to the given matrix of all that belongs to these floats.
  Affine forward;
  /// Row sum norms of the two linear parts.
  double inverse_norm, forward_norm;
};

/// What the floats of inverse stand for.
InstanceTransform transform_of(const float (&inverse)[4][3]);

/// Whether kernels can carry rays by it: finite, not nearly singular, scales that margins cover.
bool is_usable(const InstanceTransform& transform);

/// Bytes of a transform at one step, as the caller gives it.
size_t transform_bytes(TransformFormat format);

/// An array of instances of one or several scenes, at rest or moving: the caller's buffers, or
/// packed copies of them.
class Instances final : public Geometry {
 public:
  /// Throws Error(INVALID_ARGUMENT, TOO_LARGE or OUT_OF_MEMORY).
  static Instances* create(Device& device, const kiwami_instances_desc& desc);
  static Instances* create(Device& device, const kiwami_moving_instances_desc& desc);

  /// Tightly packed buffers in a file.
  struct SavedBuffers {
    uint32_t count;
    uint32_t mask;
    TransformFormat format;
    TimeSteps time;                   ///< of no segments: at rest
    const unsigned char* transforms;  ///< of one step after the other
    const unsigned char* indices;     ///< may be nullptr, as masks
    const unsigned char* masks;
  };

  /// Of a checked description; one step: at rest.
  Instances(Device& device, const kiwami_moving_instances_desc& desc);
  /// Over buffers in a file, which it holds, of scenes, at least one. Checks them unless they are
  /// trusted.
  Instances(Device& device, FileImage& image, const SavedBuffers& buffers, Array<Scene*> scenes,
            bool is_trusted);
  ~Instances();

  uint32_t count() const { return count_; }
  uint32_t scene_count() const { return static_cast<uint32_t>(scenes_.size()); }
  Scene& scene(uint32_t index) const { return *scenes_[index]; }
  bool has_masks() const { return masks_.first != nullptr; }
  bool is_moving() const { return time_.segment_count != 0; }
  TransformFormat format() const { return format_; }
  /// Of no segments where the instances rest.
  const TimeSteps& time() const { return time_; }

  /// Elements that lie a stride apart.
  struct Elements {
    const unsigned char* first = nullptr;  ///< nullptr: none
    size_t stride = 0;
    Array<unsigned char> copy;

    const unsigned char* at(uint32_t i) const { return first + size_t{i} * stride; }
  };
  const Elements& indices() const { return indices_; }
  /// Of the first step. The next ones lie step_stride() bytes further each.
  const Elements& transforms() const { return transforms_; }
  size_t step_stride() const { return step_stride_; }
  const Elements& masks() const { return masks_; }
  size_t copied_bytes() const override {
    return indices_.copy.bytes() + transforms_.copy.bytes() + masks_.copy.bytes();
  }

  // Of one instance, as the buffers are now.
  uint32_t scene_index(uint32_t instance) const;
  uint32_t instance_mask(uint32_t instance) const;
  /// Of one at rest: false for a matrix that is not finite or singular.
  bool invert(uint32_t instance, float (&inverse)[4][3]) const;
  /// Of one that moves: its steps as kernels take them, step_size_of(format()) floats each. False
  /// where the matrix of a step is not finite or singular.
  bool read_steps(uint32_t instance, float* steps) const;
  /// The matrix at a time, which is not looked at where the instances rest. Throws
  /// Error(INVALID_ARGUMENT).
  void read_transform(uint64_t instance, float time, float (&rows)[12]) const;

  /// Throws Error(INVALID_ARGUMENT) that names the first instance whose scene index is out of range
  /// or whose matrix is singular.
  void check_instances() const;

 private:
  void end(Memory& memory) noexcept override { destroy_object(memory, this); }
  Elements elements_of(const char* name, const char* stride_name, const void* data, uint64_t stride,
                       size_t element_size, bool is_shared);
  void take_transforms(const kiwami_moving_instances_desc& desc, bool is_shared);
  void read_step(uint32_t instance, uint32_t step, float* target) const;
  bool is_valid(uint32_t instance) const;

  uint32_t count_;
  TransformFormat format_;
  TimeSteps time_;
  size_t step_stride_ = 0;
  Array<Scene*> scenes_;
  Elements indices_, transforms_, masks_;
};

}  // namespace kiwami

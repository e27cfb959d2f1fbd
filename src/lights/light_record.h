// SPDX-License-Identifier: Apache-2.0
// A light as trees are built over it: where it is, where it shines to, and how much.
#pragma once

#include "kiwami/light.h"
#include "lights/cone.h"
#include "math/bounds.h"

namespace kiwami {

enum class LightKind : uint32_t {
  kLocal,    ///< in the tree
  kDistant,  ///< axis points towards it, from within spread
  kEnvironment,
  kUnusable  ///< a triangle of a mesh that has no place
};

/// 72 bytes a light.
struct LightRecord {
  Bounds box;
  Vec3f axis;  ///< of its cone, of length 1
  float cos_spread, sin_spread;
  float cos_extent;
  float power;
  float intensity_per_power;  ///< peak intensity of a unit of power
  uint16_t is_two_sided;
  uint16_t reserved;
  LightKind kind;
  uint64_t link_mask;

  /// What it can send into one direction at most: what receivers compare.
  double energy() const {
    return static_cast<double>(power) * static_cast<double>(intensity_per_power);
  }
  Cone cone() const {
    const double extent = static_cast<double>(cos_extent);
    return {{static_cast<double>(axis.x), static_cast<double>(axis.y), static_cast<double>(axis.z)},
            {static_cast<double>(cos_spread), static_cast<double>(sin_spread)},
            Angle::of_cosine(extent),
            is_two_sided != 0,
            false};
  }
  void set_cone(const Cone& cone);
};

/// Throws Error(INVALID_ARGUMENT) that names lights[index] and its field.
LightRecord record_of(const kiwami_light& light, size_t index);

/// The record of a triangle of a mesh. Its power is that of the radiance.
LightRecord record_of_triangle(const Vec3f (&corners)[3], float radiance, bool is_two_sided,
                               uint64_t link_mask);

/// The record of an instance: all of a tree's lights, box and cone, seen through local_to_world
/// (three rows of four). The cone is a full one unless the transform keeps angles.
LightRecord transformed(const LightRecord& light, const float (&local_to_world)[12],
                        float power_scale, uint64_t link_mask);

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "kiwami/scene.h"

namespace kiwami {

/// The bounds and the default of one of KIWAMI_PARAMETER_*.
struct ParameterBounds {
  double lowest, highest, preset;
  bool is_whole;  ///< only whole numbers are allowed
};

/// Throws Error(INVALID_ARGUMENT) for an unknown parameter.
ParameterBounds parameter_bounds(uint32_t parameter);

/// Whether it is one of KIWAMI_PARAMETER_*.
bool is_parameter(uint32_t parameter);

/// What a KIWAMI_QUALITY_* stands for.
struct QualityMethods {
  uint32_t builder;
  std::span<const uint32_t> optimizers;
  uint32_t contraction;
};

/// Throws Error(INVALID_ARGUMENT) for an unknown quality.
const QualityMethods& quality_methods(uint32_t quality);

/// The values of all KIWAMI_PARAMETER_*, always within their bounds.
class SceneParameters {
 public:
  /// All numbers are below this.
  static constexpr uint32_t kLimit = 64;

  SceneParameters();

  /// Throws Error(INVALID_ARGUMENT) for an unknown parameter or a value out of bounds.
  void set(uint32_t parameter, double value);

  /// Throws Error(INVALID_ARGUMENT) for too many, or for a number that is no optimiser's.
  void set_optimizers(std::span<const uint32_t> methods);
  std::span<const uint32_t> optimizers() const { return {optimizers_, optimizer_count_}; }

  bool operator==(const SceneParameters& other) const;

  double operator[](uint32_t parameter) const { return values_[parameter]; }
  /// The value of a parameter of whole numbers.
  uint32_t whole(uint32_t parameter) const { return static_cast<uint32_t>(values_[parameter]); }

 private:
  double values_[kLimit] = {};
  uint32_t optimizers_[KIWAMI_MAX_OPTIMIZERS];
  size_t optimizer_count_ = 0;
};

}  // namespace kiwami

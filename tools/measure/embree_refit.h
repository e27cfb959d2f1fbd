// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Meshes in Embree whose vertices move and whose trees are refitted
/// (RTC_BUILD_QUALITY_REFIT in a dynamic scene of low quality).
class EmbreeRefit {
 public:
  /// Nothing when the tools were built without Embree. Its instructions are limited to those of
  /// `isa`, one of KIWAMI_ISA_*.
  static std::unique_ptr<EmbreeRefit> create(const SceneFile& file, uint32_t isa, uint32_t threads);
  virtual ~EmbreeRefit() = default;

  /// The vertices of a mesh, in Embree's own buffer, to be moved.
  virtual std::span<float> vertices(size_t mesh) = 0;
  /// Tells Embree of the move and has it refit.
  virtual void refit() = 0;
};

}  // namespace kiwami::tools

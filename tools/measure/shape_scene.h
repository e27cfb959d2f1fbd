// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "measure/library.h"
#include "scene/shape_clouds.h"

namespace kiwami::tools {

/// Owns a committed scene of one geometry, the shapes of a cloud.
class ShapeScene : public Tracer {
 public:
  ShapeScene(const Device& device, const ShapeCloud& cloud);
  ~ShapeScene() override { kiwami_scene_release(scene_); }
  ShapeScene(const ShapeScene&) = delete;
  ShapeScene& operator=(const ShapeScene&) = delete;

  const kiwami_scene_info& info() const { return info_; }
  void closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const override;
  void any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) const;

 private:
  kiwami_scene* scene_ = nullptr;
  kiwami_scene_info info_{};
};

/// The same in Embree: points, oriented discs, round linear curves.
class EmbreeShapes : public Tracer {
 public:
  /// Nothing when the tools were built without Embree. `isa` is one of KIWAMI_ISA_*.
  static std::unique_ptr<EmbreeShapes> create(const ShapeCloud& cloud, uint32_t isa);

  /// One ray a call.
  virtual void any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) const = 0;
};

}  // namespace kiwami::tools

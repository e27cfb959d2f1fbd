// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kiwami/renderer.h"
#include "measure/emissive_lights.h"

namespace kiwami::tools {

/// A scene part of whose triangles shine, and how its points choose among them.
class DirectLight {
 public:
  /// width: children a node of the tree over the lights; 0: the device's default. roughness: of
  /// surfaces that are glossy; 0: they are diffuse.
  DirectLight(const Device& device, const SceneFile& file, double share,
              const LightMethodName& method, uint32_t width, double roughness);

  const LightSet& set() const { return set_; }
  /// Sets the exposure by what the camera sees: half of what is lit lies below a middle
  /// grey.
  void expose(Tracing& tracing, const Camera& camera);
  /// Fills the batch's colors: what the surfaces that its rays meet send themselves, and reflect of
  /// the lights that they chose, by points on these at random and a shadow ray to each.
  void shade(Tracing& tracing, SampleBatch& batch) const;

 private:
  void choose_targets(std::span<const kiwami_light_receiver> receivers,
                      std::span<const GlossySurface> surfaces, std::span<const size_t> sources,
                      SampleBatch& batch, std::vector<kiwami_ray>& rays,
                      std::vector<size_t>& targets, std::vector<float>& amounts) const;
  /// The radiance of a triangle, 0 for one that does not shine.
  float radiance_of(const kiwami_hit& hit) const;

  std::vector<EmissiveTriangle> triangles_;  ///< by mesh, then by triangle
  const LightMethodName& method_;
  LightSet set_;
  float roughness_;
  float exposure_ = 1.0f;
};

}  // namespace kiwami::tools

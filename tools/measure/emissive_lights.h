// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "measure/library.h"
#include "scene/vector.h"

namespace kiwami::tools {

/// A way to choose lights, by its name on the command line.
struct LightMethodName {
  const char* name;
  uint32_t method;       ///< KIWAMI_LIGHT_METHOD_*
  uint32_t max_choices;  ///< of a receiver at once
  uint32_t lobe = KIWAMI_LIGHT_LOBE_COSINE;
  uint32_t order = KIWAMI_LIGHT_ORDER_XOR;
  /// Of two choices, one made with the lobe COSINE and one with GLOSSY: weighed together by the
  /// balance heuristic (E. Veach, L. J. Guibas, "Optimally Combining Sampling Techniques for Monte
  /// Carlo Rendering", SIGGRAPH 1995).
  bool is_mixed = false;
  uint32_t sequence = KIWAMI_LIGHT_SEQUENCE_RANDOM;

  /// Whether it is for glossy receivers alone.
  bool is_glossy() const { return lobe == KIWAMI_LIGHT_LOBE_GLOSSY; }
  bool is_roulette() const {
    return method == KIWAMI_LIGHT_METHOD_CULLING || method == KIWAMI_LIGHT_METHOD_ROULETTE ||
           method == KIWAMI_LIGHT_METHOD_LAZY_ROULETTE;
  }
};
const std::vector<LightMethodName>& light_methods();
/// "power, tree, ...".
std::string light_method_list();
/// Null for an unknown name.
const LightMethodName* find_light_method(const std::string& name);

/// A triangle that shines, to both sides.
struct EmissiveTriangle {
  Vec3 corner, u, v;
  Vec3 normal;  ///< of unit length
  float area;
  float radiance;
  uint32_t mesh, number;  ///< where it is in the scene

  Vec3 middle() const { return corner + (u + v) * (1.0f / 3.0f); }
  /// What one of its points sends to a point, by area: radiance times the cosine there over the
  /// squared distance.
  float sent(Vec3 from, Vec3 at) const;
  /// What arrives from one of its points at a point with a normal, by area: radiance times the
  /// cosines over the squared distance, nothing from below the tangent plane.
  float arriving(Vec3 from, Vec3 at, Vec3 at_normal) const;
};

/// A receiver that reflects by the GGX distribution (B. Walter, S. R. Marschner, H. Li, K. E.
/// Torrance, "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007), without Fresnel
/// term.
struct GlossySurface {
  Vec3 normal;  ///< of unit length
  Vec3 view;    ///< towards the viewer, of unit length, on the side of the normal
  float roughness;

  /// What is seen of light that comes along from a direction of any length: the distribution times
  /// the cosine.
  float reflected(Vec3 towards_light) const;
  /// Around the mirror direction.
  kiwami_light_lobe lobe() const;
};

/// A part of a scene's triangles that shine: each for itself with the probability `share`, with a
/// radiance that differs by up to 64, decided by hashes of mesh and triangle.
std::vector<EmissiveTriangle> choose_emissive(const SceneFile& file, double share);

/// What belongs to receivers beside themselves: each one a receiver, or none.
struct ReceiverExtras {
  std::span<const kiwami_light_lobe> lobes;    ///< for glossy methods
  std::span<const kiwami_light_pixel> pixels;  ///< for dithered ones
};

/// Owns a set of these lights, light i being triangle i, committed.
class LightSet {
 public:
  LightSet(const Device& device, const std::vector<EmissiveTriangle>& triangles, uint32_t width,
           bool with_roulette, uint32_t builder = KIWAMI_LIGHT_BUILDER_SAOH);
  ~LightSet() { kiwami_light_tree_release(tree_); }
  LightSet(const LightSet&) = delete;
  LightSet& operator=(const LightSet&) = delete;

  const kiwami_light_tree_info& info() const { return info_; }
  /// As many choices for each receiver as the method has at most. Of mixed methods, probabilities
  /// are what contributions are to be divided by.
  void sample(const LightMethodName& method, std::span<const kiwami_light_receiver> receivers,
              const ReceiverExtras& extras, std::span<kiwami_light_choice> choices) const;

 private:
  void sample_mixed(kiwami_light_query query, std::span<const kiwami_light_receiver> receivers,
                    std::span<kiwami_light_choice> choices) const;

  kiwami_light_tree* tree_ = nullptr;
  kiwami_light_tree_info info_{};
};

/// A receiver of light at a point with a normal.
kiwami_light_receiver receiver_at(Vec3 point, Vec3 normal, double random);

}  // namespace kiwami::tools

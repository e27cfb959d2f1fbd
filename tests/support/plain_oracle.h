// SPDX-License-Identifier: Apache-2.0
// What the library must answer, from a plain loop over all triangles. It shares no code with the
// library: only the public structs.
#pragma once

#include <cstdint>
#include <vector>

#include "kiwami/trace.h"
#include "support/mesh.h"

namespace kiwami_tests {

/// Who owns the points of an edge.
enum class EdgeRule {
  kOwned,     ///< exactly one of the neighbours: what the library promises
  kInclusive  ///< all triangles at it, as the usual test has it: wrong, to show that tests notice
};

/// A scene without tree: its triangles that can be hit, by (geometry, primitive).
class PlainOracle {
 public:
  explicit PlainOracle(const Scene& scene, EdgeRule rule = EdgeRule::kOwned);

  kiwami_hit closest_hit(const kiwami_ray& ray) const;
  bool any_hit(const kiwami_ray& ray) const;
  /// All hits, by (t, geometry, primitive).
  std::vector<kiwami_hit> hits(const kiwami_ray& ray) const;
  /// The number of triangles that the ray meets.
  uint32_t all_hits(const kiwami_ray& ray) const;

  size_t triangle_count() const { return triangles_.size(); }

 private:
  struct Triangle {
    Point a, b, c;
    uint32_t primitive_id, geometry_id, mask;
  };
  struct Frame;
  struct Crossing;

  static kiwami_hit hit_of(const Triangle& triangle, const Crossing& crossing);
  bool crosses(const Frame& frame, const kiwami_ray& ray, const Triangle& triangle,
               Crossing& crossing) const;
  /// Calls visit(triangle, crossing) for each triangle that the ray meets.
  template <typename Visit>
  void for_each_crossing(const kiwami_ray& ray, Visit visit) const;

  std::vector<Triangle> triangles_;
  EdgeRule rule_;
};

/// The answer to a ray that meets nothing.
kiwami_hit missing_hit();

}  // namespace kiwami_tests

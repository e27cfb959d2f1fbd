// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "kiwami/trace.h"
#include "support/mesh.h"

namespace kiwami_tests {

/// Judges misses of a closed mesh in double precision: a ray that hits there, and whose line passes
/// the mesh's silhouette at more than the margin of the box test, must not be missed.
class SilhouetteJudge {
 public:
  struct Verdict {
    bool is_hit;      ///< strictly inside a triangle, within the interval
    double distance;  ///< of the line to the nearest silhouette edge, across the ray's major axis
    double margin;    ///< of the box test, as a distance there
  };

  explicit SilhouetteJudge(const Mesh& mesh);

  Verdict judge(const kiwami_ray& ray) const;

 private:
  /// An edge and the two triangles at it.
  struct Edge {
    uint32_t from, to;
    uint32_t left, right;
  };
  struct Flat {
    double x, y, z;
  };

  std::vector<Flat> projected(const kiwami_ray& ray) const;
  double margin_of(const kiwami_ray& ray) const;

  const Mesh& mesh_;
  std::vector<Edge> edges_;
  Point greatest_{};
};

}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kiwami/trace.h"
#include "support/closed_meshes.h"
#include "support/random.h"

namespace kiwami_tests {

/// Rays that ask for the topology of a closed mesh: lines at vertices, at points of edges, along
/// edges, along axes through vertices, and at random.
class FeatureRayGenerator {
 public:
  /// The mesh must outlive the generator.
  FeatureRayGenerator(const ClosedMesh& closed, Random random);

  /// A segment with both ends outside.
  kiwami_ray outside_segment();
  /// A whole line: every t, from an origin anywhere.
  kiwami_ray line();
  /// From inside.
  kiwami_ray inside_ray();

 private:
  Point feature();
  Point outside_point();

  const ClosedMesh& closed_;
  Random random_;
  Point centre_{}, half_extent_{};  ///< of the mesh's box
};

}  // namespace kiwami_tests

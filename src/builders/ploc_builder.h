// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/morton_order.h"

namespace kiwami {

/// Locally ordered clustering: D. Meister, J. Bittner, "Parallel Locally-Ordered Clustering for
/// Bounding Volume Hierarchy Construction", TVCG 24(3), 2018. Clusters stand along a Morton curve;
/// all pairs that are each other's nearest within a radius join at once, until one is left. Departs
/// from it in the order of equal distances (see NearestPlaces), which pairs neighbours of a run of
/// equal boxes instead of joining one pair a step, and in what it does where boxes lie in each other.
class PlocBuilder {
 public:
  struct Config {
    uint32_t radius = 16;  ///< places to each side that are looked at: 4, 8 or 16
    CurveCode curve_code = CurveCode::kPlain;
  };

  /// One primitive a leaf. The same tree for any number of threads.
  static BinaryBvh build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                         const Parallel& parallel);
};

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lights/light_clusters.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Top-down builder by the surface area orientation heuristic: Conty Estevez & Kulla, "Importance
/// Sampling of Many Lights with Adaptive Tree Splitting", PACMCGIT 1(2) (HPG), 2018. Binned on all
/// three axes; one light a leaf.
///
/// The simpler variant is that of S. Ogaki's talk "Acceleration Data Structures for Ray Tracing",
/// CEDEC 2019: lights are sorted by the octant of their direction at the root, and by power and
/// surface area alone below.
///
/// Departures: what shines about both directions, or to more than a half space, is a ninth group at
/// the root in place of being halved into opposite octants, so that every light stays one leaf.
/// From a depth of 48 on groups are halved by number, so that no tree is deeper than
/// kMaxLightDepth.
///
/// Parallel over subtrees; the tree does not depend on the number of threads.
class SaohBuilder {
 public:
  struct Config {
    /// Bins along each axis.
    uint32_t bin_count = 12;
    /// Sort by octants at the root.
    bool sorts_by_octant = false;
  };
  static constexpr uint32_t kMaxBinCount = 32;

  /// leaf_numbers: the leaves to build over, at least one; they are reordered.
  static LightLinks build(const LightLeaves& leaves, Array<uint32_t>& leaf_numbers,
                          const Config& config, Memory& memory, const Parallel& parallel);
};

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// The five kernels of one ISA and width against the plain oracle.
#pragma once

#include <string>
#include <vector>

#include "parity/kernel_tables.h"
#include "support/mesh.h"
#include "support/plain_oracle.h"
#include "support/random.h"

namespace kiwami_tests {

/// Rays with the oracle's answers.
struct Expected {
  std::vector<kiwami_ray> rays;
  std::vector<kiwami_hit> hits;
  std::vector<uint32_t> counts;  ///< triangles that the ray meets
};

/// About count rays at the scene; each that hits is followed by one whose interval touches the hit.
Expected expected_of(const PlainOracle& oracle, const Scene& scene, uint64_t count, Random random);

/// The first ray whose closest hit, or any hit, differs; "" when there is none.
std::string difference(const std::vector<kiwami_hit>& hits, const Expected& expected);
std::string difference(const std::vector<uint8_t>& any, const Expected& expected);

/// The same in an order in which rays that point into the same octant follow each other: kernels
/// trace such runs together.
Expected grouped_by_octant(const Expected& expected);

/// The first ray on which some kernel differs, in the order given or grouped by octant, or a broken
/// margin; "" when there is neither.
std::string difference(const NamedKernels& named, const kiwami::SceneView& view,
                       const Expected& expected);

}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/morton_order.h"

namespace kiwami {

/// Approximate agglomerative clustering: Y. Gu, Y. He, K. Fatahalian, G. Blelloch, "Efficient BVH
/// Construction via Approximate Agglomerative Clustering", HPG 2013. The cells of a Morton curve
/// are halved down to a few primitives; on the way back each cell joins its nearest clusters until
/// f(size) of them are left, and hands those on. Departs from it in the order of equal distances
/// (PairKey), in parallel levels near the root in place of tasks, and in that each cell computes
/// its distance matrix anew, which takes less memory than handing it on.
class AacBuilder {
 public:
  /// f(n) = cell_size^(1/2 + epsilon) / 2 * n^(1/2 - epsilon).
  struct Config {
    uint32_t cell_size = 20;  ///< cells of fewer primitives are not halved; 2 or more
    double epsilon = 0.1;     ///< 0 to 0.5: how many clusters fewer large cells hand on
    CurveCode curve_code = CurveCode::kPlain;
  };
  /// The two settings of the paper.
  static Config high_quality() { return {20, 0.1, CurveCode::kPlain}; }
  static Config fast() { return {4, 0.2, CurveCode::kPlain}; }

  /// One primitive a leaf. The same tree for any number of threads.
  static BinaryBvh build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                         const Parallel& parallel);
};

}  // namespace kiwami

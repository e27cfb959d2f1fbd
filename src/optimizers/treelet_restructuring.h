// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "optimizers/treelet_pass.h"

namespace kiwami {

/// Gives the top of each subtree, over seven subtrees, the shape of least cost: T. Karras, T. Aila,
/// "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies", HPG 2013. The shapes
/// of all subsets are found by dynamic programming, from small to large. Costs count what would
/// become a leaf as one, in whole blocks. Departs from the paper in going through subtrees in a
/// fixed order, on several threads where they are apart.
void optimize_by_treelets(BinaryBvh& bvh, const TreeletConfig& config, Memory& memory,
                          const Parallel& parallel);

}  // namespace kiwami

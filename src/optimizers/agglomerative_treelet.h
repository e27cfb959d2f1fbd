// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "optimizers/treelet_pass.h"

namespace kiwami {

/// Gives the top of each subtree a shape that joins, again and again, the two parts with the
/// smallest box around both, where that costs less: L. R. Domingues, H. Pedrini, "Bounding Volume
/// Hierarchy Optimization through Agglomerative Treelet Restructuring", HPG 2015. So treelets may
/// be larger than those whose best shape can be found. The areas around all pairs are kept in a
/// matrix. Departs from the paper in going through subtrees in a fixed order, on several threads
/// where they are apart.
void optimize_by_agglomerative_treelets(BinaryBvh& bvh, const TreeletConfig& config, Memory& memory,
                                        const Parallel& parallel);

}  // namespace kiwami

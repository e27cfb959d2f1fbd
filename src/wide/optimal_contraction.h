// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "wide/contraction.h"

namespace kiwami {

struct OptimalContractionConfig {
  uint32_t width = 8;       ///< children a node, 2 to 16
  uint32_t leaf_width = 8;  ///< primitives a leaf, at least those of each binary leaf, at most 255
  float node_cost = 1.0f;   ///< of a node, times its area
  float leaf_cost = 1.0f;   ///< of a leaf, whatever it owns, times its area
  /// Divide leaves to fill the nodes that have fewer than half of their slots, less one, free:
  /// leaf-node merging finds too few partners that are small enough to take those.
  bool fill_nodes = false;
  /// How likely a ray visits each binary node, by its number; empty: as likely as its area says.
  std::span<const float> visit_weights = {};
};

/// Contracts a binary tree to the wide tree of least cost that it holds, by the surface area
/// heuristic or by visits that were measured, by dynamic programming: A. Pinto, "Adaptive
/// Collapsing on Bounding Volume Hierarchies for Ray-Tracing", EG short papers 2010; H. Ylitie, T.
/// Karras, S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG
/// 2017. Subtrees of few primitives become leaves where that is cheaper. Where costs are equal,
/// there are fewer nodes and leaves. Nodes that are filled come after that: the cost is then the
/// least but for what divided leaves add. Takes 8 bytes a binary node while it runs. The tree is
/// not empty.
Contraction contract_optimally(const BinaryBvh& binary, const OptimalContractionConfig& config,
                               Memory& memory, const Parallel& parallel);

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "bvh/sah_cost.h"

namespace kiwami {
namespace {

/// Sums of one subtree. In double: a float loses digits over many nodes.
struct Sums {
  double node_area = 0.0, leaf_area = 0.0;
  double node_count = 0.0, block_count = 0.0;
};

// Recursive, so that the sum is taken in the order of the tree, and not of its numbering.
Sums sum_below(const BinaryBvh& bvh, uint32_t index, const SahCosts& costs) {
  const BinaryNode& node = bvh.nodes[index];
  const double area = node.bounds.half_area();
  if (node.is_leaf()) {
    const double blocks = costs.blocks_of(node.count);
    return {0.0, area * blocks, 0.0, blocks};
  }
  const Sums left = sum_below(bvh, node.first, costs);
  const Sums right = sum_below(bvh, node.first + 1, costs);
  return {area + left.node_area + right.node_area, left.leaf_area + right.leaf_area,
          1.0 + left.node_count + right.node_count, left.block_count + right.block_count};
}

}  // namespace

double sah_cost(const BinaryBvh& bvh, const SahCosts& costs) {
  if (bvh.nodes.empty()) return 0.0;
  const Sums sums = sum_below(bvh, 0, costs);
  const double root_area = bvh.nodes[0].bounds.half_area();
  if (!(root_area > 0.0)) {
    return costs.node_cost * sums.node_count + costs.leaf_cost * sums.block_count;
  }
  return (costs.node_cost * sums.node_area + costs.leaf_cost * sums.leaf_area) / root_area;
}

}  // namespace kiwami

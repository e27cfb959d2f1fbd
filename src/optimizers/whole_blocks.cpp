// SPDX-License-Identifier: Apache-2.0
#include "optimizers/whole_blocks.h"

#include <algorithm>

namespace kiwami {
namespace {

/// In the count of a node: it is no leaf, but marked as one that owns the rest of the number.
constexpr uint32_t kMark = 0x80000000u;

/// What a subtree is as leaf blocks.
struct Blocks {
  uint32_t primitive_count;
  bool is_whole;
  double area;  ///< of the blocks, one or several, whichever is less
};

}  // namespace

WholeBlocks::WholeBlocks(BinaryBvh& bvh, const SahCosts& costs, Memory& memory)
    : is_inside_(memory, bvh.nodes.size()) {
  Array<Blocks> blocks(memory, bvh.nodes.size());
  for (size_t i = bvh.nodes.size(); i-- > 0;) {
    const BinaryNode& node = bvh.nodes[i];
    const double area = node.bounds.half_area();
    if (node.is_leaf()) {
      blocks[i] = {node.count, false, area};
      continue;
    }
    const Blocks &left = blocks[node.first], &right = blocks[node.first + 1];
    const uint32_t count = left.primitive_count + right.primitive_count;
    const double apart = left.area + right.area;
    const bool fits = count <= costs.block_size && area <= apart;
    blocks[i] = {count, fits && 2 * count > costs.block_size, fits ? area : apart};
  }
  is_inside_[0] = 0;
  // Children stand behind their parents.
  for (size_t i = 0; i < bvh.nodes.size(); ++i) {
    BinaryNode& node = bvh.nodes[i];
    if (node.is_leaf()) continue;
    const bool is_whole = blocks[i].is_whole && !is_inside_[i];
    is_inside_[node.first] = is_inside_[node.first + 1] = is_whole || is_inside_[i];
    if (is_whole) node.count = kMark | blocks[i].primitive_count;
  }
}

void WholeBlocks::release(BinaryBvh& bvh) {
  for (BinaryNode& node : bvh.nodes) {
    if (node.count & kMark) node.count = 0;
  }
}

}  // namespace kiwami

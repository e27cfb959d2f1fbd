// SPDX-License-Identifier: Apache-2.0
#include "optimizers/rotation.h"

#include <utility>

#include "bvh/tree_edit.h"
#include "optimizers/whole_blocks.h"

namespace kiwami {
namespace {

/// Two slots to swap, and what that takes from the area of the inner nodes.
struct Rotation {
  uint32_t a, b;
  float gain;
};

class Rotator {
 public:
  explicit Rotator(BinaryBvh& bvh) : bvh_(bvh) {}

  /// The best rotation at a node whose children and grandchildren have boxes that fit.
  Rotation find_best(uint32_t index) const {
    const uint32_t left = bvh_.nodes[index].first, right = left + 1;
    Rotation best = {0, 0, 0.0f};
    try_with_grandchildren(left, right, best);
    try_with_grandchildren(right, left, best);
    if (!bvh_.nodes[left].is_leaf() && !bvh_.nodes[right].is_leaf()) {
      const uint32_t of_left = bvh_.nodes[left].first, of_right = bvh_.nodes[right].first;
      // Swapping the other two gives the same pairs.
      for (uint32_t i = 0; i < 2; ++i) {
        const float area =
            area_of_both(of_left + 1, of_right + i) + area_of_both(of_left, of_right + 1 - i);
        propose({of_left, of_right + i, area_of(left) + area_of(right) - area}, best);
      }
    }
    return best;
  }

  void apply(uint32_t index, const Rotation& rotation) {
    std::swap(bvh_.nodes[rotation.a], bvh_.nodes[rotation.b]);
    const uint32_t left = bvh_.nodes[index].first;
    for (uint32_t child = left; child < left + 2; ++child) fit(bvh_.nodes[child]);
  }

 private:
  float area_of(uint32_t slot) const { return bvh_.nodes[slot].bounds.half_area(); }

  float area_of_both(uint32_t a, uint32_t b) const {
    Bounds both = bvh_.nodes[a].bounds;
    both.extend(bvh_.nodes[b].bounds);
    return both.half_area();
  }

  static void propose(const Rotation& rotation, Rotation& best) {
    if (rotation.gain > best.gain) best = rotation;
  }

  /// A child against each of its sibling's children: the sibling's box becomes that of the child
  /// and of the one that stays.
  void try_with_grandchildren(uint32_t child, uint32_t sibling, Rotation& best) const {
    if (bvh_.nodes[sibling].is_leaf()) return;
    const uint32_t first = bvh_.nodes[sibling].first;
    for (uint32_t i = 0; i < 2; ++i) {
      const float area = area_of_both(child, first + 1 - i);
      propose({child, first + i, area_of(sibling) - area}, best);
    }
  }

  void fit(BinaryNode& node) {
    if (node.is_leaf()) return;
    node.bounds = bvh_.nodes[node.first].bounds;
    node.bounds.extend(bvh_.nodes[node.first + 1].bounds);
  }

  BinaryBvh& bvh_;
};

/// Rotates at every node once, from below; returns how often that paid. Slots are swapped between
/// levels, so the order from below is that of the numbers at the start: it decides only what is
/// found in this pass.
size_t rotate_all(BinaryBvh& bvh, const WholeBlocks& blocks) {
  Rotator rotator(bvh);
  size_t rotations = 0;
  for (size_t i = bvh.nodes.size(); i-- > 0;) {
    if (bvh.nodes[i].is_leaf() || blocks.is_inside(static_cast<uint32_t>(i))) continue;
    const Rotation best = rotator.find_best(static_cast<uint32_t>(i));
    if (!(best.gain > 0.0f)) continue;
    rotator.apply(static_cast<uint32_t>(i), best);
    ++rotations;
  }
  return rotations;
}

}  // namespace

void optimize_by_rotation(BinaryBvh& bvh, const RotationConfig& config, Memory& memory) {
  if (bvh.nodes.empty()) return;
  for (uint32_t round = 0; round < config.rounds; ++round) {
    // A pass needs children behind their parents, and rotations move some before.
    relabel_depth_first(bvh, memory);
    const WholeBlocks blocks(bvh, config.costs, memory);
    const size_t rotations = rotate_all(bvh, blocks);
    WholeBlocks::release(bvh);
    if (rotations == 0) break;
  }
  relabel_depth_first(bvh, memory);
  limit_depth(bvh, memory);
}

}  // namespace kiwami

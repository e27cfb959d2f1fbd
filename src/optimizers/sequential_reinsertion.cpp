// SPDX-License-Identifier: Apache-2.0
#include "optimizers/sequential_reinsertion.h"

#include <algorithm>
#include <limits>

#include "optimizers/linked_tree.h"
#include "optimizers/whole_blocks.h"

namespace kiwami {
namespace {

/// How much area a node wastes: its own, and that beyond its children's.
float waste_of(const LinkedTree& tree, uint32_t slot) {
  const BinaryNode& node = tree[slot];
  const float area = node.bounds.half_area();
  const float left = tree[node.first].bounds.half_area();
  const float right = tree[node.first + 1].bounds.half_area();
  // The paper's product of the area and its ratios to the children's sum and to the smaller one. A
  // child without area is as small as floats can tell from its parent.
  const float least = area * 0x1p-24f;
  return area * (area / std::max(0.5f * (left + right), least)) *
         (area / std::max(std::min(left, right), least));
}

/// Finds the place beside which a subtree adds least area to a tree that it is not in.
class InsertionSearch {
 public:
  InsertionSearch(const LinkedTree& tree, Memory& memory) : tree_(tree), open_(memory) {}

  uint32_t run(const Bounds& box) {
    const float area = box.half_area();
    float least = std::numeric_limits<float>::infinity();
    uint32_t best = 0;
    push({0.0f, 0});
    while (!open_.empty()) {
      const Open top = pop();
      // A box around two is no smaller than either.
      if (top.added + area >= least) break;
      const BinaryNode& node = tree_[top.node];
      Bounds both = node.bounds;
      both.extend(box);
      const float beside = top.added + both.half_area();
      if (beside < least) {
        least = beside;
        best = top.node;
      }
      // Further down this node's box has to grow.
      const float added = beside - node.bounds.half_area();
      if (node.is_leaf() || added + area >= least) continue;
      push({added, node.first});
      push({added, node.first + 1});
    }
    while (!open_.empty()) open_.pop_back();
    return best;
  }

 private:
  struct Open {
    float added;  ///< by the nodes above
    uint32_t node;

    /// Least first from a heap; the order of equal ones must not be left to chance.
    bool operator<(const Open& other) const {
      return added != other.added ? added > other.added : node > other.node;
    }
  };

  void push(const Open& open) {
    open_.push_back(open);
    std::push_heap(&open_[0], &open_[0] + open_.size());
  }

  Open pop() {
    std::pop_heap(&open_[0], &open_[0] + open_.size());
    const Open least = open_.back();
    open_.pop_back();
    return least;
  }

  const LinkedTree& tree_;
  GrowingArray<Open> open_;
};

/// The rounds over one tree.
class SequentialReinsertion {
 public:
  SequentialReinsertion(LinkedTree& tree, const WholeBlocks& blocks, Memory& memory)
      : tree_(tree),
        blocks_(blocks),
        memory_(memory),
        search_(tree, memory),
        is_tried_(memory, tree.size()) {
    is_tried_.fill_zero();
  }

  /// Returns whether there was a node to try.
  bool run_round(float batch_share) {
    const auto wanted = static_cast<size_t>(static_cast<double>(tree_.size()) * batch_share);
    const Array<Candidate> candidates = rank(std::max<size_t>(wanted, 1));
    for (const Candidate& candidate : candidates) reinsert(candidate.slot);
    return !candidates.empty();
  }

 private:
  struct Candidate {
    float waste;
    uint32_t slot;

    bool operator<(const Candidate& other) const {
      return waste != other.waste ? waste > other.waste : slot < other.slot;
    }
  };

  /// The most wasteful nodes that were not tried yet, the worst first.
  Array<Candidate> rank(size_t wanted) const {
    GrowingArray<Candidate> all(memory_);
    for (uint32_t slot = 1; slot < tree_.size(); ++slot) {
      if (is_tried_[slot] || blocks_.is_inside(slot) || tree_[slot].is_leaf()) continue;
      all.push_back({waste_of(tree_, slot), slot});
    }
    Array<Candidate> worst = all.take();
    const size_t count = std::min(wanted, worst.size());
    std::nth_element(worst.begin(), worst.begin() + count, worst.end());
    worst.shrink(count);
    std::sort(worst.begin(), worst.end());
    return worst;
  }

  void reinsert(uint32_t slot) {
    const BinaryNode node = tree_[slot];
    // Earlier ones of the round may have brought another node here.
    if (node.is_leaf()) return;
    BinaryNode larger = tree_[node.first], smaller = tree_[node.first + 1];
    if (larger.bounds.half_area() < smaller.bounds.half_area()) std::swap(larger, smaller);
    tree_.begin_changes();
    double added = -static_cast<double>(node.bounds.half_area());
    const uint32_t pair = tree_.take_out(slot, added);
    tree_.put_beside(larger, pair, search_.run(larger.bounds), added);
    tree_.put_beside(smaller, node.first, search_.run(smaller.bounds), added);
    if (added < 0.0) return;
    tree_.undo_changes();
    is_tried_[slot] = 1;
  }

  LinkedTree& tree_;
  const WholeBlocks& blocks_;
  Memory& memory_;
  InsertionSearch search_;
  Array<uint8_t> is_tried_;
};

}  // namespace

void optimize_by_reinsertion(BinaryBvh& bvh, const SequentialReinsertionConfig& config,
                             Memory& memory) {
  // With fewer than three leaves there is one tree only.
  if (bvh.nodes.size() < 5) return;
  LinkedTree tree(bvh, memory);
  {
    const WholeBlocks blocks(bvh, config.costs, memory);
    SequentialReinsertion reinsertion(tree, blocks, memory);
    for (uint32_t round = 0; round < config.rounds; ++round) {
      if (!reinsertion.run_round(config.batch_share)) break;
    }
  }
  WholeBlocks::release(bvh);
  tree.finish();
}

}  // namespace kiwami

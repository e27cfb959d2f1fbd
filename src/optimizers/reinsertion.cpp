// SPDX-License-Identifier: Apache-2.0
#include "optimizers/reinsertion.h"

#include <algorithm>

#include "optimizers/linked_tree.h"
#include "optimizers/whole_blocks.h"

namespace kiwami {
namespace {

/// Nodes that one task searches for.
constexpr size_t kSearchBlock = 256;
constexpr uint32_t kNowhere = ~0u;

/// Where a node would best go. The area of the tree would fall by gain.
struct Reinsertion {
  uint32_t node, target;
  float gain;
};

/// Finds the best place for one node without taking it out.
class PlaceSearch {
 public:
  PlaceSearch(const LinkedTree& tree, Memory& memory) : tree_(tree), open_(memory) {}

  /// target is kNowhere where the node is best left alone.
  Reinsertion run(uint32_t node) {
    node_ = node;
    box_ = tree_[node].bounds;
    node_area_ = box_.half_area();
    best_ = {node, kNowhere, 0.0f};
    climb();
    return best_;
  }

 private:
  struct Open {
    uint32_t node;
    float saved;  ///< what shrank so far, less what grew above the node
  };

  float merged_area(const Bounds& other) const {
    Bounds both = other;
    both.extend(box_);
    return both.half_area();
  }

  void propose(uint32_t target, float gain) {
    if (gain > best_.gain) best_ = {node_, target, gain};
  }

  /// Goes up from the node's parent, which would go. Each node on the way, the pivot, has the node
  /// below one of its children; places are below the other one, or the pivot itself.
  void climb() {
    uint32_t pivot = tree_.parent(node_);
    const uint32_t sibling = tree_.sibling(node_);
    const float parent_area = tree_[pivot].bounds.half_area();
    Bounds without = tree_[sibling].bounds;  // the pivot's box without the node
    // Going up, only shrinking boxes add to this; it is no less than what any place there saves.
    float saved = parent_area;
    if (!tree_[sibling].is_leaf())
      open_children(sibling, saved - merged_area(without) + without.half_area());
    search_open();
    while (pivot != 0) {
      const uint32_t other = tree_.sibling(pivot);
      pivot = tree_.parent(pivot);
      open_.push_back({other, saved});
      search_open();
      without.extend(tree_[other].bounds);
      // Beside the pivot: its place takes the old box again.
      const float area = tree_[pivot].bounds.half_area(), shrunk = without.half_area();
      propose(pivot, saved - shrunk);
      saved += area - shrunk;
    }
  }

  void open_children(uint32_t node, float saved) {
    open_.push_back({tree_[node].first + 1, saved});
    open_.push_back({tree_[node].first, saved});
  }

  void search_open() {
    while (!open_.empty()) {
      const Open top = open_.back();
      open_.pop_back();
      // A box around two is no smaller than either.
      if (top.saved - node_area_ <= best_.gain) continue;
      const BinaryNode& other = tree_[top.node];
      const float merged = merged_area(other.bounds);
      propose(top.node, top.saved - merged);
      if (other.is_leaf()) continue;
      // Further down this node's box has to grow.
      open_children(top.node, top.saved - merged + other.bounds.half_area());
    }
  }

  const LinkedTree& tree_;
  GrowingArray<Open> open_;
  uint32_t node_ = 0;
  Bounds box_{};
  float node_area_ = 0.0f;
  Reinsertion best_{};
};

/// The nodes of largest area but the root, by rising slot.
Array<uint32_t> choose_candidates(const LinkedTree& tree, const WholeBlocks& blocks, float share,
                                  Memory& memory) {
  GrowingArray<uint32_t> movable(memory);
  for (uint32_t i = 1; i < tree.size(); ++i) {
    if (!blocks.is_inside(i)) movable.push_back(i);
  }
  Array<uint32_t> slots = movable.take();
  const auto count = std::clamp<size_t>(
      static_cast<size_t>(static_cast<double>(slots.size()) * share), 1, slots.size());
  const auto is_larger = [&](uint32_t a, uint32_t b) {
    const float area_a = tree[a].bounds.half_area(), area_b = tree[b].bounds.half_area();
    return area_a != area_b ? area_a > area_b : a < b;
  };
  std::nth_element(slots.begin(), slots.begin() + (count - 1), slots.end(), is_larger);
  slots.shrink(count);
  std::sort(slots.begin(), slots.end());
  return slots;
}

/// What the candidates ask for, the greatest gain first.
Array<Reinsertion> search(const LinkedTree& tree, const Array<uint32_t>& candidates, Memory& memory,
                          const Parallel& parallel) {
  Array<Reinsertion> found(memory, candidates.size());
  parallel.for_blocks(candidates.size(), kSearchBlock, [&](size_t begin, size_t end) {
    PlaceSearch search(tree, memory);
    for (size_t i = begin; i < end; ++i) found[i] = search.run(candidates[i]);
  });
  Reinsertion* end = std::remove_if(found.begin(), found.end(), [](const Reinsertion& reinsertion) {
    return reinsertion.target == kNowhere;
  });
  found.shrink(static_cast<size_t>(end - found.begin()));
  std::sort(found.begin(), found.end(), [](const Reinsertion& a, const Reinsertion& b) {
    return a.gain != b.gain ? a.gain > b.gain : a.node < b.node;
  });
  return found;
}

/// Makes the moves that still pay; returns how many.
size_t apply(LinkedTree& tree, const Array<Reinsertion>& reinsertions, Memory& memory) {
  // Slots that hold another node than the one that was searched for.
  Array<uint8_t> is_changed(memory, tree.size());
  is_changed.fill_zero();
  size_t moves = 0;
  for (const Reinsertion& reinsertion : reinsertions) {
    const uint32_t node = reinsertion.node, target = reinsertion.target;
    const uint32_t above = tree.parent(node), beside = tree.sibling(node);
    if (is_changed[node] || is_changed[target] || target == above || target == beside) continue;
    // Earlier moves may have put the target below the node.
    if (tree.is_below(target, node)) continue;
    const uint32_t pair = tree[above].first;
    if (tree.move(node, target) >= 0.0) {
      // Back beside its sibling, which stands in the parent's place.
      tree.move(pair + 1, above);
      is_changed[pair] = is_changed[pair + 1] = 1;
      continue;
    }
    is_changed[above] = is_changed[pair] = is_changed[pair + 1] = is_changed[target] = 1;
    ++moves;
  }
  return moves;
}

}  // namespace

void optimize_by_parallel_reinsertion(BinaryBvh& bvh, const ReinsertionConfig& config,
                                      Memory& memory, const Parallel& parallel) {
  // With fewer than three leaves there is one tree only.
  if (bvh.primitive_ids.size() < 3 || bvh.nodes.size() < 5) return;
  LinkedTree tree(bvh, memory);
  const WholeBlocks blocks(bvh, config.costs, memory);
  // Where all but the root stands inside a block, there is nothing to move.
  for (uint32_t round = 0; round < config.rounds && !bvh.nodes[0].is_leaf(); ++round) {
    const Array<uint32_t> candidates =
        choose_candidates(tree, blocks, config.candidate_share, memory);
    if (apply(tree, search(tree, candidates, memory, parallel), memory) == 0) break;
  }
  WholeBlocks::release(bvh);
  tree.finish();
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "builders/lbvh_builder.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include "builders/curve_leaves.h"
#include "bvh/tree_edit.h"

namespace kiwami {
namespace {

/// Leaves that one task starts from.
constexpr size_t kLeafBlock = 4096;
/// Subtrees whose nodes are placed in parallel: enough to balance what differs in size.
constexpr size_t kSubtrees = 256;

/// What the border between two neighbours is compared by: the delta, then what halves runs of equal
/// deltas. Where both are equal, the border further left is the lesser one.
struct Border {
  uint64_t delta;
  uint32_t place;

  bool operator<(const Border& other) const {
    return delta != other.delta ? delta < other.delta : place < other.place;
  }
};

/// The hierarchy while it is made. Inner node i stands for the border between leaves i and i + 1 of
/// the curve, so that every node knows its place before the tree is complete. Subtrees that are
/// cheaper as one leaf become one on the way, as collapse_leaves would make them.
class LinearHierarchy {
 public:
  LinearHierarchy(const LeavesAlongCurve& along, const LbvhBuilder::Config& config, Memory& memory)
      : along_(along),
        config_(config),
        last_(static_cast<uint32_t>(along.leaves.size()) - 1),
        parts_(memory, 2 * size_t{last_}),
        arrivals_(memory, last_) {
    arrivals_.fill_zero();
  }

  /// Makes all that a leaf completes on its way up.
  void climb(uint32_t leaf) {
    uint32_t left = leaf, right = leaf;
    Part part = part_of(along_.leaves[leaf]);
    while (left != 0 || right != last_) {
      const bool is_left = left == 0 || (right != last_ && border(right) < border(left - 1));
      const uint32_t parent = is_left ? right : left - 1;
      Part& own = parts_[2 * parent + (is_left ? 0 : 1)];
      own = part;
      own.end = is_left ? left : right;
      // What the first one wrote before this, the second one sees after it.
      if (std::atomic_ref(arrivals_[parent]).fetch_add(1, std::memory_order_acq_rel) == 0) return;
      left = parts_[2 * parent].end;
      right = parts_[2 * parent + 1].end;
      part = join(parent, left, right);
    }
    root_ = part;
  }

  /// The nodes depth first, siblings side by side.
  Array<BinaryNode> take_nodes(Memory& memory, const Parallel& parallel) const {
    Array<BinaryNode> nodes(memory, 2 * size_t{root_.leaf_count()} - 1);
    GrowingArray<Placed> open(memory);
    open.push_back({&root_, 0, 1});
    size_t next = 0;
    for (; next < open.size() && open.size() - next < kSubtrees; ++next) {
      const Placed placed = open[next];
      if (place(placed, nodes)) {
        open.push_back(left_of(placed));
        open.push_back(right_of(placed));
      }
    }
    parallel.for_each(open.size() - next,
                      [&](size_t i) { place_all(open[next + i], nodes, memory); });
    return nodes;
  }

 private:
  /// Marks the count of an inner node, which is that of the leaves below it; first is its border.
  static constexpr uint32_t kInner = 0x80000000u;

  /// What a node knows of one of its children.
  struct Part {
    BinaryNode node;
    float cost;    ///< the least one, where it may still be a part of a leaf
    uint32_t end;  ///< of its range, at the side away from the border

    bool is_inner() const { return (node.count & kInner) != 0; }
    uint32_t leaf_count() const { return is_inner() ? node.count & ~kInner : 1; }
  };

  /// A part, where its node goes, and where those below it begin.
  struct Placed {
    const Part* part;
    uint32_t node, below;
  };

  Part part_of(const BinaryNode& leaf) const {
    return {leaf, cost_of_leaf(leaf.bounds, leaf.count), 0};
  }

  float cost_of_leaf(const Bounds& bounds, uint32_t count) const {
    return config_.costs.leaf_cost * bounds.half_area() *
           static_cast<float>(config_.costs.blocks_of(count));
  }

  /// The node at a border whose children are complete, over the leaves of the curve from left to
  /// right.
  Part join(uint32_t border_of_both, uint32_t left, uint32_t right) const {
    const Part *const parts = &parts_[2 * size_t{border_of_both}], *const second = parts + 1;
    Part both{{parts->node.bounds, border_of_both, 0}, 0.0f, 0};
    both.node.bounds.extend(second->node.bounds);
    both.node.count = kInner | (parts->leaf_count() + second->leaf_count());
    const BinaryNode& last = along_.leaves[right];
    const uint32_t first_primitive = along_.leaves[left].first;
    const uint32_t primitive_count = last.first + last.count - first_primitive;
    if (primitive_count > config_.max_leaf_size) return both;
    const float as_node =
        config_.costs.node_cost * both.node.bounds.half_area() + parts->cost + second->cost;
    const float as_leaf = cost_of_leaf(both.node.bounds, primitive_count);
    both.cost = std::min(as_leaf, as_node);
    if (as_leaf <= as_node) {
      both.node.first = first_primitive;
      both.node.count = primitive_count;
    }
    return both;
  }

  /// Writes a node; returns whether it has children.
  static bool place(const Placed& placed, Array<BinaryNode>& nodes) {
    BinaryNode& node = nodes[placed.node];
    node = placed.part->node;
    if (!placed.part->is_inner()) return false;
    node.first = placed.below;
    node.count = 0;
    return true;
  }

  Placed left_of(const Placed& placed) const {
    return {&parts_[2 * size_t{placed.part->node.first}], placed.below, placed.below + 2};
  }
  Placed right_of(const Placed& placed) const {
    const Part* const left = &parts_[2 * size_t{placed.part->node.first}];
    return {left + 1, placed.below + 1, placed.below + 2 * left->leaf_count()};
  }

  // No recursion: by areas the tree may be of any depth.
  void place_all(Placed placed, Array<BinaryNode>& nodes, Memory& memory) const {
    GrowingArray<Placed> open(memory);
    for (;;) {
      while (place(placed, nodes)) {
        open.push_back(right_of(placed));
        placed = left_of(placed);
      }
      if (open.empty()) return;
      placed = open.back();
      open.pop_back();
    }
  }

  Border border(uint32_t i) const {
    const uint32_t place = i ^ (i + 1);
    if (config_.delta == LbvhBuilder::Delta::kCode) {
      return {along_.codes[i] ^ along_.codes[i + 1], place};
    }
    Bounds both = along_.leaves[i].bounds;
    both.extend(along_.leaves[i + 1].bounds);
    // Floats that are not negative compare as their bits do.
    return {std::bit_cast<uint32_t>(both.half_area()), place};
  }

  const LeavesAlongCurve& along_;
  const LbvhBuilder::Config& config_;
  uint32_t last_;
  Array<Part> parts_;         ///< the two children of each inner node
  Array<uint32_t> arrivals_;  ///< children that are complete, by inner node
  Part root_{};
};

}  // namespace

BinaryBvh LbvhBuilder::build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                             const Parallel& parallel) {
  if (primitives.empty()) return {};
  BinaryBvh bvh{{}, Array<uint32_t>(memory, primitives.size())};
  {
    MortonOrder order =
        sort_by_morton_code(std::move(primitives), memory, parallel, config.curve_code);
    parallel.for_blocks(order.codes.size(), kLeafBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) bvh.primitive_ids[i] = order.primitives[i].id;
    });
    const LeavesAlongCurve along =
        config.chunk_size > 1
            ? leaves_by_area(std::move(order), config.chunk_size, memory, parallel)
            : leaves_of_one(std::move(order), memory, parallel);
    LinearHierarchy hierarchy(along, config, memory);
    parallel.for_blocks(along.leaves.size(), kLeafBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) hierarchy.climb(static_cast<uint32_t>(i));
    });
    bvh.nodes = hierarchy.take_nodes(memory, parallel);
  }
  limit_depth(bvh, memory);
  return bvh;
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "builders/mini_tree_builder.h"

#include "builders/morton_order.h"
#include "builders/weighted_sweep.h"
#include "bvh/tree_edit.h"

namespace kiwami {
namespace {

using Item = WeightedSweep::Item;

/// A group's range along the curve, and its tree. The pairs of slots 2 i + 1 and 2 i + 2 of all its
/// places but the last are the tree's; that one stays free for the top tree. (The last place of all
/// has none: no tree needs more pairs than it has leaves, less one.)
struct Group {
  uint32_t begin, end;
  BinaryNode root;
};

class MiniTrees {
 public:
  MiniTrees(const MortonOrder& order, const MiniTreeBuilder::Config& config, BinaryBvh& bvh,
            Memory& memory, const Parallel& parallel)
      : order_(order),
        config_(config),
        bvh_(bvh),
        memory_(memory),
        parallel_(parallel),
        groups_(memory),
        items_(memory),
        free_pairs_(memory) {}

  void run() {
    cut_groups();
    parallel_.for_each(groups_.size(), [this](size_t i) { build(groups_[i]); });
    Bounds scene = Bounds::empty();
    for (size_t i = 0; i < groups_.size(); ++i) scene.extend(groups_[i].root.bounds);
    const float most_area = config_.prune_area * scene.half_area();
    for (size_t i = 0; i < groups_.size(); ++i) prune(groups_[i], most_area);
    const Array<Item> items = items_.take();
    WeightedSweep sweep(items.data(), static_cast<uint32_t>(items.size()), memory_);
    bvh_.nodes[0] = sweep.build(bvh_, [this] {
      const uint32_t pair = free_pairs_.back();
      free_pairs_.pop_back();
      return pair;
    });
  }

 private:
  void cut_groups() {
    struct Range {
      uint32_t begin, end;
    };
    GrowingArray<Range> open(memory_);
    open.push_back({0, static_cast<uint32_t>(order_.codes.size())});
    while (!open.empty()) {
      const Range range = open.back();
      open.pop_back();
      if (range.end - range.begin <= config_.group_size) {
        groups_.push_back({range.begin, range.end, {}});
        continue;
      }
      const uint32_t middle = middle_of_cell(order_.codes, range.begin, range.end);
      open.push_back({middle, range.end});
      open.push_back({range.begin, middle});
    }
  }

  void build(Group& group) {
    const uint32_t count = group.end - group.begin;
    Array<Item> items(memory_, count);
    for (uint32_t i = 0; i < count; ++i) {
      items[i] = {{order_.primitives[group.begin + i].bounds(), group.begin + i, 1}, 1};
    }
    uint32_t next = group.begin;
    group.root =
        WeightedSweep(items.data(), count, memory_).build(bvh_, [&] { return 2 * next++ + 1; });
  }

  /// The subtrees that are small enough become items of the top tree, from left to right.
  void prune(const Group& group, float most_area) {
    if (group.end != order_.codes.size()) free_pairs_.push_back(2 * group.end - 1);
    GrowingArray<BinaryNode> open(memory_);
    open.push_back(group.root);
    while (!open.empty()) {
      const BinaryNode node = open.back();
      open.pop_back();
      if (node.is_leaf() || node.bounds.half_area() <= most_area) {
        items_.push_back({node, weight_of(node)});
        continue;
      }
      free_pairs_.push_back(node.first);
      open.push_back(bvh_.nodes[node.first + 1]);
      open.push_back(bvh_.nodes[node.first]);
    }
  }

  /// The primitives below a node. No recursion: the tree may be of any depth.
  uint32_t weight_of(const BinaryNode& root) {
    GrowingArray<BinaryNode> open(memory_);
    open.push_back(root);
    uint32_t weight = 0;
    while (!open.empty()) {
      const BinaryNode node = open.back();
      open.pop_back();
      if (node.is_leaf()) {
        ++weight;
        continue;
      }
      open.push_back(bvh_.nodes[node.first]);
      open.push_back(bvh_.nodes[node.first + 1]);
    }
    return weight;
  }

  const MortonOrder& order_;
  const MiniTreeBuilder::Config& config_;
  BinaryBvh& bvh_;
  Memory& memory_;
  const Parallel& parallel_;
  GrowingArray<Group> groups_;
  GrowingArray<Item> items_;           ///< of the top tree
  GrowingArray<uint32_t> free_pairs_;  ///< slots that no mini tree uses
};

}  // namespace

BinaryBvh MiniTreeBuilder::build(Array<BuildPrimitive> primitives, const Config& config,
                                 Memory& memory, const Parallel& parallel) {
  if (primitives.empty()) return {};
  const size_t count = primitives.size();
  BinaryBvh bvh;
  {
    const MortonOrder order = sort_by_morton_code(std::move(primitives), memory, parallel);
    bvh = {Array<BinaryNode>(memory, 2 * count - 1), Array<uint32_t>(memory, count)};
    for (size_t i = 0; i < count; ++i) bvh.primitive_ids[i] = order.primitives[i].id;
    MiniTrees(order, config, bvh, memory, parallel).run();
  }
  relabel_depth_first(bvh, memory);
  limit_depth(bvh, memory);
  return bvh;
}

}  // namespace kiwami

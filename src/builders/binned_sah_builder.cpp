// SPDX-License-Identifier: Apache-2.0
#include "builders/binned_sah_builder.h"

#include <algorithm>

#include "builders/reassignment.h"
#include "builders/sah_split.h"

namespace kiwami {
namespace {

using Config = BinnedSahBuilder::Config;

/// A node whose primitives are known and whose split is not.
struct OpenNode {
  RangeBounds bounds;
  uint32_t begin, end;
  uint32_t depth;  ///< nodes on the path from the root, this one included
  uint32_t node;   ///< its place among the nodes near the root

  uint32_t count() const { return end - begin; }
};

/// One thread's part: the whole tree below one node, in nodes numbered from 0. Its primitives stand
/// in memory of its own, of a size that caches hold: stable partitions go back and forth between
/// two buffers.
class SubtreeBuilder {
 public:
  SubtreeBuilder(const Config& config, const OpenNode& open, Memory& memory)
      : config_(config),
        open_(open),
        buffers_{Array<BuildPrimitive>(memory, open.count()),
                 Array<BuildPrimitive>(memory, open.count())},
        nodes_(memory, size_t{2} * open.count()) {}

  /// Builds the tree over the primitives that order names: the node itself into top, all below it
  /// into nodes(). Writes the ids of the node's primitives, which may stand where order stands.
  void build(const BuildPrimitive* primitives, const uint32_t* order, uint32_t* ids,
             BinaryNode& top) {
    for (uint32_t i = 0; i < open_.count(); ++i) buffers_[0][i] = primitives[order[i]];
    ids_ = ids;
    grow(open_.bounds, 0, open_.count(), open_.depth, 0, top);
  }

  const BinaryNode* nodes() const { return nodes_.data(); }
  uint32_t node_count() const { return node_count_; }

 private:
  void grow(const RangeBounds& bounds, uint32_t begin, uint32_t end, uint32_t depth, int side,
            BinaryNode& node) {
    const SplitDecision decision = decide(bounds, begin, end, depth, side);
    node.bounds = bounds.geometry.bounds();
    if (decision.kind == SplitDecision::kLeaf) {
      make_leaf(begin, end, side, node);
      return;
    }
    RangeBounds child[2];
    partition(decision, begin, end, side, child);
    const uint32_t first = node_count_;
    node_count_ += 2;
    node.first = first;
    node.count = 0;
    const uint32_t middle = begin + decision.left_count;
    grow(child[0], begin, middle, depth + 1, 1 - side, nodes_[first]);
    grow(child[1], middle, end, depth + 1, 1 - side, nodes_[first + 1]);
  }

  SplitDecision decide(const RangeBounds& bounds, uint32_t begin, uint32_t end, uint32_t depth,
                       int side) {
    const uint32_t count = end - begin;
    SplitDecision decision;
    if (decide_without_bins(count, depth, config_, decision)) return decision;
    mapping_ = BinMapping(bounds.centroids, BinnedSahBuilder::bins_of(count, depth, config_));
    bins_.clear(mapping_.bin_count);
    const BuildPrimitive* from = buffers_[side].data();
    for (uint32_t i = begin; i < end; ++i) bins_.add(from[i], mapping_);
    decision = decide_by_bins(bins_, mapping_, bounds, count, config_);
    if (config_.reassigns && decision.kind == SplitDecision::kPlane) {
      reassign(begin, end, side, decision);
    }
    return decision;
  }

  void reassign(uint32_t begin, uint32_t end, int side, SplitDecision& decision) {
    BuildPrimitive* primitives = buffers_[side].data();
    Reassignment reassignment(SplitPlane(mapping_, decision.axis, decision.last_left_bin));
    TwoSides pure, sides;
    for (uint32_t i = begin; i < end; ++i) reassignment.add_pure(primitives[i], pure);
    if (!reassignment.set_pure(pure, end - begin)) return;
    for (uint32_t i = begin; i < end; ++i) {
      primitives[i].reserved = reassignment.side_of(primitives[i]);
      sides.add(primitives[i].reserved, VectorBounds::of(primitives[i]));
    }
    take_if_cheaper(sides, config_.block_size, decision);
  }

  void partition(const SplitDecision& decision, uint32_t begin, uint32_t end, int side,
                 RangeBounds child[2]) {
    const BuildPrimitive* from = buffers_[side].data();
    BuildPrimitive* to = buffers_[1 - side].data();
    child[0] = child[1] = RangeBounds::empty();
    uint32_t cursor[2] = {begin, begin + decision.left_count};
    if (decision.kind == SplitDecision::kIndex) {
      for (uint32_t i = begin; i < end; ++i) {
        child[i >= cursor[1]].extend(from[i]);
        to[i] = from[i];
      }
      return;
    }
    const bool by_marks = decision.kind == SplitDecision::kMarks;
    const SplitPlane plane(mapping_, decision.axis, decision.last_left_bin);
    for (uint32_t i = begin; i < end; ++i) {
      const uint32_t is_right = by_marks ? from[i].reserved : plane.is_right(from[i]);
      child[is_right].extend(from[i]);
      to[cursor[is_right]++] = from[i];
    }
  }

  void make_leaf(uint32_t begin, uint32_t end, int side, BinaryNode& node) {
    node.first = begin;
    node.count = end - begin;
    for (uint32_t i = begin; i < end; ++i) ids_[i] = buffers_[side][i].id;
  }

  const Config& config_;
  const OpenNode& open_;
  Array<BuildPrimitive> buffers_[2];
  // A tree of n primitives has at most 2n - 2 nodes below its root.
  Array<BinaryNode> nodes_;
  uint32_t* ids_ = nullptr;
  uint32_t node_count_ = 0;
  BinMapping mapping_;
  SahBins bins_;
};

/// A run of one open node's primitives: the unit of work near the root.
struct Block {
  uint32_t open_node;
  uint32_t begin, end;
  uint32_t left_count;
  uint32_t cursor[2];  ///< where its primitives go, left and right
  RangeBounds child[2];
};

/// An open node of the current level, and what is being found out about it.
struct LevelNode {
  OpenNode open;
  BinMapping mapping;
  SplitDecision decision;
  uint32_t first_block, block_end;
};

/// A subtree that one thread builds.
struct Subtree {
  OpenNode open;
  int side;
};

/// One build. The nodes near the root are split level by level, each step parallel over the blocks
/// of all nodes of the level; then the subtrees below them, each by one thread. Near the root only
/// the order of the primitives is partitioned: they themselves stay where they are, and since
/// partitions are stable, each node meets its own by rising address.
class Build {
 public:
  Build(Array<BuildPrimitive> primitives, const Config& config, TreeParts& parts, Memory& memory,
        const Parallel& parallel)
      : primitives_(std::move(primitives)),
        config_(config),
        memory_(memory),
        parallel_(parallel),
        count_(static_cast<uint32_t>(primitives_.size())),
        // Enough blocks to keep many threads busy, of a size worth starting a task.
        block_size_(std::max(4096u, count_ / 1024)),
        subtree_size_(config.subtree_size_of(count_)),
        order_{Array<uint32_t>(memory, count_), Array<uint32_t>(memory, count_)},
        parts_(parts),
        subtrees_(memory) {}

  /// Returns the ids of the primitives.
  Array<uint32_t> run() {
    const OpenNode root = {bounds_of_all(), 0, count_, 1, parts_.add_top()};
    GrowingArray<LevelNode> level(memory_);
    add_open_node(root, 0, level);
    for (int side = 0; !level.empty(); side = 1 - side) level = split_level(level, side);
    build_subtrees();
    return std::move(order_[0]);
  }

 private:
  /// Sets the first order, too.
  RangeBounds bounds_of_all() {
    const size_t blocks = (count_ + block_size_ - 1) / block_size_;
    Array<RangeBounds> partial(memory_, blocks);
    parallel_.for_each(blocks, [&](size_t block) {
      const size_t begin = block * block_size_;
      const size_t end = std::min<size_t>(begin + block_size_, count_);
      RangeBounds bounds = RangeBounds::empty();
      for (size_t i = begin; i < end; ++i) {
        bounds.extend(primitives_[i]);
        order_[0][i] = static_cast<uint32_t>(i);
      }
      partial[block] = bounds;
    });
    RangeBounds all = RangeBounds::empty();
    for (const RangeBounds& bounds : partial) all.extend(bounds);
    return all;
  }

  /// Files a node whose primitives order_[side] names: as a subtree, or to be split next.
  void add_open_node(const OpenNode& open, int side, GrowingArray<LevelNode>& level) {
    if (open.count() <= subtree_size_) {
      subtrees_.push_back({open, side});
    } else {
      level.push_back({open, BinMapping(), SplitDecision(), 0, 0});
    }
  }

  GrowingArray<LevelNode> split_level(GrowingArray<LevelNode>& level, int side) {
    Array<Block> blocks = cut_into_blocks(level);
    const uint32_t* from = order_[side].data();
    decide_level(level, blocks, from);
    parallel_.for_each(blocks.size(), [&](size_t i) {
      Block& block = blocks[i];
      scatter(level[block.open_node], block, from, order_[1 - side].data());
    });
    GrowingArray<LevelNode> next(memory_);
    for (size_t i = 0; i < level.size(); ++i) add_children(level[i], blocks, 1 - side, next);
    return next;
  }

  Array<Block> cut_into_blocks(GrowingArray<LevelNode>& level) {
    GrowingArray<Block> blocks(memory_);
    for (size_t i = 0; i < level.size(); ++i) {
      const OpenNode& open = level[i].open;
      level[i].first_block = static_cast<uint32_t>(blocks.size());
      for (uint32_t begin = open.begin; begin < open.end;) {
        const uint32_t end = begin + std::min(block_size_, open.end - begin);
        blocks.push_back({static_cast<uint32_t>(i), begin, end, 0, {0, 0}, {}});
        begin = end;
      }
      level[i].block_end = static_cast<uint32_t>(blocks.size());
    }
    return blocks.take();
  }

  /// Decides each node's split, and where in the other buffer each block's primitives go.
  void decide_level(GrowingArray<LevelNode>& level, Array<Block>& blocks, const uint32_t* from) {
    parallel_.for_each(level.size(), [&](size_t i) {
      LevelNode& node = level[i];
      const uint32_t bins = BinnedSahBuilder::bins_of(node.open.count(), node.open.depth, config_);
      node.mapping = BinMapping(node.open.bounds.centroids, bins);
    });
    Array<SahBins> block_bins(memory_, blocks.size());
    parallel_.for_each(blocks.size(), [&](size_t i) {
      const BinMapping& mapping = level[blocks[i].open_node].mapping;
      block_bins[i].clear(mapping.bin_count);
      for (uint32_t k = blocks[i].begin; k < blocks[i].end; ++k) {
        prefetch_after(k, blocks[i].end, from);
        block_bins[i].add(primitives_[from[k]], mapping);
      }
    });
    parallel_.for_each(level.size(), [&](size_t i) {
      LevelNode& node = level[i];
      const OpenNode& open = node.open;
      if (!decide_without_bins(open.count(), open.depth, config_, node.decision)) {
        SahBins bins = block_bins[node.first_block];
        for (uint32_t block = node.first_block + 1; block < node.block_end; ++block) {
          bins.merge(block_bins[block], node.mapping.bin_count);
        }
        node.decision = decide_by_bins(bins, node.mapping, open.bounds, open.count(), config_);
      }
      count_left(node, blocks, block_bins);
    });
    if (config_.reassigns) reassign_level(level, blocks, from);
    parallel_.for_each(level.size(), [&](size_t i) { place_blocks(level[i], blocks); });
  }

  static void count_left(const LevelNode& node, Array<Block>& blocks,
                         const Array<SahBins>& block_bins) {
    const SplitDecision& decision = node.decision;
    const uint32_t middle = node.open.begin + decision.left_count;
    for (uint32_t i = node.first_block; i < node.block_end; ++i) {
      Block& block = blocks[i];
      block.left_count = decision.kind == SplitDecision::kPlane
                             ? block_bins[i].count_left(decision.axis, decision.last_left_bin)
                             : std::clamp(middle, block.begin, block.end) - block.begin;
    }
  }

  /// Lets primitives that a plane cuts go to the cheaper side.
  void reassign_level(GrowingArray<LevelNode>& level, Array<Block>& blocks, const uint32_t* from) {
    Array<TwoSides> sides(memory_, blocks.size());
    Array<Reassignment> reassignments(memory_, level.size());
    Array<uint8_t> is_judged(memory_, level.size());
    const auto reassignment_of = [](const LevelNode& node) {
      const SplitDecision& decision = node.decision;
      return Reassignment(SplitPlane(node.mapping, decision.axis, decision.last_left_bin));
    };
    parallel_.for_each(blocks.size(), [&](size_t i) {
      sides[i] = TwoSides();
      const LevelNode& node = level[blocks[i].open_node];
      if (node.decision.kind != SplitDecision::kPlane) return;
      const Reassignment reassignment = reassignment_of(node);
      for (uint32_t k = blocks[i].begin; k < blocks[i].end; ++k) {
        reassignment.add_pure(primitives_[from[k]], sides[i]);
      }
    });
    parallel_.for_each(level.size(), [&](size_t i) {
      const LevelNode& node = level[i];
      is_judged[i] = 0;
      if (node.decision.kind != SplitDecision::kPlane) return;
      reassignments[i] = reassignment_of(node);
      is_judged[i] = reassignments[i].set_pure(sum_of(node, sides), node.open.count());
    });
    parallel_.for_each(blocks.size(), [&](size_t i) {
      sides[i] = TwoSides();
      if (!is_judged[blocks[i].open_node]) return;
      const Reassignment& reassignment = reassignments[blocks[i].open_node];
      for (uint32_t k = blocks[i].begin; k < blocks[i].end; ++k) {
        BuildPrimitive& primitive = primitives_[from[k]];
        primitive.reserved = reassignment.side_of(primitive);
        sides[i].add(primitive.reserved, VectorBounds::of(primitive));
      }
    });
    parallel_.for_each(level.size(), [&](size_t i) {
      LevelNode& node = level[i];
      if (!is_judged[i]) return;
      take_if_cheaper(sum_of(node, sides), config_.block_size, node.decision);
      if (node.decision.kind != SplitDecision::kMarks) return;
      for (uint32_t k = node.first_block; k < node.block_end; ++k) {
        blocks[k].left_count = sides[k].count[0];
      }
    });
  }

  static TwoSides sum_of(const LevelNode& node, const Array<TwoSides>& sides) {
    TwoSides sum;
    for (uint32_t i = node.first_block; i < node.block_end; ++i) sum.merge(sides[i]);
    return sum;
  }

  /// Processors do not foresee rising addresses with gaps.
  void prefetch_after(uint32_t position, uint32_t end, const uint32_t* order) const {
    constexpr uint32_t kDistance = 16;
    if (end - position <= kDistance) return;
    simde_mm_prefetch(reinterpret_cast<const char*>(&primitives_[order[position + kDistance]]),
                      SIMDE_MM_HINT_T0);
  }

  /// The scan that makes the parallel partition stable.
  static void place_blocks(const LevelNode& node, Array<Block>& blocks) {
    uint32_t left = node.open.begin, right = left + node.decision.left_count;
    for (uint32_t i = node.first_block; i < node.block_end; ++i) {
      Block& block = blocks[i];
      block.cursor[0] = left;
      block.cursor[1] = right;
      left += block.left_count;
      right += block.end - block.begin - block.left_count;
    }
  }

  void scatter(const LevelNode& node, Block& block, const uint32_t* from, uint32_t* to) const {
    RangeBounds child[2] = {RangeBounds::empty(), RangeBounds::empty()};
    uint32_t cursor[2] = {block.cursor[0], block.cursor[1]};
    const SplitDecision& decision = node.decision;
    const bool by_index = decision.kind == SplitDecision::kIndex;
    const bool by_marks = decision.kind == SplitDecision::kMarks;
    const SplitPlane plane(node.mapping, decision.axis, decision.last_left_bin);
    const uint32_t middle = node.open.begin + decision.left_count;
    for (uint32_t i = block.begin; i < block.end; ++i) {
      prefetch_after(i, block.end, from);
      const BuildPrimitive& primitive = primitives_[from[i]];
      const uint32_t is_right = by_index   ? i >= middle
                                : by_marks ? primitive.reserved
                                           : plane.is_right(primitive);
      child[is_right].extend(primitive);
      to[cursor[is_right]++] = from[i];
    }
    block.child[0] = child[0];
    block.child[1] = child[1];
  }

  void add_children(const LevelNode& parent, const Array<Block>& blocks, int side,
                    GrowingArray<LevelNode>& next) {
    const OpenNode& open = parent.open;
    const uint32_t first = parts_.add_top();
    parts_.add_top();
    parts_.top(open.node) = {open.bounds.geometry.bounds(), first, 0};
    const uint32_t edges[3] = {open.begin, open.begin + parent.decision.left_count, open.end};
    for (uint32_t child = 0; child < 2; ++child) {
      RangeBounds bounds = RangeBounds::empty();
      for (uint32_t i = parent.first_block; i < parent.block_end; ++i) {
        bounds.extend(blocks[i].child[child]);
      }
      add_open_node({bounds, edges[child], edges[child + 1], open.depth + 1, first + child}, side,
                    next);
    }
  }

  void build_subtrees() {
    // In the order of primitives, so that neighbouring subtrees are neighbours in memory.
    subtree_list_ = subtrees_.take();
    std::sort(subtree_list_.begin(), subtree_list_.end(),
              [](const Subtree& a, const Subtree& b) { return a.open.begin < b.open.begin; });
    Array<uint32_t> order(memory_, subtree_list_.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<uint32_t>(i);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      return subtree_list_[a].open.count() > subtree_list_[b].open.count();
    });
    parts_.set_subtree_count(order.size());
    parallel_.for_each(order.size(), [&](size_t i) {
      const Subtree& subtree = subtree_list_[order[i]];
      const OpenNode& open = subtree.open;
      SubtreeBuilder builder(config_, open, memory_);
      builder.build(primitives_.data(), order_[subtree.side].data() + open.begin,
                    order_[0].data() + open.begin, parts_.top(open.node));
      parts_.keep(order[i], {open.node, builder.nodes(), builder.node_count(), open.begin,
                             open.count(), order_[0].data() + open.begin});
    });
  }

  Array<BuildPrimitive> primitives_;
  const Config& config_;
  Memory& memory_;
  const Parallel& parallel_;
  uint32_t count_;
  uint32_t block_size_;
  uint32_t subtree_size_;
  Array<uint32_t> order_[2];  ///< of the primitives; in the end the first one holds their ids
  TreeParts& parts_;
  GrowingArray<Subtree> subtrees_;
  Array<Subtree> subtree_list_;
};

}  // namespace

uint32_t BinnedSahBuilder::bins_of(uint32_t primitive_count, uint32_t depth, const Config& config) {
  uint32_t most = std::clamp(config.bin_count, 2u, SahBins::kMaxBins);
  if (config.bin_halving_depth != 0) {
    const uint32_t halvings = std::min((depth - 1) / config.bin_halving_depth, 31u);
    most = std::min(most, std::max(most >> halvings, 8u));
  }
  return std::min(most, 4 + primitive_count / 4);
}

BinaryBvh BinnedSahBuilder::build(Array<BuildPrimitive> primitives, const Config& config,
                                  Memory& memory, const Parallel& parallel) {
  if (primitives.empty()) return {Array<BinaryNode>(memory, 0), Array<uint32_t>(memory, 0)};
  JoinedNodes nodes(memory, parallel);
  Array<uint32_t> ids = build_parts(std::move(primitives), config, nodes, memory, parallel);
  return {nodes.join(), std::move(ids)};
}

Array<uint32_t> BinnedSahBuilder::build_parts(Array<BuildPrimitive> primitives,
                                              const Config& config, TreeParts& parts,
                                              Memory& memory, const Parallel& parallel) {
  return Build(std::move(primitives), config, parts, memory, parallel).run();
}

}  // namespace kiwami

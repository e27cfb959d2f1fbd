// SPDX-License-Identifier: Apache-2.0
#include "builders/sweep_sah_builder.h"

#include <algorithm>
#include <bit>

#include "builders/joined_nodes.h"
#include "builders/sah_split.h"
#include "parallel/radix_sort.h"

namespace kiwami {
namespace {

using Config = SweepSahBuilder::Config;

/// The best position along one axis: its first left_count primitives go left.
struct BestPosition {
  double cost = std::numeric_limits<double>::infinity();
  uint32_t left_count = 0;
  uint32_t larger_count = 0;  ///< of the two sides

  /// Among equal costs the balanced one: equal boxes would lose one block a level otherwise.
  bool is_better_than(const BestPosition& other) const {
    return cost < other.cost || (cost == other.cost && larger_count < other.larger_count);
  }
};

/// A node whose primitives are known and whose split is not.
struct OpenNode {
  VectorBounds bounds;
  uint32_t begin, end;
  uint32_t depth;  ///< nodes on the path from the root, this one included
  uint32_t node;

  uint32_t count() const { return end - begin; }
};

/// A decided split: the first left_count primitives along an axis go left.
struct SweepSplit {
  bool is_leaf;
  int axis;
  uint32_t left_count;
  VectorBounds child[2];
};

/// Primitives and their three orders. A node is one range of all three.
class SweepOrders {
 public:
  SweepOrders(const BuildPrimitive* primitives, uint32_t* const order[3],
              uint32_t* const scratch[3], uint8_t* is_right, const Config& config)
      : primitives_(primitives), is_right_(is_right), config_(config) {
    std::copy_n(order, 3, order_);
    std::copy_n(scratch, 3, scratch_);
  }

  /// The best position along an axis, the first of equal ones. A node of no area costs the same
  /// wherever it is cut: there, balance decides.
  BestPosition sweep(const OpenNode& open, int axis) const {
    const uint32_t* const order = order_[axis];
    uint32_t* const right_area = scratch_[axis];
    VectorBounds box = VectorBounds::empty();
    for (uint32_t i = open.end - 1; i > open.begin; --i) {
      box.extend(VectorBounds::of(primitives_[order[i]]));
      right_area[i] = std::bit_cast<uint32_t>(box.half_area());
    }
    const bool has_area = open.bounds.half_area() > 0.0f;
    BestPosition best;
    box = VectorBounds::empty();
    for (uint32_t i = open.begin; i + 1 < open.end; ++i) {
      box.extend(VectorBounds::of(primitives_[order[i]]));
      const uint32_t left = i + 1 - open.begin, right = open.count() - left;
      const double left_cost = static_cast<double>(box.half_area()) * blocks(left);
      const double right_cost =
          static_cast<double>(std::bit_cast<float>(right_area[i + 1])) * blocks(right);
      const uint32_t larger = std::max(left, right);
      const BestPosition here = {has_area ? left_cost + right_cost : larger, left, larger};
      if (here.is_better_than(best)) best = here;
    }
    return best;
  }

  /// Whether the node needs no sweep; otherwise it is to be decided by the best of each axis.
  bool decide_alone(const OpenNode& open, SweepSplit& split) const {
    SplitDecision decision;
    if (!decide_without_bins(open.count(), open.depth, config_, decision)) return false;
    split = {decision.kind == SplitDecision::kLeaf, 0, decision.left_count, {}};
    return true;
  }

  SweepSplit decide(const OpenNode& open, const BestPosition best[3]) const {
    int axis = 0;
    for (int other = 1; other < 3; ++other) {
      if (best[other].is_better_than(best[axis])) axis = other;
    }
    const double area = open.bounds.half_area();
    const double split_cost = config_.node_cost * area + config_.leaf_cost * best[axis].cost;
    const double leaf_cost = config_.leaf_cost * area * blocks(open.count());
    const bool is_leaf =
        open.count() <= config_.max_leaf_size && !(area > 0.0 && split_cost < leaf_cost);
    return {is_leaf, axis, best[axis].left_count, {}};
  }

  /// Marks the sides of a node's primitives and finds the boxes of both.
  void mark(const OpenNode& open, SweepSplit& split) const {
    split.child[0] = split.child[1] = VectorBounds::empty();
    for (uint32_t i = open.begin; i < open.end; ++i) {
      const uint32_t id = order_[split.axis][i];
      is_right_[id] = i - open.begin >= split.left_count;
      split.child[is_right_[id]].extend(VectorBounds::of(primitives_[id]));
    }
  }

  /// Divides the order of an axis by the marks.
  void partition(const OpenNode& open, const SweepSplit& split, int axis) const {
    if (axis == split.axis) return;
    uint32_t* const order = order_[axis];
    uint32_t* const right = scratch_[axis] + open.begin;
    uint32_t left_end = open.begin, right_count = 0;
    for (uint32_t i = open.begin; i < open.end; ++i) {
      const uint32_t id = order[i];
      // Both are written, one of them counts: no branch on what is as good as random.
      const uint32_t goes_right = is_right_[id];
      right[right_count] = id;
      order[left_end] = id;
      right_count += goes_right;
      left_end += 1 - goes_right;
    }
    std::copy_n(right, right_count, order + left_end);
  }

 private:
  double blocks(uint32_t count) const { return blocks_of(count, config_.block_size); }

  const BuildPrimitive* primitives_;
  uint32_t* order_[3];
  uint32_t* scratch_[3];
  uint8_t* is_right_;
  const Config& config_;
};

/// One thread's part: the whole tree below one node, in nodes numbered from 0. Its primitives stand
/// in memory of its own, by their places along the first axis, of a size that caches hold.
class SubtreeBuilder {
 public:
  SubtreeBuilder(const Config& config, uint32_t count, Memory& memory)
      : primitives_(memory, count),
        order_(memory, size_t{3} * count),
        scratch_(memory, count),
        is_right_(memory, count),
        // A tree of n primitives has at most 2n - 2 nodes below its root.
        nodes_(memory, size_t{2} * count),
        orders_(make_orders(config, count)) {}

  /// order: the node's range of each order of all primitives; place: memory by primitive, of which
  /// the node's are overwritten. Writes the node itself to top, and the ids of its primitives.
  void build(const OpenNode& open, const BuildPrimitive* primitives, const uint32_t* const order[3],
             uint32_t* place, BinaryNode& top, uint32_t* ids) {
    const uint32_t count = open.count();
    for (uint32_t i = 0; i < count; ++i) {
      primitives_[i] = primitives[order[0][i]];
      place[order[0][i]] = i;
    }
    for (uint32_t axis = 0; axis < 3; ++axis) {
      for (uint32_t i = 0; i < count; ++i) order_[axis * count + i] = place[order[axis][i]];
    }
    ids_ = ids;
    grow({open.bounds, 0, count, open.depth, 0}, top);
  }

  const BinaryNode* nodes() const { return nodes_.data(); }
  uint32_t node_count() const { return node_count_; }

 private:
  SweepOrders make_orders(const Config& config, uint32_t count) {
    uint32_t* const order[3] = {order_.data(), order_.data() + count,
                                order_.data() + size_t{2} * count};
    uint32_t* const scratch[3] = {scratch_.data(), scratch_.data(), scratch_.data()};
    return {primitives_.data(), order, scratch, is_right_.data(), config};
  }

  void grow(const OpenNode& open, BinaryNode& node) {
    node.bounds = open.bounds.bounds();
    SweepSplit split;
    if (!orders_.decide_alone(open, split)) {
      BestPosition best[3];
      for (int axis = 0; axis < 3; ++axis) best[axis] = orders_.sweep(open, axis);
      split = orders_.decide(open, best);
    }
    if (split.is_leaf) {
      node.first = open.begin;
      node.count = open.count();
      for (uint32_t i = open.begin; i < open.end; ++i) ids_[i] = primitives_[order_[i]].id;
      return;
    }
    orders_.mark(open, split);
    for (int axis = 0; axis < 3; ++axis) orders_.partition(open, split, axis);
    const uint32_t first = node_count_, middle = open.begin + split.left_count;
    node_count_ += 2;
    node.first = first;
    node.count = 0;
    grow({split.child[0], open.begin, middle, open.depth + 1, 0}, nodes_[first]);
    grow({split.child[1], middle, open.end, open.depth + 1, 0}, nodes_[first + 1]);
  }

  Array<BuildPrimitive> primitives_;
  Array<uint32_t> order_;
  Array<uint32_t> scratch_;
  Array<uint8_t> is_right_;
  Array<BinaryNode> nodes_;
  SweepOrders orders_;
  uint32_t* ids_ = nullptr;
  uint32_t node_count_ = 0;
};

/// One build: near the root level by level, each step parallel over the axes of all nodes of the
/// level; then the subtrees below, each by one thread.
class Build {
 public:
  Build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
        const Parallel& parallel)
      : primitives_(std::move(primitives)),
        config_(config),
        memory_(memory),
        parallel_(parallel),
        count_(static_cast<uint32_t>(primitives_.size())),
        subtree_size_(config.subtree_size_of(count_)),
        is_right_(memory, count_),
        nodes_(memory, parallel),
        subtrees_(memory) {}

  BinaryBvh run() {
    for (int axis = 0; axis < 3; ++axis) sort_along(axis);
    for (Array<uint32_t>& scratch : scratch_) scratch = Array<uint32_t>(memory_, count_);
    VectorBounds bounds = VectorBounds::empty();
    for (const uint32_t i : order_[0]) bounds.extend(VectorBounds::of(primitives_[i]));
    GrowingArray<OpenNode> level(memory_);
    add_open_node({bounds, 0, count_, 1, nodes_.add_top()}, level);
    while (!level.empty()) level = split_level(level);
    build_subtrees();
    primitives_ = Array<BuildPrimitive>();
    return {nodes_.join([this](size_t i) { return subtrees_[i].begin; }), std::move(scratch_[1])};
  }

 private:
  /// Rising as the floats do, where -0 equals 0.
  static uint32_t sort_key(float value) {
    const uint32_t bits = std::bit_cast<uint32_t>(value + 0.0f);
    return (bits >> 31) != 0 ? ~bits : bits | 0x80000000u;
  }

  void sort_along(int axis) {
    Array<uint64_t> keys(memory_, count_);
    parallel_.for_blocks(count_, kBlockSize, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        keys[i] = uint64_t{sort_key(primitives_[i].doubled_centroid()[axis])} << 32 | i;
      }
    });
    radix_sort(
        keys, 32, [](uint64_t key) { return key >> 32; }, memory_, parallel_);
    order_[axis] = Array<uint32_t>(memory_, count_);
    parallel_.for_blocks(count_, kBlockSize, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) order_[axis][i] = static_cast<uint32_t>(keys[i]);
    });
  }

  /// Files a node: as a subtree, or to be split next.
  void add_open_node(const OpenNode& open, GrowingArray<OpenNode>& level) {
    (open.count() <= subtree_size_ ? subtrees_ : level).push_back(open);
  }

  GrowingArray<OpenNode> split_level(const GrowingArray<OpenNode>& level) {
    uint32_t* const order[3] = {order_[0].data(), order_[1].data(), order_[2].data()};
    uint32_t* const scratch[3] = {scratch_[0].data(), scratch_[1].data(), scratch_[2].data()};
    const SweepOrders orders(primitives_.data(), order, scratch, is_right_.data(), config_);
    const size_t count = level.size();
    Array<BestPosition> best(memory_, 3 * count);
    parallel_.for_each(3 * count, [&](size_t i) {
      best[i] = orders.sweep(level[i / 3], static_cast<int>(i % 3));
    });
    Array<SweepSplit> splits(memory_, count);
    parallel_.for_each(count, [&](size_t i) {
      if (!orders.decide_alone(level[i], splits[i])) {
        splits[i] = orders.decide(level[i], &best[3 * i]);
      }
      orders.mark(level[i], splits[i]);
    });
    parallel_.for_each(3 * count, [&](size_t i) {
      orders.partition(level[i / 3], splits[i / 3], static_cast<int>(i % 3));
    });
    GrowingArray<OpenNode> next(memory_);
    for (size_t i = 0; i < count; ++i) add_children(level[i], splits[i], next);
    return next;
  }

  void add_children(const OpenNode& open, const SweepSplit& split, GrowingArray<OpenNode>& next) {
    const uint32_t first = nodes_.add_top(), second = nodes_.add_top();
    nodes_.top(open.node) = {open.bounds.bounds(), first, 0};
    const uint32_t middle = open.begin + split.left_count;
    add_open_node({split.child[0], open.begin, middle, open.depth + 1, first}, next);
    add_open_node({split.child[1], middle, open.end, open.depth + 1, second}, next);
  }

  void build_subtrees() {
    nodes_.set_subtree_count(subtrees_.size());
    parallel_.for_each(subtrees_.size(), [&](size_t i) {
      const OpenNode& open = subtrees_[i];
      const uint32_t* const order[3] = {order_[0].data() + open.begin,
                                        order_[1].data() + open.begin,
                                        order_[2].data() + open.begin};
      SubtreeBuilder builder(config_, open.count(), memory_);
      builder.build(open, primitives_.data(), order, scratch_[0].data(), nodes_.top(open.node),
                    scratch_[1].data() + open.begin);
      nodes_.keep(i, open.node, builder.nodes(), builder.node_count());
    });
    for (Array<uint32_t>& order : order_) order = Array<uint32_t>();
    scratch_[0] = Array<uint32_t>();
    scratch_[2] = Array<uint32_t>();
  }

  static constexpr size_t kBlockSize = 32768;

  Array<BuildPrimitive> primitives_;
  const Config& config_;
  Memory& memory_;
  const Parallel& parallel_;
  uint32_t count_;
  uint32_t subtree_size_;
  Array<uint32_t> order_[3];
  Array<uint32_t> scratch_[3];  ///< in the end the second one holds the ids
  Array<uint8_t> is_right_;
  JoinedNodes nodes_;
  GrowingArray<OpenNode> subtrees_;
};

}  // namespace

BinaryBvh SweepSahBuilder::build(Array<BuildPrimitive> primitives, const Config& config,
                                 Memory& memory, const Parallel& parallel) {
  if (primitives.empty()) return {Array<BinaryNode>(memory, 0), Array<uint32_t>(memory, 0)};
  return Build(std::move(primitives), config, memory, parallel).run();
}

}  // namespace kiwami

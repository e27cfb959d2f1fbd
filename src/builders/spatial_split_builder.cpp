// SPDX-License-Identifier: Apache-2.0
#include "builders/spatial_split_builder.h"

#include <algorithm>
#include <cstring>

#include "builders/joined_nodes.h"
#include "builders/spatial_bins.h"

namespace kiwami {
namespace {

using Config = SpatialSplitBuilder::Config;

/// A node whose references are known and whose split is not. They stand at begin; behind them there
/// is room for those that splits may add.
struct OpenNode {
  RangeBounds bounds;
  size_t begin;
  uint32_t count;
  uint32_t spare;
  uint32_t depth;  ///< nodes on the path from the root, this one included
  uint32_t node;

  uint32_t capacity() const { return count + spare; }
};

/// Where a reference goes, kept in BuildPrimitive::reserved while its node is divided.
enum Side : uint32_t { kLeft, kRight, kBoth };

/// Decides where the references that a plane cuts go, one after the other: into both sides, or
/// whole into the one where that is cheaper.
class Unsplitting {
 public:
  explicit Unsplitting(const SpatialPlane& plane)
      : box_{plane.box[0], plane.box[1]},
        area_{box_[0].half_area(), box_[1].half_area()},
        count_{static_cast<double>(plane.count[0]), static_cast<double>(plane.count[1])} {}

  Side choose(const Bounds& reference) {
    const Bounds whole[2] = {union_of(box_[0], reference), union_of(box_[1], reference)};
    const double area[2] = {whole[0].half_area(), whole[1].half_area()};
    const double both = area_[0] * count_[0] + area_[1] * count_[1];
    const double left = area[0] * count_[0] + area_[1] * (count_[1] - 1.0);
    const double right = area_[0] * (count_[0] - 1.0) + area[1] * count_[1];
    if (both <= left && both <= right) return kBoth;
    const int side = left <= right ? 0 : 1;
    box_[side] = whole[side];
    area_[side] = area[side];
    count_[1 - side] -= 1.0;
    return side == 0 ? kLeft : kRight;
  }

 private:
  static Bounds union_of(Bounds a, const Bounds& b) {
    a.extend(b);
    return a;
  }

  Bounds box_[2];
  double area_[2];
  double count_[2];
};

/// Divides nodes, each within its own range of the references.
class Splitter {
 public:
  Splitter(BuildPrimitive* references, const TriangleSource& source, const Config& config,
           double root_area)
      : references_(references),
        source_(source),
        config_(config),
        least_overlap_(config.split_alpha * root_area) {}

  /// false: the node is a leaf. Otherwise child holds what becomes of it.
  bool split(const OpenNode& open, OpenNode child[2]) {
    const SplitDecision decision = decide(open);
    if (decision.kind == SplitDecision::kLeaf) return false;
    if (space_.cost < std::numeric_limits<double>::infinity() && split_space(open, child)) {
      return true;
    }
    split_objects(open, decision, child);
    return true;
  }

 private:
  /// Sets space_ to a plane that is cheaper than any split of objects, if there is one.
  SplitDecision decide(const OpenNode& open) {
    space_ = SpatialPlane();
    SplitDecision decision;
    if (decide_without_bins(open.count, open.depth, config_, decision)) return decision;
    mapping_ = BinMapping(open.bounds.centroids, bins_of(open.count, config_.bin_count));
    bins_.clear(mapping_.bin_count);
    const BuildPrimitive* references = references_ + open.begin;
    for (uint32_t i = 0; i < open.count; ++i) bins_.add(references[i], mapping_);
    const double area = open.bounds.geometry.half_area();
    BestPlane best;
    for (int axis = 0; axis < 3; ++axis) {
      if (mapping_.is_flat(axis)) continue;
      kiwami::find_best_plane(bins_, mapping_.bin_count, axis, open.count, config_.block_size,
                              area > 0.0, best);
    }
    if (area > 0.0 && can_split_space(open) && overlap_of(best) > least_overlap_) {
      space_.cost = best.cost;
      find_spatial_plane(open);
      if (space_.cost == best.cost) space_ = SpatialPlane();
    }
    return choose(open, area, best);
  }

  SplitDecision choose(const OpenNode& open, double area, const BestPlane& best) const {
    const double cost =
        config_.node_cost * area + config_.leaf_cost * std::min(best.cost, space_.cost);
    const double leaf_cost = config_.leaf_cost * area * blocks_of(open.count, config_.block_size);
    if (open.count <= config_.max_leaf_size && !(area > 0.0 && cost < leaf_cost)) {
      return {SplitDecision::kLeaf, 0, 0, 0};
    }
    if (best.left_count == 0) return split_by_index(open.count, config_.block_size);
    return {SplitDecision::kPlane, best.axis, best.last_left_bin, best.left_count};
  }

  /// What fits into one block would only need a second one for its parts.
  bool can_split_space(const OpenNode& open) const {
    return open.spare != 0 && open.count > config_.block_size;
  }

  uint32_t bins_of(uint32_t count, uint32_t most) const {
    return std::min(std::clamp(most, 2u, SahBins::kMaxBins), 4 + count / 4);
  }

  /// The area that the boxes of an object split have in common; infinite where there is no split.
  double overlap_of(const BestPlane& best) const {
    if (best.left_count == 0) return std::numeric_limits<double>::infinity();
    VectorBounds side[2] = {VectorBounds::empty(), VectorBounds::empty()};
    for (uint32_t bin = 0; bin < mapping_.bin_count; ++bin) {
      if (bins_.count[bin][best.axis] == 0) continue;
      side[bin > best.last_left_bin].extend(bins_.box[bin][best.axis]);
    }
    return intersection_of(side[0].bounds(), side[1].bounds()).half_area();
  }

  void find_spatial_plane(const OpenNode& open) {
    const Bounds box = open.bounds.geometry.bounds();
    // More than of centroids: a plane that just misses where triangles end cuts all of them.
    const uint32_t bin_count = bins_of(open.count, 2 * config_.bin_count);
    const BuildPrimitive* references = references_ + open.begin;
    const auto corners_of = [this](uint32_t id, Vec3f corner[3]) {
      source_.corners_of(id, corner);
    };
    for (int axis = 0; axis < 3; ++axis) {
      BinPlanes planes;
      if (!planes.place(box, axis, bin_count)) continue;
      SpatialBins bins(planes, axis, bin_count);
      for (uint32_t i = 0; i < open.count; ++i) bins.add(references[i], corners_of);
      bins.find_best_plane(open.count, open.spare, config_.block_size, space_);
    }
  }

  /// Divides the references at the plane space_. false, and nothing is changed: one side would have
  /// none or all of them.
  bool split_space(const OpenNode& open, OpenNode child[2]) {
    uint32_t count[3] = {0, 0, 0};  // by Side
    BuildPrimitive* references = references_ + open.begin;
    Unsplitting unsplitting(space_);
    for (uint32_t i = 0; i < open.count; ++i) {
      references[i].reserved = side_of(references[i], unsplitting);
      ++count[references[i].reserved];
    }
    const uint32_t left = count[kLeft] + count[kBoth], right = count[kRight] + count[kBoth];
    if (std::max(left, right) == open.count || std::min(left, right) == 0) return false;
    partition_space(open, child);
    open_children(open, left, right, child);
    return true;
  }

  Side side_of(const BuildPrimitive& reference, Unsplitting& unsplitting) const {
    if (!reaches_right(reference, space_.axis, space_.position)) return kLeft;
    if (!reaches_left(reference, space_.axis, space_.position)) return kRight;
    Bounds part[2];
    cut(reference, part);
    if (part[1].is_empty()) return kLeft;
    if (part[0].is_empty()) return kRight;
    return unsplitting.choose(reference.bounds());
  }

  void cut(const BuildPrimitive& reference, Bounds part[2]) const {
    Vec3f corner[3];
    source_.corners_of(reference.id, corner);
    split_triangle(corner, reference.bounds(), space_.axis, space_.position, part);
  }

  /// Sorts the references by their marks, in place, and adds the right parts of those that go to
  /// both sides at the end. The right child's references follow those of the left one.
  void partition_space(const OpenNode& open, OpenNode child[2]) {
    BuildPrimitive* references = references_ + open.begin;
    child[0].bounds = child[1].bounds = RangeBounds::empty();
    uint32_t left_end = 0, right_begin = open.count, end = open.count;
    while (left_end < right_begin) {
      BuildPrimitive& reference = references[left_end];
      if (reference.reserved == kRight) {
        child[1].bounds.extend(reference);
        std::swap(reference, references[--right_begin]);
        continue;
      }
      if (reference.reserved == kBoth) {
        Bounds part[2];
        cut(reference, part);
        reference = {part[0].lower, reference.id, part[0].upper, 0};
        references[end] = {part[1].lower, reference.id, part[1].upper, 0};
        child[1].bounds.extend(references[end++]);
      }
      child[0].bounds.extend(reference);
      ++left_end;
    }
  }

  void split_objects(const OpenNode& open, const SplitDecision& decision, OpenNode child[2]) {
    BuildPrimitive* references = references_ + open.begin;
    child[0].bounds = child[1].bounds = RangeBounds::empty();
    if (decision.kind == SplitDecision::kIndex) {
      for (uint32_t i = 0; i < open.count; ++i) {
        child[i >= decision.left_count].bounds.extend(references[i]);
      }
    } else {
      const SplitPlane plane(mapping_, decision.axis, decision.last_left_bin);
      uint32_t left_end = 0, right_begin = open.count;
      while (left_end < right_begin) {
        BuildPrimitive& reference = references[left_end];
        const bool is_right = plane.is_right(reference);
        child[is_right].bounds.extend(reference);
        if (is_right) {
          std::swap(reference, references[--right_begin]);
        } else {
          ++left_end;
        }
      }
    }
    open_children(open, decision.left_count, open.count - decision.left_count, child);
  }

  /// Gives each child its share of the room that is left, by the expected cost of its references,
  /// and moves the right one's references behind the left one's room.
  void open_children(const OpenNode& open, uint32_t left, uint32_t right, OpenNode child[2]) {
    const uint32_t spare = open.capacity() - left - right;
    const double left_cost = child[0].bounds.geometry.half_area() * static_cast<double>(left);
    const double right_cost = child[1].bounds.geometry.half_area() * static_cast<double>(right);
    const double cost = left_cost + right_cost;
    const uint32_t left_spare =
        cost > 0.0 ? std::min(spare, static_cast<uint32_t>(spare * (left_cost / cost))) : 0;
    child[0].begin = open.begin;
    child[0].count = left;
    child[0].spare = left_spare;
    child[1].begin = open.begin + left + left_spare;
    child[1].count = right;
    child[1].spare = spare - left_spare;
    child[0].depth = child[1].depth = open.depth + 1;
    if (left_spare == 0) return;
    BuildPrimitive* from = references_ + open.begin + left;
    std::memmove(static_cast<void*>(from + left_spare), from, right * sizeof(BuildPrimitive));
  }

  BuildPrimitive* references_;
  const TriangleSource& source_;
  const Config& config_;
  double least_overlap_;
  BinMapping mapping_;
  SahBins bins_;
  SpatialPlane space_;
};

/// One thread's part: the whole tree below one node, in nodes numbered from 0. The ids of leaves
/// are written where the references of leaves before them stood.
class SubtreeBuilder {
 public:
  SubtreeBuilder(BuildPrimitive* references, const TriangleSource& source, const Config& config,
                 double root_area, const OpenNode& open, Memory& memory)
      : references_(references),
        ids_(reinterpret_cast<unsigned char*>(references + open.begin)),
        splitter_(references, source, config, root_area),
        // A tree of n references has at most 2n - 2 nodes below its root.
        nodes_(memory, size_t{2} * open.capacity()) {}

  void build(const OpenNode& open, BinaryNode& top) { grow(open, top); }

  const BinaryNode* nodes() const { return nodes_.data(); }
  uint32_t node_count() const { return node_count_; }
  uint32_t id_count() const { return id_count_; }

 private:
  void grow(const OpenNode& open, BinaryNode& node) {
    OpenNode child[2];
    if (!splitter_.split(open, child)) {
      node = {open.bounds.geometry.bounds(), id_count_, open.count};
      for (uint32_t i = 0; i < open.count; ++i) write_id(references_[open.begin + i].id);
      return;
    }
    const uint32_t first = node_count_;
    node_count_ += 2;
    grow(child[0], nodes_[first]);
    grow(child[1], nodes_[first + 1]);
    // The parts of a reference that was cut fill less than its box.
    node = {nodes_[first].bounds, first, 0};
    node.bounds.extend(nodes_[first + 1].bounds);
  }

  /// Behind the ids there are only references of leaves to come: an id takes an eighth of one.
  void write_id(uint32_t id) { std::memcpy(ids_ + id_count_++ * sizeof id, &id, sizeof id); }

  BuildPrimitive* references_;
  unsigned char* ids_;
  Splitter splitter_;
  Array<BinaryNode> nodes_;
  uint32_t node_count_ = 0;
  uint32_t id_count_ = 0;
};

/// One build: near the root level by level, parallel over the nodes of the level; then the subtrees
/// below, each by one thread.
class Build {
 public:
  Build(Array<BuildPrimitive> primitives, const TriangleSource& source, const Config& config,
        Memory& memory, const Parallel& parallel)
      : source_(source),
        config_(config),
        memory_(memory),
        parallel_(parallel),
        count_(static_cast<uint32_t>(primitives.size())),
        subtree_size_(config.subtree_size_of(count_)),
        budget_(budget_of(count_, config)),
        references_(std::move(primitives)),
        nodes_(memory, parallel),
        top_(memory),
        subtrees_(memory) {
    reserve_budget();
  }

  BinaryBvh run() {
    RangeBounds bounds = RangeBounds::empty();
    for (uint32_t i = 0; i < count_; ++i) bounds.extend(references_[i]);
    root_area_ = bounds.geometry.half_area();
    GrowingArray<OpenNode> level(memory_);
    add_open_node({bounds, 0, count_, budget_, 1, nodes_.add_top()}, level);
    while (!level.empty()) level = split_level(level);
    const uint32_t id_count = build_subtrees();
    Array<uint32_t> ids = collect_ids(id_count);
    references_ = Array<BuildPrimitive>();
    BinaryBvh bvh{nodes_.join([this](size_t i) { return first_id_[i]; }), std::move(ids),
                  id_count != count_};
    return bvh;
  }

 private:
  /// References beyond one a triangle; ids of leaves are numbered with 32 bits.
  static uint32_t budget_of(uint32_t count, const Config& config) {
    const double most = static_cast<double>(kMaxReferenceCount - count);
    return static_cast<uint32_t>(std::min(config.split_budget * count, most));
  }

  void reserve_budget() {
    if (budget_ == 0) return;
    Array<BuildPrimitive> roomy(memory_, size_t{count_} + budget_);
    std::memcpy(static_cast<void*>(roomy.data()), references_.data(), references_.bytes());
    references_ = std::move(roomy);
  }

  void add_open_node(const OpenNode& open, GrowingArray<OpenNode>& level) {
    (open.count <= subtree_size_ ? subtrees_ : level).push_back(open);
  }

  GrowingArray<OpenNode> split_level(const GrowingArray<OpenNode>& level) {
    Array<OpenNode> children(memory_, 2 * level.size());
    parallel_.for_each(level.size(), [&](size_t i) {
      // Always: it has more references than a leaf may own.
      Splitter(references_.data(), source_, config_, root_area_).split(level[i], &children[2 * i]);
    });
    GrowingArray<OpenNode> next(memory_);
    for (size_t i = 0; i < level.size(); ++i) {
      const uint32_t first = nodes_.add_top(), second = nodes_.add_top();
      nodes_.top(level[i].node) = {Bounds::empty(), first, 0};
      top_.push_back(level[i].node);
      children[2 * i].node = first;
      children[2 * i + 1].node = second;
      add_open_node(children[2 * i], next);
      add_open_node(children[2 * i + 1], next);
    }
    return next;
  }

  /// Returns the number of ids of all leaves.
  uint32_t build_subtrees() {
    nodes_.set_subtree_count(subtrees_.size());
    first_id_ = Array<uint32_t>(memory_, subtrees_.size());
    parallel_.for_each(subtrees_.size(), [&](size_t i) {
      const OpenNode& open = subtrees_[i];
      SubtreeBuilder builder(references_.data(), source_, config_, root_area_, open, memory_);
      builder.build(open, nodes_.top(open.node));
      nodes_.keep(i, open.node, builder.nodes(), builder.node_count());
      first_id_[i] = builder.id_count();
    });
    for (size_t i = top_.size(); i-- > 0;) {
      BinaryNode& node = nodes_.top(top_[i]);
      node.bounds = nodes_.top(node.first).bounds;
      node.bounds.extend(nodes_.top(node.first + 1).bounds);
    }
    uint32_t next = 0;
    for (uint32_t& first : first_id_) {
      const uint32_t count = first;
      first = next;
      next += count;
    }
    return next;
  }

  Array<uint32_t> collect_ids(uint32_t id_count) const {
    Array<uint32_t> ids(memory_, id_count);
    parallel_.for_each(subtrees_.size(), [&](size_t i) {
      const uint32_t end = i + 1 < subtrees_.size() ? first_id_[i + 1] : id_count;
      std::memcpy(ids.data() + first_id_[i], references_.data() + subtrees_[i].begin,
                  (end - first_id_[i]) * sizeof(uint32_t));
    });
    return ids;
  }

  static constexpr uint32_t kMaxReferenceCount = 0xFFFFFFFEu;

  const TriangleSource& source_;
  const Config& config_;
  Memory& memory_;
  const Parallel& parallel_;
  uint32_t count_;
  uint32_t subtree_size_;
  uint32_t budget_;
  Array<BuildPrimitive> references_;
  double root_area_ = 0.0;
  JoinedNodes nodes_;
  GrowingArray<uint32_t> top_;  ///< the inner nodes near the root, parents first
  GrowingArray<OpenNode> subtrees_;
  Array<uint32_t> first_id_;  ///< by subtree
};

}  // namespace

BinaryBvh SpatialSplitBuilder::build(Array<BuildPrimitive> primitives, const TriangleSource& source,
                                     const Config& config, Memory& memory,
                                     const Parallel& parallel) {
  if (primitives.empty()) return {Array<BinaryNode>(memory, 0), Array<uint32_t>(memory, 0)};
  return Build(std::move(primitives), source, config, memory, parallel).run();
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "measure/baselines/structure.h"

namespace kiwami::tools {
namespace {

constexpr uint32_t kMaxLeafSize = 4;
// Halvings of the grid box that put everything on one side, one after the other, before the
// triangles are halved by their order instead.
constexpr uint32_t kMaxIdleHalvings = 96;
// Below this depth they are halved by their order, so that the stack below suffices.
constexpr uint32_t kMaxSpatialDepth = 160;
constexpr uint32_t kStackSize = kMaxSpatialDepth + 32;
constexpr uint32_t kLeaf = 3;

/// 16 bytes; the two children of an inner node stand side by side.
struct Node {
  float clips[2];       ///< where the left child ends, and where the right one begins
  uint32_t first;       ///< the left child, or the first triangle
  uint32_t axis : 2;    ///< kLeaf: a leaf
  uint32_t count : 30;  ///< triangles of a leaf
};

/// Each node has two planes alone: the end of the left set and the beginning of the right one along
/// an axis (C. Waechter, A. Keller, "Instant Ray Tracing: The Bounding Interval Hierarchy",
/// Eurographics Symposium on Rendering, 2006). Sets are divided at the middle of a regular grid's
/// box, the triangles in place, as in quicksort. Nodes for empty space alone are left out.
class BoundingIntervalHierarchy final : public StructureOf<BoundingIntervalHierarchy> {
 public:
  explicit BoundingIntervalHierarchy(std::span<const Corners> triangles) {
    if (triangles.empty()) return;
    box_ = empty_box();
    for (const Corners& corners : triangles) {
      boxes_.push_back(box_of(corners));
      grow(box_, boxes_.back());
    }
    order_.resize(triangles.size());
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.resize(1);
    build(0, 0, static_cast<uint32_t>(order_.size()), box_, 0);
    triangles_ = prepare_triangles(triangles, order_);
    boxes_ = {};
    order_ = {};
  }

  uint64_t bytes() const override {
    return nodes_.size() * sizeof(Node) + triangles_.size() * sizeof(PreparedTriangle);
  }

  template <bool kAnyHit, typename Probe>
  void trace(const kiwami_ray& given, BaselineHit& hit, Probe& probe) const {
    if (nodes_.empty()) return;
    const PreparedRay ray(given);
    Interval interval{0, ray.tmin, hit.t};
    if (!clip_to_box(ray, interval)) return;
    Interval stack[kStackSize];
    uint32_t waiting = 0;
    for (;;) {
      const Node& node = nodes_[interval.node];
      if (node.axis == kLeaf) {
        if (trace_leaf<kAnyHit>(node, ray, hit, probe)) return;
      } else {
        probe.on_step();
        const auto [near, far] = divide(node, ray, interval);
        const bool meets_near = near.entry <= near.exit;
        const bool meets_far = far.entry <= far.exit;
        if (meets_near && meets_far) stack[waiting++] = far;
        if (meets_near || meets_far) {
          interval = meets_near ? near : far;
          continue;
        }
      }
      do {
        if (waiting == 0) return;
        interval = stack[--waiting];
      } while (interval.entry > hit.t);
      interval.exit = std::min(interval.exit, hit.t);
    }
  }

 private:
  /// A part of the ray, in a node.
  struct Interval {
    uint32_t node;
    float entry;
    float exit;
  };
  struct Halves {
    Interval near;
    Interval far;
  };

  void build(uint32_t number, uint32_t first, uint32_t count, Box grid, uint32_t depth) {
    nodes_[number] = {{0.0f, 0.0f}, first, kLeaf, count};
    if (count <= kMaxLeafSize) return;
    int axis = 0;
    const uint32_t middle = halve(first, count, grid, axis, depth);
    float left_end = -std::numeric_limits<float>::infinity();
    float right_begin = std::numeric_limits<float>::infinity();
    for (uint32_t i = first; i < first + count; ++i) {
      const Box& box = boxes_[order_[i]];
      if (i < middle) {
        left_end = std::max(left_end, box.high[axis]);
      } else {
        right_begin = std::min(right_begin, box.low[axis]);
      }
    }
    const auto child = static_cast<uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[number] = {{left_end, right_begin}, child, static_cast<uint32_t>(axis) & 3u, 0};
    Box left = grid;
    Box right = grid;
    cut(left, axis, false);
    cut(right, axis, true);
    build(child, first, middle - first, left, depth + 1);
    build(child + 1, middle, first + count - middle, right, depth + 1);
  }

  /// Partitions a range at the middle of the grid's box along its longest axis, which shrinks to
  /// one half for as long as nothing lies in the other. Returns the first place of the right side.
  uint32_t halve(uint32_t first, uint32_t count, Box& grid, int& axis, uint32_t depth) {
    const auto begin = order_.begin() + first;
    for (uint32_t i = 0; i < kMaxIdleHalvings && depth < kMaxSpatialDepth; ++i) {
      const Vec3 extent = grid.extent();
      axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
      const float plane = grid.center()[axis];
      const auto middle = std::partition(begin, begin + count, [&](uint32_t triangle) {
        return boxes_[triangle].center()[axis] < plane;
      });
      const auto left_count = static_cast<uint32_t>(middle - begin);
      if (left_count > 0 && left_count < count) return first + left_count;
      cut(grid, axis, left_count == 0);
    }
    return first + count / 2;
  }

  /// Leaves one half of a box.
  static void cut(Box& box, int axis, bool upper) {
    const float plane = box.center()[axis];
    Vec3& side = upper ? box.low : box.high;
    (axis == 0 ? side.x : axis == 1 ? side.y : side.z) = plane;
  }

  /// Where a plane is met, and what rounding may add.
  static float before(float distance) { return distance - std::abs(distance) * 0x1p-20f; }
  static float after(float distance) { return distance + std::abs(distance) * 0x1p-20f; }

  bool clip_to_box(const PreparedRay& ray, Interval& interval) const {
    for (int axis = 0; axis < 3; ++axis) {
      const float near = ray.backwards[axis] ? box_.high[axis] : box_.low[axis];
      const float far = ray.backwards[axis] ? box_.low[axis] : box_.high[axis];
      interval.entry =
          std::max(interval.entry, before((near - ray.origin[axis]) * ray.inverse[axis]));
      interval.exit = std::min(interval.exit, after((far - ray.origin[axis]) * ray.inverse[axis]));
    }
    return interval.entry <= interval.exit;
  }

  static Halves divide(const Node& node, const PreparedRay& ray, const Interval& interval) {
    const auto axis = static_cast<int>(node.axis);
    const uint32_t near = ray.backwards[axis] ? 1 : 0;
    const float near_end = (node.clips[near] - ray.origin[axis]) * ray.inverse[axis];
    const float far_begin = (node.clips[1 - near] - ray.origin[axis]) * ray.inverse[axis];
    return {{node.first + near, interval.entry, std::min(interval.exit, after(near_end))},
            {node.first + 1 - near, std::max(interval.entry, before(far_begin)), interval.exit}};
  }

  /// Whether the ray needs no more.
  template <bool kAnyHit, typename Probe>
  bool trace_leaf(const Node& leaf, const PreparedRay& ray, BaselineHit& hit, Probe& probe) const {
    for (uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      probe.on_triangle();
      const bool met = triangles_[i].intersect(ray.origin, ray.direction, ray.tmin, hit);
      if (kAnyHit && met) return true;
    }
    return false;
  }

  Box box_{};
  std::vector<Box> boxes_;       ///< of the triangles, while the tree is built
  std::vector<uint32_t> order_;  ///< of the triangles, while the tree is built
  std::vector<Node> nodes_;
  std::vector<PreparedTriangle> triangles_;
};

}  // namespace

std::unique_ptr<Structure> build_bounding_interval_hierarchy(std::span<const Corners> triangles) {
  return std::make_unique<BoundingIntervalHierarchy>(triangles);
}

}  // namespace kiwami::tools

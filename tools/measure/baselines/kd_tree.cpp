// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "measure/baselines/structure.h"

namespace kiwami::tools {
namespace {

constexpr uint32_t kBins = 32;
constexpr float kNodeCost = 1.0f;
constexpr float kTriangleCost = 1.5f;
// A split that cuts off empty space costs this share.
constexpr float kEmptyBonus = 0.8f;
constexpr uint32_t kStackSize = 64;  // above the greatest depth, 8 + 1.3 * 32
constexpr uint32_t kLeaf = 3;
// Boxes of clipped triangles are widened by this share of their coordinates, for rounding.
constexpr float kRounding = 1e-6f;

/// 8 bytes; the two children of an inner node stand side by side.
struct Node {
  uint32_t plane_or_count;  ///< the bits of the plane's place, or the triangles of a leaf
  uint32_t axis : 2;        ///< kLeaf: a leaf
  uint32_t first : 30;      ///< the left child, or the first entry

  float plane() const { return std::bit_cast<float>(plane_or_count); }
};

/// A triangle and the box of what of it lies in a node.
struct Reference {
  uint32_t triangle;
  Box box;
};

float& component(Vec3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// A convex polygon, of at most three corners and one more for each clipping plane.
struct Polygon {
  std::array<Vec3, 9> corners;
  uint32_t count = 0;

  /// Keeps what lies beyond a plane across an axis, or before it (I. E. Sutherland, G. W. Hodgman,
  /// "Reentrant Polygon Clipping", Communications of the ACM, 1974).
  void clip(int axis, float plane, bool keeps_upper) {
    Polygon kept;
    for (uint32_t i = 0; i < count; ++i) {
      const Vec3 a = corners[i];
      const Vec3 b = corners[(i + 1) % count];
      const bool has_a = keeps_upper ? a[axis] >= plane : a[axis] <= plane;
      const bool has_b = keeps_upper ? b[axis] >= plane : b[axis] <= plane;
      if (has_a) kept.add(a);
      if (has_a == has_b) continue;
      const float t = (plane - a[axis]) / (b[axis] - a[axis]);
      Vec3 crossing = a * (1.0f - t) + b * t;
      component(crossing, axis) = plane;
      kept.add(crossing);
    }
    *this = kept;
  }

  void add(Vec3 corner) {
    if (count < corners.size()) corners[count++] = corner;
  }
};

Box widened(const Box& box) {
  Box wide = box;
  for (int axis = 0; axis < 3; ++axis) {
    component(wide.low, axis) -= std::abs(box.low[axis]) * kRounding;
    component(wide.high, axis) += std::abs(box.high[axis]) * kRounding;
  }
  return wide;
}

/// The box around the part of a triangle that lies in `cell`, within `cell`; empty if there is
/// none.
Box clipped_box(const Corners& corners, const Box& cell) {
  Polygon polygon;
  for (const Vec3 corner : corners) polygon.add(corner);
  const Box wide = widened(cell);
  for (int axis = 0; axis < 3; ++axis) {
    polygon.clip(axis, wide.low[axis], true);
    polygon.clip(axis, wide.high[axis], false);
  }
  if (polygon.count == 0) return empty_box();
  Box box = empty_box();
  for (uint32_t i = 0; i < polygon.count; ++i) grow(box, polygon.corners[i]);
  box = widened(box);
  for (int axis = 0; axis < 3; ++axis) {
    component(box.low, axis) = std::max(box.low[axis], cell.low[axis]);
    component(box.high, axis) = std::min(box.high[axis], cell.high[axis]);
  }
  return box;
}

/// A plane between two bins.
struct Split {
  float cost;
  int axis = 0;
  uint32_t bin = 0;  ///< the first one beyond the plane
};

/// Bins of equal size along an axis of a cell.
struct Binning {
  float low;
  float size;

  Binning(const Box& cell, int axis)
      : low(cell.low[axis]), size((cell.high[axis] - low) / static_cast<float>(kBins)) {}
  bool is_flat() const { return !(size > 0.0f); }
  float plane(uint32_t bin) const { return low + static_cast<float>(bin) * size; }
  uint32_t operator()(float position) const {
    return std::min(static_cast<uint32_t>(std::max((position - low) / size, 0.0f)), kBins - 1);
  }
};

/// A tree of planes by the surface area heuristic: I. Wald, V. Havran, "On building fast kd-Trees
/// for Ray Tracing, and on doing that in O(N log N)", Symposium on Interactive Ray Tracing, 2006,
/// for the cost, the bonus for empty space and the clipped triangles. It differs in that planes are
/// tried between bins (M. Shevtsov, A. Soupikov, A. Kapustin, "Highly Parallel Fast KD-tree
/// Construction for Interactive Ray Tracing of Dynamic Scenes", Eurographics, 2007).
class KdTree final : public StructureOf<KdTree> {
 public:
  explicit KdTree(std::span<const Corners> triangles) : corners_(triangles) {
    if (triangles.empty()) return;
    std::vector<Reference> references;
    std::vector<uint32_t> order;
    box_ = empty_box();
    for (uint32_t i = 0; i < triangles.size(); ++i) {
      references.push_back({i, box_of(triangles[i])});
      grow(box_, references.back().box);
      order.push_back(i);
    }
    max_depth_ = 8 + static_cast<uint32_t>(1.3f * std::log2(static_cast<float>(order.size())));
    nodes_.resize(1);
    build(0, std::move(references), box_, 0);
    triangles_ = prepare_triangles(triangles, order);
    corners_ = {};
  }

  uint64_t bytes() const override {
    return nodes_.size() * sizeof(Node) + entries_.size() * sizeof(uint32_t) +
           triangles_.size() * sizeof(PreparedTriangle);
  }

  template <bool kAnyHit, typename Probe>
  void trace(const kiwami_ray& given, BaselineHit& hit, Probe& probe) const {
    if (nodes_.empty()) return;
    const PreparedRay ray(given);
    Interval interval{0, ray.tmin, hit.t};
    if (!clip_to_box(ray, interval)) return;
    Mailbox mailbox;
    Interval stack[kStackSize];
    uint32_t waiting = 0;
    for (;;) {
      const Node& node = nodes_[interval.node];
      if (node.axis != kLeaf) {
        probe.on_step();
        descend(node, ray, interval, stack, waiting);
        continue;
      }
      if (trace_leaf<kAnyHit>(node, ray, hit, mailbox, probe)) return;
      // A hit beyond this cell may lie behind another one.
      if (hit.t <= interval.exit || waiting == 0) return;
      interval = stack[--waiting];
    }
  }

 private:
  /// A part of the ray, in a node.
  struct Interval {
    uint32_t node;
    float entry;
    float exit;
  };

  void build(uint32_t number, std::vector<Reference> references, const Box& cell, uint32_t depth) {
    const auto count = static_cast<uint32_t>(references.size());
    const Split split = find_split(references, cell);
    if (depth >= max_depth_ || !(split.cost < kTriangleCost * static_cast<float>(count))) {
      nodes_[number] = {count, kLeaf, static_cast<uint32_t>(entries_.size()) & kMaxFirst};
      for (const Reference& reference : references) entries_.push_back(reference.triangle);
      return;
    }
    const Binning bin_of(cell, split.axis);
    const float plane = bin_of.plane(split.bin);
    Box left_cell = cell;
    Box right_cell = cell;
    component(left_cell.high, split.axis) = plane;
    component(right_cell.low, split.axis) = plane;
    std::vector<Reference> left;
    std::vector<Reference> right;
    for (const Reference& reference : references) {
      const bool is_left = bin_of(reference.box.low[split.axis]) < split.bin;
      const bool is_right = bin_of(reference.box.high[split.axis]) >= split.bin;
      if (is_left) push(left, reference, left_cell, is_right);
      if (is_right) push(right, reference, right_cell, is_left);
    }
    references = {};
    const auto child = static_cast<uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[number] = {std::bit_cast<uint32_t>(plane), static_cast<uint32_t>(split.axis) & 3u,
                      child & kMaxFirst};
    build(child, std::move(left), left_cell, depth + 1);
    build(child + 1, std::move(right), right_cell, depth + 1);
  }

  void push(std::vector<Reference>& side, const Reference& reference, const Box& cell,
            bool is_divided) const {
    Reference part = reference;
    if (is_divided) part.box = clipped_box(corners_[reference.triangle], cell);
    if (part.box.low.x <= part.box.high.x) side.push_back(part);
  }

  static Split find_split(const std::vector<Reference>& references, const Box& cell) {
    Split best{std::numeric_limits<float>::infinity()};
    const float area = half_area(cell);
    if (!(area > 0.0f) || references.empty()) return best;
    for (int axis = 0; axis < 3; ++axis) {
      const Binning bin_of(cell, axis);
      if (bin_of.is_flat()) continue;
      std::array<uint32_t, kBins> begins{};
      std::array<uint32_t, kBins> ends{};
      for (const Reference& reference : references) {
        ++begins[bin_of(reference.box.low[axis])];
        ++ends[bin_of(reference.box.high[axis])];
      }
      uint32_t left = 0;
      auto right = static_cast<uint32_t>(references.size());
      for (uint32_t bin = 1; bin < kBins; ++bin) {
        left += begins[bin - 1];
        right -= ends[bin - 1];
        Box left_cell = cell;
        Box right_cell = cell;
        component(left_cell.high, axis) = bin_of.plane(bin);
        component(right_cell.low, axis) = bin_of.plane(bin);
        const float weight = half_area(left_cell) * static_cast<float>(left) +
                             half_area(right_cell) * static_cast<float>(right);
        const float bonus = left == 0 || right == 0 ? kEmptyBonus : 1.0f;
        const float cost = bonus * (kNodeCost + kTriangleCost * weight / area);
        if (cost < best.cost) best = {cost, axis, bin};
      }
    }
    return best;
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

  /// Goes to the child that the ray meets first; the other one waits, if the ray reaches it.
  static void descend(const Node& node, const PreparedRay& ray, Interval& interval, Interval* stack,
                      uint32_t& waiting) {
    const auto axis = static_cast<int>(node.axis);
    const uint32_t near = ray.backwards[axis] ? 1 : 0;
    const float distance = (node.plane() - ray.origin[axis]) * ray.inverse[axis];
    if (before(distance) > interval.exit) {
      interval.node = node.first + near;
    } else if (after(distance) < interval.entry) {
      interval.node = node.first + 1 - near;
    } else {
      stack[waiting++] = {node.first + 1 - near, std::max(interval.entry, before(distance)),
                          interval.exit};
      interval = {node.first + near, interval.entry, std::min(interval.exit, after(distance))};
    }
  }

  /// Whether the ray needs no more.
  template <bool kAnyHit, typename Probe>
  bool trace_leaf(const Node& leaf, const PreparedRay& ray, BaselineHit& hit, Mailbox& mailbox,
                  Probe& probe) const {
    for (uint32_t i = leaf.first; i < leaf.first + leaf.plane_or_count; ++i) {
      const uint32_t triangle = entries_[i];
      if (mailbox.has_seen(triangle)) continue;
      probe.on_triangle();
      const bool met = triangles_[triangle].intersect(ray.origin, ray.direction, ray.tmin, hit);
      if (kAnyHit && met) return true;
    }
    return false;
  }

  static constexpr uint32_t kMaxFirst = (1u << 30) - 1;

  std::span<const Corners> corners_;  ///< while the tree is built
  uint32_t max_depth_ = 0;
  Box box_{};
  std::vector<Node> nodes_;
  std::vector<uint32_t> entries_;  ///< triangles, leaf by leaf
  std::vector<PreparedTriangle> triangles_;
};

}  // namespace

std::unique_ptr<Structure> build_kd_tree(std::span<const Corners> triangles) {
  return std::make_unique<KdTree>(triangles);
}

}  // namespace kiwami::tools

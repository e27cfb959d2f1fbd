// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "measure/baselines/structure.h"

namespace kiwami::tools {
namespace {

constexpr uint32_t kBins = 16;
constexpr uint32_t kMaxLeafSize = 8;
// Below this depth the halves are equal, so that the stack below suffices for 2^32 triangles.
constexpr uint32_t kMaxUnbalancedDepth = 64;
constexpr uint32_t kStackSize = kMaxUnbalancedDepth + 32;

/// 32 bytes; the two children of an inner node stand side by side.
struct Node {
  float bounds[6];  ///< least and greatest x, least and greatest y, ...
  uint32_t first;   ///< the left child, or the first triangle
  uint32_t count;   ///< triangles; 0: an inner node
};

/// A split of a range of primitives.
struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = 0;
  uint32_t bin = 0;  ///< the first one of the right side
};

/// Where the centres of a range fall along an axis.
struct Binning {
  float low;
  float scale;

  Binning(const Box& centers, int axis) : low(centers.low[axis]) {
    const float extent = centers.high[axis] - low;
    scale = extent > 0.0f ? static_cast<float>(kBins) / extent : 0.0f;
  }
  uint32_t operator()(float center) const {
    return std::min(static_cast<uint32_t>((center - low) * scale), kBins - 1);
  }
};

/// Top-down by the surface area heuristic over bins (I. Wald, "On fast Construction of SAH-based
/// Bounding Volume Hierarchies", Symposium on Interactive Ray Tracing, 2007), on one thread.
class Builder {
 public:
  explicit Builder(std::span<const Corners> triangles) : order_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    boxes_.reserve(triangles.size());
    for (const Corners& corners : triangles) boxes_.push_back(box_of(corners));
    if (triangles.empty()) return;
    nodes_.resize(1);
    build(0, 0, static_cast<uint32_t>(order_.size()), 0);
  }

  std::vector<Node> nodes_;
  std::vector<uint32_t> order_;

 private:
  void build(uint32_t number, uint32_t first, uint32_t count, uint32_t depth) {
    Box box = empty_box();
    Box centers = empty_box();
    for (uint32_t i = first; i < first + count; ++i) {
      grow(box, boxes_[order_[i]]);
      grow(centers, boxes_[order_[i]].center());
    }
    nodes_[number] = {
        {box.low.x, box.high.x, box.low.y, box.high.y, box.low.z, box.high.z}, first, count};
    const Split split = find_split(centers, first, count);
    // In units of the box's area: a node costs as much as a triangle.
    const float leaf_cost = half_area(box) * static_cast<float>(count - 1);
    if (count == 1 || (count <= kMaxLeafSize && !(split.cost < leaf_cost))) return;
    const uint32_t middle = partition(split, centers, first, count, depth);
    const auto child = static_cast<uint32_t>(nodes_.size());
    nodes_.resize(nodes_.size() + 2);
    nodes_[number].first = child;
    nodes_[number].count = 0;
    build(child, first, middle - first, depth + 1);
    build(child + 1, middle, first + count - middle, depth + 1);
  }

  Split find_split(const Box& centers, uint32_t first, uint32_t count) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      const Binning bin_of(centers, axis);
      if (bin_of.scale == 0.0f) continue;
      std::array<Box, kBins> boxes;
      std::array<uint32_t, kBins> counts{};
      boxes.fill(empty_box());
      for (uint32_t i = first; i < first + count; ++i) {
        const Box& box = boxes_[order_[i]];
        const uint32_t bin = bin_of(box.center()[axis]);
        grow(boxes[bin], box);
        ++counts[bin];
      }
      sweep(boxes, counts, axis, best);
    }
    return best;
  }

  static void sweep(const std::array<Box, kBins>& boxes, const std::array<uint32_t, kBins>& counts,
                    int axis, Split& best) {
    std::array<float, kBins> right_costs{};
    Box box = empty_box();
    uint32_t count = 0;
    for (uint32_t bin = kBins - 1; bin > 0; --bin) {
      grow(box, boxes[bin]);
      count += counts[bin];
      right_costs[bin] = half_area(box) * static_cast<float>(count);
    }
    box = empty_box();
    const uint32_t total = count + counts[0];
    count = 0;
    for (uint32_t bin = 1; bin < kBins; ++bin) {
      grow(box, boxes[bin - 1]);
      count += counts[bin - 1];
      const float cost = half_area(box) * static_cast<float>(count) + right_costs[bin];
      if (count > 0 && count < total && cost < best.cost) best = {cost, axis, bin};
    }
  }

  /// The first place of the right side.
  uint32_t partition(const Split& split, const Box& centers, uint32_t first, uint32_t count,
                     uint32_t depth) {
    const auto begin = order_.begin() + first;
    if (std::isinf(split.cost) || depth >= kMaxUnbalancedDepth) {
      const int axis = split.axis;
      std::nth_element(begin, begin + count / 2, begin + count, [&](uint32_t a, uint32_t b) {
        return boxes_[a].center()[axis] < boxes_[b].center()[axis];
      });
      return first + count / 2;
    }
    const Binning bin_of(centers, split.axis);
    const auto middle = std::partition(begin, begin + count, [&](uint32_t i) {
      return bin_of(boxes_[i].center()[split.axis]) < split.bin;
    });
    return static_cast<uint32_t>(middle - order_.begin());
  }

  std::vector<Box> boxes_;
};

/// A ray and what its slab test needs. The factor covers the rounding of the far distances (T. Ize,
/// "Robust BVH Ray Traversal", Journal of Computer Graphics Techniques, 2013).
struct SlabRay : PreparedRay {
  float far_inverse[3];

  explicit SlabRay(const kiwami_ray& ray) : PreparedRay(ray) {
    for (int axis = 0; axis < 3; ++axis) far_inverse[axis] = inverse[axis] * 1.00000024f;
  }
};

/// A hierarchy of two children a node, traversed pair by pair, the nearer child first, as many a
/// renderer does it.
class BinaryBvh final : public StructureOf<BinaryBvh> {
 public:
  explicit BinaryBvh(std::span<const Corners> triangles) {
    Builder builder(triangles);
    nodes_ = std::move(builder.nodes_);
    triangles_ = prepare_triangles(triangles, builder.order_);
  }

  uint64_t bytes() const override {
    return nodes_.size() * sizeof(Node) + triangles_.size() * sizeof(PreparedTriangle);
  }

  template <bool kAnyHit, typename Probe>
  void trace(const kiwami_ray& given, BaselineHit& hit, Probe& probe) const {
    if (nodes_.empty()) return;
    const SlabRay ray(given);
    uint32_t stack[kStackSize];
    uint32_t waiting = 0;
    const Node* node = nodes_.data();
    for (;;) {
      if (node->count > 0) {
        if (trace_leaf<kAnyHit>(*node, ray, hit, probe)) return;
      } else {
        probe.on_step();
        const Node* near = &nodes_[node->first];
        const Node* far = near + 1;
        const auto [near_entry, meets_near] = enter(*near, ray, hit.t);
        const auto [far_entry, meets_far] = enter(*far, ray, hit.t);
        if (meets_near && meets_far) {
          if (far_entry < near_entry) std::swap(near, far);
          stack[waiting++] = static_cast<uint32_t>(far - nodes_.data());
        }
        if (meets_near || meets_far) {
          node = meets_near ? near : far;
          continue;
        }
      }
      if (waiting == 0) return;
      node = &nodes_[stack[--waiting]];
    }
  }

 private:
  struct Entry {
    float distance;
    bool meets;
  };

  static Entry enter(const Node& node, const SlabRay& ray, float tmax) {
    float entry = ray.tmin;
    float exit = tmax;
    for (int axis = 0; axis < 3; ++axis) {
      const int near = axis * 2 + (ray.backwards[axis] ? 1 : 0);
      const float near_plane = node.bounds[near];
      const float far_plane = node.bounds[near ^ 1];
      const float origin = ray.origin[axis];
      entry = std::max(entry, (near_plane - origin) * ray.inverse[axis]);
      exit = std::min(exit, (far_plane - origin) * ray.far_inverse[axis]);
    }
    return {entry, entry <= exit};
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

  std::vector<Node> nodes_;
  std::vector<PreparedTriangle> triangles_;
};

}  // namespace

std::unique_ptr<Structure> build_binary_bvh(std::span<const Corners> triangles) {
  return std::make_unique<BinaryBvh>(triangles);
}

}  // namespace kiwami::tools

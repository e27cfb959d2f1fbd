// SPDX-License-Identifier: Apache-2.0
#include "wide/visit_weights.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace kiwami {
namespace {

/// Rays that one task traces.
constexpr size_t kRayBlock = 64;

/// Traces rays through a binary tree and counts the nodes that each visits.
class VisitCounter {
 public:
  VisitCounter(const BinaryBvh& bvh, const TriangleSource& source, Memory& memory)
      : bvh_(bvh), source_(source), counts_(memory, bvh.nodes.size()) {
    counts_.fill_zero();
  }

  /// Not before its hit is known: what a ray visits must not depend on the order of the search.
  void trace(const RepresentativeRay& given) {
    const StatisticalRay ray(given, {0.0f, 0.0f, 0.0f});
    count(ray, find_closest(ray));
  }

  uint32_t operator[](uint32_t node) const { return counts_[node]; }

 private:
  struct Open {
    double entry;
    uint32_t node;
  };

  /// The distance of the closest hit, or tmax.
  double find_closest(const StatisticalRay& ray) const {
    double closest = ray.tmax();
    Open stack[BinaryBvh::kMaxDepth + 1];
    size_t size = 0;
    stack[size++] = {ray.enter(bvh_.nodes[0].bounds, closest), 0};
    while (size != 0) {
      const Open top = stack[--size];
      if (!is_met(top.entry) || top.entry > closest) continue;
      const BinaryNode& node = bvh_.nodes[top.node];
      if (node.is_leaf()) {
        closest = std::min(closest, find_closest_in(node, ray));
        continue;
      }
      Open near = {ray.enter(bvh_.nodes[node.first].bounds, closest), node.first};
      Open far = {ray.enter(bvh_.nodes[node.first + 1].bounds, closest), node.first + 1};
      if (far.entry < near.entry) std::swap(near, far);
      stack[size++] = far;
      stack[size++] = near;
    }
    return closest;
  }

  double find_closest_in(const BinaryNode& leaf, const StatisticalRay& ray) const {
    double closest = ray.tmax();
    for (uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      Vec3f corner[3];
      source_.corners_of(bvh_.primitive_ids[i], corner);
      closest = std::min(closest, ray.meet(corner));
    }
    return closest;
  }

  void count(const StatisticalRay& ray, double closest) {
    uint32_t stack[BinaryBvh::kMaxDepth + 1];
    size_t size = 0;
    stack[size++] = 0;
    while (size != 0) {
      const uint32_t index = stack[--size];
      const BinaryNode& node = bvh_.nodes[index];
      if (!is_met(ray.enter(node.bounds, closest))) continue;
      std::atomic_ref(counts_[index]).fetch_add(1, std::memory_order_relaxed);
      if (node.is_leaf()) continue;
      stack[size++] = node.first + 1;
      stack[size++] = node.first;
    }
  }

  static bool is_met(double entry) { return !std::isinf(entry); }

  const BinaryBvh& bvh_;
  const TriangleSource& source_;
  Array<uint32_t> counts_;
};

}  // namespace

Array<float> measure_visit_weights(const BinaryBvh& bvh, const TriangleSource& source,
                                   std::span<const RepresentativeRay> rays, float guess_weight,
                                   Memory& memory, const Parallel& parallel) {
  VisitCounter counter(bvh, source, memory);
  parallel.for_blocks(rays.size(), kRayBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) counter.trace(rays[i]);
  });
  Array<float> weights(memory, bvh.nodes.size());
  uint32_t stack[BinaryBvh::kMaxDepth + 1];
  size_t size = 0;
  stack[size++] = 0;
  weights[0] = 1.0f;
  while (size != 0) {
    const uint32_t index = stack[--size];
    const BinaryNode& node = bvh.nodes[index];
    if (node.is_leaf()) continue;
    const float area = node.bounds.half_area();
    const auto visits = static_cast<float>(counter[index]);
    for (uint32_t child = node.first; child < node.first + 2; ++child) {
      const float guess = area > 0.0f ? bvh.nodes[child].bounds.half_area() / area : 1.0f;
      weights[child] = weights[index] *
                       (static_cast<float>(counter[child]) + guess_weight * guess) /
                       (visits + guess_weight);
      stack[size++] = child;
    }
  }
  return weights;
}

}  // namespace kiwami

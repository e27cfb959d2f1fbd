// SPDX-License-Identifier: Apache-2.0
#include "optimizers/nary_reorder.h"

#include <atomic>
#include <cmath>
#include <limits>

#include "wide/slot_owners.h"

namespace kiwami {
namespace {

/// Rays that one task follows.
constexpr size_t kRayBlock = 64;

/// The triangles in the leaves of a tree, in either layout.
struct LeafTriangles {
  const WideTree& tree;
  const TriangleSource& source;

  /// Calls visit(corners) for the triangles of a leaf until it returns true; then returns true.
  template <typename Visit>
  bool visit_each(ChildReference leaf, Visit&& visit) const {
    const uint32_t* const ids = tree.leaf_ids(tree.number_of(leaf));
    for (uint32_t lanes = leaf.mask(); lanes != 0; lanes &= lanes - 1) {
      Vec3f corner[3];
      source.corners_of(ids[std::countr_zero(lanes)], corner);
      if (visit(corner)) return true;
    }
    return false;
  }
};

/// How often rays meet each slot's box, and how often something below it stops them.
template <int N>
class SlotCounters {
 public:
  struct Count {
    uint32_t met, stopped;
  };

  SlotCounters(const LeafTriangles& triangles, Memory& memory)
      : triangles_(triangles), counts_(memory, triangles.tree.node_count * N) {
    counts_.fill_zero();
  }

  /// Follows a ray to all that it meets below a reference; returns whether something stops it.
  bool follow(const StatisticalRay& ray, ChildReference reference) {
    uint32_t mask = reference.mask();
    if (mask == 0) return false;
    if (reference.is_leaf()) return is_stopped(ray, reference);
    const WideNode<N>& node = node_at<N>(triangles_.tree.view.memory, reference);
    Count* const counts = counts_.data() + reference.node_offset() / sizeof node * N;
    bool is_any_stopped = false;
    for (; mask != 0; mask &= mask - 1) {
      const int slot = std::countr_zero(mask);
      if (std::isinf(ray.enter(box_of(node, slot), ray.tmax()))) continue;
      std::atomic_ref(counts[slot].met).fetch_add(1, std::memory_order_relaxed);
      if (!follow(ray, node.child[slot])) continue;
      std::atomic_ref(counts[slot].stopped).fetch_add(1, std::memory_order_relaxed);
      is_any_stopped = true;
    }
    return is_any_stopped;
  }

  const Count& operator()(uint32_t node, uint32_t slot) const {
    return counts_[size_t{node} * N + slot];
  }

 private:
  bool is_stopped(const StatisticalRay& ray, ChildReference leaf) const {
    return triangles_.visit_each(
        leaf, [&](const Vec3f corner[3]) { return !std::isinf(ray.meet(corner)); });
  }

  LeafTriangles triangles_;
  Array<Count> counts_;
};

double area_of(const Vec3f corner[3]) {
  double normal[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int y = (axis + 1) % 3, z = (axis + 2) % 3;
    const auto edge = [&](int vertex, int k) {
      return static_cast<double>(corner[vertex][k]) - corner[0][k];
    };
    normal[axis] = edge(1, y) * edge(2, z) - edge(1, z) * edge(2, y);
  }
  return 0.5 * std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
}

/// part / whole, at most 1; 0 of nothing.
double share_of(double part, double whole) {
  return whole > 0.0 ? std::min(part / whole, 1.0) : 0.0;
}

/// Orders from the leaves up, since the cost of a visit follows from the order below.
template <int N>
class NaryReorder {
 public:
  NaryReorder(WideTree& tree, const TriangleSource& source, const NaryReorderConfig& config,
              Memory& memory)
      : tree_(tree),
        triangles_{tree, source},
        config_(config),
        counters_(triangles_, memory),
        owners_(collect_owners<N>(tree, memory)),
        visits_(memory, owners_.size()) {}

  void run(std::span<const RepresentativeRay> rays, const Parallel& parallel) {
    if (is_over_boxes()) rays = {};
    parallel.for_blocks(rays.size(), kRayBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        counters_.follow({rays[i], tree_.view.centre}, tree_.view.root);
      }
    });
    ray_count_ = static_cast<uint32_t>(rays.size());
    for (size_t i = owners_.size(); i-- > 0;) order(i);
  }

 private:
  /// What is expected of a ray that meets the box of some subtree.
  struct Visit {
    double cost;
    double stopped;  ///< how likely something inside stops it, guessed from areas
  };
  struct Slot {
    double met, stopped, cost;
  };

  bool is_over_boxes() const { return triangles_.source.mesh_count == 0; }

  /// By areas: a line through a box of half area A meets a triangle inside of area T with
  /// probability T / A. What is known by its box alone is taken to fill it.
  Visit guess_leaf(ChildReference leaf, double box_area) const {
    if (is_over_boxes()) return {config_.leaf_cost, 1.0};
    double passed = 1.0;
    triangles_.visit_each(leaf, [&](const Vec3f corner[3]) {
      passed *= 1.0 - share_of(area_of(corner), box_area);
      return false;
    });
    return {config_.leaf_cost, 1.0 - passed};
  }

  /// The guess, corrected by what rays met: so many were there, of which so many count.
  double correct(double guess, uint32_t counted, uint32_t all) const {
    return (guess * config_.guess_weight + counted) / (double{config_.guess_weight} + all);
  }

  void order(size_t index) {
    const SlotOwner owner = owners_[index];
    WideNode<N>& node = tree_.nodes<N>()[owner.node];
    Bounds box = Bounds::empty();
    for (uint32_t mask = owner.mask; mask != 0; mask &= mask - 1) {
      box.extend(box_of(node, std::countr_zero(mask)));
    }
    const double area = box.half_area();
    const uint32_t met = index == 0 ? ray_count_ : count_of_parent(owner).met;
    Slot slots[N];
    SlotSorter<N> sorter;
    double passed = 1.0;
    uint32_t child = owner.first_child;
    for (uint32_t mask = owner.mask; mask != 0; mask &= mask - 1) {
      const auto slot = static_cast<uint32_t>(std::countr_zero(mask));
      const double slot_area = box_of(node, static_cast<int>(slot)).half_area();
      const ChildReference reference = node.child[slot];
      const Visit visit = reference.is_leaf() ? guess_leaf(reference, slot_area) : visits_[child++];
      const auto& count = counters_(owner.node, slot);
      const double reach = share_of(slot_area, area);
      slots[slot] = {correct(reach, count.met, met),
                     correct(visit.stopped, count.stopped, count.met), visit.cost};
      passed *= 1.0 - reach * visit.stopped;
      sorter.add(static_cast<int>(slot), slots[slot].stopped / slots[slot].cost);
    }
    sorter.sort();
    double cost = config_.node_cost, goes_on = 1.0;
    for (int i = 0; i < sorter.size(); ++i) {
      const Slot& slot = slots[sorter[i]];
      cost += goes_on * slot.met * slot.cost;
      goes_on *= 1.0 - slot.met * slot.stopped;
    }
    visits_[index] = {cost, 1.0 - passed};
    sorter.apply(node, owner.mask);
  }

  /// Parents are ordered after their children: the counts are still those of their slots.
  const typename SlotCounters<N>::Count& count_of_parent(const SlotOwner& owner) const {
    return counters_(owners_[owner.parent].node, owner.parent_slot);
  }

  WideTree& tree_;
  LeafTriangles triangles_;
  NaryReorderConfig config_;
  SlotCounters<N> counters_;
  Array<SlotOwner> owners_;
  Array<Visit> visits_;  ///< by owner
  uint32_t ray_count_ = 0;
};

}  // namespace

void reorder_by_rays(WideTree& tree, const TriangleSource& source,
                     std::span<const RepresentativeRay> rays, const NaryReorderConfig& config,
                     Memory& memory, const Parallel& parallel) {
  with_width(tree.width, [&](auto width) {
    NaryReorder<width>(tree, source, config, memory).run(rays, parallel);
  });
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// The traversal of a wide tree by a packet of coherent rays.
//
// All rays of a packet run through the tree together, after I. Wald, P. Slusallek, C. Benthin,
// M. Wagner, "Interactive Rendering with Coherent Ray Tracing", CGF 20(3), 2001. At a node the
// interval that all rays span is tested first against all children at once (S. Boulos, I. Wald,
// P. Shirley, "Geometric and Arithmetic Culling Methods for Entire Ray Packets", technical report
// UUCS-06-010, 2006), then each child that is left against the single rays. Where few rays go on
// together, each goes on alone. Every ray accepts the triangles that it would accept alone, and the
// least (distance, id) does not depend on the order: the answers are those of single rays.
#pragma once

#include "kernels/traversal-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// Rays in lanes, as the box test reads them, and the intervals that they span.
template <int N>
struct PacketSlabs {
  static constexpr int kSize = 2 * N;

  alignas(64) float reciprocal[3][kSize];
  alignas(64) float near_offset[3][kSize];
  alignas(64) float far_offset[3][kSize];
  alignas(64) float tmin[kSize];
  alignas(64) float best[kSize];
  const PlaneOffsets<N>* planes;  ///< the same for all rays
  float least_reciprocal[3], greatest_reciprocal[3];
  float least_near_offset[3], greatest_far_offset[3];
  float least_tmin;
};

template <int N>
inline float least_of(const float* values) {
  float least = values[0];
  for (int i = 1; i < PacketSlabs<N>::kSize; ++i) least = values[i] < least ? values[i] : least;
  return least;
}
template <int N>
inline float greatest_of(const float* values) {
  float most = values[0];
  for (int i = 1; i < PacketSlabs<N>::kSize; ++i) most = values[i] > most ? values[i] : most;
  return most;
}

template <int N>
inline void set_up_packet(const ScalarRay* rays, const TreeView& tree, PacketSlabs<N>& out) {
  for (int i = 0; i < PacketSlabs<N>::kSize; ++i) {
    AxisSlabs slabs;
    set_up_axes(rays[i], tree, slabs);
    float lanes[4];
    store(lanes, slabs.reciprocal);
    for (int axis = 0; axis < 3; ++axis) out.reciprocal[axis][i] = lanes[axis];
    store(lanes, slabs.near_offset);
    for (int axis = 0; axis < 3; ++axis) out.near_offset[axis][i] = lanes[axis];
    store(lanes, slabs.far_offset);
    for (int axis = 0; axis < 3; ++axis) out.far_offset[axis][i] = lanes[axis];
    out.tmin[i] = scaled_lower(rays[i], rays[i].tmin);
    out.best[i] = scaled_upper(rays[i], rays[i].tmax);
  }
  out.planes = &kPlaneOffsets<N>[sign_bits(load<4>(rays[0].direction)) & kAllAxes];
  for (int axis = 0; axis < 3; ++axis) {
    out.least_reciprocal[axis] = least_of<N>(out.reciprocal[axis]);
    out.greatest_reciprocal[axis] = greatest_of<N>(out.reciprocal[axis]);
    out.least_near_offset[axis] = least_of<N>(out.near_offset[axis]);
    out.greatest_far_offset[axis] = greatest_of<N>(out.far_offset[axis]);
  }
  out.least_tmin = least_of<N>(out.tmin);
}

/// The children that some ray may meet: for each child a lower bound of all entry distances and an
/// upper bound of all exits. Each bound is made by the operations of the single test on operands
/// that bound those of every ray, and rounding is monotone: what a single ray meets is met.
template <int N>
inline uint32_t test_interval(const WideNode<N>& node, const PacketSlabs<N>& packet,
                              float greatest_best, vfloat<N>& entry) {
  vfloat<N> latest_exit = broadcast<N>(greatest_best);
  entry = broadcast<N>(packet.least_tmin);
  for (int axis = 0; axis < 3; ++axis) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(node.bounds);
    const auto planes = [&](size_t offset) {
      return load<N>(reinterpret_cast<const float*>(bytes + offset));
    };
    const vfloat<N> near = planes(packet.planes->near[axis]);
    const vfloat<N> far = planes(packet.planes->far[axis]);
    const vfloat<N> least = broadcast<N>(packet.least_reciprocal[axis]);
    const vfloat<N> greatest = broadcast<N>(packet.greatest_reciprocal[axis]);
    const vfloat<N> near_offset = broadcast<N>(packet.least_near_offset[axis]);
    const vfloat<N> far_offset = broadcast<N>(packet.greatest_far_offset[axis]);
    entry = max(entry, min(multiply_add(near, least, near_offset),
                           multiply_add(near, greatest, near_offset)));
    latest_exit = min(latest_exit, max(multiply_add(far, least, far_offset),
                                       multiply_add(far, greatest, far_offset)));
  }
  return less_equal(entry, latest_exit);
}

/// The rays, out of those named, that meet the box in one slot.
template <int N>
inline uint32_t test_rays(const WideNode<N>& node, int slot, const PacketSlabs<N>& packet,
                          uint32_t rays) {
  constexpr uint32_t group_mask = (1u << N) - 1u;
  uint32_t met = 0;
  for (int group = 0; group < PacketSlabs<N>::kSize; group += N) {
    if ((rays & (group_mask << group)) == 0) continue;
    vfloat<N> entry = load<N>(packet.tmin + group);
    vfloat<N> exit = load<N>(packet.best + group);
    for (int axis = 0; axis < 3; ++axis) {
      const auto* bytes = reinterpret_cast<const unsigned char*>(node.bounds);
      const auto plane = [&](size_t offset) {
        return broadcast<N>(reinterpret_cast<const float*>(bytes + offset)[slot]);
      };
      const vfloat<N> reciprocal = load<N>(packet.reciprocal[axis] + group);
      entry = max(multiply_add(plane(packet.planes->near[axis]), reciprocal,
                               load<N>(packet.near_offset[axis] + group)),
                  entry);
      exit = min(multiply_add(plane(packet.planes->far[axis]), reciprocal,
                              load<N>(packet.far_offset[axis] + group)),
                 exit);
    }
    met |= less_equal(entry, exit) << group;
  }
  return met & rays;
}

/// The rays, out of those named, whose best hit lies at or beyond a distance.
template <int N>
inline uint32_t rays_beyond(const PacketSlabs<N>& packet, float distance, uint32_t rays) {
  uint32_t beyond = 0;
  for (int group = 0; group < PacketSlabs<N>::kSize; group += N) {
    beyond |= less_equal(broadcast<N>(distance), load<N>(packet.best + group)) << group;
  }
  return beyond & rays;
}

/// One ray of the packet alone, from a subtree on.
template <int N, typename Query>
inline bool continue_alone(const TreeView& tree, const PacketSlabs<N>& packet, int i,
                           const StackEntry& start, Query& query) {
  const auto lanes = [&](const float(&values)[3][PacketSlabs<N>::kSize]) {
    const float four[4] = {values[0][i], values[1][i], values[2][i], 0.0f};
    return spread<N>(load<4>(four));
  };
  const SlabRay<N> ray{lanes(packet.reciprocal), lanes(packet.near_offset),
                       lanes(packet.far_offset), packet.tmin[i], packet.planes};
  NoProbe probe;
  return traverse<N>(tree, start, ray, query, probe);
}

/// A subtree that rays of a packet have still to visit.
struct PacketEntry {
  StackEntry start;  ///< its entry is a lower bound for all rays
  uint32_t rays;     ///< those that enter it
};

/// Adds an entry to those above bottom, as insert_farthest_first does for a single ray.
inline PacketEntry* insert_farthest_first(PacketEntry* bottom, PacketEntry* top,
                                          const PacketEntry& added) {
  PacketEntry* place = top;
  for (; place != bottom && place[-1].start.entry < added.start.entry; --place) *place = place[-1];
  *place = added;
  return top + 1;
}

/// The state of one packet on its way through the tree.
template <int N, typename Query>
struct PacketTraversal {
  static constexpr int kSize = PacketSlabs<N>::kSize;
  /// Fewer rays than this go on alone.
  static constexpr int kLeastTogether = kSize * 3 / 8;
  static constexpr uint32_t kAll = kSize == 32 ? ~0u : (1u << kSize) - 1u;

  const TreeView& tree;
  PacketSlabs<N>& packet;
  Query* queries;
  uint32_t alive = kAll;  ///< rays that have not ended
  float greatest_best = 0.0f;

  void run() {
    greatest_best = greatest_of<N>(packet.best);
    PacketEntry stack[kStackSize<N>];
    PacketEntry* top = stack;
    *top++ = {{tree.root, packet.least_tmin}, kAll};
    while (top != stack) {
      PacketEntry current = *--top;
      const StackEntry& start = current.start;
      if (start.entry > greatest_best) continue;
      current.rays = rays_beyond(packet, start.entry, current.rays & alive);
      if (current.rays == 0) continue;
      if (__builtin_popcount(current.rays) < kLeastTogether) {
        for_each_ray(current.rays,
                     [&](int i) { return continue_alone<N>(tree, packet, i, start, queries[i]); });
      } else if (start.subtree.is_leaf()) {
        const LeafBlock<N>& leaf = leaf_at<N>(tree.memory, start.subtree);
        NoProbe probe;
        for_each_ray(current.rays, [&](int i) {
          return queries[i].visit_leaf(leaf, start.subtree.mask(), probe);
        });
      } else {
        top = visit_node(current, top);
      }
    }
  }

  /// Calls visit(i) for each of the rays; those that are then done leave the packet.
  template <typename Visit>
  void for_each_ray(uint32_t rays, Visit visit) {
    for (; rays; rays &= rays - 1) {
      const int i = __builtin_ctz(rays);
      if (visit(i)) {
        alive &= ~(1u << i);
        packet.best[i] = -__builtin_inff();
      } else {
        packet.best[i] = queries[i].best_bound;
      }
    }
    greatest_best = greatest_of<N>(packet.best);
  }

  PacketEntry* visit_node(const PacketEntry& current, PacketEntry* top) {
    const WideNode<N>& node = node_at<N>(tree.memory, current.start.subtree);
    vfloat<N> entry;
    uint32_t hits =
        test_interval(node, packet, greatest_best, entry) & current.start.subtree.mask();
    float entries[N];
    store(entries, entry);
    PacketEntry* const bottom = top;
    for (; hits; hits &= hits - 1) {
      const int slot = __builtin_ctz(hits);
      const uint32_t rays = test_rays(node, slot, packet, current.rays);
      if (rays == 0) continue;
      top = insert_farthest_first(bottom, top, {child_of(node, slot, entries[slot]), rays});
    }
    return top;
  }
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// The traversal of a wide tree by a stream of rays of one octant.
//
// All rays of a stream go through the tree together; a child collects, as bits, the rays that meet
// it. So a node is read once for all of them, and what is branched on is a loop over rays instead
// of the outcome of each test (after V. Fuetterling, C. Lojewski, F.-J. Pfreundt, A. Ebert,
// "Efficient Ray Tracing Kernels for Modern CPU Architectures", JCGT 4(5), 2015, where rays are
// lists and not bits). There are two ways to test a node. Where few rays are left, each is tested
// against all children at once. Where many are, the interval that all rays of the stream span is
// tested against all children at once (S. Boulos, I. Wald, P. Shirley, "Geometric and Arithmetic
// Culling Methods for Entire Ray Packets", technical report UUCS-06-010, 2006), and then each child
// that is left against the rays, a ray a lane (I. Wald, P. Slusallek, C. Benthin, M. Wagner,
// "Interactive Rendering with Coherent Ray Tracing", CGF 20(3), 2001).
//
// Every ray accepts the triangles that it would accept alone, and the least (distance, id) does not
// depend on the order: the answers are those of single rays.
#pragma once

#include "kernels/traversal-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// Rays of a stream: one bit of a word each.
constexpr int kStreamSize = 32;

/// Bit i, to be read as a vector of equal lanes.
struct RayBits {
  uint32_t bit[kStreamSize];
};
constexpr RayBits make_ray_bits() {
  RayBits bits{};
  for (uint32_t i = 0; i < kStreamSize; ++i) bits.bit[i] = 1u << i;
  return bits;
}
constexpr RayBits kRayBits = make_ray_bits();

/// The rays in lanes, as the box test reads them, and the intervals that they span.
template <int N>
struct StreamSlabs {
  alignas(64) float reciprocal[3][kStreamSize];
  alignas(64) float near_offset[3][kStreamSize];
  alignas(64) float far_offset[3][kStreamSize];
  alignas(64) float nearest[kStreamSize];
  alignas(64) float farthest[kStreamSize];
  float least_reciprocal[3], greatest_reciprocal[3];
  float least_near_offset[3], greatest_far_offset[3];
  float least_nearest, greatest_farthest;
};

/// The least and the greatest of one value of all rays.
template <int N>
inline void find_interval(const float* values, float& least, float& greatest) {
  vfloat<N> low = load<N>(values), high = low;
  for (int group = N; group < kStreamSize; group += N) {
    const vfloat<N> others = load<N>(values + group);
    low = min(low, others);
    high = max(high, others);
  }
  least = least_lane(low);
  greatest = greatest_lane(high);
}

/// Turns rays into lanes; where there are fewer than kStreamSize, the first stands in for the rest.
template <int N>
inline void set_up_stream(ReadyRay* rays, int count, StreamSlabs<N>& out) {
  for (int i = count; i < kStreamSize; ++i) rays[i] = rays[0];
  const auto turn = [&](size_t offset, float(&axes)[3][kStreamSize], float* fourth) {
    for (int group = 0; group < kStreamSize; group += N) {
      vfloat<N> columns[4];
      load_rows(reinterpret_cast<const unsigned char*>(rays + group) + offset, sizeof(ReadyRay),
                columns);
      for (int axis = 0; axis < 3; ++axis) store(axes[axis] + group, columns[axis]);
      if (fourth) store(fourth + group, columns[3]);
    }
  };
  turn(offsetof(ReadyRay, reciprocal), out.reciprocal, out.nearest);
  turn(offsetof(ReadyRay, near_offset), out.near_offset, out.farthest);
  turn(offsetof(ReadyRay, far_offset), out.far_offset, nullptr);
  float unused;
  for (int axis = 0; axis < 3; ++axis) {
    find_interval<N>(out.reciprocal[axis], out.least_reciprocal[axis],
                     out.greatest_reciprocal[axis]);
    find_interval<N>(out.near_offset[axis], out.least_near_offset[axis], unused);
    find_interval<N>(out.far_offset[axis], unused, out.greatest_far_offset[axis]);
  }
  find_interval<N>(out.nearest, out.least_nearest, unused);
  find_interval<N>(out.farthest, unused, out.greatest_farthest);
}

/// The planes of a node that rays of one octant meet first and last.
template <int N>
struct NodePlanes {
  vfloat<N> near[3], far[3];

  NodePlanes(const WideNode<N>& node, const PlaneOffsets<N>& offsets) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(node.bounds);
    for (int axis = 0; axis < 3; ++axis) {
      near[axis] = load<N>(reinterpret_cast<const float*>(bytes + offsets.near[axis]));
      far[axis] = load<N>(reinterpret_cast<const float*>(bytes + offsets.far[axis]));
    }
  }
};

/// The children that some ray may meet: for each child a lower bound of all entry distances and an
/// upper bound of all exits. Each bound is made by the operations of the single test on operands
/// that bound those of every ray, and rounding is monotone: what a single ray meets is met.
template <int N>
inline uint32_t test_interval(const NodePlanes<N>& planes, const StreamSlabs<N>& slabs) {
  vfloat<N> exit = broadcast<N>(slabs.greatest_farthest);
  vfloat<N> entry = broadcast<N>(slabs.least_nearest);
  for (int axis = 0; axis < 3; ++axis) {
    const vfloat<N> least = broadcast<N>(slabs.least_reciprocal[axis]);
    const vfloat<N> greatest = broadcast<N>(slabs.greatest_reciprocal[axis]);
    const vfloat<N> near_offset = broadcast<N>(slabs.least_near_offset[axis]);
    const vfloat<N> far_offset = broadcast<N>(slabs.greatest_far_offset[axis]);
    entry = max(entry, min(multiply_add(planes.near[axis], least, near_offset),
                           multiply_add(planes.near[axis], greatest, near_offset)));
    exit = min(exit, max(multiply_add(planes.far[axis], least, far_offset),
                         multiply_add(planes.far[axis], greatest, far_offset)));
  }
  return less_equal(entry, exit);
}

/// The rays, out of those named, that meet the box in one slot.
template <int N>
inline uint32_t test_rays(const WideNode<N>& node, const PlaneOffsets<N>& offsets, int slot,
                          const StreamSlabs<N>& slabs, uint32_t rays, float& first_entry) {
  vfloat<N> first = broadcast<N>(__FLT_MAX__);
  constexpr uint32_t group_mask = ~0u >> (32 - N);
  uint32_t met = 0;
  for (int group = 0; group < kStreamSize; group += N) {
    if ((rays & (group_mask << group)) == 0) continue;
    vfloat<N> entry = load<N>(slabs.nearest + group);
    vfloat<N> exit = load<N>(slabs.farthest + group);
    for (int axis = 0; axis < 3; ++axis) {
      const auto* bytes = reinterpret_cast<const unsigned char*>(node.bounds);
      const auto plane = [&](size_t offset) {
        return broadcast<N>(reinterpret_cast<const float*>(bytes + offset)[slot]);
      };
      const vfloat<N> reciprocal = load<N>(slabs.reciprocal[axis] + group);
      entry = max(multiply_add(plane(offsets.near[axis]), reciprocal,
                               load<N>(slabs.near_offset[axis] + group)),
                  entry);
      exit = min(multiply_add(plane(offsets.far[axis]), reciprocal,
                              load<N>(slabs.far_offset[axis] + group)),
                 exit);
    }
    met |= less_equal(entry, exit) << group;
    first = min(first, entry);
  }
  first_entry = least_lane(first);
  return met & rays;
}

/// The state of one stream on its way through the tree.
template <int N, typename Query>
struct StreamTraversal {
  /// Rays that are tested in lanes; fewer are tested one after the other.
  static constexpr int kLeastInLanes = 14;

  /// A subtree that rays have still to visit.
  struct Entry {
    ChildReference subtree;
    uint32_t rays;
    float entry;  ///< a lower bound of the distances at which they enter it
  };

  const TreeView& tree;
  ReadyRay* rays;  ///< all of one octant
  Query* queries;
  uint32_t alive;  ///< rays that have not ended
  StreamSlabs<N>& slabs;
  const PlaneOffsets<N>& offsets = kPlaneOffsets<N>[rays[0].backward];
  uint32_t visits = 0;      ///< of nodes by the stream
  uint32_t ray_visits = 0;  ///< of nodes by rays

  void run() {
    Entry stack[kStackSize<N>];
    Entry* top = stack;
    *top++ = {tree.root, alive, slabs.least_nearest};
    NoProbe probe;
    while (top != stack) {
      --top;
      const uint32_t active = rays_that_reach(*top);
      if (active == 0) continue;
      const ChildReference subtree = top->subtree;
      if (!subtree.is_leaf()) {
        top = visit_node(subtree, active, top);
        continue;
      }
      typename Query::Room room;
      const auto& leaf = queries[__builtin_ctz(active)].leaf_at(tree, subtree, room);
      for_each_ray(active,
                   [&](int i) { return queries[i].visit_leaf(leaf, subtree.mask(), probe); });
    }
  }

  /// Puts the children that are met onto the stack, with the rays that meet them.
  Entry* visit_node(ChildReference subtree, uint32_t active, Entry* top) {
    const WideNode<N>& node = node_at<N>(tree.memory, subtree);
    const NodePlanes<N> planes(node, offsets);
    const int count = __builtin_popcount(active);
    ++visits;
    ray_visits += static_cast<uint32_t>(count);
    uint32_t slots = subtree.mask();
    if (count >= kLeastInLanes) {
      slots &= test_interval(planes, slabs);
      // In lanes, each slot takes a test for every N rays of the stream.
      if (__builtin_popcount(slots) * (kStreamSize / N) < count) {
        return visit_in_lanes(node, slots, active, top);
      }
    }
    return visit_by_rays(node, planes, slots, active, top);
  }

  /// The rays of an entry that have not ended, nor found a hit before it.
  uint32_t rays_that_reach(const Entry& from) const {
    uint32_t active = from.rays & alive;
    if constexpr (Query::kOrdered) {
      if (__builtin_popcount(active) < kLeastInLanes) {
        for (uint32_t left = active; left; left &= left - 1) {
          const int i = __builtin_ctz(left);
          active ^= static_cast<uint32_t>(from.entry > rays[i].farthest) << i;
        }
        return active;
      }
      uint32_t reach = 0;
#pragma GCC unroll 8
      for (int group = 0; group < kStreamSize; group += N) {
        reach |= less_equal(broadcast<N>(from.entry), load<N>(slabs.farthest + group)) << group;
      }
      active &= reach;
    }
    return active;
  }

  /// Calls visit(i) for each of the rays; those that are then done leave the stream.
  template <typename Visit>
  void for_each_ray(uint32_t active, Visit visit) {
    for (; active; active &= active - 1) {
      const int i = __builtin_ctz(active);
      if (visit(i)) alive &= ~(1u << i);
      if constexpr (Query::kShrinks) {
        rays[i].farthest = slabs.farthest[i] = queries[i].best_bound;
      }
    }
  }

  /// Adds a child; for queries that care, the entries above bottom stay sorted, nearest on top.
  Entry* add(Entry* bottom, Entry* top, ChildReference subtree, uint32_t met, float entry) const {
    Entry* place = top;
    if constexpr (Query::kOrdered) {
      for (; place != bottom && place[-1].entry < entry; --place) *place = place[-1];
    }
    place->subtree = subtree;
    place->rays = met;
    if constexpr (Query::kOrdered) place->entry = entry;
    prefetch<N>(tree, subtree);
    return top + 1;
  }

  Entry* visit_by_rays(const WideNode<N>& node, const NodePlanes<N>& planes, uint32_t slots,
                       uint32_t active, Entry* top) {
    vfloat<N> met = broadcast<N>(0.0f);
    vfloat<N> first_entry = broadcast<N>(__FLT_MAX__);
    for (; active; active &= active - 1) {
      const int i = __builtin_ctz(active);
      const ReadyRay& ray = rays[i];
      vfloat<N> entry = broadcast<N>(ray.nearest);
      vfloat<N> exit = broadcast<N>(ray.farthest);
      for (int axis = 0; axis < 3; ++axis) {
        const vfloat<N> reciprocal = broadcast<N>(ray.reciprocal[axis]);
        entry =
            max(multiply_add(planes.near[axis], reciprocal, broadcast<N>(ray.near_offset[axis])),
                entry);
        exit = min(multiply_add(planes.far[axis], reciprocal, broadcast<N>(ray.far_offset[axis])),
                   exit);
      }
      met = mark_less_equal(met, entry, exit, kRayBits.bit[i]);
      if constexpr (Query::kOrdered) first_entry = min(entry, first_entry);
    }
    float met_by[N], entries[N];
    store(met_by, met);
    if constexpr (Query::kOrdered) store(entries, first_entry);
    Entry* const bottom = top;
    for (slots &= marked_lanes(met); slots;) {
      const int slot = 31 - __builtin_clz(slots);
      slots ^= 1u << slot;
      uint32_t bits;
      __builtin_memcpy(&bits, &met_by[slot], sizeof bits);
      top = add(bottom, top, node.child[slot], bits, Query::kOrdered ? entries[slot] : 0.0f);
    }
    return top;
  }

  Entry* visit_in_lanes(const WideNode<N>& node, uint32_t slots, uint32_t active, Entry* top) {
    Entry* const bottom = top;
    for (; slots;) {
      const int slot = 31 - __builtin_clz(slots);
      slots ^= 1u << slot;
      float entry;
      const uint32_t met = test_rays(node, offsets, slot, slabs, active, entry);
      if (met != 0) top = add(bottom, top, node.child[slot], met, entry);
    }
    return top;
  }
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

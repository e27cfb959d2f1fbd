// SPDX-License-Identifier: Apache-2.0
// What the agglomerative builders share: clusters, the order of their pairs, and joining.
#pragma once

#include <algorithm>

#include "builders/morton_order.h"
#include "builders/sah_bins.h"

namespace kiwami {

/// Primitives that stand in one subtree. Two that join put their nodes into the pair of slots that
/// belongs to the higher of their places: each place but the first one disappears once, so every
/// pair is used once, and who joins whom in parallel needs no common counter.
struct Cluster {
  Vec3f lower;
  uint32_t first;  ///< the node's: a pair of slots, or the place of the only primitive
  Vec3f upper;
  uint32_t count;  ///< primitives
  uint32_t place;  ///< of its first primitive along the curve

  BinaryNode node() const { return {{lower, upper}, first, count == 1 ? 1u : 0u}; }
  VectorBounds bounds() const {
    const float* words = reinterpret_cast<const float*>(this);
    return {simde_mm_loadu_ps(words), simde_mm_loadu_ps(words + 4)};
  }
};

/// How near two clusters are: by the area of the box around both, then by what keeps equal boxes
/// balanced. A total order of pairs in which a joined cluster is farther from any third one than
/// the nearer of its parts (its box is no smaller, and it has more primitives). So joining all
/// pairs that are each other's nearest gives the same tree as joining the least pair of all first.
struct PairKey {
  float area;
  uint32_t count;  ///< primitives of both
  uint32_t apart;  ///< exclusive or of both places
  uint32_t place;  ///< the lower one

  static PairKey of(const Cluster& a, const Cluster& b, float area) {
    return {area, a.count + b.count, a.place ^ b.place, std::min(a.place, b.place)};
  }
  static PairKey of(const Cluster& a, const Cluster& b) { return of(a, b, area_of_both(a, b)); }

  static float area_of_both(const Cluster& a, const Cluster& b) {
    VectorBounds both = a.bounds();
    both.extend(b.bounds());
    return both.half_area();
  }

  /// Farther than any pair of clusters.
  static PairKey farthest() { return {std::numeric_limits<float>::infinity(), ~0u, ~0u, ~0u}; }

  bool operator<(const PairKey& other) const {
    if (area != other.area) return area < other.area;
    if (count != other.count) return count < other.count;
    if (apart != other.apart) return apart < other.apart;
    return place < other.place;
  }
};

/// Writes both to the tree and returns what they make. The one of the lower place stands left.
inline Cluster join(const Cluster& a, const Cluster& b, BinaryBvh& bvh) {
  const Cluster& left = a.place < b.place ? a : b;
  const Cluster& right = a.place < b.place ? b : a;
  const uint32_t first = 2 * right.place - 1;
  bvh.nodes[first] = left.node();
  bvh.nodes[first + 1] = right.node();
  VectorBounds both = left.bounds();
  both.extend(right.bounds());
  const Bounds bounds = both.bounds();
  return {bounds.lower, first, bounds.upper, left.count + right.count, left.place};
}

/// Makes a cluster of each primitive, and the tree to join them in.
inline BinaryBvh separate(Array<BuildPrimitive> primitives, Array<Cluster>& clusters,
                          Memory& memory) {
  const size_t count = primitives.size();
  BinaryBvh bvh{{}, Array<uint32_t>(memory, count)};
  clusters = Array<Cluster>(memory, count);
  for (uint32_t i = 0; i < count; ++i) {
    bvh.primitive_ids[i] = primitives[i].id;
    clusters[i] = {primitives[i].lower, i, primitives[i].upper, 1, i};
  }
  primitives = {};  // makes room for the nodes
  bvh.nodes = Array<BinaryNode>(memory, 2 * count - 1);
  return bvh;
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// The dynamic programme of optimal_contraction.h over rows of floats, four costs at a time.
#pragma once

#include <simde/x86/sse2.h>

#include <algorithm>
#include <cstdint>
#include <limits>

namespace kiwami {

/// The least costs of a cluster as at most 1, 2, ... N children of one wide node. Before them
/// stand N infinite ones: a row can be read from up to N places further left, as the costs of so
/// many children fewer.
template <int N>
struct CostRow {
  float values[2 * N];

  float& of(uint32_t children) { return values[N + children - 1]; }
  float of(uint32_t children) const { return values[N + children - 1]; }

  void clear() { std::fill_n(values, 2 * N, std::numeric_limits<float>::infinity()); }

  /// The same cost however many children it may become.
  void set_all(float cost) { std::fill_n(values + N, N, cost); }
};

/// The row of two clusters joined, of which the lesser cost (as a node or as a leaf) is still to be
/// taken in: the costs of at most i children, of which both have some. The first one has at most
/// first_size children that lower its cost.
template <int N>
inline void share_children(const CostRow<N>& first, uint32_t first_size, const CostRow<N>& second,
                           CostRow<N>& joined) {
  constexpr int kVectors = N / 4;
  simde__m128 least[kVectors];
  for (simde__m128& vector : least) {
    vector = simde_mm_set1_ps(std::numeric_limits<float>::infinity());
  }
  const uint32_t last = std::min<uint32_t>(first_size, N - 1);
  for (uint32_t from_first = 1; from_first <= last; ++from_first) {
    const simde__m128 cost = simde_mm_set1_ps(first.of(from_first));
    const float* rest = second.values + N - from_first;
    for (int i = 0; i < kVectors; ++i) {
      least[i] = simde_mm_min_ps(least[i], simde_mm_add_ps(cost, simde_mm_loadu_ps(rest + 4 * i)));
    }
  }
  for (int i = 0; i < kVectors; ++i) simde_mm_storeu_ps(joined.values + N + 4 * i, least[i]);
}

/// Takes in the cost as one child.
template <int N>
inline void limit_costs(CostRow<N>& row, float as_one_child) {
  const simde__m128 limit = simde_mm_set1_ps(as_one_child);
  for (int i = N; i < 2 * N; i += 4) {
    simde_mm_storeu_ps(row.values + i, simde_mm_min_ps(simde_mm_loadu_ps(row.values + i), limit));
  }
}

/// What is known of a cluster beside its row.
struct ClusterTraits {
  static constexpr uint8_t kNoLeaf = 255;  ///< primitives: more than any leaf may have

  uint8_t primitive_count;  ///< or kNoLeaf
  uint8_t size;             ///< more children do not lower its cost
  bool is_leaf;             ///< a leaf of primitives where it becomes one child
};

/// The prices of the programme.
struct ClusterPrices {
  float node_cost, leaf_cost;
  uint32_t leaf_width;  ///< primitives a leaf
  float area_scale;     ///< 1 / the area of the scene, or 0

  ClusterPrices(float of_node, float of_leaf, uint32_t width_of_leaf, double scene_area)
      : node_cost(of_node),
        leaf_cost(of_leaf),
        leaf_width(width_of_leaf),
        area_scale(scene_area >= 0x1p-126 ? static_cast<float>(1.0 / scene_area) : 0.0f) {}

  /// Relative to the scene, so that sums of floats cannot overflow; never zero, so that fewer nodes
  /// are better among those without area.
  float weight_of(float half_area) const { return half_area * area_scale + 0x1p-64f; }
};

/// Solves the programme for two clusters that join to one of this weight.
template <int N>
inline ClusterTraits join_clusters(const ClusterPrices& prices, float weight,
                                   const CostRow<N>& left, ClusterTraits of_left,
                                   const CostRow<N>& right, ClusterTraits of_right,
                                   CostRow<N>& row) {
  if (of_left.size <= of_right.size) {
    share_children(left, of_left.size, right, row);
  } else {
    share_children(right, of_right.size, left, row);
  }
  const uint32_t primitive_count = uint32_t{of_left.primitive_count} + of_right.primitive_count;
  const float as_node = row.of(N) + prices.node_cost * weight;
  const float as_leaf = prices.leaf_cost * weight;
  const bool can_be_leaf = primitive_count <= prices.leaf_width;
  const bool is_leaf = can_be_leaf && as_leaf <= as_node;
  const float as_one_child = is_leaf ? as_leaf : as_node;
  const uint32_t size = std::min<uint32_t>(uint32_t{of_left.size} + of_right.size, N - 1);
  const bool is_divided = row.of(size) < as_one_child;
  limit_costs(row, as_one_child);
  return {static_cast<uint8_t>(can_be_leaf ? primitive_count : ClusterTraits::kNoLeaf),
          static_cast<uint8_t>(is_divided ? size : 1), is_leaf};
}

}  // namespace kiwami

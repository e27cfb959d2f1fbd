// SPDX-License-Identifier: Apache-2.0
// What a traversal reports of itself: nothing, or counts.
#pragma once

#include "kernels/ray-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

struct NoProbe {
  static constexpr bool kNeedsEntry = false;

  void on_node() {}
  void on_leaf(float) {}
  void on_accept(const SceneView&, const ReadyRay&, uint32_t, float) {}
  void on_double_fallback() {}
};

/// Counts, and checks what the order of visits rests on: no accepted hit lies before the distance
/// at which the ray enters the box of its own leaf; in a tree that has duplicates, that some leaf
/// of its triangle holds it.
template <int N>
struct CountingProbe {
  static constexpr bool kNeedsEntry = true;

  TraversalCounters& counters;
  float leaf_entry = 0.0f;

  void on_node() { ++counters.node_visits; }
  void on_leaf(float entry) {
    ++counters.leaf_visits;
    leaf_entry = entry;
  }
  void on_accept(const SceneView& scene, const ReadyRay& ray, uint32_t id, float t);
  void on_double_fallback() { ++counters.double_fallbacks; }
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

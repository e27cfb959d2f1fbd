// SPDX-License-Identifier: Apache-2.0
// What a traversal reports of itself: nothing, or counts.
#pragma once

#include "kernels/ray-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

struct NoProbe {
  static constexpr bool kNeedsEntry = false;

  /// What leave takes to undo an enter.
  struct Level {};

  void on_node() {}
  void on_leaf(float) {}
  void on_accept(const SceneView&, const ReadyRay&, uint32_t, float) {}
  void on_accept_in_leaf(const ReadyRay&, float) {}
  void on_double_fallback() {}
  Level enter(const ReadyRay&) { return {}; }
  void leave(Level) {}
};

/// Counts, and checks what the order of visits rests on: no accepted hit lies before the distance
/// at which the ray enters the box of its own leaf, nor those of the instances around it; in a tree
/// that has duplicates, that some leaf of its triangle holds it.
template <int N>
struct CountingProbe {
  static constexpr bool kNeedsEntry = true;

  /// The leaf of an instance or a mesh's tree that was entered, as the ray outside sees it.
  struct Level {
    const ReadyRay* ray;
    float leaf_entry;
  };

  TraversalCounters& counters;
  float leaf_entry = 0.0f;
  uint32_t depth = 0;
  // Within the last instance there may be the tree of a mesh.
  Level levels[KIWAMI_MAX_INSTANCE_DEPTH + 1] = {};

  void on_node() { ++counters.node_visits; }
  void on_leaf(float entry) {
    ++counters.leaf_visits;
    leaf_entry = entry;
  }
  void on_accept(const SceneView& scene, const ReadyRay& ray, uint32_t id, float t);
  /// Of what stands in one leaf alone.
  void on_accept_in_leaf(const ReadyRay& ray, float t) {
    on_accept(scaled_upper(ray, t) >= leaf_entry, t);
  }
  void on_double_fallback() { ++counters.double_fallbacks; }
  Level enter(const ReadyRay& ray) { return levels[depth++] = {&ray, leaf_entry}; }
  void leave(const Level& level) {
    leaf_entry = level.leaf_entry;
    --depth;
  }

 private:
  void on_accept(bool is_in_box, float t) {
    ++counters.accepted;
    for (uint32_t i = 0; i < depth; ++i) {
      is_in_box = is_in_box && scaled_upper(*levels[i].ray, t) >= levels[i].leaf_entry;
    }
    if (!is_in_box) ++counters.margin_violations;
  }
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

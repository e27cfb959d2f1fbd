// SPDX-License-Identifier: Apache-2.0
// Several rays on their way through the tree in turn, so that while one waits for memory the others
// go on.
#pragma once

#include "kernels/traversal-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// Rays that are under way at once.
constexpr int kFlights = 8;
/// Trees below this come from the caches soon enough that taking turns costs more than it hides.
constexpr uint64_t kLeastInterleavedBytes = 32u << 20;

/// A ray under way.
template <int N, typename Query>
struct Flight {
  Query query;
  int number;  ///< of the ray
  StackEntry* top;
  StackEntry current;
  StackEntry stack[kStackSize<N>];
};

/// Traces count rays and calls deliver(number, query) for each, in no order.
template <typename Query, int N, typename Deliver>
inline void trace_interleaved(const SceneView& scene, const ReadyRay* rays, int count,
                              Deliver deliver) {
  Flight<N, Query> flights[kFlights];
  Flight<N, Query>* under_way[kFlights];
  NoProbe probe;
  int next = 0;
  const auto start = [&](Flight<N, Query>& flight) {
    flight.number = next++;
    flight.query.begin(scene, rays[flight.number]);
    flight.top = flight.stack;
    flight.current = {scene.tree.root, rays[flight.number].nearest};
  };
  int flying = 0;
  for (; flying < kFlights && flying < count; ++flying) {
    under_way[flying] = &flights[flying];
    start(flights[flying]);
  }
  while (flying > 0) {
    for (int i = 0; i < flying; ++i) {
      Flight<N, Query>& flight = *under_way[i];
      const SlabRay<N> ray(*flight.query.ray);
      bool is_done = false;
      if (!advance<N>(scene.tree, ray, flight.query, probe, flight.stack, flight.top,
                      flight.current, is_done)) {
        prefetch<N>(scene.tree, flight.current.subtree);
        continue;
      }
      deliver(flight.number, flight.query);
      if (next < count) {
        start(flight);
      } else {
        under_way[i--] = under_way[--flying];
      }
    }
  }
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "core/visits.h"

#include <cmath>
#include <cstring>

namespace kiwami {
namespace {

/// Rays that one task traces.
constexpr size_t kBlockSize = 1024;

/// Sums over the rays of one task: whole numbers, so that their order does not matter.
struct Sums {
  uint64_t hits, nodes, leaves, squared_leaves;
};

/// One ray with its counts.
class RayCounter {
 public:
  RayCounter(const CommittedScene& scene, bool any_hit) : scene_(scene), any_hit_(any_hit) {}

  /// Returns whether it hits.
  bool trace(const unsigned char* ray, kiwami_ray_visits& visits) const {
    TraversalCounters counters{};
    kiwami_hit hit;
    uint8_t occluded = 0;
    if (any_hit_) {
      const RayBatch batch = {ray, sizeof(kiwami_ray), &occluded, 1, 1};
      run(&TraversalKernels::any_hit_counted, &GeneralKernels::any_hit_counted, batch, counters);
    } else {
      const RayBatch batch = {ray, sizeof(kiwami_ray), reinterpret_cast<unsigned char*>(&hit),
                              sizeof(kiwami_hit), 1};
      run(&TraversalKernels::closest_hit_counted, &GeneralKernels::closest_hit_counted, batch,
          counters);
    }
    visits = {static_cast<uint32_t>(counters.node_visits),
              static_cast<uint32_t>(counters.leaf_visits)};
    return any_hit_ ? occluded != 0 : hit.primitive_id != KIWAMI_INVALID_ID;
  }

 private:
  void run(CountingKernel TraversalKernels::*plain, CountingGeneralKernel GeneralKernels::*general,
           const RayBatch& batch, TraversalCounters& counters) const {
    if (scene_.is_plain()) {
      (scene_.kernels().*plain)(scene_.view(), batch, counters);
    } else {
      (scene_.kernels().general.*general)(scene_.view(), batch, QueryOptions{}, counters);
    }
  }

  const CommittedScene& scene_;
  bool any_hit_;
};

/// The standard deviation of numbers, from their sum and the sum of their squares.
double deviation(uint64_t sum, uint64_t squared_sum, size_t count) {
  if (count == 0) return 0.0;
  const double mean = static_cast<double>(sum) / static_cast<double>(count);
  const double variance =
      static_cast<double>(squared_sum) / static_cast<double>(count) - mean * mean;
  return std::sqrt(variance > 0.0 ? variance : 0.0);
}

}  // namespace

kiwami_visits count_visits(const CommittedScene& scene, const kiwami_ray* rays, size_t ray_stride,
                           size_t count, bool any_hit, kiwami_ray_visits* each,
                           size_t each_stride) {
  const RayCounter counter(scene, any_hit);
  const auto* const source = reinterpret_cast<const unsigned char*>(rays);
  auto* const target = reinterpret_cast<unsigned char*>(each);
  Array<Sums> sums(scene.memory(), (count + kBlockSize - 1) / kBlockSize);
  scene.parallel().for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
    Sums block{};
    for (size_t i = begin; i < end; ++i) {
      kiwami_ray_visits visits;
      if (counter.trace(source + i * ray_stride, visits)) ++block.hits;
      block.nodes += visits.node_visits;
      block.leaves += visits.leaf_visits;
      block.squared_leaves += uint64_t{visits.leaf_visits} * visits.leaf_visits;
      if (target) std::memcpy(target + i * each_stride, &visits, sizeof visits);
    }
    sums[begin / kBlockSize] = block;
  });
  kiwami_visits all{};
  uint64_t squared_leaves = 0;
  all.ray_count = count;
  for (const Sums& block : sums) {
    all.hit_count += block.hits;
    all.node_visits += block.nodes;
    all.leaf_visits += block.leaves;
    squared_leaves += block.squared_leaves;
  }
  all.leaf_count_variability = deviation(all.leaf_visits, squared_leaves, count);
  return all;
}

}  // namespace kiwami

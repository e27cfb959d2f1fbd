// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kiwami/bench.h"
#include "measure/bench_rays.h"
#include "measure/library.h"
#include "measure/peer.h"

namespace kiwami::tools {

/// No build is measured more often than this.
constexpr uint32_t kMostBuilds = 3;

double per_triangle(uint64_t bytes, uint64_t triangles);

/// Throws UsageError when the device has not got as many threads as were asked for.
void check_threads(const Device& device, uint32_t threads);

RayVisits visits_of(const BuiltScene& scene, const BenchRays& rays);

/// Our side of a contest: rays and what a scene answered to them.
class OwnRun {
 public:
  /// Scene and rays must outlive the run.
  OwnRun(const BuiltScene& scene, const BenchRays& rays, BenchApi api, uint32_t threads);

  /// Forgets the answers, so that those of the last round cannot pass for new ones.
  void reset();
  void trace();
  uint64_t hash() const;
  /// As PeerRun::distance.
  float distance(size_t i) const;

 private:
  const BuiltScene& scene_;
  const BenchRays& rays_;
  BenchApi api_;
  uint32_t threads_;
  std::vector<kiwami_hit> hits_;
  std::vector<uint8_t> occluded_;
};

/// Peers are not watertight, and of triangles at the same place either may be met: up to this share
/// of the answers may contradict ours.
constexpr double kMostDisagreements = 0.01;

/// The answers that differ: a hit on one side alone, or distances further apart than rounding and
/// `least_distance` explain.
uint64_t count_disagreements(const OwnRun& own, const PeerRun& peer, size_t count,
                             float least_distance);

}  // namespace kiwami::tools

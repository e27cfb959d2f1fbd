// SPDX-License-Identifier: Apache-2.0
#include "kiwami/own_run.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "kiwami/options.h"
#include "measure/contest.h"
#include "measure/parallel_blocks.h"

namespace kiwami::tools {
namespace {

constexpr size_t kRaysPerBlock = 4096;

}  // namespace

double per_triangle(uint64_t bytes, uint64_t triangles) {
  return static_cast<double>(bytes) / static_cast<double>(std::max<uint64_t>(triangles, 1));
}

void check_threads(const Device& device, uint32_t threads) {
  if (device.info().thread_count == threads) return;
  throw UsageError("--threads is " + std::to_string(threads) +
                   ", but this machine has processors for " +
                   std::to_string(device.info().thread_count));
}

RayVisits visits_of(const BuiltScene& scene, const BenchRays& rays) {
  const kiwami_visits visits = scene.visits(rays.set.rays, rays.any_hit);
  const auto count = static_cast<double>(std::max<uint64_t>(visits.ray_count, 1));
  return {static_cast<double>(visits.node_visits) / count,
          static_cast<double>(visits.leaf_visits) / count, visits.leaf_count_variability};
}

OwnRun::OwnRun(const BuiltScene& scene, const BenchRays& rays, BenchApi api, uint32_t threads)
    : scene_(scene),
      rays_(rays),
      api_(api),
      threads_(threads),
      hits_(rays.any_hit ? 0 : rays.set.rays.size()),
      occluded_(rays.any_hit ? rays.set.rays.size() : 0) {}

void OwnRun::reset() {
  if (!hits_.empty()) std::memset(hits_.data(), 0xCD, hits_.size() * sizeof hits_[0]);
  std::fill(occluded_.begin(), occluded_.end(), uint8_t{0xCD});
}

void OwnRun::trace() {
  const std::span<const kiwami_ray> rays = rays_.set.rays;
  if (api_ == BenchApi::kBatch) {
    if (rays_.any_hit) {
      scene_.any_hits(rays, occluded_);
    } else {
      scene_.own_closest_hits(rays, hits_);
    }
    return;
  }
  parallel_blocks(threads_, rays.size(), kRaysPerBlock, [&](size_t first, size_t last) {
    const auto block = rays.subspan(first, last - first);
    if (rays_.any_hit) {
      scene_.any_hits_singly(block, std::span(occluded_).subspan(first, block.size()));
    } else {
      scene_.closest_hits_singly(block, std::span(hits_).subspan(first, block.size()));
    }
  });
}

uint64_t OwnRun::hash() const {
  return rays_.any_hit ? hash_bytes(std::as_bytes(std::span(occluded_))) : hash_hits(hits_);
}

float OwnRun::distance(size_t i) const {
  if (!rays_.any_hit) return hits_[i].t;
  return occluded_[i] != 0 ? 0.0f : std::numeric_limits<float>::infinity();
}

uint64_t count_disagreements(const OwnRun& own, const PeerRun& peer, size_t count,
                             float least_distance) {
  uint64_t disagreements = 0;
  for (size_t i = 0; i < count; ++i) {
    const float a = own.distance(i);
    const float b = peer.distance(i);
    // Written so that an infinite distance agrees with another one alone.
    const bool agree = a == b || std::abs(a - b) <= 1e-3f * std::min(a, b) + least_distance;
    if (!agree) ++disagreements;
  }
  return disagreements;
}

}  // namespace kiwami::tools

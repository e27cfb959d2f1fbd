// SPDX-License-Identifier: Apache-2.0
#include "builders/nearest_cluster.h"

#include <bit>

namespace kiwami {
namespace {

constexpr size_t kBlockSize = 2048;

size_t buckets_of(size_t clusters, size_t bucket_size) {
  return std::bit_ceil((clusters + bucket_size - 1) / bucket_size);
}

}  // namespace

NearestClusterTree::NearestClusterTree(size_t most_clusters, Memory& memory)
    : nodes_(memory, 2 * buckets_of(most_clusters, kBucketSize)) {}

NearestClusterTree::Node NearestClusterTree::nothing() {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  return {{-infinity, -infinity, -infinity}, ~0u, {infinity, infinity, infinity}, 0};
}

void NearestClusterTree::extend(Node& node, const Node& other) {
  for (int axis = 0; axis < 3; ++axis) {
    node.latest_lower[axis] = max_keep(node.latest_lower[axis], other.latest_lower[axis]);
    node.earliest_upper[axis] = min_keep(node.earliest_upper[axis], other.earliest_upper[axis]);
  }
  node.least_count = std::min(node.least_count, other.least_count);
}

NearestClusterTree::Node NearestClusterTree::bucket(uint32_t index) const {
  Node node = nothing();
  const uint32_t begin = std::min(index * kBucketSize, count_);
  const uint32_t end = std::min(begin + kBucketSize, count_);
  for (uint32_t i = begin; i < end; ++i) {
    extend(node, {clusters_[i].lower, clusters_[i].count, clusters_[i].upper, 0});
  }
  return node;
}

void NearestClusterTree::assign(const Cluster* clusters, uint32_t count, const Parallel& parallel) {
  clusters_ = clusters;
  count_ = count;
  bucket_count_ = static_cast<uint32_t>(buckets_of(count, kBucketSize));
  parallel.for_blocks(bucket_count_, kBlockSize, [this](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      nodes_[bucket_count_ + i] = bucket(static_cast<uint32_t>(i));
    }
  });
  for (uint32_t level = bucket_count_ / 2; level > 0; level /= 2) {
    parallel.for_blocks(level, kBlockSize, [&](size_t begin, size_t end) {
      for (size_t i = level + begin; i < level + end; ++i) {
        nodes_[i] = nodes_[2 * i];
        extend(nodes_[i], nodes_[2 * i + 1]);
      }
    });
  }
}

/// No cluster below a node, `height` levels above the buckets, makes a lesser pair. Rounding keeps
/// the order of floats, so this holds for the computed areas, too.
PairKey NearestClusterTree::least_key(const Cluster& cluster, uint32_t node,
                                      uint32_t height) const {
  const Node& bound = nodes_[node];
  if (bound.least_count == ~0u) return PairKey::farthest();
  VectorBounds both = cluster.bounds();
  const float* words = reinterpret_cast<const float*>(&bound);
  both.extend({simde_mm_loadu_ps(words), simde_mm_loadu_ps(words + 4)});
  const uint32_t first = ((node << height) - bucket_count_) * kBucketSize;
  const uint32_t last = std::min(first + (kBucketSize << height), count_) - 1;
  // The bits that all places below have in common.
  const uint32_t place = clusters_[first].place;
  const uint32_t varying = static_cast<uint32_t>(std::bit_width(place ^ clusters_[last].place));
  const auto apart = static_cast<uint32_t>(uint64_t{cluster.place ^ place} >> varying << varying);
  return {both.half_area(), cluster.count + bound.least_count, apart, 0};
}

void NearestClusterTree::search_bucket(Search& search, uint32_t bucket) const {
  const uint32_t begin = bucket * kBucketSize;
  const uint32_t end = std::min(begin + kBucketSize, count_);
  for (uint32_t i = begin; i < end; ++i) {
    if (i == search.index) continue;
    const PairKey key = PairKey::of(search.cluster, clusters_[i]);
    if (!(key < search.best)) continue;
    search.best = key;
    search.nearest = i;
  }
}

void NearestClusterTree::search_below(Search& search, uint32_t node, uint32_t height) const {
  struct Open {
    uint32_t node, height;
    PairKey least;
  };
  Open open[33];  // one a level, and one more
  uint32_t size = 0;
  open[size++] = {node, height, least_key(search.cluster, node, height)};
  while (size != 0) {
    const Open top = open[--size];
    if (!(top.least < search.best)) continue;
    if (top.height == 0) {
      search_bucket(search, top.node - bucket_count_);
      continue;
    }
    const uint32_t left = 2 * top.node, below = top.height - 1;
    Open near = {left, below, least_key(search.cluster, left, below)};
    Open far = {left + 1, below, least_key(search.cluster, left + 1, below)};
    if (far.least < near.least) std::swap(near, far);
    open[size++] = far;
    open[size++] = near;
  }
}

uint32_t NearestClusterTree::nearest_of(uint32_t index) const {
  Search search{clusters_[index], index, PairKey::farthest(), index};
  uint32_t node = bucket_count_ + index / kBucketSize;
  search_bucket(search, index / kBucketSize);
  for (uint32_t height = 0; node > 1; node /= 2, ++height) {
    search_below(search, node ^ 1, height);
  }
  return search.nearest;
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "builders/cluster_matrix.h"

#include <utility>

namespace kiwami {

uint32_t ClusterMatrix::combine(Cluster* clusters, uint32_t count, uint32_t target,
                                BinaryBvh& bvh) {
  if (count <= target) return count;
  clusters_ = clusters;
  count_ = count;
  reserve(count);
  fill();
  for (uint32_t i = 0; i < count_; ++i) find_nearest(i);
  while (count_ > target) {
    const uint32_t i = least_row(), j = nearest_[i];
    join_rows(std::min(i, j), std::max(i, j), bvh);
  }
  return count_;
}

void ClusterMatrix::reserve(uint32_t count) {
  stride_ = count;
  if (nearest_.size() >= count) return;
  // The old memory goes first.
  distances_ = Array<float>();
  distances_ = Array<float>(memory_, size_t{count} * count);
  nearest_ = Array<uint32_t>(memory_, count);
  keys_ = Array<PairKey>(memory_, count);
}

void ClusterMatrix::fill() {
  for (uint32_t i = 0; i < count_; ++i) {
    row(i)[i] = std::numeric_limits<float>::infinity();
    for (uint32_t j = 0; j < i; ++j) {
      row(i)[j] = row(j)[i] = PairKey::area_of_both(clusters_[i], clusters_[j]);
    }
  }
}

void ClusterMatrix::find_nearest(uint32_t i) {
  const float* distances = row(i);
  PairKey best = PairKey::farthest();
  for (uint32_t j = 0; j < count_; ++j) {
    if (!(distances[j] <= best.area) || j == i) continue;
    const PairKey key = PairKey::of(clusters_[i], clusters_[j], distances[j]);
    if (!(key < best)) continue;
    best = key;
    nearest_[i] = j;
  }
  keys_[i] = best;
}

uint32_t ClusterMatrix::least_row() const {
  uint32_t least = 0;
  for (uint32_t i = 1; i < count_; ++i) {
    if (keys_[i] < keys_[least]) least = i;
  }
  return least;
}

/// The pair moves to row i, i < j, and the last row to j.
void ClusterMatrix::join_rows(uint32_t i, uint32_t j, BinaryBvh& bvh) {
  const uint32_t last = --count_;
  clusters_[i] = join(clusters_[i], clusters_[j], bvh);
  clusters_[j] = clusters_[last];
  nearest_[j] = nearest_[last];
  keys_[j] = keys_[last];
  for (uint32_t k = 0; k < count_; ++k) row(j)[k] = row(k)[j] = row(last)[k];
  row(j)[j] = std::numeric_limits<float>::infinity();
  for (uint32_t k = 0; k < count_; ++k) {
    if (k == i) continue;
    row(i)[k] = row(k)[i] = PairKey::area_of_both(clusters_[i], clusters_[k]);
  }
  find_nearest(i);
  // A row whose nearest was neither of the two keeps it: the joined one is not nearer to it.
  for (uint32_t k = 0; k < count_; ++k) {
    if (k == i) continue;
    if (nearest_[k] == i || nearest_[k] == j) {
      find_nearest(k);
    } else if (nearest_[k] == last) {
      nearest_[k] = j;
    }
  }
}

}  // namespace kiwami

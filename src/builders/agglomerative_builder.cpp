// SPDX-License-Identifier: Apache-2.0
#include "builders/agglomerative_builder.h"

#include "builders/cluster_matrix.h"
#include "builders/nearest_cluster.h"
#include "bvh/tree_edit.h"

namespace kiwami {
namespace {

/// Clusters that one task searches for.
constexpr size_t kBlockSize = 256;
/// A cluster whose nearest one has to be searched for.
constexpr uint32_t kUnknown = ~0u;

/// The rounds of joining. Clusters stand in the order of their places.
class GreedyClustering {
 public:
  GreedyClustering(Array<Cluster> clusters, BinaryBvh& bvh, Memory& memory,
                   const Parallel& parallel)
      : bvh_(bvh),
        parallel_(parallel),
        clusters_(std::move(clusters)),
        nearest_(memory, clusters_.size()),
        moved_to_(memory, clusters_.size()),
        tree_(clusters_.size(), memory),
        count_(static_cast<uint32_t>(clusters_.size())) {
    std::fill(nearest_.begin(), nearest_.end(), kUnknown);
  }

  void run(uint32_t matrix_size, Memory& memory) {
    while (count_ > std::max(matrix_size, 1u)) {
      tree_.assign(clusters_.data(), count_, parallel_);
      parallel_.for_blocks(count_, kBlockSize, [this](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          if (nearest_[i] == kUnknown) nearest_[i] = tree_.nearest_of(static_cast<uint32_t>(i));
        }
      });
      join_mutual_pairs();
    }
    ClusterMatrix(memory).combine(clusters_.data(), count_, 1, bvh_);
    bvh_.nodes[0] = clusters_[0].node();
  }

 private:
  /// The pair of least key is mutual, so there is one at least.
  void join_mutual_pairs() {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count_; ++i) {
      const uint32_t other = nearest_[i];
      if (nearest_[other] != i) {
        moved_to_[i] = kept;
        clusters_[kept++] = clusters_[i];
      } else if (i < other) {
        moved_to_[i] = kUnknown;
        clusters_[kept++] = join(clusters_[i], clusters_[other], bvh_);
      } else {
        moved_to_[i] = kUnknown;
      }
    }
    // What was nearest to a cluster stays so unless it has joined: no joined one is nearer.
    uint32_t next = 0;
    for (uint32_t i = 0; i < count_; ++i) {
      const bool joins = moved_to_[i] == kUnknown;
      const uint32_t other = nearest_[i];
      if (joins && other < i) continue;
      nearest_[next++] = joins ? kUnknown : moved_to_[other];
    }
    count_ = kept;
  }

  BinaryBvh& bvh_;
  const Parallel& parallel_;
  Array<Cluster> clusters_;
  Array<uint32_t> nearest_;
  Array<uint32_t> moved_to_;
  NearestClusterTree tree_;
  uint32_t count_;
};

}  // namespace

BinaryBvh AgglomerativeBuilder::build(Array<BuildPrimitive> primitives, const Config& config,
                                      Memory& memory, const Parallel& parallel) {
  if (primitives.empty()) return {};
  BinaryBvh bvh;
  {
    Array<Cluster> clusters;
    MortonOrder order = sort_by_morton_code(std::move(primitives), memory, parallel);
    order.codes = {};
    bvh = separate(std::move(order.primitives), clusters, memory);
    GreedyClustering(std::move(clusters), bvh, memory, parallel).run(config.matrix_size, memory);
  }
  relabel_depth_first(bvh, memory);
  limit_depth(bvh, memory);
  return bvh;
}

}  // namespace kiwami

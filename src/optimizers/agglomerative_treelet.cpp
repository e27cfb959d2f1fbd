// SPDX-License-Identifier: Apache-2.0
#include "optimizers/agglomerative_treelet.h"

namespace kiwami {
namespace {

class AgglomerativeShaper {
 public:
  explicit AgglomerativeShaper(const TreeletConfig& config) : costs_(config) {}

  bool shape(const TreeletCluster* leaves, uint32_t count, double cost, Join* joins) const {
    Clusters clusters;
    for (uint32_t i = 0; i < count; ++i) clusters.add(leaves[i], i);
    for (uint32_t made = 0; made + 1 < count; ++made) {
      joins[made] = clusters.join_nearest(costs_, count + made);
    }
    // What rounding alone could gain is left alone.
    return clusters.cost_of_first() < cost * (1.0 - 1e-9);
  }

 private:
  /// What is left to join, with the area around each pair.
  class Clusters {
   public:
    void add(const TreeletCluster& cluster, uint32_t number) {
      clusters_[size_] = cluster;
      numbers_[size_] = number;
      measure(size_++);
    }

    Join join_nearest(const ClusterCosts& costs, uint32_t number) {
      uint32_t high = 1, low = 0;
      for (uint32_t i = 1; i < size_; ++i) {
        for (uint32_t j = 0; j < i; ++j) {
          if (areas_[i][j] >= areas_[high][low]) continue;
          high = i;
          low = j;
        }
      }
      const Join join = {numbers_[low], numbers_[high]};
      clusters_[low] = costs.joined(clusters_[low], clusters_[high]);
      numbers_[low] = number;
      // The last one fills the gap.
      --size_;
      if (high != size_) {
        clusters_[high] = clusters_[size_];
        numbers_[high] = numbers_[size_];
        for (uint32_t i = 0; i < size_; ++i) set(high, i, get(size_, i));
      }
      measure(low);
      return join;
    }

    double cost_of_first() const { return clusters_[0].cost; }

   private:
    void measure(uint32_t cluster) {
      for (uint32_t i = 0; i < size_; ++i) {
        Bounds both = clusters_[i].bounds;
        both.extend(clusters_[cluster].bounds);
        set(cluster, i, both.half_area());
      }
    }

    float get(uint32_t i, uint32_t j) const { return i > j ? areas_[i][j] : areas_[j][i]; }
    void set(uint32_t i, uint32_t j, float area) { (i > j ? areas_[i][j] : areas_[j][i]) = area; }

    uint32_t size_ = 0;
    TreeletCluster clusters_[kMaxTreeletLeaves];
    uint32_t numbers_[kMaxTreeletLeaves];
    float areas_[kMaxTreeletLeaves][kMaxTreeletLeaves];  ///< [i][j] with j < i
  };

  ClusterCosts costs_;
};

}  // namespace

void optimize_by_agglomerative_treelets(BinaryBvh& bvh, const TreeletConfig& config, Memory& memory,
                                        const Parallel& parallel) {
  if (bvh.nodes.empty()) return;
  {
    const AgglomerativeShaper shaper(config);
    TreeletPass(bvh, config, shaper, memory).run(parallel);
  }
  relabel_depth_first(bvh, memory);
  limit_depth(bvh, memory);
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/clusters.h"

namespace kiwami {

/// A search tree over clusters that stand in the order of their places: buckets of neighbours, and
/// above them pairs. Nodes are numbered as in a heap: node i has the children 2 i and 2 i + 1.
class NearestClusterTree {
 public:
  NearestClusterTree(size_t most_clusters, Memory& memory);

  /// Takes the clusters in; the old ones are forgotten.
  void assign(const Cluster* clusters, uint32_t count, const Parallel& parallel);

  /// The cluster whose pair with this one has the least key. There are two clusters or more.
  uint32_t nearest_of(uint32_t cluster) const;

 private:
  static constexpr uint32_t kBucketSize = 4;

  /// What all clusters below have in common: on each axis none begins after latest_lower or ends
  /// before earliest_upper, and none has fewer primitives. The box that reaches from one to the
  /// other, however these lie, makes the box around any of them and a third one no smaller.
  struct Node {
    Vec3f latest_lower;
    uint32_t least_count;
    Vec3f earliest_upper;
    uint32_t reserved;
  };

  struct Search {
    const Cluster& cluster;
    uint32_t index;
    PairKey best;
    uint32_t nearest;
  };

  static Node nothing();
  static void extend(Node& node, const Node& other);
  Node bucket(uint32_t index) const;
  PairKey least_key(const Cluster& cluster, uint32_t node, uint32_t height) const;
  void search_bucket(Search& search, uint32_t bucket) const;
  void search_below(Search& search, uint32_t node, uint32_t height) const;

  const Cluster* clusters_ = nullptr;
  uint32_t count_ = 0;
  uint32_t bucket_count_ = 1;  ///< a power of two
  Array<Node> nodes_;
};

}  // namespace kiwami

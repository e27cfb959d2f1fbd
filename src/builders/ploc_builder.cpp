// SPDX-License-Identifier: Apache-2.0
#include "builders/ploc_builder.h"

#include <algorithm>
#include <utility>

#include "bvh/tree_edit.h"

namespace kiwami {
namespace {

constexpr size_t kBlockSize = 2048;

/// The rounds of joining. A cluster is the node that it will be; when it joins another one, both
/// are written to the pair of slots that is free next.
class Clustering {
 public:
  Clustering(Array<BinaryNode> leaves, uint32_t radius, BinaryBvh& bvh, Memory& memory,
             const Parallel& parallel)
      : bvh_(bvh),
        radius_(radius),
        count_(leaves.size()),
        parallel_(parallel),
        clusters_(std::move(leaves)),
        joined_(memory, count_),
        nearest_(memory, count_),
        of_blocks_(memory, (count_ + kBlockSize - 1) / kBlockSize) {}

  void run() {
    while (count_ > 1) {
      parallel_.for_blocks(count_, kBlockSize,
                           [this](size_t begin, size_t end) { find_nearest(begin, end); });
      join();
    }
    bvh_.nodes[0] = clusters_[0];
  }

 private:
  /// Clusters and pairs of one block: how many, then where its first ones go.
  struct Output {
    uint32_t cluster, pair;
  };

  void find_nearest(size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) nearest_[i] = nearest_of(i);
  }

  /// The least (area of the box around both, exclusive or of the places): the same number for both
  /// of a pair, so the least of all pairs is mutual and every round joins one at least.
  uint32_t nearest_of(size_t i) const {
    const size_t first = i > radius_ ? i - radius_ : 0;
    const size_t last = std::min(i + radius_, count_ - 1);
    const Bounds own = clusters_[i].bounds;
    float least = std::numeric_limits<float>::infinity();
    size_t best = first == i ? i + 1 : first;
    for (size_t j = first; j <= last; ++j) {
      if (j == i) continue;
      Bounds both = own;
      both.extend(clusters_[j].bounds);
      const float area = both.half_area();
      if (area < least || (area == least && (i ^ j) < (i ^ best))) {
        least = area;
        best = j;
      }
    }
    return static_cast<uint32_t>(best);
  }

  bool is_mutual(size_t i) const { return nearest_[nearest_[i]] == i; }

  void join() {
    parallel_.for_blocks(count_, kBlockSize, [this](size_t begin, size_t end) {
      Output output = {0, 0};
      for (size_t i = begin; i < end; ++i) {
        const bool joins = is_mutual(i);
        output.cluster += !joins || i < nearest_[i];
        output.pair += joins && i < nearest_[i];
      }
      of_blocks_[begin / kBlockSize] = output;
    });
    Output next = {0, pairs_};
    for (size_t block = 0; block * kBlockSize < count_; ++block) {
      const Output of_block = std::exchange(of_blocks_[block], next);
      next = {next.cluster + of_block.cluster, next.pair + of_block.pair};
    }
    parallel_.for_blocks(count_, kBlockSize,
                         [this](size_t begin, size_t end) { write(begin, end); });
    std::swap(clusters_, joined_);
    count_ = next.cluster;
    pairs_ = next.pair;
  }

  void write(size_t begin, size_t end) {
    Output next = of_blocks_[begin / kBlockSize];
    for (size_t i = begin; i < end; ++i) {
      if (!is_mutual(i)) {
        joined_[next.cluster++] = clusters_[i];
        continue;
      }
      const size_t other = nearest_[i];
      if (other < i) continue;
      const uint32_t first = 2 * next.pair++ + 1;
      bvh_.nodes[first] = clusters_[i];
      bvh_.nodes[first + 1] = clusters_[other];
      Bounds both = clusters_[i].bounds;
      both.extend(clusters_[other].bounds);
      joined_[next.cluster++] = {both, first, 0};
    }
  }

  BinaryBvh& bvh_;
  size_t radius_;
  size_t count_;
  const Parallel& parallel_;
  Array<BinaryNode> clusters_, joined_;
  Array<uint32_t> nearest_;
  Array<Output> of_blocks_;
  uint32_t pairs_ = 0;
};

}  // namespace

BinaryBvh PlocBuilder::build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                             const Parallel& parallel) {
  if (primitives.empty()) return {};
  const size_t count = primitives.size();
  BinaryBvh bvh{{}, Array<uint32_t>(memory, count)};
  Array<BinaryNode> leaves;
  {
    const MortonOrder order =
        sort_by_morton_code(std::move(primitives), memory, parallel, config.curve_code);
    leaves = Array<BinaryNode>(memory, count);
    for (uint32_t i = 0; i < count; ++i) {
      bvh.primitive_ids[i] = order.primitives[i].id;
      leaves[i] = {order.primitives[i].bounds(), i, 1};
    }
  }
  bvh.nodes = Array<BinaryNode>(memory, 2 * count - 1);
  Clustering(std::move(leaves), config.radius, bvh, memory, parallel).run();
  relabel_depth_first(bvh, memory);
  limit_depth(bvh, memory);
  return bvh;
}

}  // namespace kiwami

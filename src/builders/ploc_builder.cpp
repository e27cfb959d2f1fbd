// SPDX-License-Identifier: Apache-2.0
#include "builders/ploc_builder.h"

#include <algorithm>
#include <utility>

#include "builders/nearest_places.h"
#include "bvh/tree_edit.h"

namespace kiwami {
namespace {

constexpr size_t kBlockSize = 2048;
/// Where boxes lie in each other, it may be one pair that joins in a round. When so many times the
/// first number of clusters have been looked at, neighbours join instead. Otherwise a third and
/// more of the clusters join in each round.
constexpr uint64_t kMostWork = 32;

/// The rounds of joining. A cluster is the node that it will be, but that it holds the number of its
/// primitives in any case, and a leaf the id of its own; when it joins another one, both are written
/// to the pair of slots that is free next.
class Clustering {
 public:
  Clustering(Array<BinaryNode> leaves, uint32_t radius, Array<BinaryNode>& nodes, Memory& memory,
             const Parallel& parallel)
      : nodes_(nodes),
        memory_(memory),
        radius_(radius),
        count_(leaves.size()),
        parallel_(parallel),
        clusters_(std::move(leaves)),
        joined_(memory, count_),
        nearest_(memory, count_),
        of_blocks_(memory, (count_ + kBlockSize - 1) / kBlockSize) {}

  void run() {
    for (uint64_t work = kMostWork * count_; count_ > 1; work -= std::min<uint64_t>(work, count_)) {
      const bool looks = work >= count_;
      parallel_.for_blocks(count_, kBlockSize, [&](size_t begin, size_t end) {
        if (looks) {
          find_nearest(begin, end);
        } else {
          pair_neighbours(begin, end);
        }
      });
      join();
    }
    nodes_[0] = clusters_[0];
  }

 private:
  /// Clusters and pairs of one block: how many, then where its first ones go.
  struct Output {
    uint32_t cluster, pair;
  };

  void find_nearest(size_t begin, size_t end) {
    const size_t first = begin - std::min<size_t>(begin, radius_);
    const size_t last = std::min(end + radius_, count_);
    NearestPlaces places(memory_, static_cast<uint32_t>(last - first),
                         static_cast<uint32_t>(first));
    for (size_t i = first; i < last; ++i) {
      const Bounds& box = clusters_[i].bounds;
      places.set(static_cast<uint32_t>(i - first), box.lower, box.upper);
    }
    places.find(static_cast<uint32_t>(last - first), radius_);
    for (size_t i = begin; i < end; ++i) {
      nearest_[i] = static_cast<uint32_t>(first + places.nearest(static_cast<uint32_t>(i - first)));
    }
  }

  void pair_neighbours(size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      nearest_[i] = static_cast<uint32_t>(std::min(i ^ 1, count_ - 1));
    }
  }

  bool is_mutual(size_t i) const { return nearest_[i] != i && nearest_[nearest_[i]] == i; }

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
      nodes_[first] = clusters_[i];
      nodes_[first + 1] = clusters_[other];
      Bounds both = clusters_[i].bounds;
      both.extend(clusters_[other].bounds);
      joined_[next.cluster++] = {both, first, clusters_[i].count + clusters_[other].count};
    }
  }

  Array<BinaryNode>& nodes_;
  Memory& memory_;
  uint32_t radius_;
  size_t count_;
  const Parallel& parallel_;
  Array<BinaryNode> clusters_, joined_;
  Array<uint32_t> nearest_;
  Array<Output> of_blocks_;
  uint32_t pairs_ = 0;
};

/// Numbers the nodes that clustering wrote as relabel_depth_first does. The numbers of primitives
/// tell where each subtree goes, so threads copy different ones, and to another array: following
/// cycles through one waits for memory at each step.
class DepthFirstCopy {
 public:
  DepthFirstCopy(const Array<BinaryNode>& from, BinaryBvh& to, Memory& memory)
      : from_(from), to_(to), memory_(memory) {}

  void run(const Parallel& parallel) {
    GrowingArray<Subtree> open(memory_), parts(memory_);
    open.push_back({0, 0, 1, 0});
    while (!open.empty()) {
      const Subtree top = open.back();
      open.pop_back();
      if (from_[top.from].count <= kBlockSize) {
        parts.push_back(top);
      } else {
        place(top, open);
      }
    }
    parallel.for_each(parts.size(), [&](size_t i) {
      GrowingArray<Subtree> below(memory_);
      below.push_back(parts[i]);
      while (!below.empty()) {
        const Subtree top = below.back();
        below.pop_back();
        place(top, below);
      }
    });
  }

 private:
  struct Subtree {
    uint32_t from, to;  ///< its root
    uint32_t next;      ///< where the nodes below the root begin
    uint32_t id;        ///< where its primitives begin
  };

  /// Copies the root, and leaves what is below it in `open`, what stands left on top.
  void place(const Subtree& subtree, GrowingArray<Subtree>& open) {
    const BinaryNode& node = from_[subtree.from];
    if (node.count == 1) {
      to_.nodes[subtree.to] = {node.bounds, subtree.id, 1};
      to_.primitive_ids[subtree.id] = node.first;
      return;
    }
    const uint32_t first = node.first, next = subtree.next, left = from_[first].count;
    to_.nodes[subtree.to] = {node.bounds, next, 0};
    open.push_back({first + 1, next + 1, next + 2 * left, subtree.id + left});
    open.push_back({first, next, next + 2, subtree.id});
  }

  const Array<BinaryNode>& from_;
  BinaryBvh& to_;
  Memory& memory_;
};

}  // namespace

BinaryBvh PlocBuilder::build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                             const Parallel& parallel) {
  if (primitives.empty()) return {};
  const size_t count = primitives.size();
  Array<BinaryNode> leaves;
  {
    const MortonOrder order =
        sort_by_morton_code(std::move(primitives), memory, parallel, config.curve_code);
    leaves = Array<BinaryNode>(memory, count);
    parallel.for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        leaves[i] = {order.primitives[i].bounds(), order.primitives[i].id, 1};
      }
    });
  }
  Array<BinaryNode> nodes(memory, 2 * count - 1);
  Clustering(std::move(leaves), config.radius, nodes, memory, parallel).run();
  BinaryBvh bvh{Array<BinaryNode>(memory, nodes.size()), Array<uint32_t>(memory, count)};
  DepthFirstCopy(nodes, bvh, memory).run(parallel);
  nodes = {};
  limit_depth(bvh, memory);
  return bvh;
}

}  // namespace kiwami

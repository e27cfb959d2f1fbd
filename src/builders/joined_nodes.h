// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Nodes of a tree that is built in parts: those near the root, and below some of them subtrees,
/// each by one thread in nodes numbered from 0. Owns copies of the parts until they are joined.
class JoinedNodes {
 public:
  JoinedNodes(Memory& memory, const Parallel& parallel)
      : memory_(memory), parallel_(parallel), top_(memory) {}
  ~JoinedNodes();
  JoinedNodes(const JoinedNodes&) = delete;
  JoinedNodes& operator=(const JoinedNodes&) = delete;

  /// Adds a node near the root; returns its number.
  uint32_t add_top() {
    top_.push_back(BinaryNode{});
    return static_cast<uint32_t>(top_.size() - 1);
  }
  BinaryNode& top(uint32_t node) { return top_[node]; }

  /// To be called once, before subtrees are kept.
  void set_subtree_count(size_t count);

  /// Copies what stands below the top node root; nodes and leaves are numbered from 0 there, and
  /// root too if it is a leaf. Subtrees stand in the joined array in the order of index. May be
  /// called by several threads for different indices.
  void keep(size_t index, uint32_t root, const BinaryNode* nodes, uint32_t count);

  /// All nodes in one array without gaps, those near the root first. first_id: where the primitive
  /// ids of each subtree begin. Frees the parts.
  template <typename FirstId>
  Array<BinaryNode> join(FirstId&& first_id) {
    number_parts();
    Array<BinaryNode> nodes(memory_, node_count_);
    for (size_t i = 0; i < top_.size(); ++i) nodes[i] = top_[i];
    parallel_.for_each(parts_.size(), [&](size_t i) { place(parts_[i], first_id(i), nodes); });
    return nodes;
  }

 private:
  struct Part {
    BinaryNode* nodes;
    uint32_t count;
    uint32_t root;   ///< among the top nodes
    uint32_t first;  ///< of the joined nodes
  };

  void number_parts();
  void place(Part& part, uint32_t first_id, Array<BinaryNode>& nodes);
  void free_part(Part& part);

  Memory& memory_;
  const Parallel& parallel_;
  GrowingArray<BinaryNode> top_;
  Array<Part> parts_;
  uint32_t node_count_ = 0;
};

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// What one thread built below a node near the root: nodes and leaves are numbered from 0, and the
/// root too if it is a leaf.
struct BuiltSubtree {
  uint32_t root;  ///< among the nodes near the root
  const BinaryNode* nodes;
  uint32_t node_count;
  uint32_t first_id;  ///< of its primitives, among all
  uint32_t id_count;
  uint32_t* ids;  ///< of its primitives, where they stay
};

/// Where a tree goes that is built in parts: the nodes near the root, and below some of them
/// subtrees.
class TreeParts {
 public:
  explicit TreeParts(Memory& memory) : top_(memory) {}
  virtual ~TreeParts() = default;
  TreeParts(const TreeParts&) = delete;
  TreeParts& operator=(const TreeParts&) = delete;

  /// Adds a node near the root; returns its number.
  uint32_t add_top() {
    top_.push_back(BinaryNode{});
    return static_cast<uint32_t>(top_.size() - 1);
  }
  BinaryNode& top(uint32_t node) { return top_[node]; }

  /// Called once, before subtrees are kept.
  virtual void set_subtree_count(size_t count) = 0;
  /// Takes what it needs of a subtree; they are numbered in the order of their primitives. May be
  /// called by several threads for different numbers.
  virtual void keep(size_t index, const BuiltSubtree& subtree) = 0;

 protected:
  GrowingArray<BinaryNode> top_;
};

/// The parts of a binary tree. Owns copies of them until they are joined.
class JoinedNodes : public TreeParts {
 public:
  JoinedNodes(Memory& memory, const Parallel& parallel)
      : TreeParts(memory), memory_(memory), parallel_(parallel) {}
  ~JoinedNodes() override;

  void set_subtree_count(size_t count) override;
  void keep(size_t index, const BuiltSubtree& subtree) override {
    keep(index, subtree.root, subtree.nodes, subtree.node_count);
    parts_[index].first_id = subtree.first_id;
  }

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

  /// The same where each subtree was kept with its first_id.
  Array<BinaryNode> join() {
    return join([this](size_t i) { return parts_[i].first_id; });
  }

 private:
  struct Part {
    BinaryNode* nodes;
    uint32_t count;
    uint32_t root;      ///< among the top nodes
    uint32_t first;     ///< of the joined nodes
    uint32_t first_id;  ///< where it was told
  };

  void number_parts();
  void place(Part& part, uint32_t first_id, Array<BinaryNode>& nodes);
  void free_part(Part& part);

  Memory& memory_;
  const Parallel& parallel_;
  Array<Part> parts_;
  uint32_t node_count_ = 0;
};

}  // namespace kiwami

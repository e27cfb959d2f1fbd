// SPDX-License-Identifier: Apache-2.0
// The walk that all contractions share: from what becomes the children of each node to the tree.
#pragma once

#include <algorithm>

#include "core/error.h"
#include "wide/chosen_slots.h"
#include "wide/contraction.h"

namespace kiwami {

/// Sizes of leaves are kept in bytes.
constexpr uint32_t kMaxLeafSize = 255;

/// The contraction of one subtree (or of the nodes near the root). Chooser has
///   uint32_t choose(uint32_t binary_node, ChosenSlot* chosen) const
/// which gives the children of a node, from left to right, and returns their number.
template <typename Chooser>
class ContractionWalk {
 public:
  /// A contracted node that has its index but not yet its slots.
  struct Pending {
    uint32_t node, binary_node, depth;
  };

  ContractionWalk(const BinaryBvh& binary, const Chooser& chooser, Memory& memory)
      : nodes_(memory), slots_(memory), leaf_sizes_(memory), binary_(binary), chooser_(chooser) {}

  /// Adds the root as slot 0; returns what is to be expanded where it is no leaf.
  Pending add_root(ChosenSlot root) {
    add_slot(root);
    return {0, root.binary_node, 1};
  }

  /// Contracts all below a binary node, which becomes node 0; for which no slot is added.
  void contract_subtree(uint32_t binary_node, uint32_t depth) {
    add_node(binary_node);
    expand_all({0, binary_node, depth});
  }

  /// Makes the slots of a node and the nodes of its inner children; returns its first slot.
  uint32_t expand(const Pending& pending) {
    result_.depth = std::max(result_.depth, pending.depth);
    ChosenSlot chosen[kMaxContractionWidth];
    const uint32_t count = chooser_.choose(pending.binary_node, chosen);
    const uint32_t first_slot = static_cast<uint32_t>(slots_.size());
    nodes_[pending.node] = {first_slot, count};
    for (uint32_t i = 0; i < count; ++i) add_slot(chosen[i]);
    return first_slot;
  }

  const GrowingArray<ContractedSlot>& slots() const { return slots_; }
  const GrowingArray<ContractedNode>& nodes() const { return nodes_; }

  Contraction take() {
    result_.nodes = nodes_.take();
    result_.slots = slots_.take();
    result_.leaf_sizes = leaf_sizes_.take();
    return std::move(result_);
  }

 private:
  void expand_all(const Pending& pending) {
    const uint32_t first_slot = expand(pending);
    const uint32_t end = first_slot + nodes_[pending.node].slot_count;
    for (uint32_t i = first_slot; i < end; ++i) {
      const ContractedSlot slot = slots_[i];
      if (!slot.is_leaf()) expand_all({slot.child, slot.binary_node, pending.depth + 1});
    }
  }

  void add_slot(ChosenSlot chosen) {
    if (!chosen.is_leaf) {
      slots_.push_back({chosen.binary_node, add_node(chosen.binary_node)});
      return;
    }
    uint32_t count = 0;
    for_each_leaf(binary_, chosen.binary_node,
                  [&](const BinaryNode& leaf) { count += leaf.count; });
    if (count > kMaxLeafSize) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "leaf %u owns %u triangles, expected at most %u",
                  chosen.binary_node, count, kMaxLeafSize);
    }
    if (binary_.has_duplicates) {
      uint32_t ids[kMaxLeafSize];
      count = static_cast<uint32_t>(copy_ids_below(binary_, chosen.binary_node, ids) - ids);
    }
    result_.leaf_area += binary_.nodes[chosen.binary_node].bounds.half_area();
    slots_.push_back({chosen.binary_node, kLeafFlag | static_cast<uint32_t>(leaf_sizes_.size())});
    leaf_sizes_.push_back(static_cast<uint8_t>(count));
  }

  uint32_t add_node(uint32_t binary_node) {
    result_.node_area += binary_.nodes[binary_node].bounds.half_area();
    nodes_.push_back({0, 0});
    return static_cast<uint32_t>(nodes_.size() - 1);
  }

  GrowingArray<ContractedNode> nodes_;
  GrowingArray<ContractedSlot> slots_;
  GrowingArray<uint8_t> leaf_sizes_;
  const BinaryBvh& binary_;
  const Chooser& chooser_;
  Contraction result_;
};

/// Contracts level by level near the root, then the subtrees below in parallel.
template <typename Chooser>
class ParallelContraction {
  using Walk = ContractionWalk<Chooser>;
  using Pending = typename Walk::Pending;

 public:
  ParallelContraction(const BinaryBvh& binary, const Chooser& chooser, Memory& memory,
                      const Parallel& parallel)
      : binary_(binary), chooser_(chooser), memory_(memory), parallel_(parallel) {}

  Contraction run(ChosenSlot root) {
    Walk walk(binary_, chooser_, memory_);
    GrowingArray<Pending> open(memory_);
    size_t next = 0;
    const Pending first = walk.add_root(root);
    if (!root.is_leaf) open.push_back(first);
    while (next < open.size() && open.size() - next < kSubtrees) {
      const Pending pending = open[next++];
      const uint32_t first_slot = walk.expand(pending);
      for (size_t i = first_slot; i < walk.slots().size(); ++i) {
        const ContractedSlot& slot = walk.slots()[i];
        if (slot.is_leaf()) continue;
        open.push_back({slot.child, slot.binary_node, pending.depth + 1});
      }
    }
    const size_t count = open.size() - next;
    if (count == 0) return walk.take();
    Contraction parts[kSubtrees + kMaxContractionWidth];
    parallel_.for_each(count, [&](size_t i) {
      Walk subtree(binary_, chooser_, memory_);
      subtree.contract_subtree(open[next + i].binary_node, open[next + i].depth);
      parts[i] = subtree.take();
    });
    return join(walk.take(), parts, &open[next], count);
  }

 private:
  /// Subtrees that are contracted in parallel: enough to balance what differs in size.
  static constexpr size_t kSubtrees = 128;

  /// Where the nodes, slots and leaves of a subtree go.
  struct Offsets {
    size_t node, slot, leaf;
  };

  Contraction join(const Contraction& top, const Contraction* parts, const Pending* roots,
                   size_t count) {
    Offsets offsets[kSubtrees + kMaxContractionWidth];
    Offsets end = {top.nodes.size(), top.slots.size(), top.leaf_sizes.size()};
    Contraction all;
    all.depth = top.depth;
    // The roots of the subtrees were counted near the root already.
    all.node_area = top.node_area;
    all.leaf_area = top.leaf_area;
    for (size_t i = 0; i < count; ++i) {
      offsets[i] = end;
      end.node += parts[i].nodes.size() - 1;
      end.slot += parts[i].slots.size();
      end.leaf += parts[i].leaf_sizes.size();
      all.depth = std::max(all.depth, parts[i].depth);
      all.node_area += parts[i].node_area - binary_.nodes[roots[i].binary_node].bounds.half_area();
      all.leaf_area += parts[i].leaf_area;
    }
    all.nodes = Array<ContractedNode>(memory_, end.node);
    all.slots = Array<ContractedSlot>(memory_, end.slot);
    all.leaf_sizes = Array<uint8_t>(memory_, end.leaf);
    std::copy(top.nodes.begin(), top.nodes.end(), all.nodes.begin());
    std::copy(top.slots.begin(), top.slots.end(), all.slots.begin());
    std::copy(top.leaf_sizes.begin(), top.leaf_sizes.end(), all.leaf_sizes.begin());
    parallel_.for_each(count,
                       [&](size_t i) { copy_part(parts[i], roots[i].node, offsets[i], all); });
    return all;
  }

  static void copy_part(const Contraction& part, uint32_t root, const Offsets& offset,
                        Contraction& all) {
    const uint32_t slot_offset = static_cast<uint32_t>(offset.slot);
    for (size_t i = 0; i < part.nodes.size(); ++i) {
      ContractedNode node = part.nodes[i];
      node.first_slot += slot_offset;
      all.nodes[i == 0 ? root : offset.node + i - 1] = node;
    }
    for (size_t i = 0; i < part.slots.size(); ++i) {
      ContractedSlot slot = part.slots[i];
      // Node 0 of a part is its root, which stands elsewhere and is nobody's child here.
      slot.child += static_cast<uint32_t>(slot.is_leaf() ? offset.leaf : offset.node - 1);
      all.slots[offset.slot + i] = slot;
    }
    std::copy(part.leaf_sizes.begin(), part.leaf_sizes.end(), all.leaf_sizes.begin() + offset.leaf);
  }

  const BinaryBvh& binary_;
  const Chooser& chooser_;
  Memory& memory_;
  const Parallel& parallel_;
};

}  // namespace kiwami

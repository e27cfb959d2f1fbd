// SPDX-License-Identifier: Apache-2.0
// The traversal of a wide tree by one ray, depth first and near children first.
#pragma once

#include "kernels/node-inl.h"
#include "kernels/probe-inl.h"
#include "kernels/query-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// A subtree still to be visited.
struct StackEntry {
  uint32_t child;
  uint32_t mask;
  float entry;    ///< distance at which the ray enters its box
  uint32_t rays;  ///< of a packet: those that enter it
};

/// A path of kMaxWideDepth nodes leaves at most N - 1 entries at each.
template <int N>
constexpr uint32_t kStackSize = kMaxWideDepth*(N - 1) + 1;

template <int N>
inline StackEntry child_of(const WideNode<N>& node, int slot, float entry) {
  return {node.child[slot], node.mask[slot], entry, 0};
}

// Inlined by force: GCC takes a function that only prefetches for one without effects and drops it.
template <size_t kSize>
__attribute__((always_inline)) inline void prefetch_lines(const void* first) {
  const auto* line = static_cast<const char*>(first);
#pragma GCC unroll 16
  for (size_t offset = 0; offset < kSize; offset += 64) __builtin_prefetch(line + offset);
}

/// Brings a child that will be visited later into the cache.
template <int N>
__attribute__((always_inline)) inline void prefetch(const TreeView& tree, uint32_t child) {
  if (child & kLeafFlag) {
    const auto* const leaves = static_cast<const LeafBlock<N>*>(tree.leaves);
    prefetch_lines<sizeof(LeafBlock<N>)>(leaves + (child ^ kLeafFlag));
  } else {
    const auto* const nodes = static_cast<const WideNode<N>*>(tree.nodes);
    prefetch_lines<sizeof(WideNode<N>)>(nodes + child);
  }
}

/// Adds an entry to those above bottom, which are sorted farthest first: insertion sort, since few
/// children are hit at once. Returns the new top of the stack.
inline StackEntry* insert_farthest_first(StackEntry* bottom, StackEntry* top,
                                         const StackEntry& added) {
  StackEntry* place = top;
  for (; place != bottom && place[-1].entry < added.entry; --place) *place = place[-1];
  *place = added;
  return top + 1;
}

/// Puts the nearest of the hit slots into next and the others onto the stack, farthest first.
/// Returns the new top of the stack.
template <int N>
inline StackEntry* choose_nearest(const TreeView& tree, const WideNode<N>& node, uint32_t hits,
                                  const float* entry, StackEntry* top, StackEntry& next) {
  int slot = __builtin_ctz(hits);
  hits &= hits - 1;
  next = child_of(node, slot, entry[slot]);
  if (hits == 0) return top;
  StackEntry* const bottom = top;
  for (; hits; hits &= hits - 1) {
    slot = __builtin_ctz(hits);
    StackEntry other = child_of(node, slot, entry[slot]);
    prefetch<N>(tree, other.child);
    if (other.entry < next.entry) {
      const StackEntry nearer = other;
      other = next;
      next = nearer;
    }
    top = insert_farthest_first(bottom, top, other);
  }
  return top;
}

/// Puts the first of the hit slots into next and the others onto the stack, in their order.
template <int N>
inline StackEntry* choose_first(const TreeView& tree, const WideNode<N>& node, uint32_t hits,
                                const float* entry, StackEntry* top, StackEntry& next) {
  for (; hits & (hits - 1);) {
    const int slot = 31 - __builtin_clz(hits);
    prefetch<N>(tree, node.child[slot]);
    *top++ = child_of(node, slot, entry[slot]);
    hits ^= 1u << slot;
  }
  const int slot = __builtin_ctz(hits);
  next = child_of(node, slot, entry[slot]);
  return top;
}

/// Visits what the query has to see of the subtree at start. Returns true if the query ended it.
template <int N, typename Query, typename Probe>
inline bool traverse(const TreeView& tree, const StackEntry& start, const SlabRay<N>& ray,
                     Query& query, Probe& probe) {
  const auto* const nodes = static_cast<const WideNode<N>*>(tree.nodes);
  const auto* const leaves = static_cast<const LeafBlock<N>*>(tree.leaves);
  StackEntry stack[kStackSize<N>];
  StackEntry* top = stack;
  StackEntry current = start;
  while (true) {
    if (!(current.child & kLeafFlag)) {
      probe.on_node();
      const WideNode<N>& node = nodes[current.child];
      vfloat<N> entry;
      const uint32_t hits = test_boxes(node, ray, query.best_bound, entry) & current.mask;
      if (hits != 0) {
        float entries[N];
        store(entries, entry);
        if constexpr (Query::kOrdered) {
          top = choose_nearest(tree, node, hits, entries, top, current);
        } else {
          top = choose_first(tree, node, hits, entries, top, current);
        }
        continue;
      }
    } else {
      probe.on_leaf(current.entry);
      if (query.visit_leaf(leaves[current.child ^ kLeafFlag], current.mask, probe)) return true;
    }
    do {
      if (top == stack) return false;
      current = *--top;
    } while (Query::kOrdered && current.entry > query.best_bound);
  }
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

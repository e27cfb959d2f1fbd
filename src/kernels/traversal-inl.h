// SPDX-License-Identifier: Apache-2.0
// The traversal of a wide tree by one ray, depth first and near children first.
#pragma once

#include "kernels/node-inl.h"
#include "kernels/probe-inl.h"
#include "kernels/query-inl.h"

// How the functions that choose among children are inlined. Objects with many traversals force it,
// since GCC would call them there.
#ifndef KIWAMI_INLINE_CHOICE
#define KIWAMI_INLINE_CHOICE inline
#endif

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// A subtree still to be visited.
struct StackEntry {
  ChildReference subtree;
  float entry;  ///< distance at which the ray enters its box
};

/// A path of kMaxWideDepth nodes leaves at most N - 1 entries at each.
template <int N>
constexpr uint32_t kStackSize = kMaxWideDepth*(N - 1) + 1;

template <int N>
inline StackEntry child_of(const WideNode<N>& node, int slot, float entry) {
  return {node.child[slot], entry};
}

/// Brings a child that will be visited later into the cache, but for the ids of a leaf block.
// Inlined by force: GCC takes a function that only prefetches for one without effects and drops it.
template <int N>
__attribute__((always_inline)) inline void prefetch(const TreeView& tree, ChildReference subtree) {
  static_assert(sizeof(LeafBlock<N>) > sizeof(WideNode<N>));
  // In a leaf it is a byte too far, which is in the same line and needs no branch.
  const unsigned char* const line = tree.memory + subtree.node_offset();
#pragma GCC unroll 16
  for (size_t offset = 0; offset < sizeof(WideNode<N>); offset += 64) {
    __builtin_prefetch(line + offset);
  }
}

/// Adds an entry to those above bottom, which are sorted farthest first: insertion sort, since few
/// children are hit at once. Returns the new top of the stack. Members are copied one by one: a
/// vector that is read where two stores went would wait for both.
inline StackEntry* insert_farthest_first(StackEntry* bottom, StackEntry* top,
                                         const StackEntry& added) {
  StackEntry* place = top;
  for (; place != bottom && place[-1].entry < added.entry; --place) {
    place->subtree = place[-1].subtree;
    place->entry = place[-1].entry;
  }
  place->subtree = added.subtree;
  place->entry = added.entry;
  return top + 1;
}

/// Puts the nearest of the hit slots into next and the others onto the stack, farthest first.
/// Returns the new top of the stack.
template <int N>
KIWAMI_INLINE_CHOICE StackEntry* choose_nearest(const TreeView& tree, const WideNode<N>& node,
                                                uint32_t hits, const float* entry, StackEntry* top,
                                                StackEntry& next) {
  int slot = __builtin_ctz(hits);
  hits &= hits - 1;
  next = child_of(node, slot, entry[slot]);
  if (hits == 0) return top;
  StackEntry* const bottom = top;
  for (; hits; hits &= hits - 1) {
    slot = __builtin_ctz(hits);
    StackEntry other = child_of(node, slot, entry[slot]);
    prefetch<N>(tree, other.subtree);
    if (other.entry < next.entry) {
      const StackEntry nearer = other;
      other = next;
      next = nearer;
    }
    top = insert_farthest_first(bottom, top, other);
  }
  return top;
}

/// Puts the first of the hit slots into next and the others onto the stack, in their order. Their
/// entry distances are copied only for those that look at them.
template <int N, bool kNeedsEntry>
KIWAMI_INLINE_CHOICE StackEntry* choose_first(const TreeView& tree, const WideNode<N>& node,
                                              uint32_t hits, const float* entry, StackEntry* top,
                                              StackEntry& next) {
  for (; hits & (hits - 1);) {
    const int slot = 31 - __builtin_clz(hits);
    top->subtree = node.child[slot];
    if constexpr (kNeedsEntry) top->entry = entry[slot];
    prefetch<N>(tree, top->subtree);
    ++top;
    hits ^= 1u << slot;
  }
  const int slot = __builtin_ctz(hits);
  next = child_of(node, slot, entry[slot]);
  return top;
}

/// Visits the current node or leaf and makes the next one current. Returns true at the end: where
/// nothing is left, or the query has ended. It sets is_done in the second case.
// Inlined by force: it stands in several loops, and a call would keep the ray out of registers.
template <int N, typename Query, typename Probe>
__attribute__((always_inline)) inline bool advance(const TreeView& tree, const SlabRay<N>& ray,
                                                   Query& query, Probe& probe,
                                                   const StackEntry* stack, StackEntry*& top,
                                                   StackEntry& current, bool& is_done) {
  constexpr bool needs_entry = Query::kOrdered || Probe::kNeedsEntry;
  if (!current.subtree.is_leaf()) {
    probe.on_node();
    const WideNode<N>& node = node_at<N>(tree.memory, current.subtree);
    vfloat<N> entry;
    uint32_t hits;
    // Some know better where the boxes are.
    if constexpr (requires { query.test_boxes(current.subtree, ray, entry); }) {
      hits = query.test_boxes(current.subtree, ray, entry) & current.subtree.mask();
    } else {
      hits = test_boxes(node, ray, query.best_bound, entry) & current.subtree.mask();
    }
    if (hits != 0) {
      float entries[N];
      store(entries, entry);
      if constexpr (Query::kOrdered) {
        top = choose_nearest(tree, node, hits, entries, top, current);
      } else {
        top = choose_first<N, needs_entry>(tree, node, hits, entries, top, current);
      }
      return false;
    }
  } else {
    probe.on_leaf(current.entry);
    // Some want to find what a leaf refers to themselves.
    if constexpr (requires { query.visit_block(tree, current.subtree, probe); }) {
      is_done = query.visit_block(tree, current.subtree, probe);
      if (is_done) return true;
    } else {
      typename Query::Room room;
      const auto& leaf = query.leaf_at(tree, current.subtree, room);
      if (query.visit_leaf(leaf, current.subtree.mask(), probe)) {
        is_done = true;
        return true;
      }
    }
  }
  do {
    if (top == stack) return true;
    --top;
  } while (Query::kOrdered && top->entry > query.best_bound);
  current.subtree = top->subtree;
  if constexpr (needs_entry) current.entry = top->entry;
  return false;
}

/// Visits what the query has to see of the subtree at start. Returns true if the query ended it.
// Inlined by force, for single rays of plain scenes: in a function of its own the query and the ray
// are reached through pointers, which takes registers from the loop.
template <int N, typename Query, typename Probe>
__attribute__((always_inline)) inline bool traverse_inlined(const TreeView& tree,
                                                            const StackEntry& start,
                                                            const ReadyRay& ready, Query& query,
                                                            Probe& probe) {
  const SlabRay<N> ray(ready);
  StackEntry stack[kStackSize<N>];
  StackEntry* top = stack;
  StackEntry current = start;
  bool is_done = false;
  while (!advance<N>(tree, ray, query, probe, stack, top, current, is_done)) {
  }
  return is_done;
}

/// The same where there are many kinds of queries.
template <int N, typename Query, typename Probe>
inline bool traverse(const TreeView& tree, const StackEntry& start, const ReadyRay& ready,
                     Query& query, Probe& probe) {
  return traverse_inlined<N>(tree, start, ready, query, probe);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// Closest hits through a binary tree, one ray and one node at a time: through the boxes of its
// nodes, or through a dual-split tree (D. Lin, K. Shkurko, I. Mallett, C. Yuksel, "Dual-Split
// Trees", I3D 2019). Triangles, distances and margins are those of the wide trees: each plane bounds
// a box that holds the triangle, so an accepted hit lies between the distances at which the ray
// meets them, each with its margin (see ray-inl.h), and every tree finds the same hits.
#pragma once

#include "kernels/answers-inl.h"
#include "kernels/probe-inl.h"
#include "kernels/query-inl.h"
#include "wide/binary_layout.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

using BinaryQuery = ClosestHitQuery<kBinaryBlockWidth, GatheredLeaves<kBinaryBlockWidth>>;

/// A subtree to be visited, and between which distances the ray is in it.
struct BinarySpan {
  uint32_t node;
  float entry, exit;

  bool is_met() const { return entry <= exit; }
};

/// A ray on its way through a tree.
struct BinaryWalk {
  const BinaryTreeView& tree;
  const ReadyRay& ray;
  BinaryTreeCounters& counters;
  BinaryQuery query;
  uint32_t size = 0;
  BinarySpan stack[kMaxWideDepth + 1];

  BinaryWalk(const BinaryTreeView& view, const ReadyRay& ready, BinaryTreeCounters& counted)
      : tree(view), ray(ready), counters(counted) {
    query.begin(view.scene, ready);
  }

  bool runs_backward(uint32_t axis) const { return ((ray.backward >> axis) & 1u) != 0; }

  /// Leaves of a span what is not beyond a plane.
  void clip(BinarySpan& span, uint32_t axis, bool is_upper, float plane) {
    ++counters.plane_tests;
    if (is_upper == runs_backward(axis)) {
      const float distance = plane * ray.reciprocal[axis] + ray.near_offset[axis];
      if (distance > span.entry) span.entry = distance;
    } else {
      const float distance = plane * ray.reciprocal[axis] + ray.far_offset[axis];
      if (distance < span.exit) span.exit = distance;
    }
  }

  BinarySpan span_of_box(const float (&bounds)[3][2], uint32_t node) {
    BinarySpan span{node, ray.nearest, query.best_bound};
    for (uint32_t axis = 0; axis < 3; ++axis) {
      clip(span, axis, false, bounds[axis][0]);
      clip(span, axis, true, bounds[axis][1]);
    }
    return span;
  }

  void visit_leaf(uint32_t block) {
    ++counters.leaf_visits;
    const uint64_t offset = uint64_t{block} * sizeof(IndexBlock<kBinaryBlockWidth>);
    const TreeView& leaves = tree.scene.tree;
    const auto& ids =
        index_leaf_at<kBinaryBlockWidth>(leaves.memory, ChildReference::to_leaf(offset, 1)).id;
    uint32_t lanes = 0, bit = 1;
    for (const uint32_t id : ids) {
      if (id != KIWAMI_INVALID_ID) lanes |= bit;
      bit <<= 1;
    }
    BinaryQuery::Room room;
    NoProbe probe;
    const auto& triangles = query.leaf_at(leaves, ChildReference::to_leaf(offset, lanes), room);
    query.visit_leaf(triangles, lanes, probe);
  }

  /// Makes the nearer of two subtrees, if any is met, the current one; the other has to wait.
  bool choose(const BinarySpan& first, const BinarySpan& second, BinarySpan& current) {
    if (first.is_met() && second.is_met()) stack[size++] = second;
    if (!first.is_met() && !second.is_met()) return false;
    current = first.is_met() ? first : second;
    return true;
  }

  /// The next subtree that waits and may still hold a nearer hit.
  bool pop(BinarySpan& current) {
    while (size != 0) {
      current = stack[--size];
      if (current.exit > query.best_bound) current.exit = query.best_bound;
      if (current.is_met()) return true;
    }
    return false;
  }

  bool step_through_boxes(BinarySpan& current) {
    const BoxNode& node = tree.boxes[current.node];
    if (node.is_leaf != 0) {
      visit_leaf(node.first);
      return pop(current);
    }
    ++counters.node_visits;
    const BinarySpan first = span_of_box(tree.boxes[node.first].bounds, node.first);
    const BinarySpan second = span_of_box(tree.boxes[node.first + 1].bounds, node.first + 1);
    const bool is_chosen = second.entry < first.entry ? choose(second, first, current)
                                                      : choose(first, second, current);
    return is_chosen || pop(current);
  }

  bool step_through_planes(BinarySpan& current) {
    const DualSplitNode& node = tree.nodes[current.node];
    const DualSplitNode::Kind kind = node.kind();
    if (kind == DualSplitNode::kSplit) {
      ++counters.node_visits;
      const uint32_t axis = node.axis();
      BinarySpan lower{current.node + 1, current.entry, current.exit};
      BinarySpan upper{current.node + node.upper_offset(), current.entry, current.exit};
      clip(lower, axis, true, node.plane[0]);
      clip(upper, axis, false, node.plane[1]);
      const bool is_chosen =
          runs_backward(axis) ? choose(upper, lower, current) : choose(lower, upper, current);
      return is_chosen || pop(current);
    }
    if (kind != DualSplitNode::kLeaf) {
      for (int k = 0; k < 2; ++k) {
        clip(current, node.side(k).axis, node.side(k).is_upper != 0, node.plane[k]);
      }
    }
    if (node.is_leaf()) {
      if (current.is_met()) visit_leaf(node.block());
      return pop(current);
    }
    ++counters.node_visits;
    ++current.node;
    return current.is_met() || pop(current);
  }
};

template <bool kHasBoxes>
inline kiwami_hit trace_binary(const BinaryTreeView& tree, const UnalignedRay& ray,
                               BinaryTreeCounters& counters) {
  if (tree.node_count == 0 || !is_traceable(ray)) return BinaryQuery::miss();
  ReadyRay ready;
  set_up(ray, tree.scene.tree, ready);
  BinaryWalk walk(tree, ready, counters);
  BinarySpan current = walk.span_of_box(tree.bounds, 0);
  bool goes_on = current.is_met();
  while (goes_on) {
    goes_on = kHasBoxes ? walk.step_through_boxes(current) : walk.step_through_planes(current);
  }
  return walk.query.answer();
}

template <bool kHasBoxes>
void trace_binary_batch(const BinaryTreeView& tree, const RayBatch& batch,
                        BinaryTreeCounters& counters) {
  for (size_t i = 0; i < batch.count; ++i) {
    write_answer(batch, i, trace_binary<kHasBoxes>(tree, ray_of(batch, i), counters));
  }
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

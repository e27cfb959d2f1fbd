// SPDX-License-Identifier: Apache-2.0
// A tree of any size in a few thousand rows: what costs most one by one, the rest together.
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>
#include <span>
#include <vector>

namespace kiwami::tools {

/// What is known of each node of a tree.
struct NodeFigures {
  std::vector<kiwami_bvh_node_measures> measures;
  std::vector<uint64_t> visits;  ///< of some set of rays; empty: not known
};

/// What a row of a summary stands for.
enum class RowKind : uint32_t {
  kInner = 0,   ///< an inner node; its children are rows, too
  kLeaf = 1,    ///< a leaf
  kFolded = 2,  ///< an inner node, without rows for what is below it
  kGroup = 3    ///< several children of one node, with all below them
};

/// A row of a summary. Of a group, area, cost, overlap and visits are summed over its members, the
/// box is around all of them, and `node` is the first.
struct SummaryRow {
  RowKind kind;
  int32_t parent;  ///< a row before this one; -1 for the root
  uint32_t node;   ///< its number in the tree
  uint32_t depth;
  uint32_t member_count;
  float lower[3], upper[3];
  double area;
  double cost;  ///< its own part of the tree's cost by the surface area heuristic
  double subtree_cost;
  uint64_t subtree_node_count;  ///< itself included
  uint64_t primitive_count;
  double overlap;  ///< its own part of the tree's end-point overlap
  uint64_t visits;
};

/// At most `most_rows` rows, at least one unless the tree is empty. A tree of no more nodes has one
/// row for each. Of a larger one, the nodes whose subtrees cost most have rows of their own; what
/// remains of a node's children is one row.
std::vector<SummaryRow> summarize(std::span<const kiwami_bvh_node> nodes,
                                  const NodeFigures& figures, size_t most_rows);

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
// A tree in few rows keeps what matters and loses nothing.
#include "measure/tree_summary.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kiwami_tests {
namespace {

using namespace kiwami::tools;

/// A tree, breadth first, each inner node with `fan` children, whose subtrees cost less and less.
struct Example {
  std::vector<kiwami_bvh_node> nodes;
  NodeFigures figures;
};

Example make_tree(uint32_t inner_count, uint32_t fan) {
  Example tree;
  tree.nodes.resize(size_t{inner_count} * fan + 1);
  tree.nodes[0].parent = KIWAMI_INVALID_ID;
  for (uint32_t i = 0; i < inner_count; ++i) {
    tree.nodes[i].first_child = i * fan + 1;
    tree.nodes[i].child_count = fan;
    for (uint32_t child = i * fan + 1; child <= (i + 1) * fan; ++child) {
      tree.nodes[child].parent = i;
      tree.nodes[child].depth = tree.nodes[i].depth + 1;
    }
  }
  for (uint32_t i = 0; i < tree.nodes.size(); ++i) {
    const auto position = static_cast<float>(i);
    for (int axis = 0; axis < 3; ++axis) {
      tree.nodes[i].lower[axis] = position;
      tree.nodes[i].upper[axis] = position + 1.0f;
    }
    tree.nodes[i].primitive_count = tree.nodes[i].child_count > 0 ? 0 : 1;
    tree.figures.measures.push_back({i * 3.0, 1.0 / (1.0 + i % 97), i * 0.5});
    tree.figures.visits.push_back(i);
  }
  for (size_t i = tree.nodes.size(); i-- > 1;) {
    tree.nodes[tree.nodes[i].parent].primitive_count += tree.nodes[i].primitive_count;
  }
  return tree;
}

/// What the rows stand for in all: an inner row for itself, every other one for its subtree.
double total_cost(const std::vector<SummaryRow>& rows) {
  double cost = 0.0;
  for (const SummaryRow& row : rows) {
    const bool is_whole = row.kind == RowKind::kFolded || row.kind == RowKind::kGroup;
    cost += is_whole ? row.subtree_cost : row.cost;
  }
  return cost;
}

uint64_t total_nodes(const std::vector<SummaryRow>& rows) {
  uint64_t nodes = 0;
  for (const SummaryRow& row : rows) {
    nodes += row.kind == RowKind::kInner ? 1 : row.subtree_node_count;
  }
  return nodes;
}

TEST(TreeSummary, OfNothingIsEmpty) { EXPECT_TRUE(summarize({}, {}, 10).empty()); }

TEST(TreeSummary, ASmallTreeHasARowForEachNode) {
  const Example tree = make_tree(3, 4);
  const std::vector<SummaryRow> rows = summarize(tree.nodes, tree.figures, 13);
  ASSERT_EQ(rows.size(), 13u);
  for (uint32_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].node, i);
    EXPECT_EQ(rows[i].kind, i < 3 ? RowKind::kInner : RowKind::kLeaf);
    EXPECT_EQ(rows[i].parent, i == 0 ? -1 : static_cast<int32_t>((i - 1) / 4));
    EXPECT_EQ(rows[i].member_count, 1u);
    EXPECT_EQ(rows[i].area, i * 3.0);
    EXPECT_EQ(rows[i].overlap, i * 0.5);
    EXPECT_EQ(rows[i].visits, i);
    EXPECT_EQ(rows[i].depth, tree.nodes[i].depth);
  }
  EXPECT_EQ(rows[0].subtree_node_count, 13u);
  EXPECT_EQ(rows[1].subtree_node_count, 5u);
  EXPECT_DOUBLE_EQ(rows[0].subtree_cost, total_cost(rows));
}

TEST(TreeSummary, WhatIsLeftOutIsInItsParentsGroup) {
  Example tree = make_tree(3, 4);
  for (auto& measures : tree.figures.measures) measures.sah = 0.125;
  tree.figures.measures[3].sah = 4.0;
  // The dearest three: the root, node 3 and, of equal ones the first, node 1; node 2 is folded.
  const std::vector<SummaryRow> rows = summarize(tree.nodes, tree.figures, 6);
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[1].node, 1u);
  EXPECT_EQ(rows[1].kind, RowKind::kInner);
  EXPECT_EQ(rows[2].node, 3u);
  EXPECT_EQ(rows[2].kind, RowKind::kLeaf);
  EXPECT_EQ(rows[3].kind, RowKind::kGroup);
  EXPECT_EQ(rows[3].parent, 0);
  EXPECT_EQ(rows[3].member_count, 2u);
  EXPECT_EQ(rows[3].node, 2u);
  EXPECT_EQ(rows[3].subtree_node_count, 6u);
  EXPECT_EQ(rows[3].primitive_count, 5u);
  EXPECT_EQ(rows[3].lower[0], 2.0f);
  EXPECT_EQ(rows[3].upper[0], 5.0f);
  EXPECT_EQ(rows[3].cost, 0.25);
  EXPECT_EQ(rows[3].subtree_cost, 0.75);
  EXPECT_EQ(rows[3].visits, 6u);
  EXPECT_EQ(rows[4].kind, RowKind::kGroup);
  EXPECT_EQ(rows[4].parent, 1);
  EXPECT_EQ(rows[4].member_count, 4u);
}

TEST(TreeSummary, KeepsItsLimitAndAllSums) {
  const Example tree = make_tree(2000, 8);
  const double cost = total_cost(summarize(tree.nodes, tree.figures, tree.nodes.size()));
  for (const size_t most : {1, 2, 3, 7, 100, 999, 16000}) {
    const std::vector<SummaryRow> rows = summarize(tree.nodes, tree.figures, most);
    ASSERT_GE(rows.size(), 1u);
    EXPECT_LE(rows.size(), most);
    EXPECT_GE(rows.size(), most / 4);
    EXPECT_EQ(total_nodes(rows), tree.nodes.size()) << most;
    EXPECT_NEAR(total_cost(rows), cost, 1e-9 * cost) << most;
    for (size_t i = 1; i < rows.size(); ++i) {
      ASSERT_GE(rows[i].parent, 0);
      ASSERT_LT(rows[i].parent, static_cast<int32_t>(i));
      EXPECT_EQ(rows[static_cast<size_t>(rows[i].parent)].kind, RowKind::kInner);
    }
  }
}

TEST(TreeSummary, OneRowIsTheFoldedRoot) {
  const Example tree = make_tree(3, 4);
  const std::vector<SummaryRow> rows = summarize(tree.nodes, tree.figures, 1);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].kind, RowKind::kFolded);
  EXPECT_EQ(rows[0].subtree_node_count, 13u);
}

}  // namespace
}  // namespace kiwami_tests

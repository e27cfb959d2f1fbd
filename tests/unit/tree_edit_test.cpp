// SPDX-License-Identifier: Apache-2.0
#include "bvh/tree_edit.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "support/environment.h"
#include "unit/binary_tree_test.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::Bounds;
using kiwami::BuildPrimitive;
using kiwami::SahCosts;

class TreeEdit : public BinaryTreeTest {
 protected:
  /// A chain: each inner node has a leaf of one primitive at its left.
  BinaryBvh chain(const Array<BuildPrimitive>& primitives) {
    const auto count = static_cast<uint32_t>(primitives.size());
    BinaryBvh bvh{Array<BinaryNode>(memory_, 2 * count - 1), Array<uint32_t>(memory_, count)};
    for (uint32_t i = 0; i < count; ++i) bvh.primitive_ids[i] = primitives[i].id;
    bvh.nodes[2 * count - 2] = {primitives[count - 1].bounds(), count - 1, 1};
    for (uint32_t i = count - 1; i-- > 0;) {
      const uint32_t left = 2 * i + 1;
      bvh.nodes[left] = {primitives[i].bounds(), i, 1};
      Bounds both = primitives[i].bounds();
      both.extend(bvh.nodes[left + 1].bounds);
      bvh.nodes[2 * i] = {both, left, 0};
    }
    return bvh;
  }

  /// The least cost of a subtree by trying both for each node, without any order of nodes.
  double least_cost(const BinaryBvh& bvh, uint32_t index, uint32_t max_leaf_size,
                    const SahCosts& costs, uint32_t& count) {
    const BinaryNode& node = bvh.nodes[index];
    const double area = node.bounds.half_area();
    double divided = std::numeric_limits<double>::infinity();
    if (node.is_leaf()) {
      count = node.count;
    } else {
      uint32_t left = 0, right = 0;
      divided = costs.node_cost * area + least_cost(bvh, node.first, max_leaf_size, costs, left) +
                least_cost(bvh, node.first + 1, max_leaf_size, costs, right);
      count = left + right;
      if (count > max_leaf_size) return divided;
    }
    const uint32_t blocks = (count + costs.block_size - 1) / costs.block_size;
    return std::min(divided, costs.leaf_cost * area * blocks);
  }
};

TEST_F(TreeEdit, RelabellingKeepsTheTreeAndForgetsItsNumbering) {
  const Mesh mesh = soup(3000, seed());
  BinaryBvh bvh = build_binned(mesh, 4);
  BinaryBvh shuffled = build_binned(mesh, 4);
  relabel_depth_first(bvh, memory_);
  verify(bvh, mesh, 4);
  // Moves every pair of siblings to the mirrored place, behind a gap.
  const auto pairs = static_cast<uint32_t>((shuffled.nodes.size() + 1) / 2);
  BinaryBvh moved{Array<BinaryNode>(memory_, 2 * pairs + 2), Array<uint32_t>(memory_, 0)};
  const auto place = [&](uint32_t first) { return 2 * pairs + 1 - first; };
  for (size_t i = 0; i < shuffled.nodes.size(); ++i) {
    BinaryNode node = shuffled.nodes[i];
    const auto index = static_cast<uint32_t>(i);
    const uint32_t first = index - (index + 1) % 2;
    if (!node.is_leaf()) node.first = place(node.first);
    moved.nodes[i == 0 ? 0 : place(first) + (index - first)] = node;
  }
  moved.primitive_ids = std::move(shuffled.primitive_ids);
  relabel_depth_first(moved, memory_);
  EXPECT_TRUE(are_equal(bvh, moved));
}

TEST_F(TreeEdit, PrimitivesBelowANodeStandSideBySide) {
  BinaryBvh bvh = build_binned(soup(2000, seed()), 2);
  relabel_depth_first(bvh, memory_);
  uint32_t next = 0;
  kiwami::for_each_leaf(bvh, 0, [&](const BinaryNode& leaf) {
    EXPECT_EQ(leaf.first, next);
    next += leaf.count;
  });
  EXPECT_EQ(next, 2000u);
}

TEST_F(TreeEdit, DepthIsLimitedWhereItMustBe) {
  for (const uint32_t count : {1u, 2u, 71u, 72u, 73u, 74u, 200u, 5000u}) {
    const Mesh mesh = soup(count, seed());
    const Array<BuildPrimitive> primitives = primitives_of(mesh, memory_);
    BinaryBvh bvh = chain(primitives);
    limit_depth(bvh, memory_);
    verify(bvh, mesh, 1);  // which checks the depth
  }
}

TEST_F(TreeEdit, ATreeOfTheGreatestDepthStaysAsItIs) {
  const Array<BuildPrimitive> primitives =
      primitives_of(soup(BinaryBvh::kMaxDepth, seed()), memory_);
  BinaryBvh bvh = chain(primitives), before = chain(primitives);
  limit_depth(bvh, memory_);
  EXPECT_TRUE(are_equal(bvh, before));
}

TEST_F(TreeEdit, LeavesAreCollapsedAtTheLeastCost) {
  for (const SahCosts costs :
       {SahCosts{1, 1, 8}, SahCosts{0.3f, 1, 4}, SahCosts{0.05f, 1, 1}, SahCosts{0.2f, 3, 2}}) {
    for (const Mesh& mesh : {soup(1500, seed()), terrain(30), spheres(4, seed())}) {
      BinaryBvh bvh = build_binned(mesh, 1);
      relabel_depth_first(bvh, memory_);
      uint32_t count = 0;
      const double expected = least_cost(bvh, 0, 8, costs, count) / bvh.nodes[0].bounds.half_area();
      collapse_leaves(bvh, 8, costs, memory_);
      verify(bvh, mesh, 8);
      EXPECT_NEAR(sah_cost(bvh, costs), expected, 1e-9 * expected);
    }
  }
}

TEST_F(TreeEdit, DegenerateTreesPassThroughAllEdits) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    BinaryBvh bvh = build_binned(named.mesh, 1);
    relabel_depth_first(bvh, memory_);
    limit_depth(bvh, memory_);
    verify(bvh, named.mesh, 1);
    collapse_leaves(bvh, 8, {}, memory_);
    verify(bvh, named.mesh, 8);
    EXPECT_GE(sah_cost(bvh, {}), 0.0);
  }
}

TEST_F(TreeEdit, CostOfASmallTreeIsThatOfTheDefinition) {
  // Two unit cubes in a box of 3 x 1 x 1: half areas 3 and 7.
  BinaryBvh bvh{Array<BinaryNode>(memory_, 3), Array<uint32_t>(memory_, 12)};
  bvh.nodes[0] = {{{0, 0, 0}, {3, 1, 1}}, 1, 0};
  bvh.nodes[1] = {{{0, 0, 0}, {1, 1, 1}}, 0, 3};
  bvh.nodes[2] = {{{2, 0, 0}, {3, 1, 1}}, 3, 9};
  const SahCosts costs = {0.5f, 2.0f, 4};
  EXPECT_DOUBLE_EQ(sah_cost(bvh, costs), (0.5 * 7 + 2.0 * 3 * 1 + 2.0 * 3 * 3) / 7.0);
  EXPECT_EQ(sah_cost(BinaryBvh(), costs), 0.0);
}

}  // namespace
}  // namespace kiwami_tests

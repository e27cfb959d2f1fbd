// SPDX-License-Identifier: Apache-2.0
#include "wide/contraction.h"

#include <gtest/gtest.h>

#include <set>

#include "builders/binned_sah_builder.h"
#include "support/environment.h"
#include "unit/tree_scenes.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::ContractedNode;
using kiwami::ContractedSlot;
using kiwami::Contraction;

class ContractionTest : public testing::Test {
 protected:
  ContractionTest() : memory_(nullptr, nullptr, nullptr) {}

  BinaryBvh build(const Mesh& mesh, uint32_t leaf_size) {
    kiwami::BinnedSahBuilder::Config config;
    config.max_leaf_size = config.block_size = leaf_size;
    auto primitives = primitives_of(mesh, memory_);
    return kiwami::BinnedSahBuilder::build(std::move(primitives), config, memory_, Threads(1));
  }

  kiwami::Memory memory_;
  Threads one_thread_{1};
};

std::set<uint32_t> leaves_of(const BinaryBvh& bvh) {
  std::set<uint32_t> leaves;
  for (uint32_t i = 0; i < bvh.nodes.size(); ++i) {
    if (bvh.nodes[i].is_leaf()) leaves.insert(i);
  }
  return leaves;
}

double area_of(const BinaryBvh& bvh, bool leaves) {
  double area = 0;
  for (const BinaryNode& node : bvh.nodes) {
    if (node.is_leaf() == leaves) area += node.bounds.half_area();
  }
  return area;
}

void check(const BinaryBvh& bvh, const Contraction& contraction, uint32_t width) {
  std::set<uint32_t> leaves, children;
  uint32_t next_leaf = 0;
  for (const ContractedSlot& slot : contraction.slots) {
    if (!slot.is_leaf()) {
      EXPECT_TRUE(children.insert(slot.child).second) << "node " << slot.child << " has 2 parents";
      continue;
    }
    EXPECT_TRUE(bvh.nodes[slot.binary_node].is_leaf());
    EXPECT_EQ(slot.child & ~kiwami::kLeafFlag, next_leaf++);
    leaves.insert(slot.binary_node);
  }
  EXPECT_EQ(leaves, leaves_of(bvh));
  EXPECT_EQ(contraction.leaf_sizes.size(), leaves.size());
  EXPECT_EQ(children.size(), contraction.nodes.size());
  for (uint32_t i = 0; i < contraction.nodes.size(); ++i) {
    const ContractedNode& node = contraction.nodes[i];
    ASSERT_GE(node.slot_count, 2u);
    ASSERT_LE(node.slot_count, width);
    for (uint32_t s = node.first_slot; s < node.first_slot + node.slot_count; ++s) {
      const ContractedSlot& slot = contraction.slots[s];
      if (slot.is_leaf()) continue;
      EXPECT_GT(slot.child, i) << "a child stands before its parent";
      EXPECT_EQ(node.slot_count, width) << "node " << i << " has free slots above a node";
    }
  }
}

TEST_F(ContractionTest, KeepsLeavesWidthAndOrder) {
  const Mesh meshes[] = {terrain(30), soup(3000, seed()), spheres(3000, seed())};
  for (const Mesh& mesh : meshes) {
    for (const uint32_t leaf_size : {1u, 8u}) {
      const BinaryBvh bvh = build(mesh, leaf_size);
      for (const uint32_t width : {2u, 3u, 4u, 8u, 16u}) {
        SCOPED_TRACE("width " + std::to_string(width));
        check(bvh, kiwami::contract(bvh, width, memory_, one_thread_), width);
      }
    }
  }
}

TEST_F(ContractionTest, WidthTwoIsTheBinaryTree) {
  const BinaryBvh bvh = build(soup(1000, seed()), 4);
  const Contraction contraction = kiwami::contract(bvh, 2, memory_, one_thread_);
  EXPECT_EQ(contraction.nodes.size() + contraction.leaf_sizes.size(), bvh.nodes.size());
  EXPECT_NEAR(contraction.node_area, area_of(bvh, false), 1e-9 * contraction.node_area);
  EXPECT_NEAR(contraction.leaf_area, area_of(bvh, true), 1e-9 * contraction.leaf_area);
}

TEST_F(ContractionTest, WiderNodesHaveLessAreaAndDepth) {
  const BinaryBvh bvh = build(spheres(5000, seed()), 1);
  Contraction last = kiwami::contract(bvh, 2, memory_, one_thread_);
  for (const uint32_t width : {4u, 8u, 16u}) {
    Contraction wider = kiwami::contract(bvh, width, memory_, one_thread_);
    EXPECT_LT(wider.node_area, last.node_area);
    EXPECT_LT(wider.depth, last.depth);
    EXPECT_EQ(wider.leaf_area, last.leaf_area);
    last = std::move(wider);
  }
}

TEST_F(ContractionTest, OpensTheChildOfLargestArea) {
  // Four leaves in a row of boxes; the right pair is larger, so with three slots it is opened.
  BinaryBvh bvh;
  bvh.nodes = kiwami::Array<BinaryNode>(memory_, 7);
  bvh.nodes[0] = {{{0, 0, 0}, {9, 1, 1}}, 1, 0};
  bvh.nodes[1] = {{{0, 0, 0}, {2, 1, 1}}, 3, 0};
  bvh.nodes[2] = {{{2, 0, 0}, {9, 1, 1}}, 5, 0};
  bvh.nodes[3] = {{{0, 0, 0}, {1, 1, 1}}, 0, 1};
  bvh.nodes[4] = {{{1, 0, 0}, {2, 1, 1}}, 1, 1};
  bvh.nodes[5] = {{{2, 0, 0}, {5, 1, 1}}, 2, 1};
  bvh.nodes[6] = {{{5, 0, 0}, {9, 1, 1}}, 3, 1};
  const Contraction contraction = kiwami::contract(bvh, 3, memory_, one_thread_);
  ASSERT_EQ(contraction.nodes.size(), 2u);
  ASSERT_EQ(contraction.slots.size(), 6u);
  const uint32_t expected[] = {0, 1, 5, 6, 3, 4};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(contraction.slots[i].binary_node, expected[i]);
  EXPECT_EQ(contraction.depth, 2u);
  EXPECT_EQ(contraction.node_area, 19.0 + 5.0);
}

TEST_F(ContractionTest, ARootThatIsALeafHasNoNodes) {
  const BinaryBvh bvh = build(soup(3, seed()), 8);
  const Contraction contraction = kiwami::contract(bvh, 8, memory_, one_thread_);
  EXPECT_TRUE(contraction.nodes.empty());
  ASSERT_EQ(contraction.slots.size(), 1u);
  EXPECT_TRUE(contraction.slots[0].is_leaf());
  EXPECT_EQ(contraction.depth, 0u);
}

}  // namespace
}  // namespace kiwami_tests

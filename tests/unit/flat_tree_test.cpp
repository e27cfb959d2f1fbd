// SPDX-License-Identifier: Apache-2.0
// Flat trees against the binary and contracted trees they show, and what their verifier finds.
#include "wide/flat_tree.h"

#include <gtest/gtest.h>

#include <functional>

#include "bvh/flat_edit.h"
#include "core/error.h"
#include "unit/binary_tree_test.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::Bounds;
using kiwami::FlatTree;

class FlatTreeTest : public BinaryTreeTest {
 protected:
  static constexpr uint32_t kLeafSize = 3;

  kiwami::Array<Bounds> boxes_of(const Mesh& mesh) {
    kiwami::Array<Bounds> boxes(memory_, mesh.triangles.size());
    for (const kiwami::BuildPrimitive& primitive : primitives_of(mesh, memory_)) {
      boxes[primitive.id] = primitive.bounds();
    }
    return boxes;
  }

  void verify_flat(const FlatTree& tree, const kiwami::Array<Bounds>& boxes, uint32_t width,
                   uint32_t leaf_width) {
    kiwami::verify_flat_tree({tree.nodes.data(), tree.nodes.size()}, tree.primitive_ids, boxes,
                             width, leaf_width, memory_);
  }
};

TEST_F(FlatTreeTest, ShowsEveryNodeOfABinaryTree) {
  const Mesh mesh = soup(500, 1);
  const BinaryBvh binary = build_binned(mesh, kLeafSize);
  const FlatTree flat = kiwami::flatten(binary, memory_);
  verify_flat(flat, boxes_of(mesh), 2, kLeafSize);
  size_t leaves = 0;
  kiwami::for_each_leaf(binary, 0, [&](const kiwami::BinaryNode&) { ++leaves; });
  EXPECT_EQ(flat.nodes.size(), 2 * leaves - 1);
  EXPECT_EQ(kiwami::flatten(BinaryBvh(), memory_).nodes.size(), 0u);
}

TEST_F(FlatTreeTest, ShowsEverySlotOfAContraction) {
  const Mesh mesh = soup(500, 2);
  const BinaryBvh binary = build_binned(mesh, kLeafSize);
  const kiwami::Contraction contraction = kiwami::contract(binary, 8, memory_, Threads(1));
  const FlatTree flat = kiwami::flatten(contraction, binary, memory_);
  verify_flat(flat, boxes_of(mesh), 8, kLeafSize);
  EXPECT_EQ(flat.nodes.size(), contraction.slots.size());
}

TEST_F(FlatTreeTest, TheVerifierFindsEveryBrokenInvariant) {
  const Mesh mesh = soup(60, 3);
  const BinaryBvh binary = build_binned(mesh, kLeafSize);
  const kiwami::Array<Bounds> boxes = boxes_of(mesh);
  const auto last = [](FlatTree& tree) -> kiwami_bvh_node& {
    return tree.nodes[tree.nodes.size() - 1];
  };
  const std::function<void(FlatTree&)> breaks[] = {
      [](FlatTree& tree) { tree.nodes[0].parent = 0; },
      [](FlatTree& tree) { tree.nodes[0].primitive_count -= 1; },
      [](FlatTree& tree) { tree.nodes[0].first_child = 2; },
      [](FlatTree& tree) { tree.nodes[0].child_count = 3; },
      [](FlatTree& tree) { tree.nodes[2].parent = 1; },
      [](FlatTree& tree) { tree.nodes[2].depth = 5; },
      [](FlatTree& tree) { tree.nodes[2].first_primitive += 1; },
      [](FlatTree& tree) { tree.nodes[1].upper[1] = 1e9f; },
      [&](FlatTree& tree) { last(tree).primitive_count = 0; },
      [&](FlatTree& tree) { last(tree).lower[0] = last(tree).upper[0]; },
      [](FlatTree& tree) { tree.primitive_ids[5] = 1000; },
      [](FlatTree& tree) { tree.primitive_ids[5] = tree.primitive_ids[6]; },
      [](FlatTree& tree) { std::swap(tree.primitive_ids[0], tree.primitive_ids[59]); }};
  int number = 0;
  for (const auto& break_it : breaks) {
    FlatTree tree = kiwami::flatten(binary, memory_);
    verify_flat(tree, boxes, 2, kLeafSize);
    break_it(tree);
    EXPECT_THROW(verify_flat(tree, boxes, 2, kLeafSize), kiwami::Error) << number;
    ++number;
  }
  const FlatTree tree = kiwami::flatten(binary, memory_);
  EXPECT_THROW(verify_flat(tree, boxes, 2, kLeafSize - 1), kiwami::Error);
}

}  // namespace
}  // namespace kiwami_tests

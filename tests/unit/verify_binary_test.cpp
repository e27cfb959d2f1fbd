// SPDX-License-Identifier: Apache-2.0
// Each invariant of a binary tree is broken once, and the verifier must name it.
#include "bvh/verify_binary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/error.h"
#include "support/environment.h"
#include "unit/tree_scenes.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::BuildPrimitive;

/// Two leaves of two primitives under one root, made by hand.
class VerifyBinary : public testing::Test {
 protected:
  VerifyBinary() : memory_(nullptr, nullptr, nullptr), primitives_(memory_, 4) {
    for (uint32_t i = 0; i < 4; ++i) {
      const float x = static_cast<float>(i);
      // Ids need not be 0, 1, 2, 3.
      primitives_[i] = {{x, 0, 0}, 10 * i, {x + 0.5f, 1, 1}, 0};
    }
    bvh_.nodes = Array<BinaryNode>(memory_, 3);
    bvh_.nodes[0] = {{{0, 0, 0}, {3.5f, 1, 1}}, 1, 0};
    bvh_.nodes[1] = {{{0, 0, 0}, {2.5f, 1, 1}}, 0, 2};
    bvh_.nodes[2] = {{{1, 0, 0}, {3.5f, 1, 1}}, 2, 2};
    bvh_.primitive_ids = Array<uint32_t>(memory_, 4);
    const uint32_t ids[4] = {20, 0, 10, 30};
    for (int i = 0; i < 4; ++i) bvh_.primitive_ids[i] = ids[i];
  }

  /// The verifier's sentence; "" where it finds nothing.
  std::string verdict(uint32_t max_leaf_size = 2) {
    try {
      kiwami::verify_binary_bvh(bvh_, primitives_.data(), primitives_.size(), max_leaf_size,
                                memory_);
    } catch (const kiwami::Error& error) {
      EXPECT_EQ(error.result(), KIWAMI_ERROR_VALIDATION);
      return error.what();
    }
    return "";
  }

  void expect_verdict(const char* part) {
    const std::string sentence = verdict();
    EXPECT_NE(sentence.find(part), std::string::npos) << "it said: " << sentence;
  }

  kiwami::Memory memory_;
  Array<BuildPrimitive> primitives_;
  BinaryBvh bvh_;
};

TEST_F(VerifyBinary, AcceptsTheTree) { EXPECT_EQ(verdict(), ""); }

TEST_F(VerifyBinary, RejectsALeafThatIsTooLarge) {
  EXPECT_NE(verdict(1).find("at most 1"), std::string::npos);
}
TEST_F(VerifyBinary, RejectsAnInnerBoxThatIsTooLarge) {
  bvh_.nodes[0].bounds.upper.x = 4;
  expect_verdict("inner node 0");
}
TEST_F(VerifyBinary, RejectsALeafBoxThatIsTooSmall) {
  bvh_.nodes[1].bounds.lower.x = 0.25f;
  bvh_.nodes[0].bounds.lower.x = 0.25f;
  expect_verdict("leaf 1");
}
TEST_F(VerifyBinary, RejectsANanBox) {
  bvh_.nodes[2].bounds.lower.y = NAN;
  expect_verdict("leaf 2");
}
TEST_F(VerifyBinary, RejectsAnIdInTwoLeaves) {
  bvh_.primitive_ids[2] = 0;
  bvh_.nodes[2].bounds.lower.x = 0;
  expect_verdict("another leaf owns");
}
TEST_F(VerifyBinary, RejectsAnUnknownId) {
  bvh_.primitive_ids[3] = 31;
  expect_verdict("no primitive's");
}
TEST_F(VerifyBinary, RejectsAMissingId) {
  bvh_.nodes[2].count = 1;
  bvh_.nodes[2].bounds = {{1, 0, 0}, {1.5f, 1, 1}};
  bvh_.nodes[0].bounds.upper.x = 2.5f;
  expect_verdict("is in no leaf");
}
TEST_F(VerifyBinary, RejectsALeafBeyondTheIds) {
  bvh_.nodes[2].first = 3;
  expect_verdict("leaf 2 owns ids");
}
TEST_F(VerifyBinary, RejectsChildrenOutOfRange) {
  bvh_.nodes[0].first = 2;
  expect_verdict("children at 2");
}
TEST_F(VerifyBinary, RejectsChildrenBeforeTheirParent) {
  bvh_.nodes[0].first = 0;
  expect_verdict("children at 0");
}
TEST_F(VerifyBinary, RejectsTwoParents) {
  Array<BinaryNode> nodes(memory_, 5);
  nodes[0] = {{{0, 0, 0}, {3.5f, 1, 1}}, 1, 0};
  nodes[1] = {{{0, 0, 0}, {3.5f, 1, 1}}, 3, 0};
  nodes[2] = nodes[1];
  nodes[3] = bvh_.nodes[1];
  nodes[4] = bvh_.nodes[2];
  bvh_.nodes = std::move(nodes);
  expect_verdict("two parents");
}
TEST_F(VerifyBinary, RejectsAnIdThatWasGivenTwice) {
  primitives_[1].id = 0;
  expect_verdict("given twice");
}
TEST_F(VerifyBinary, RejectsTheWrongNumberOfIds) {
  bvh_.primitive_ids.shrink(3);
  expect_verdict("3 primitive ids");
}
TEST_F(VerifyBinary, RejectsATreeWithoutNodes) {
  bvh_.nodes = Array<BinaryNode>(memory_, 0);
  expect_verdict("has no nodes");
}

TEST_F(VerifyBinary, RejectsAPathThatIsTooLong) {
  // A chain: each inner node has one leaf of one primitive, and all boxes are equal.
  constexpr uint32_t kCount = BinaryBvh::kMaxDepth + 1;
  primitives_ = Array<BuildPrimitive>(memory_, kCount);
  bvh_.primitive_ids = Array<uint32_t>(memory_, kCount);
  bvh_.nodes = Array<BinaryNode>(memory_, 2 * kCount - 1);
  for (uint32_t i = 0; i < kCount; ++i) {
    primitives_[i] = {{0, 0, 0}, i, {1, 1, 1}, 0};
    bvh_.primitive_ids[i] = i;
  }
  for (uint32_t i = 0; i + 1 < kCount; ++i) {
    const kiwami::Bounds box = {{0, 0, 0}, {1, 1, 1}};
    bvh_.nodes[2 * i] = {box, 2 * i + 1, 0};
    bvh_.nodes[2 * i + 1] = {box, i, 1};
    bvh_.nodes[2 * i + 2] = {box, i + 1, 1};
  }
  expect_verdict("expected at most 72");
}

TEST_F(VerifyBinary, AcceptsTheEmptyTreeAndRejectsNodesInIt) {
  kiwami::verify_binary_bvh(BinaryBvh{}, nullptr, 0, 8, memory_);
  BinaryBvh stray;
  stray.nodes = Array<BinaryNode>(memory_, 1);
  EXPECT_THROW(kiwami::verify_binary_bvh(stray, nullptr, 0, 8, memory_), kiwami::Error);
}

}  // namespace
}  // namespace kiwami_tests

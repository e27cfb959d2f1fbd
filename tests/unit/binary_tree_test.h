// SPDX-License-Identifier: Apache-2.0
// What the tests of builders, edits and optimisers of binary trees share.
#pragma once

#include <gtest/gtest.h>

#include "unit/tree_scenes.h"

namespace kiwami_tests {

/// Prints the seed before each test, and owns the memory of its trees.
class BinaryTreeTest : public testing::Test {
 protected:
  void SetUp() override;

  /// By the binned builder, on one thread.
  kiwami::BinaryBvh build_binned(const Mesh& mesh, uint32_t max_leaf_size);

  /// Throws where an invariant is broken.
  void verify(const kiwami::BinaryBvh& bvh, const Mesh& mesh, uint32_t max_leaf_size);

  kiwami::BinaryBvh copy(const kiwami::BinaryBvh& bvh);

  kiwami::Memory memory_{nullptr, nullptr, nullptr};
};

/// Whether two trees are equal to the byte.
bool are_equal(const kiwami::BinaryBvh& a, const kiwami::BinaryBvh& b);

/// A tree of one primitive a leaf as nested brackets of their ids.
std::string text_of(const kiwami::BinaryBvh& bvh, uint32_t index = 0);

/// Half the surface of the box around two boxes.
float area_of_both(const kiwami::Bounds& a, const kiwami::Bounds& b);

}  // namespace kiwami_tests

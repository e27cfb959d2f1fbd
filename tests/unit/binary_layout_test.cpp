// SPDX-License-Identifier: Apache-2.0
// The verifier of binary layouts finds each thing that can be wrong.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "core/error.h"
#include "wide/binary_layouts.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryLayout;
using kiwami::Bounds;
using kiwami::DualSplitNode;

/// Sixteen unit boxes in a row with gaps, which climb: so there are planes to carve.
class BinaryLayoutTest : public testing::Test {
 protected:
  static constexpr uint32_t kCount = 16;

  BinaryLayoutTest() : nodes_(memory_, 2 * kCount - 1), ids_(memory_, kCount) {
    boxes_ = kiwami::Array<Bounds>(memory_, kCount);
    for (uint32_t i = 0; i < kCount; ++i) {
      const float at = 3.0f * static_cast<float>(i);
      boxes_[i] = {{at, 0.5f * at, 0.0f}, {at + 1.0f, 0.5f * at + 1.0f, 1.0f}};
      ids_[i] = i;
    }
    // A complete binary tree, breadth first.
    for (uint32_t i = 2 * kCount - 1; i-- > 0;) {
      kiwami_bvh_node& node = nodes_[i] = {};
      const bool is_leaf = i >= kCount - 1;
      Bounds bounds = is_leaf ? boxes_[i - (kCount - 1)] : Bounds::empty();
      if (!is_leaf) {
        node.first_child = 2 * i + 1;
        node.child_count = 2;
        for (uint32_t child = 2 * i + 1; child < 2 * i + 3; ++child) {
          for (int axis = 0; axis < 3; ++axis) {
            bounds.lower[axis] = std::min(bounds.lower[axis], nodes_[child].lower[axis]);
            bounds.upper[axis] = std::max(bounds.upper[axis], nodes_[child].upper[axis]);
          }
        }
      }
      node.first_primitive = is_leaf ? i - (kCount - 1) : 0;
      node.primitive_count = is_leaf ? 1 : 0;
      for (int axis = 0; axis < 3; ++axis) {
        node.lower[axis] = bounds.lower[axis];
        node.upper[axis] = bounds.upper[axis];
      }
    }
  }

  BinaryLayout dual_split() {
    return kiwami::dual_split_layout({nodes_, ids_, {0.0f, 0.0f, 0.0f}}, memory_);
  }
  std::string fault_of(const BinaryLayout& layout) {
    try {
      kiwami::verify_binary_layout(layout, {boxes_, false}, memory_);
      return {};
    } catch (const kiwami::Error& error) {
      return error.what();
    }
  }
  /// The first node of a kind.
  static DualSplitNode& find(BinaryLayout& layout, DualSplitNode::Kind kind) {
    for (DualSplitNode& node : layout.nodes) {
      if (node.kind() == kind) return node;
    }
    ADD_FAILURE() << "no node of kind " << kind;
    return layout.nodes[0];
  }

  kiwami::Memory memory_{nullptr, nullptr, nullptr};
  kiwami::Array<kiwami_bvh_node> nodes_;
  kiwami::Array<uint32_t> ids_;
  kiwami::Array<Bounds> boxes_;
};

TEST_F(BinaryLayoutTest, DualSplitTreesKeepEachLeafsBox) {
  BinaryLayout layout = dual_split();
  EXPECT_EQ(fault_of(layout), "");
  EXPECT_EQ(layout.split_count, kCount - 1);
  EXPECT_EQ(layout.blocks.size(), kCount);
  EXPECT_EQ(layout.nodes.size(), layout.split_count + layout.carve_count + kCount);
  // What is empty beside the climbing row is worth a plane.
  find(layout, DualSplitNode::kCarvedLeaf);
}

TEST_F(BinaryLayoutTest, FaultsAreFound) {
  const std::pair<const char*, std::function<void(BinaryLayout&)>> faults[] = {
      {"depth-first order",
       [](BinaryLayout& l) { find(l, DualSplitNode::kSplit).header += 1 << 4; }},
      {"beyond what is left",
       [](BinaryLayout& l) { find(l, DualSplitNode::kSplit).plane[0] = 1e3f; }},
      {"reaches out", [](BinaryLayout& l) { find(l, DualSplitNode::kSplit).plane[0] -= 0.5f; }},
      {"beyond what is left",
       [](BinaryLayout& l) {
         DualSplitNode& leaf = find(l, DualSplitNode::kCarvedLeaf);
         leaf.plane[0] += leaf.side(0).is_upper != 0 ? -0.25f : 0.25f;
       }},
      {"reaches out",
       [](BinaryLayout& l) { find(l, DualSplitNode::kCarvedLeaf).header += 1 << 8; }},
      {"another leaf has, too", [](BinaryLayout& l) { l.blocks[0].id[1] = l.blocks[0].id[0]; }},
      {"not there", [](BinaryLayout& l) { l.blocks[0].id[0] = 99; }},
      {"stands in no leaf", [](BinaryLayout& l) { l.blocks[0].id[0] = KIWAMI_INVALID_ID; }}};
  for (const auto& [sentence, damage] : faults) {
    BinaryLayout layout = dual_split();
    damage(layout);
    EXPECT_NE(fault_of(layout).find(sentence), std::string::npos)
        << sentence << ", not " << fault_of(layout);
  }
}

TEST_F(BinaryLayoutTest, FaultsOfBoxesAreFound) {
  const auto boxes = [&] {
    return kiwami::box_layout({nodes_, ids_, {0.0f, 0.0f, 0.0f}}, memory_);
  };
  EXPECT_EQ(fault_of(boxes()), "");
  BinaryLayout layout = boxes();
  layout.boxes[1].bounds[0][1] -= 0.5f;
  EXPECT_NE(fault_of(layout).find("reaches out"), std::string::npos);
  layout = boxes();
  layout.boxes[2].first = 1;
  EXPECT_NE(fault_of(layout).find("stands behind its children"), std::string::npos);
}

}  // namespace
}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
#include "wide/wide_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <memory>

#include "builders/binned_sah_builder.h"
#include "core/error.h"
#include "support/environment.h"
#include "unit/tree_scenes.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::ChildReference;
using kiwami::ContractionMethod;
using kiwami::LeafBlock;
using kiwami::WideNode;
using kiwami::WideTree;
using kiwami::WideTreeConfig;

class WideTreeTest : public testing::Test {
 protected:
  WideTreeTest() : memory_(nullptr, nullptr, nullptr) {}

  WideTree build(const TreeScene& scene, uint32_t width, uint32_t leaf_size, bool merge,
                 const kiwami::Parallel& parallel) {
    kiwami::BinnedSahBuilder::Config config;
    config.max_leaf_size = config.block_size = leaf_size;
    auto primitives = scene.primitives(memory_);
    BinaryBvh binary =
        kiwami::BinnedSahBuilder::build(std::move(primitives), config, memory_, parallel);
    WideTreeConfig wide;
    wide.width = width;
    wide.merge_leaves = merge;
    wide.contraction = contraction_;
    wide.max_leaf_size = width;
    return kiwami::build_wide_tree(std::move(binary), scene.source(), wide, memory_, parallel);
  }

  void verify(const WideTree& tree, const TreeScene& scene) {
    kiwami::verify_wide_tree(tree, scene.source(), scene.count(), memory_);
  }

  kiwami::Memory memory_;
  Threads one_thread_{1};
  ContractionMethod contraction_ = ContractionMethod::kSurfaceArea;
};

double fill(uint64_t used, uint64_t count, uint32_t width) {
  return static_cast<double>(used) / static_cast<double>(count * width);
}

TEST_F(WideTreeTest, MergingFillsTheNodes) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  const std::unique_ptr<TreeScene> scenes[] = {
      std::make_unique<TreeScene>("terrain", terrain(75)),
      std::make_unique<TreeScene>("soup", soup(12000, seed())),
      std::make_unique<TreeScene>("spheres", spheres(20000, seed())),
      std::make_unique<TreeScene>("large terrain", terrain(250))};
  for (const auto& scene : scenes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const uint32_t leaf_size : {1u, width}) {
        const WideTree apart = build(*scene, width, leaf_size, false, one_thread_);
        const WideTree merged = build(*scene, width, leaf_size, true, one_thread_);
        verify(apart, *scene);
        verify(merged, *scene);
        const double slots = fill(merged.used_slots, merged.node_count, width);
        const double lanes = fill(merged.used_lanes, merged.leaf_block_count, width);
        std::printf(
            "%-13s %6u triangles, width %2u, leaves of %2u: slots %.2f %% (apart %.2f %%), "
            "lanes %.2f %% (apart %.2f %%)\n",
            scene->name().c_str(), scene->count(), width, leaf_size, 100 * slots,
            100 * fill(apart.used_slots, apart.node_count, width), 100 * lanes,
            100 * fill(apart.used_lanes, apart.leaf_block_count, width));
        EXPECT_EQ(apart.used_slots, merged.used_slots);
        EXPECT_EQ(apart.used_lanes, merged.used_lanes);
        EXPECT_EQ(apart.sah_cost, merged.sah_cost);
        EXPECT_EQ(apart.depth, merged.depth);
        if (width >= 8) {
          // A grid cut into equal parts has many nodes of nearly one size, which do not add up to
          // a full one.
          const bool is_regular = scene->name() == "large terrain" && leaf_size == 8;
          EXPECT_GE(slots, is_regular ? 0.93 : 0.96);
          EXPECT_GE(lanes, 0.90);
        }
      }
    }
  }
}

TEST_F(WideTreeTest, MergingFillsTheNodesOfTheOptimalContraction) {
  contraction_ = ContractionMethod::kOptimal;
  const std::unique_ptr<TreeScene> scenes[] = {
      std::make_unique<TreeScene>("terrain", terrain(75)),
      std::make_unique<TreeScene>("soup", soup(12000, seed())),
      std::make_unique<TreeScene>("spheres", spheres(20000, seed())),
      std::make_unique<TreeScene>("large terrain", terrain(250))};
  for (const auto& scene : scenes) {
    for (const uint32_t width : {8u, 16u}) {
      const WideTree tree = build(*scene, width, width / 2, true, one_thread_);
      verify(tree, *scene);
      const double slots = fill(tree.used_slots, tree.node_count, width);
      const double lanes = fill(tree.used_lanes, tree.leaf_block_count, width);
      std::printf("%-13s %6u triangles, width %2u: slots %.2f %%, lanes %.2f %%\n",
                  scene->name().c_str(), scene->count(), width, 100 * slots, 100 * lanes);
      EXPECT_GE(slots, 0.96);
      EXPECT_GE(lanes, 0.94);
    }
  }
}

TEST_F(WideTreeTest, OptimalContractionsOfDegenerateInputsGiveValidTrees) {
  contraction_ = ContractionMethod::kOptimal;
  for (NamedMesh& named : degenerate_meshes(seed())) {
    const TreeScene scene(named.name, named.mesh);
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const uint32_t leaf_size : {1u, width / 2}) {
        SCOPED_TRACE(named.name + ", width " + std::to_string(width));
        EXPECT_NO_THROW(verify(build(scene, width, leaf_size, true, one_thread_), scene));
      }
    }
  }
}

TEST_F(WideTreeTest, DegenerateInputsGiveValidTrees) {
  for (NamedMesh& named : degenerate_meshes(seed())) {
    const TreeScene scene(named.name, named.mesh);
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const bool merge : {false, true}) {
        for (const uint32_t leaf_size : {1u, width}) {
          SCOPED_TRACE(named.name + ", width " + std::to_string(width));
          EXPECT_NO_THROW(verify(build(scene, width, leaf_size, merge, one_thread_), scene));
        }
      }
    }
  }
}

TEST_F(WideTreeTest, NoTrianglesGiveNothingToHit) {
  const TreeScene scene("empty", Mesh{});
  const WideTree tree = build(scene, 8, 8, true, one_thread_);
  EXPECT_EQ(tree.view.root.mask(), 0u);
  EXPECT_EQ(tree.node_count + tree.leaf_block_count, 0u);
  EXPECT_NO_THROW(verify(tree, scene));
}

TEST_F(WideTreeTest, AFewTrianglesAreOneLeaf) {
  const TreeScene scene("three", soup(3, seed()));
  const WideTree tree = build(scene, 8, 8, true, one_thread_);
  EXPECT_EQ(tree.view.root, ChildReference::to_leaf(0, 7));
  EXPECT_EQ(tree.depth, 0u);
  EXPECT_DOUBLE_EQ(tree.sah_cost, 1.0);
}

TEST_F(WideTreeTest, BytesAreEqualOnAnyNumberOfThreads) {
  const TreeScene scene("spheres", spheres(20000, seed()));
  const kiwami::Parallel plain_threads(0, run_on_plain_threads, nullptr, 4);
  const Threads two(2);
  const WideTree reference = build(scene, 8, 8, true, one_thread_);
  for (const kiwami::Parallel* parallel :
       {&plain_threads, static_cast<const kiwami::Parallel*>(&two)}) {
    const WideTree tree = build(scene, 8, 8, true, *parallel);
    ASSERT_EQ(tree.memory.size(), reference.memory.size());
    EXPECT_EQ(std::memcmp(tree.memory.data(), reference.memory.data(), tree.memory.size()), 0);
    EXPECT_EQ(tree.view.root, reference.view.root);
  }
}

TEST_F(WideTreeTest, RefusesOtherWidthsAndLeavesThatAreTooLarge) {
  const TreeScene scene("soup", soup(100, seed()));
  EXPECT_THROW(build(scene, 5, 4, true, one_thread_), kiwami::Error);
  EXPECT_THROW(build(scene, 4, 8, true, one_thread_), kiwami::Error);
}

/// Breaks one thing in a tree of eight slots; the verifier must name it.
class CorruptedWideTree : public WideTreeTest {
 protected:
  CorruptedWideTree() : scene_("spheres", spheres(2000, 1)) {
    tree_ = build(scene_, 8, 6, true, one_thread_);
    verify(tree_, scene_);
  }

  WideNode<8>* nodes() { return tree_.nodes<8>(); }
  LeafBlock<8>* leaves() { return tree_.leaves<8>(); }
  void set_mask(ChildReference& child, uint32_t mask) {
    child = child.is_leaf() ? ChildReference::to_leaf(child.offset(), mask)
                            : ChildReference::to_node(child.offset(), mask);
  }

  /// The first node slot (number of node, slot) that refers to a leaf, or to a node.
  std::pair<uint32_t, int> find_slot(bool to_leaf) {
    for (uint32_t i = 0; i < tree_.node_count; ++i) {
      for (int slot = 0; slot < 8; ++slot) {
        const ChildReference child = nodes()[i].child[slot];
        if (child.mask() != 0 && child.is_leaf() == to_leaf) return {i, slot};
      }
    }
    throw std::logic_error("no such slot");
  }
  std::pair<uint32_t, int> find_unused_slot() {
    for (uint32_t i = 0; i < tree_.node_count; ++i) {
      for (int slot = 0; slot < 8; ++slot) {
        if (nodes()[i].child[slot].mask() == 0) return {i, slot};
      }
    }
    throw std::logic_error("no unused slot");
  }
  std::pair<uint32_t, int> find_unused_lane() {
    for (uint32_t i = 0; i < tree_.leaf_block_count; ++i) {
      for (int lane = 0; lane < 8; ++lane) {
        if (leaves()[i].id[lane] == KIWAMI_INVALID_ID) return {i, lane};
      }
    }
    throw std::logic_error("no unused lane");
  }

  void expect_verdict(const char* part) {
    try {
      verify(tree_, scene_);
      ADD_FAILURE() << "the verifier found nothing, expected: " << part;
    } catch (const kiwami::Error& error) {
      EXPECT_EQ(error.result(), KIWAMI_ERROR_VALIDATION);
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }

  TreeScene scene_;
  WideTree tree_;
};

TEST_F(CorruptedWideTree, ReferenceOutOfRange) {
  const auto [node, slot] = find_slot(false);
  nodes()[node].child[slot] = tree_.node_reference(tree_.node_count, 1);
  expect_verdict("as a node, expected");
}
TEST_F(CorruptedWideTree, LeafReferenceOutOfRange) {
  const auto [node, slot] = find_slot(true);
  nodes()[node].child[slot] = tree_.leaf_reference(tree_.leaf_block_count, 1);
  expect_verdict("as a leaf block, expected");
}
TEST_F(CorruptedWideTree, ReferenceBetweenTwoNodes) {
  const auto [node, slot] = find_slot(false);
  nodes()[node].child[slot].bits += 64;
  expect_verdict("as a node, expected");
}
TEST_F(CorruptedWideTree, LeafReferenceToANode) {
  const auto [node, slot] = find_slot(true);
  nodes()[node].child[slot] = ChildReference::to_leaf(0, 1);
  expect_verdict("as a leaf block, expected");
}
TEST_F(CorruptedWideTree, CycleToTheRoot) {
  const auto [node, slot] = find_slot(false);
  nodes()[node].child[slot] = tree_.view.root;
  expect_verdict("of which others own");
}
TEST_F(CorruptedWideTree, MaskOfNothing) {
  const auto [node, slot] = find_slot(false);
  set_mask(nodes()[node].child[slot], 0);
  expect_verdict("with mask 0x0");
}
TEST_F(CorruptedWideTree, MaskBeyondTheWidth) {
  const auto [node, slot] = find_slot(true);
  ChildReference& child = nodes()[node].child[slot];
  set_mask(child, child.mask() | 0x100);
  expect_verdict("expected some of 8 bits");
}
TEST_F(CorruptedWideTree, MaskWithoutOneOfItsLanes) {
  const auto [node, slot] = find_slot(true);
  ChildReference& child = nodes()[node].child[slot];
  ASSERT_NE(child.mask() & (child.mask() - 1), 0u);
  set_mask(child, child.mask() & (child.mask() - 1));
  expect_verdict("contents but no owner");
}
TEST_F(CorruptedWideTree, ChildBoxOutsideItsParents) {
  const auto [node, slot] = find_slot(false);
  nodes()[node].bounds[1][1][slot] = nodes()[node].bounds[1][0][slot];
  expect_verdict("leaves the box");
}
TEST_F(CorruptedWideTree, LeafBoxAnUlpTooSmall) {
  const auto [node, slot] = find_slot(true);
  float& upper = nodes()[node].bounds[0][1][slot];
  upper = std::nextafter(upper, -FLT_MAX);
  expect_verdict("leaves its box on axis 0");
}
TEST_F(CorruptedWideTree, EmptyBox) {
  const auto [node, slot] = find_slot(true);
  std::swap(nodes()[node].bounds[2][0][slot], nodes()[node].bounds[2][1][slot]);
  expect_verdict("is empty");
}
TEST_F(CorruptedWideTree, NanBox) {
  const auto [node, slot] = find_slot(true);
  nodes()[node].bounds[2][0][slot] = NAN;
  expect_verdict("is empty");
}
TEST_F(CorruptedWideTree, UnusedSlotWithABox) {
  const auto [node, slot] = find_unused_slot();
  nodes()[node].bounds[2][0][slot] = 0;
  expect_verdict("contents but no owner");
}
TEST_F(CorruptedWideTree, UnusedLaneWithAVertex) {
  const auto [block, lane] = find_unused_lane();
  leaves()[block].position[1][2][lane] = 0;
  expect_verdict("contents but no owner");
}
TEST_F(CorruptedWideTree, ChangedVertex) {
  leaves()[0].position[1][2][0] = std::nextafter(leaves()[0].position[1][2][0], FLT_MAX);
  expect_verdict("is not the original one");
}
TEST_F(CorruptedWideTree, TriangleTwice) {
  // Triangles that are equal but for their ids, or the vertices would give it away.
  Mesh mesh = spheres(200, 1);
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i) mesh.triangles[i] = mesh.triangles[0];
  const TreeScene equal("equal", mesh);
  tree_ = build(equal, 8, 8, true, one_thread_);
  verify(tree_, equal);
  leaves()[1].id[0] = leaves()[0].id[0];
  try {
    verify(tree_, equal);
    ADD_FAILURE();
  } catch (const kiwami::Error& error) {
    EXPECT_NE(std::string(error.what()).find("in two lanes"), std::string::npos) << error.what();
  }
}
TEST_F(CorruptedWideTree, UnknownTriangle) {
  leaves()[1].id[0] = scene_.count();
  expect_verdict("has id 2000");
}
TEST_F(CorruptedWideTree, GreatestBoundTooSmall) {
  tree_.view.greatest_bound.x = std::nextafter(tree_.view.greatest_bound.x, 0.0f);
  expect_verdict("leaves the box");
}
TEST_F(CorruptedWideTree, NanCentre) {
  tree_.view.centre.z = NAN;
  expect_verdict("centre on axis 2");
}
TEST_F(CorruptedWideTree, MovedCentre) {
  tree_.view.centre.z += 1;
  expect_verdict("leaves its box on axis 2");
}
TEST_F(CorruptedWideTree, RootMaskWithoutASlot) {
  const uint32_t mask = tree_.view.root.mask();
  set_mask(tree_.view.root, mask & (mask - 1));
  expect_verdict("contents but no owner");
}
TEST_F(CorruptedWideTree, RootWithoutAMask) {
  set_mask(tree_.view.root, 0);
  expect_verdict("contents but no owner");
}
TEST_F(CorruptedWideTree, WrongTotals) {
  ++tree_.used_slots;
  expect_verdict("used slots");
  --tree_.used_slots;
  ++tree_.used_lanes;
  expect_verdict("used lanes");
  --tree_.used_lanes;
  ++tree_.depth;
  expect_verdict("levels");
  --tree_.depth;
  tree_.node_count += 1;
  expect_verdict("bytes do not hold");
  tree_.node_count -= 1;
  tree_.leaf_block_count -= 1;
  expect_verdict("bytes do not hold");
  tree_.leaf_block_count += 1;
  tree_.width = 7;
  expect_verdict("width is 7");
}
TEST_F(CorruptedWideTree, MissingTriangle) {
  try {
    kiwami::verify_wide_tree(tree_, scene_.source(), scene_.count() + 1, memory_);
    ADD_FAILURE();
  } catch (const kiwami::Error& error) {
    EXPECT_NE(std::string(error.what()).find("triangles"), std::string::npos);
  }
}

}  // namespace
}  // namespace kiwami_tests

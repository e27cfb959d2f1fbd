// SPDX-License-Identifier: Apache-2.0
#include "wide/wide_bottom_up.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>

#include "builders/lbvh_builder.h"
#include "bvh/tree_edit.h"
#include "support/environment.h"
#include "unit/tree_scenes.h"
#include "unit/wide_drafts.h"
#include "wide/cluster_forest.h"
#include "wide/optimal_contraction.h"
#include "wide/wide_tree.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::BuildPrimitive;
using kiwami::ClusterForest;
using kiwami::NearestPlaces;
using kiwami::WideBottomUpConfig;
using kiwami::WideDraft;
using kiwami::WideTree;
using kiwami::WideTreeConfig;

class WideBottomUp : public testing::Test {
 protected:
  void SetUp() override { std::printf("seed %llu\n", static_cast<unsigned long long>(seed())); }

  static WideBottomUpConfig config_of(uint32_t width) {
    WideBottomUpConfig config;
    config.width = config.leaf_width = width;
    config.fill_nodes = true;
    return config;
  }

  WideDraft draft(const TreeScene& scene, const WideBottomUpConfig& config,
                  const kiwami::Parallel& parallel) {
    return kiwami::build_wide_bottom_up(scene.primitives(memory_), config, memory_, parallel);
  }

  WideTree pack(const TreeScene& scene, const WideDraft& draft, uint32_t width) {
    WideTreeConfig config;
    config.width = width;
    return kiwami::pack_wide_tree(draft, scene.source(), config, memory_, one_thread_);
  }

  void verify(const TreeScene& scene, const WideBottomUpConfig& config) {
    const WideTree tree = pack(scene, draft(scene, config, one_thread_), config.width);
    kiwami::verify_wide_tree(tree, scene.source(), scene.count(), memory_);
  }

  kiwami::Memory memory_{nullptr, nullptr, nullptr};
  Threads one_thread_{1};
  Threads many_threads_{5};
};

TEST_F(WideBottomUp, DegenerateInputsGiveValidTrees) {
  for (NamedMesh& named : degenerate_meshes(seed())) {
    const TreeScene scene(named.name, named.mesh);
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const uint32_t block_size : {256u, 2048u}) {
        SCOPED_TRACE(named.name + ", width " + std::to_string(width));
        WideBottomUpConfig config = config_of(width);
        config.block_size = block_size;
        EXPECT_NO_THROW(verify(scene, config));
      }
    }
  }
}

TEST_F(WideBottomUp, TreesOfSeveralLevelsAreValid) {
  const std::unique_ptr<TreeScene> scenes[] = {
      std::make_unique<TreeScene>("terrain", terrain(150)),
      std::make_unique<TreeScene>("soup", soup(30000, seed())),
      std::make_unique<TreeScene>("spheres", spheres(30000, seed()))};
  for (const auto& scene : scenes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const uint32_t radius : {4u, 8u, 16u}) {
        SCOPED_TRACE(scene->name() + ", width " + std::to_string(width));
        WideBottomUpConfig config = config_of(width);
        config.block_size = 256;
        config.radius = radius;
        config.fill_nodes = radius != 8;
        EXPECT_NO_THROW(verify(*scene, config));
      }
    }
  }
}

TEST_F(WideBottomUp, NestedBoxesStayWithinTheGreatestDepth) {
  const TreeScene scene("nested", nested(20000));
  for (const uint32_t width : {4u, 8u, 16u}) {
    for (const uint32_t block_size : {256u, 2048u, 65536u}) {
      WideBottomUpConfig config = config_of(width);
      config.block_size = block_size;
      EXPECT_NO_THROW(verify(scene, config)) << width << " " << block_size;
    }
  }
}

TEST_F(WideBottomUp, TheNumberOfThreadsDoesNotShow) {
  const TreeScene scene("soup", soup(30000, seed()));
  WideBottomUpConfig config = config_of(8);
  config.block_size = 512;
  const WideDraft one = draft(scene, config, one_thread_);
  const WideDraft many = draft(scene, config, many_threads_);
  EXPECT_TRUE(are_equal(one, many));
}

TEST_F(WideBottomUp, CostsLessThanTheContractedLinearTree) {
  const std::unique_ptr<TreeScene> scenes[] = {
      std::make_unique<TreeScene>("terrain", terrain(150)),
      std::make_unique<TreeScene>("spheres", spheres(30000, seed()))};
  for (const auto& scene : scenes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      const WideTree tree = pack(*scene, draft(*scene, config_of(width), one_thread_), width);
      BinaryBvh linear =
          kiwami::LbvhBuilder::build(scene->primitives(memory_), {}, memory_, one_thread_);
      kiwami::collapse_leaves(linear, width, {1.0f, 1.0f, width}, memory_);
      WideTreeConfig config;
      config.width = width;
      const WideTree contracted =
          kiwami::build_wide_tree(std::move(linear), scene->source(), config, memory_, one_thread_);
      std::printf("%-8s width %2u: %.2f, linear %.2f\n", scene->name().c_str(), width,
                  tree.sah_cost, contracted.sah_cost);
      EXPECT_LT(tree.sah_cost, contracted.sah_cost) << scene->name() << ", width " << width;
    }
  }
}

/// The binary tree that a forest holds when one tree is left.
class ForestAsBinaryTree {
 public:
  template <int N>
  static BinaryBvh of(const ClusterForest<N>& forest, kiwami::Memory& memory) {
    const uint32_t leaves = forest.leaf_count();
    BinaryBvh bvh{kiwami::Array<kiwami::BinaryNode>(memory, 2 * size_t{leaves} - 1),
                  kiwami::Array<uint32_t>(memory, leaves)};
    uint32_t next = 1;
    copy(forest, forest.tree_at(0), 0, next, bvh);
    kiwami::relabel_depth_first(bvh, memory);
    return bvh;
  }

 private:
  template <int N>
  static void copy(const ClusterForest<N>& forest, uint32_t tree, uint32_t to, uint32_t& next,
                   BinaryBvh& bvh) {
    if (tree < forest.leaf_count()) {
      bvh.primitive_ids[tree] = forest.primitive_id(tree);
      bvh.nodes[to] = {forest.box_of(tree), tree, 1};
      return;
    }
    const uint32_t first = next;
    next += 2;
    bvh.nodes[to] = {forest.box_of(tree), first, 0};
    copy(forest, forest.left_child(tree), first, next, bvh);
    copy(forest, forest.right_child(tree), first + 1, next, bvh);
  }
};

template <int N>
void expect_least_cost(const Mesh& mesh, uint32_t leaf_width, float node_cost,
                       kiwami::Memory& memory) {
  const auto primitives = primitives_of(mesh, memory);
  kiwami::Bounds all = kiwami::Bounds::empty();
  for (const BuildPrimitive& primitive : primitives) all.extend(primitive.bounds());
  WideBottomUpConfig config;
  config.width = N;
  config.leaf_width = leaf_width;
  config.node_cost = node_cost;
  config.block_size = static_cast<uint32_t>(primitives.size());
  ClusterForest<N> forest(config, all.half_area(), config.block_size, memory);
  forest.clear();
  for (const BuildPrimitive& primitive : primitives) forest.add_primitive(primitive);
  forest.join_nearest(1);
  ASSERT_EQ(forest.place_count(), 1u);

  const BinaryBvh bvh = ForestAsBinaryTree::of(forest, memory);
  const kiwami::Contraction least =
      kiwami::contract_optimally(bvh, {N, leaf_width, node_cost, 1.0f, false}, memory, Threads(1));
  const double expected =
      (node_cost * least.node_area + least.leaf_area) / bvh.nodes[0].bounds.half_area();
  EXPECT_NEAR(forest.costs_of(forest.tree_at(0)).of(1), expected, 1e-4 * expected);
}

TEST_F(WideBottomUp, ChoosesTheChildrenOfLeastCostInABlock) {
  for (const Mesh& mesh : {terrain(20), soup(700, seed()), spheres(900, seed())}) {
    for (const float node_cost : {0.3f, 1.0f, 3.0f}) {
      expect_least_cost<4>(mesh, 4, node_cost, memory_);
      expect_least_cost<8>(mesh, 8, node_cost, memory_);
      expect_least_cost<8>(mesh, 3, node_cost, memory_);
      expect_least_cost<16>(mesh, 16, node_cost, memory_);
    }
  }
}

TEST_F(WideBottomUp, WritesWhatTheBlockCosts) {
  const TreeScene scene("soup", soup(900, seed()));
  for (const uint32_t width : {4u, 8u, 16u}) {
    WideBottomUpConfig config = config_of(width);
    config.fill_nodes = false;
    const WideDraft of_one_block = draft(scene, config, one_thread_);
    const double cost =
        (of_one_block.node_area + of_one_block.leaf_area) / of_one_block.boxes[0].half_area();
    config.block_size = 256;
    const WideDraft of_more = draft(scene, config, one_thread_);
    // What is committed early can only be worse than what is chosen among all.
    EXPECT_LE(cost, 1.02 * (of_more.node_area + of_more.leaf_area) / of_more.boxes[0].half_area());
  }
}

TEST_F(WideBottomUp, FindsTheNearestWithinItsReach) {
  const auto primitives = primitives_of(soup(500, seed()), memory_);
  NearestPlaces nearest(memory_, 500);
  for (uint32_t i = 0; i < 500; ++i) nearest.set(i, primitives[i].lower, primitives[i].upper);
  nearest.find<2>(500);
  const auto distance = [&](uint32_t a, uint32_t b) {
    kiwami::Bounds both = primitives[a].bounds();
    both.extend(primitives[b].bounds());
    return both.half_area();
  };
  uint32_t mutual = 0;
  for (uint32_t i = 0; i < 500; ++i) {
    float least = std::numeric_limits<float>::infinity();
    for (uint32_t j = i < 8 ? 0 : i - 8; j <= std::min(i + 8, 499u); ++j) {
      if (j != i) least = std::min(least, distance(i, j));
    }
    ASSERT_NE(nearest.nearest(i), i);
    ASSERT_LE(std::max(nearest.nearest(i), i) - std::min(nearest.nearest(i), i), 8u);
    EXPECT_EQ(distance(i, nearest.nearest(i)), least);
    EXPECT_EQ(nearest.is_mutual(i), nearest.nearest(nearest.nearest(i)) == i);
    mutual += nearest.is_mutual(i);
  }
  EXPECT_GE(mutual, 100u);
}

TEST_F(WideBottomUp, OfEqualBoxesNeighboursAreNearest) {
  NearestPlaces nearest(memory_, 200);
  for (uint32_t i = 0; i < 200; ++i) nearest.set(i, {1, 1, 1}, {2, 2, 2});
  nearest.find<4>(200);
  for (uint32_t i = 0; i < 200; ++i) EXPECT_EQ(nearest.nearest(i), i ^ 1);
}

}  // namespace
}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
#include "wide/wide_top_down.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>

#include "support/environment.h"
#include "unit/tree_scenes.h"
#include "unit/wide_drafts.h"
#include "wide/optimal_contraction.h"
#include "wide/wide_tree.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::BinnedSahBuilder;
using kiwami::WideDraft;
using kiwami::WideTopDownConfig;
using kiwami::WideTree;
using kiwami::WideTreeConfig;

class WideTopDown : public testing::Test {
 protected:
  void SetUp() override { std::printf("seed %llu\n", static_cast<unsigned long long>(seed())); }

  static WideTopDownConfig config_of(uint32_t width, uint32_t subtree_size) {
    WideTopDownConfig config;
    config.width = config.leaf_width = width;
    config.splits.max_leaf_size = 4;
    config.splits.block_size = width;
    config.splits.subtree_size = subtree_size;
    return config;
  }

  WideDraft draft(const TreeScene& scene, const WideTopDownConfig& config,
                  const kiwami::Parallel& parallel) {
    return kiwami::build_wide_top_down(scene.primitives(memory_), config, memory_, parallel);
  }

  void verify(const TreeScene& scene, const WideTopDownConfig& config) {
    WideTreeConfig packing;
    packing.width = config.width;
    const WideTree tree = kiwami::pack_wide_tree(draft(scene, config, one_thread_), scene.source(),
                                                 packing, memory_, one_thread_);
    kiwami::verify_wide_tree(tree, scene.source(), scene.count(), memory_);
  }

  static double cost_of(double node_cost, double node_area, double leaf_area, double root_area) {
    return (node_cost * node_area + leaf_area) / root_area;
  }

  kiwami::Memory memory_{nullptr, nullptr, nullptr};
  Threads one_thread_{1};
  Threads many_threads_{5};
};

TEST_F(WideTopDown, DegenerateInputsGiveValidTrees) {
  for (NamedMesh& named : degenerate_meshes(seed())) {
    const TreeScene scene(named.name, named.mesh);
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const uint32_t subtree_size : {0u, 50u}) {
        SCOPED_TRACE(named.name + ", width " + std::to_string(width));
        EXPECT_NO_THROW(verify(scene, config_of(width, subtree_size)));
      }
    }
  }
}

TEST_F(WideTopDown, TreesOfManySubtreesAreValid) {
  const std::unique_ptr<TreeScene> scenes[] = {
      std::make_unique<TreeScene>("terrain", terrain(100)),
      std::make_unique<TreeScene>("soup", soup(20000, seed())),
      std::make_unique<TreeScene>("nested", nested(20000))};
  for (const auto& scene : scenes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      // The least size leaves single primitives as subtrees, and most nodes near the root.
      for (const uint32_t subtree_size : {1u, 300u, 0u}) {
        SCOPED_TRACE(scene->name() + ", width " + std::to_string(width));
        WideTopDownConfig config = config_of(width, subtree_size);
        config.fill_nodes = subtree_size == 300;
        EXPECT_NO_THROW(verify(*scene, config));
      }
    }
  }
}

TEST_F(WideTopDown, TheNumberOfThreadsDoesNotShow) {
  const TreeScene scene("soup", soup(30000, seed()));
  for (const uint32_t subtree_size : {200u, 5000u}) {
    const WideTopDownConfig config = config_of(8, subtree_size);
    EXPECT_TRUE(are_equal(draft(scene, config, one_thread_), draft(scene, config, many_threads_)));
  }
}

/// The reference keeps the binary tree, of the same splits, and contracts it optimally.
TEST_F(WideTopDown, CostsWhatTheOptimalContractionDoes) {
  const std::unique_ptr<TreeScene> scenes[] = {
      std::make_unique<TreeScene>("terrain", terrain(80)),
      std::make_unique<TreeScene>("soup", soup(12000, seed())),
      std::make_unique<TreeScene>("spheres", spheres(12000, seed()))};
  for (const auto& scene : scenes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const float node_cost : {0.5f, 2.0f}) {
        WideTopDownConfig config = config_of(width, 20000);
        config.splits.node_cost = node_cost;
        const BinaryBvh binary = BinnedSahBuilder::build(scene->primitives(memory_), config.splits,
                                                         memory_, one_thread_);
        const double root_area = binary.nodes[0].bounds.half_area();
        const kiwami::Contraction least = kiwami::contract_optimally(
            binary, {width, width, node_cost, 1.0f, false}, memory_, one_thread_);
        const double expected = cost_of(node_cost, least.node_area, least.leaf_area, root_area);

        const WideDraft whole = draft(*scene, config, one_thread_);
        const double cost = cost_of(node_cost, whole.node_area, whole.leaf_area, root_area);
        EXPECT_NEAR(cost, expected, 1e-4 * expected) << scene->name() << ", width " << width;
        // What is written early is not divided any more.
        config.splits.subtree_size = 1000;
        const WideDraft parts = draft(*scene, config, one_thread_);
        const double of_parts = cost_of(node_cost, parts.node_area, parts.leaf_area, root_area);
        EXPECT_GE(of_parts, expected * (1 - 1e-4)) << scene->name() << ", width " << width;
        EXPECT_LE(of_parts, expected * 1.05) << scene->name() << ", width " << width;
      }
    }
  }
}

}  // namespace
}  // namespace kiwami_tests

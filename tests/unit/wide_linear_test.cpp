// SPDX-License-Identifier: Apache-2.0
#include "wide/wide_linear.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>

#include "builders/lbvh_builder.h"
#include "core/error.h"
#include "support/environment.h"
#include "unit/tree_scenes.h"
#include "unit/wide_drafts.h"
#include "wide/wide_tree.h"

namespace kiwami_tests {
namespace {

using kiwami::WideDraft;
using kiwami::WideLinearConfig;
using kiwami::WideTree;
using kiwami::WideTreeConfig;

class WideLinear : public testing::Test {
 protected:
  void SetUp() override { std::printf("seed %llu\n", static_cast<unsigned long long>(seed())); }

  WideDraft draft(const TreeScene& scene, const WideLinearConfig& config,
                  const kiwami::Parallel& parallel) {
    return kiwami::build_wide_linear(scene.primitives(memory_), config, memory_, parallel);
  }

  void verify(const TreeScene& scene, const WideLinearConfig& config) {
    WideTreeConfig packing;
    packing.width = config.width;
    const WideTree tree = kiwami::pack_wide_tree(draft(scene, config, one_thread_), scene.source(),
                                                 packing, memory_, one_thread_);
    kiwami::verify_wide_tree(tree, scene.source(), scene.count(), memory_);
  }

  kiwami::Memory memory_{nullptr, nullptr, nullptr};
  Threads one_thread_{1};
  Threads many_threads_{5};
};

TEST_F(WideLinear, DegenerateInputsGiveValidTrees) {
  for (NamedMesh& named : degenerate_meshes(seed())) {
    const TreeScene scene(named.name, named.mesh);
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const uint32_t part_size : {1u, 50u, 16384u}) {
        SCOPED_TRACE(named.name + ", width " + std::to_string(width));
        EXPECT_NO_THROW(verify(scene, {width, width, part_size}));
      }
    }
  }
}

TEST_F(WideLinear, TreesOfManyPartsAreValid) {
  const std::unique_ptr<TreeScene> scenes[] = {
      std::make_unique<TreeScene>("terrain", terrain(100)),
      std::make_unique<TreeScene>("soup", soup(20000, seed())),
      std::make_unique<TreeScene>("nested", nested(20000))};
  for (const auto& scene : scenes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      // The least size leaves single primitives as parts, and all nodes to the top.
      for (const uint32_t part_size : {1u, 300u, 5000u}) {
        for (const uint32_t leaf_width : {1u, width}) {
          SCOPED_TRACE(scene->name() + ", width " + std::to_string(width));
          EXPECT_NO_THROW(verify(*scene, {width, leaf_width, part_size}));
        }
      }
    }
  }
}

TEST_F(WideLinear, TheNumberOfThreadsDoesNotShow) {
  const TreeScene scene("soup", soup(30000, seed()));
  for (const uint32_t part_size : {200u, 5000u}) {
    const WideLinearConfig config = {8, 8, part_size};
    EXPECT_TRUE(are_equal(draft(scene, config, one_thread_), draft(scene, config, many_threads_)));
  }
}

/// Parts decide who builds what, not what is built.
TEST_F(WideLinear, PartsDoNotShowInTheCost) {
  const TreeScene scene("soup", soup(20000, seed()));
  const WideDraft whole = draft(scene, {8, 8, 1u << 20}, one_thread_);
  for (const uint32_t part_size : {1u, 100u, 3000u}) {
    const WideDraft parts = draft(scene, {8, 8, part_size}, one_thread_);
    EXPECT_EQ(parts.nodes.size(), whole.nodes.size());
    EXPECT_EQ(parts.leaf_sizes.size(), whole.leaf_sizes.size());
    EXPECT_EQ(parts.depth, whole.depth);
    EXPECT_NEAR(parts.node_area, whole.node_area, 1e-9 * whole.node_area);
    EXPECT_NEAR(parts.leaf_area, whole.leaf_area, 1e-9 * whole.leaf_area);
  }
}

/// The reference keeps the binary tree over the same codes, and contracts it by area.
TEST_F(WideLinear, CostsAboutAsMuchAsTheContractedLinearTree) {
  const std::unique_ptr<TreeScene> scenes[] = {
      std::make_unique<TreeScene>("terrain", terrain(80)),
      std::make_unique<TreeScene>("soup", soup(12000, seed())),
      std::make_unique<TreeScene>("spheres", spheres(12000, seed()))};
  for (const auto& scene : scenes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      kiwami::LbvhBuilder::Config binary_config;
      binary_config.curve_code = kiwami::CurveCode::kExtended;
      binary_config.max_leaf_size = width;
      WideTreeConfig packing;
      packing.width = width;
      const WideTree contracted =
          kiwami::build_wide_tree(kiwami::LbvhBuilder::build(scene->primitives(memory_),
                                                             binary_config, memory_, one_thread_),
                                  scene->source(), packing, memory_, one_thread_);
      const WideTree direct =
          kiwami::pack_wide_tree(draft(*scene, {width, width, 2000}, one_thread_), scene->source(),
                                 packing, memory_, one_thread_);
      EXPECT_LE(direct.sah_cost, contracted.sah_cost * 1.25)
          << scene->name() << ", width " << width;
    }
  }
}

TEST_F(WideLinear, RefusesOtherWidths) {
  const TreeScene scene("terrain", terrain(4));
  EXPECT_THROW(draft(scene, {5, 5, 100}, one_thread_), kiwami::Error);
}

}  // namespace
}  // namespace kiwami_tests

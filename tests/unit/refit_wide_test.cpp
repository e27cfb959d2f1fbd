// SPDX-License-Identifier: Apache-2.0
#include "wide/refit_wide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "builders/binned_sah_builder.h"
#include "builders/spatial_split_builder.h"
#include "core/error.h"
#include "support/environment.h"
#include "support/random.h"
#include "unit/tree_scenes.h"

namespace kiwami_tests {
namespace {

using kiwami::RefitResult;
using kiwami::WideTree;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A tree over a mesh whose vertices move.
class RefitWideTest : public testing::Test {
 protected:
  RefitWideTest() : memory_(nullptr, nullptr, nullptr) {}

  void set_mesh(Mesh mesh) {
    mesh_ = std::move(mesh);
    view_ = {};
    view_.vertices = reinterpret_cast<const unsigned char*>(mesh_.vertices.data());
    view_.vertex_stride = sizeof mesh_.vertices[0];
    view_.vertex_count = mesh_.vertices.size();
    view_.indices = reinterpret_cast<const unsigned char*>(mesh_.triangles.data());
    view_.index_stride = sizeof mesh_.triangles[0];
    view_.triangle_count = static_cast<uint32_t>(mesh_.triangles.size());
  }

  WideTree build(uint32_t width, bool merge, bool with_splits = false) {
    const TreeScene scene("moving", mesh_);
    auto primitives = scene.primitives(memory_);
    kiwami::BinaryBvh binary;
    if (with_splits) {
      kiwami::SpatialSplitBuilder::Config config;
      config.max_leaf_size = config.block_size = width;
      config.split_budget = 1.0;
      binary = kiwami::SpatialSplitBuilder::build(std::move(primitives), scene.source(), config,
                                                  memory_, one_thread_);
    } else {
      kiwami::BinnedSahBuilder::Config config;
      config.max_leaf_size = config.block_size = width;
      binary = kiwami::BinnedSahBuilder::build(std::move(primitives), config, memory_, one_thread_);
    }
    kiwami::WideTreeConfig wide;
    wide.width = width;
    wide.merge_leaves = merge;
    return kiwami::build_wide_tree(std::move(binary), scene.source(), wide, memory_, one_thread_);
  }

  RefitResult refit(WideTree& tree, const kiwami::Parallel& parallel) {
    return kiwami::refit_wide_tree(tree, source_, 1.0, 1.0, memory_, parallel);
  }
  RefitResult refit(WideTree& tree) { return refit(tree, one_thread_); }

  void verify(const WideTree& tree, size_t triangle_count) {
    EXPECT_NO_THROW(kiwami::verify_wide_tree(tree, source_, triangle_count, memory_));
  }
  void verify(const WideTree& tree) { verify(tree, mesh_.triangles.size()); }

  void move_all(float distance, Random& random) {
    for (auto& vertex : mesh_.vertices) {
      for (int axis = 0; axis < 3; ++axis) vertex[axis] += distance * random.symmetric();
    }
  }

  static std::vector<unsigned char> bytes_of(const WideTree& tree) {
    return {tree.memory.begin(), tree.memory.end()};
  }

  kiwami::Memory memory_;
  Threads one_thread_{1};
  Mesh mesh_;
  kiwami::TriangleMeshView view_{};
  kiwami::TriangleSource source_{&view_, 1};
};

TEST_F(RefitWideTest, WithoutAMoveTheTreeKeepsEveryByte) {
  for (const Mesh& mesh : {terrain(40), soup(3000, seed()), spheres(3000, seed())}) {
    set_mesh(mesh);
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const bool merge : {false, true}) {
        WideTree tree = build(width, merge);
        const std::vector<unsigned char> before = bytes_of(tree);
        const kiwami::TreeView view = tree.view;
        const double cost = tree.sah_cost;
        EXPECT_EQ(refit(tree).vanished_lanes, 0u);
        EXPECT_EQ(bytes_of(tree), before) << "width " << width << ", merged " << merge;
        EXPECT_EQ(std::memcmp(&tree.view, &view, sizeof view), 0);
        EXPECT_NEAR(tree.sah_cost, cost, 1e-9 * cost);
      }
    }
  }
}

TEST_F(RefitWideTest, MovedTrianglesGiveAValidTreeWhateverTheThreads) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  Random random(seed());
  const Threads four_threads(4);
  for (const Mesh& mesh : {terrain(60), soup(8000, seed()), spheres(8000, seed())}) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      set_mesh(mesh);
      WideTree tree = build(width, true);
      WideTree other = build(width, true);
      const double built_cost = tree.sah_cost;
      for (const float distance : {0.001f, 0.1f, 10.0f}) {
        move_all(distance, random);
        const RefitResult result = refit(tree);
        verify(tree);
        refit(other, four_threads);
        EXPECT_EQ(bytes_of(tree), bytes_of(other));
        EXPECT_EQ(tree.sah_cost, other.sah_cost);
        EXPECT_FALSE(result.bounds.is_empty());
      }
      EXPECT_GT(tree.sah_cost, built_cost);
    }
  }
}

TEST_F(RefitWideTest, TrianglesOfManyLeavesHaveTheirWholeBoxInEach) {
  Random random(seed());
  set_mesh(soup(2000, seed()));
  WideTree tree = build(8, true, true);
  ASSERT_NE(tree.view.has_duplicates, 0u);
  refit(tree);
  verify(tree);
  move_all(0.5f, random);
  refit(tree);
  verify(tree);
}

TEST_F(RefitWideTest, TrianglesVanishAndComeBack) {
  Random random(seed());
  for (const uint32_t width : {4u, 8u, 16u}) {
    set_mesh(spheres(3000, seed()));
    WideTree tree = build(width, true);
    const std::vector<unsigned char> before = bytes_of(tree);
    const Mesh original = mesh_;
    const float bad[] = {kNan, std::numeric_limits<float>::infinity(),
                         -2.0f * KIWAMI_MAX_COORDINATE};
    // Some vertices, then all of them.
    for (const uint32_t one_in : {50u, 1u}) {
      for (auto& vertex : mesh_.vertices) {
        if (random.one_in(one_in)) vertex[static_cast<int>(random.below(3))] = bad[random.below(3)];
      }
      size_t left = 0;
      for (uint32_t i = 0; i < view_.triangle_count; ++i) {
        kiwami::Vec3f corner[3];
        view_.corners_of(i, corner);
        bool is_good = true;
        for (const kiwami::Vec3f& vertex : corner) {
          for (int axis = 0; axis < 3; ++axis) {
            is_good = is_good && std::abs(vertex[axis]) <= KIWAMI_MAX_COORDINATE;
          }
        }
        if (is_good) ++left;
      }
      EXPECT_EQ(refit(tree).vanished_lanes, mesh_.triangles.size() - left);
      verify(tree, left);
      if (one_in == 1) {
        EXPECT_EQ(left, 0u);
      }
    }
    mesh_.vertices = original.vertices;
    set_mesh(mesh_);
    EXPECT_EQ(refit(tree).vanished_lanes, 0u);
    verify(tree);
    EXPECT_EQ(bytes_of(tree), before);
  }
}

TEST_F(RefitWideTest, FarFromItsOldPlaceTheTreeHasANewFrame) {
  set_mesh(spheres(1000, seed()));
  WideTree tree = build(8, true);
  for (auto& vertex : mesh_.vertices) vertex.x += 1e6f;
  const RefitResult result = refit(tree);
  verify(tree);
  EXPECT_NEAR(tree.view.centre.x, 0.5f * (result.bounds.lower.x + result.bounds.upper.x), 1.0f);
  EXPECT_LT(tree.view.greatest_bound.x, result.bounds.upper.x - result.bounds.lower.x);
}

TEST_F(RefitWideTest, DegenerateMeshesGiveValidTrees) {
  for (NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    set_mesh(named.mesh);
    WideTree tree = build(8, true);
    refit(tree);
    verify(tree);
    if (mesh_.vertices.empty()) continue;
    for (auto& vertex : mesh_.vertices) vertex = mesh_.vertices[0];
    refit(tree);
    verify(tree);
  }
}

TEST_F(RefitWideTest, IndicesBeyondTheVerticesAreAnError) {
  set_mesh(soup(100, seed()));
  WideTree tree = build(8, true);
  view_.vertex_count = 10;
  try {
    refit(tree);
    ADD_FAILURE();
  } catch (const kiwami::Error& error) {
    EXPECT_EQ(error.result(), KIWAMI_ERROR_INVALID_ARGUMENT);
  }
}

}  // namespace
}  // namespace kiwami_tests

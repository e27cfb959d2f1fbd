// SPDX-License-Identifier: Apache-2.0
// Spatial splits: the clipping, the builder, and what stands downstream of triangles in several
// leaves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "builders/spatial_split_builder.h"
#include "bvh/sah_cost.h"
#include "bvh/tree_edit.h"
#include "bvh/triangle_clip.h"
#include "bvh/triangle_cover.h"
#include "bvh/verify_binary.h"
#include "core/error.h"
#include "support/environment.h"
#include "support/random.h"
#include "unit/binary_tree_test.h"
#include "wide/wide_tree.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::Bounds;
using kiwami::SpatialSplitBuilder;
using kiwami::Vec3f;
using kiwami::WideTree;
using Config = SpatialSplitBuilder::Config;

Config config_of(uint32_t max_leaf_size, double budget) {
  Config config;
  config.max_leaf_size = config.block_size = max_leaf_size;
  config.split_budget = budget;
  config.split_alpha = 0.0;
  return config;
}

/// Long thin triangles in all directions: their boxes overlap nearly everywhere.
Mesh sticks(uint32_t count, uint64_t seed) {
  Random random(seed, 77);
  Mesh mesh;
  const auto point = [&] {
    return Point{random.symmetric(), random.symmetric(), random.symmetric()};
  };
  for (uint32_t i = 0; i < count; ++i) {
    const Point a = point(), b = point();
    mesh.add(a, b, b + point() * 0.01f);
  }
  return mesh;
}

class SpatialSplit : public BinaryTreeTest {
 protected:
  /// Builds and verifies.
  BinaryBvh build(const TreeScene& scene, const Config& config, const kiwami::Parallel& parallel) {
    BinaryBvh bvh = SpatialSplitBuilder::build(scene.primitives(memory_), scene.source(), config,
                                               memory_, parallel);
    EXPECT_EQ(verdict(bvh, scene, config.max_leaf_size), "") << scene.name();
    const double budget = std::floor(config.split_budget * scene.count());
    EXPECT_LE(static_cast<double>(bvh.primitive_ids.size()), scene.count() + budget);
    EXPECT_EQ(bvh.has_duplicates, bvh.primitive_ids.size() != scene.count());
    return bvh;
  }

  /// The verifier's sentence; "" where it finds nothing.
  std::string verdict(const BinaryBvh& bvh, const TreeScene& scene, uint32_t max_leaf_size) {
    const auto primitives = scene.primitives(memory_);
    try {
      kiwami::verify_binary_bvh(bvh, primitives.data(), primitives.size(), max_leaf_size, memory_,
                                &scene.source());
    } catch (const kiwami::Error& error) {
      return error.what();
    }
    return "";
  }

  std::string verdict(const WideTree& tree, const TreeScene& scene) {
    try {
      kiwami::verify_wide_tree(tree, scene.source(), scene.count(), memory_);
    } catch (const kiwami::Error& error) {
      return error.what();
    }
    return "";
  }

  WideTree widen(BinaryBvh bvh, const TreeScene& scene, uint32_t width, bool merges,
                 kiwami::ContractionMethod contraction) {
    kiwami::WideTreeConfig config;
    config.width = config.max_leaf_size = width;
    config.merge_leaves = merges;
    config.contraction = contraction;
    return build_wide_tree(std::move(bvh), scene.source(), config, memory_, one_thread_);
  }

  Threads one_thread_{1};
  kiwami::Parallel many_threads_{0, run_on_plain_threads, nullptr, 8};
};

/// A triangle anywhere between small and large, sometimes with equal coordinates.
void random_triangle(Random& random, Vec3f corner[3]) {
  const float size = random.power_of_two(-20, 20), offset = random.power_of_two(-20, 20);
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      corner[k][axis] = random.one_in(8) ? offset : random.symmetric() * size + offset;
    }
  }
}

Bounds bounds_of(const Vec3f corner[3]) {
  Bounds box = Bounds::empty();
  for (int k = 0; k < 3; ++k) box.extend(corner[k]);
  return box;
}

/// The box of the part of a triangle on one side of a plane (below for a sign of -1), in more
/// digits than the library uses.
struct WideBox {
  long double lower[3], upper[3];

  WideBox(const Vec3f corner[3], int axis, float plane, int sign) {
    std::fill_n(lower, 3, std::numeric_limits<long double>::infinity());
    std::fill_n(upper, 3, -std::numeric_limits<long double>::infinity());
    for (int k = 0; k < 3; ++k) {
      const Vec3f &from = corner[k], &to = corner[(k + 1) % 3];
      const long double begin = from[axis], end = to[axis], at = plane;
      if ((begin - at) * sign >= 0) add(from, from, 0.0L);
      if ((begin - at) * (end - at) < 0) add(from, to, (at - begin) / (end - begin));
    }
  }

  void add(const Vec3f& from, const Vec3f& to, long double ratio) {
    for (int k = 0; k < 3; ++k) {
      const long double begin = from[k], end = to[k];
      const long double value = begin + ratio * (end - begin);
      lower[k] = std::min(lower[k], value);
      upper[k] = std::max(upper[k], value);
    }
  }
};

TEST_F(SpatialSplit, PartsOfATriangleAreRoundedOutwardsAndTight) {
  Random random(seed(), 1);
  int inexact = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Vec3f corner[3];
    random_triangle(random, corner);
    const Bounds box = bounds_of(corner);
    const int axis = trial % 3;
    const float plane = random.one_in(10)
                            ? corner[0][axis]
                            : box.lower[axis] + (box.upper[axis] - box.lower[axis]) * random.unit();
    Bounds side[2];
    kiwami::split_triangle(corner, box, axis, plane, side);
    for (int s = 0; s < 2; ++s) {
      const WideBox exact(corner, axis, plane, s == 0 ? -1 : 1);
      if (exact.lower[axis] > exact.upper[axis]) continue;
      for (int k = 0; k < 3; ++k) {
        const long double size = std::max(std::fabs(box.lower[k]), std::fabs(box.upper[k]));
        const long double error = size * 0x1p-58L, step = size * 0x1p-22L;
        ASSERT_LE(side[s].lower[k], exact.lower[k] + error);
        ASSERT_GE(side[s].upper[k], exact.upper[k] - error);
        ASSERT_GE(side[s].lower[k], exact.lower[k] - step);
        ASSERT_LE(side[s].upper[k], exact.upper[k] + step);
        inexact += static_cast<long double>(side[s].lower[k]) != exact.lower[k];
      }
    }
  }
  EXPECT_GT(inexact, 10000);
}

TEST_F(SpatialSplit, PartsStayInTheBoxThatTheyAreCutFrom) {
  const Vec3f corner[3] = {{0, 0, 0}, {4, 4, 0}, {4, 0, 0}};
  Bounds side[2];
  kiwami::split_triangle(corner, {{1, 0, 0}, {3, 1, 0}}, 0, 2.0f, side);
  EXPECT_EQ(side[0].lower.x, 1.0f);
  EXPECT_EQ(side[0].upper.x, 2.0f);
  EXPECT_EQ(side[1].upper.x, 3.0f);
  EXPECT_EQ(side[1].upper.y, 1.0f);
  // Beyond the triangle within the box: nothing.
  kiwami::split_triangle(corner, {{0, 3, 0}, {4, 4, 0}}, 0, 2.0f, side);
  EXPECT_TRUE(side[0].is_empty());
  EXPECT_FALSE(side[1].is_empty());
}

TEST_F(SpatialSplit, ACoverWithAGapIsNone) {
  Random random(seed(), 2);
  int gaps = 0, seen = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Vec3f corner[3];
    random_triangle(random, corner);
    std::vector<Bounds> boxes = {bounds_of(corner)};
    for (int cut = 0; cut < 12; ++cut) {
      const size_t chosen = random.below(static_cast<uint32_t>(boxes.size()));
      const Bounds box = boxes[chosen];
      const int axis = random.between(0, 2);
      const float plane = 0.5f * box.lower[axis] + 0.5f * box.upper[axis];
      if (!(box.lower[axis] < plane && plane < box.upper[axis])) continue;
      Bounds side[2];
      kiwami::split_triangle(corner, box, axis, plane, side);
      if (side[0].is_empty() || side[1].is_empty()) continue;
      boxes[chosen] = side[0];
      boxes.push_back(side[1]);
    }
    const Vec3f origin = {0, 0, 0};
    std::vector<Bounds> copy = boxes;
    ASSERT_TRUE(kiwami::is_covered(corner, origin, copy)) << trial;
    if (boxes.size() < 2) continue;
    // What one box held may lie on the sides of the others, where the triangle is flat.
    copy.assign(boxes.begin() + 1, boxes.end());
    seen += !kiwami::is_covered(corner, origin, copy);
    ++gaps;
  }
  EXPECT_GT(gaps, 1000);
  EXPECT_GT(seen, gaps * 9 / 10);

  // One rounding is enough.
  const Vec3f corner[3] = {{0, 0, 0}, {1, 1, 0}, {1, 0, 1}};
  Bounds halves[2];
  kiwami::split_triangle(corner, bounds_of(corner), 0, 0.3f, halves);
  EXPECT_TRUE(kiwami::is_covered(corner, {0, 0, 0}, halves));
  halves[0].upper.x = kiwami::next_down(0.3f);
  EXPECT_FALSE(kiwami::is_covered(corner, {0, 0, 0}, halves));
}

TEST_F(SpatialSplit, TreesAreValidAndWithinTheBudget) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    const TreeScene scene(named.name, named.mesh);
    for (const double budget : {0.0, 0.05, 0.3, 4.0}) {
      for (const uint32_t leaf_size : {1u, 4u, 16u}) {
        Config config = config_of(leaf_size, budget);
        build(scene, config, one_thread_);
        config.subtree_size = 16;
        build(scene, config, one_thread_);
      }
    }
  }
}

TEST_F(SpatialSplit, NoPrimitivesGiveNoNodes) {
  const BinaryBvh bvh = build(TreeScene("none", Mesh{}), Config{}, one_thread_);
  EXPECT_TRUE(bvh.nodes.empty());
  EXPECT_TRUE(bvh.primitive_ids.empty());
}

TEST_F(SpatialSplit, LongTrianglesGainAndFineMeshesAreLeftAlone) {
  const TreeScene crossed("sticks", sticks(2000, seed()));
  const double split = sah_cost(build(crossed, config_of(8, 4.0), one_thread_), {});
  const double whole = sah_cost(build(crossed, config_of(8, 0.0), one_thread_), {});
  const double binned = sah_cost(build_binned(sticks(2000, seed()), 8), {});
  std::printf("sticks: split %.1f, without a budget %.1f, binned %.1f\n", split, whole, binned);
  EXPECT_NEAR(whole, binned, 0.02 * binned);
  EXPECT_LT(split, 0.95 * binned);

  const TreeScene fine("terrain", terrain(60));
  Config config;
  const BinaryBvh bvh = build(fine, config, one_thread_);
  std::printf("terrain: %zu references of %u triangles\n", bvh.primitive_ids.size(), fine.count());
  EXPECT_LT(static_cast<double>(bvh.primitive_ids.size()), 1.1 * fine.count());
}

TEST_F(SpatialSplit, TreesAreEqualOnAnyNumberOfThreadsAndForAnySizeOfSubtrees) {
  const TreeScene scenes[] = {TreeScene("sticks", sticks(12000, seed())),
                              TreeScene("soup", soup(12000, seed()))};
  for (const TreeScene& scene : scenes) {
    Config config = config_of(8, 0.5);
    BinaryBvh reference = build(scene, config, one_thread_);
    EXPECT_TRUE(reference.has_duplicates);
    EXPECT_TRUE(are_equal(build(scene, config, many_threads_), reference));
    relabel_depth_first(reference, memory_);
    for (const uint32_t subtree_size : {~0u, 100u}) {
      config.subtree_size = subtree_size;
      BinaryBvh bvh = build(scene, config, many_threads_);
      relabel_depth_first(bvh, memory_);
      EXPECT_TRUE(are_equal(bvh, reference)) << "subtrees of " << subtree_size;
    }
  }
}

TEST_F(SpatialSplit, TheVerifierNamesWhatIsBroken) {
  const TreeScene scene("sticks", sticks(300, seed()));
  const Config config = config_of(4, 2.0);
  const BinaryBvh original = build(scene, config, one_thread_);
  const auto broken = [&](auto&& damage) {
    BinaryBvh bvh = copy(original);
    bvh.has_duplicates = true;
    damage(bvh);
    return verdict(bvh, scene, config.max_leaf_size);
  };
  EXPECT_EQ(broken([](BinaryBvh&) {}), "");
  EXPECT_NE(broken([](BinaryBvh& bvh) { bvh.has_duplicates = false; }).find("expected 300"),
            std::string::npos);
  const auto first_leaf = [](BinaryBvh& bvh, uint32_t least) -> BinaryNode& {
    return *std::find_if(bvh.nodes.begin(), bvh.nodes.end(),
                         [least](const BinaryNode& node) { return node.count >= least; });
  };
  EXPECT_NE(broken([&](BinaryBvh& bvh) {
              const BinaryNode& leaf = first_leaf(bvh, 2);
              bvh.primitive_ids[leaf.first + 1] = bvh.primitive_ids[leaf.first];
            }).find("twice"),
            std::string::npos);
  // A triangle that stands in several leaves leaves one of them.
  const std::string hole = broken([&](BinaryBvh& bvh) {
    std::vector<uint32_t> count(scene.count(), 0);
    for (const uint32_t id : bvh.primitive_ids) ++count[id];
    for (BinaryNode& leaf : bvh.nodes) {
      if (leaf.count < 2) continue;
      const uint32_t last = bvh.primitive_ids[leaf.first + leaf.count - 1];
      if (count[last] < 3) continue;
      --leaf.count;
      return;
    }
  });
  EXPECT_TRUE(hole.find("do not cover") != std::string::npos ||
              hole.find("is not the union") != std::string::npos)
      << hole;
}

TEST_F(SpatialSplit, WideTreesAreValid) {
  const TreeScene scenes[] = {TreeScene("sticks", sticks(1500, seed())),
                              TreeScene("soup", soup(1500, seed()))};
  for (const TreeScene& scene : scenes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const bool merges : {false, true}) {
        for (const auto contraction :
             {kiwami::ContractionMethod::kSurfaceArea, kiwami::ContractionMethod::kOptimal}) {
          BinaryBvh bvh = build(scene, config_of(std::min(width, 4u), 3.0), one_thread_);
          const size_t references = bvh.primitive_ids.size();
          const WideTree tree = widen(std::move(bvh), scene, width, merges, contraction);
          EXPECT_EQ(verdict(tree, scene), "") << scene.name() << ", width " << width;
          EXPECT_EQ(tree.view.has_duplicates, 1u);
          EXPECT_LE(tree.used_lanes, references);
          EXPECT_GT(tree.used_lanes, scene.count());
        }
      }
    }
  }
}

TEST_F(SpatialSplit, AWideLeafHoldsATriangleOnce) {
  // Two leaves around the halves of one triangle, which become one leaf.
  Mesh mesh;
  mesh.add({0, 0, 0}, {2, 0, 0}, {0, 2, 0});
  const TreeScene scene("halves", mesh);
  BinaryBvh bvh{Array<BinaryNode>(memory_, 3), Array<uint32_t>(memory_, 2), true};
  bvh.nodes[0] = {{{0, 0, 0}, {2, 2, 0}}, 1, 0};
  bvh.nodes[1] = {{{0, 0, 0}, {1, 2, 0}}, 0, 1};
  bvh.nodes[2] = {{{1, 0, 0}, {2, 1, 0}}, 1, 1};
  bvh.primitive_ids[0] = bvh.primitive_ids[1] = 0;
  EXPECT_EQ(verdict(bvh, scene, 1), "");
  const WideTree tree = widen(std::move(bvh), scene, 4, true, kiwami::ContractionMethod::kOptimal);
  EXPECT_EQ(tree.used_lanes, 1u);
  EXPECT_EQ(verdict(tree, scene), "");
}

TEST_F(SpatialSplit, TheWideVerifierSeesABoxThatIsTooSmall) {
  const TreeScene scene("sticks", sticks(400, seed()));
  BinaryBvh bvh = build(scene, config_of(4, 3.0), one_thread_);
  WideTree tree = widen(std::move(bvh), scene, 8, false, kiwami::ContractionMethod::kSurfaceArea);
  ASSERT_EQ(verdict(tree, scene), "");
  auto* const nodes = tree.nodes<8>();
  int seen = 0, shrunk = 0;
  for (uint32_t i = 0; i < tree.node_count; ++i) {
    if (!nodes[i].child[0].is_leaf() || nodes[i].child[0].mask() == 0) continue;
    float& bound = nodes[i].bounds[1][1][0];
    const float kept = bound;
    bound = 0.75f * kept + 0.25f * nodes[i].bounds[1][0][0];
    if (bound < kept) {
      ++shrunk;
      seen += verdict(tree, scene).find("do not cover") != std::string::npos;
    }
    bound = kept;
  }
  // What is left uncovered may be covered by chance by another part of the triangle.
  EXPECT_GT(shrunk, 20);
  EXPECT_GE(seen, shrunk * 9 / 10);
  tree.view.has_duplicates = 0;
  EXPECT_NE(verdict(tree, scene), "");
}

}  // namespace
}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
#include "builders/sweep_sah_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bvh/sah_cost.h"
#include "bvh/tree_edit.h"
#include "support/environment.h"
#include "unit/binary_tree_test.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::Bounds;
using kiwami::BuildPrimitive;
using kiwami::SweepSahBuilder;
using Config = SweepSahBuilder::Config;

Config config_of(uint32_t max_leaf_size) {
  Config config;
  config.max_leaf_size = config.block_size = max_leaf_size;
  return config;
}

class SweepSah : public BinaryTreeTest {
 protected:
  BinaryBvh build(const Mesh& mesh, const Config& config, const kiwami::Parallel& parallel) {
    BinaryBvh bvh = SweepSahBuilder::build(primitives_of(mesh, memory_), config, memory_, parallel);
    verify(bvh, mesh, config.max_leaf_size);
    return bvh;
  }

  Threads one_thread_{1};
};

std::vector<BuildPrimitive> primitives_below(const BinaryBvh& bvh, uint32_t node,
                                             const Array<BuildPrimitive>& by_id) {
  std::vector<BuildPrimitive> primitives;
  for_each_leaf(bvh, node, [&](const BinaryNode& leaf) {
    for (uint32_t i = 0; i < leaf.count; ++i) {
      primitives.push_back(by_id[bvh.primitive_ids[leaf.first + i]]);
    }
  });
  return primitives;
}

double blocks(size_t count, const Config& config) {
  return static_cast<double>((count + config.block_size - 1) / config.block_size);
}

template <typename Iterator>
double half_cost(Iterator begin, Iterator end, const Config& config) {
  Bounds box = Bounds::empty();
  for (Iterator i = begin; i != end; ++i) box.extend(i->bounds());
  return box.half_area() * blocks(static_cast<size_t>(end - begin), config);
}

/// The least cost of two halves over all positions along all axes, each box made anew.
double least_cost(std::vector<BuildPrimitive> primitives, const Config& config) {
  double least = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    std::sort(primitives.begin(), primitives.end(),
              [axis](const BuildPrimitive& a, const BuildPrimitive& b) {
                const float x = a.doubled_centroid()[axis], y = b.doubled_centroid()[axis];
                return x < y || (x == y && a.id < b.id);
              });
    for (auto cut = primitives.begin() + 1; cut != primitives.end(); ++cut) {
      least = std::min(least, half_cost(primitives.begin(), cut, config) +
                                  half_cost(cut, primitives.end(), config));
    }
  }
  return least;
}

/// Compares each decision of a tree with the exhaustive one; returns how many splits it compared.
int compare_splits(const BinaryBvh& bvh, uint32_t index, const Array<BuildPrimitive>& by_id,
                   const Config& config) {
  const BinaryNode& node = bvh.nodes[index];
  const std::vector<BuildPrimitive> primitives = primitives_below(bvh, index, by_id);
  const double area = node.bounds.half_area();
  const double least = primitives.size() > 1 ? least_cost(primitives, config)
                                             : std::numeric_limits<double>::infinity();
  const bool pays = config.node_cost * area + config.leaf_cost * least <
                    config.leaf_cost * area * blocks(primitives.size(), config);
  if (node.is_leaf()) {
    EXPECT_FALSE(pays) << "leaf " << index << " of " << node.count << " should be split";
    return 0;
  }
  EXPECT_TRUE(pays || primitives.size() > config.max_leaf_size) << "node " << index;
  const auto below = [&](uint32_t child) {
    const std::vector<BuildPrimitive> half = primitives_below(bvh, child, by_id);
    return half_cost(half.begin(), half.end(), config);
  };
  EXPECT_EQ(below(node.first) + below(node.first + 1), least)
      << "node " << index << " over " << primitives.size() << " primitives";
  return 1 + compare_splits(bvh, node.first, by_id, config) +
         compare_splits(bvh, node.first + 1, by_id, config);
}

TEST_F(SweepSah, EachSplitIsTheBestOfAllPositions) {
  int compared = 0;
  for (const uint32_t leaf_size : {1u, 4u, 8u}) {
    for (const uint32_t count : {2u, 3u, 10u, 40u, 150u, 300u}) {
      const Mesh mesh = soup(count, seed() + count);
      Config config = config_of(leaf_size);
      for (const uint32_t subtree_size : {~0u, 20u}) {
        config.subtree_size = subtree_size;
        const BinaryBvh bvh = build(mesh, config, one_thread_);
        compared += compare_splits(bvh, 0, primitives_of(mesh, memory_), config);
      }
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST_F(SweepSah, NoPrimitivesGiveNoNodes) {
  const BinaryBvh bvh = build(Mesh{}, Config{}, one_thread_);
  EXPECT_TRUE(bvh.nodes.empty());
  EXPECT_TRUE(bvh.primitive_ids.empty());
}

TEST_F(SweepSah, DegenerateInputsGiveValidTrees) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    for (const uint32_t leaf_size : {1u, 2u, 8u, 16u}) {
      SCOPED_TRACE(named.name + ", leaves of " + std::to_string(leaf_size));
      Config config = config_of(leaf_size);
      EXPECT_NO_THROW(build(named.mesh, config, one_thread_));
      config.subtree_size = 16;
      EXPECT_NO_THROW(build(named.mesh, config, one_thread_));
    }
  }
}

TEST_F(SweepSah, EqualBoxesAreHalvedInWholeBlocks) {
  Mesh mesh;
  for (int i = 0; i < 1000; ++i) mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 2});
  BinaryBvh bvh = build(mesh, config_of(8), one_thread_);
  int partial = 0;
  for (const BinaryNode& node : bvh.nodes) partial += node.is_leaf() && node.count != 8;
  EXPECT_EQ(partial, 0);
  std::vector<uint32_t> depth(bvh.nodes.size(), 1);
  for (size_t i = 0; i < bvh.nodes.size(); ++i) {
    if (bvh.nodes[i].is_leaf()) continue;
    depth[bvh.nodes[i].first] = depth[bvh.nodes[i].first + 1] = depth[i] + 1;
  }
  EXPECT_LE(*std::max_element(depth.begin(), depth.end()), 8u);
}

TEST_F(SweepSah, DepthStaysInRangeWhereEachSplitTakesOneAway) {
  Mesh mesh;
  for (int i = 0; i < 115; ++i) {
    for (int copy = 0; copy < 20; ++copy) {
      const float x = std::ldexp(1.0f, i - 56);
      mesh.add({x, 0, 0}, {x, x, 0}, {x, 0, x});
    }
  }
  for (const uint32_t leaf_size : {1u, 8u}) {
    EXPECT_NO_THROW(build(mesh, config_of(leaf_size), one_thread_));
  }
}

TEST_F(SweepSah, TreesAreEqualOnAnyNumberOfThreadsAndForAnySizeOfSubtrees) {
  const kiwami::Parallel many_threads(0, run_on_plain_threads, nullptr, 8);
  for (const Mesh& mesh : {terrain(90), soup(20000, seed()), spheres(20000, seed())}) {
    Config config = config_of(8);
    BinaryBvh reference = build(mesh, config, one_thread_);
    EXPECT_TRUE(are_equal(build(mesh, config, many_threads), reference));
    relabel_depth_first(reference, memory_);
    for (const uint32_t subtree_size : {~0u, 1000u, 20u}) {
      config.subtree_size = subtree_size;
      BinaryBvh bvh = build(mesh, config, many_threads);
      relabel_depth_first(bvh, memory_);
      EXPECT_TRUE(are_equal(bvh, reference)) << "subtrees of " << subtree_size;
    }
  }
}

TEST_F(SweepSah, CostsNoMoreThanBins) {
  for (const Mesh& mesh : {soup(5000, seed()), spheres(5000, seed())}) {
    const double swept = sah_cost(build(mesh, config_of(8), one_thread_), {});
    const double binned = sah_cost(build_binned(mesh, 8), {});
    std::printf("swept %.2f, binned %.2f\n", swept, binned);
    EXPECT_LT(swept, binned * 1.01);
  }
}

}  // namespace
}  // namespace kiwami_tests

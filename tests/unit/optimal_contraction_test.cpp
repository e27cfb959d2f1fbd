// SPDX-License-Identifier: Apache-2.0
#include "wide/optimal_contraction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "builders/binned_sah_builder.h"
#include "support/environment.h"
#include "support/random.h"
#include "unit/tree_scenes.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::ContractedNode;
using kiwami::ContractedSlot;
using kiwami::Contraction;
using kiwami::OptimalContractionConfig;

uint32_t primitives_below(const BinaryBvh& bvh, uint32_t node) {
  const BinaryNode& top = bvh.nodes[node];
  if (top.is_leaf()) return top.count;
  return primitives_below(bvh, top.first) + primitives_below(bvh, top.first + 1);
}

/// The least cost by trying every set of descendants that a node could have as its children.
class BruteForce {
 public:
  BruteForce(const BinaryBvh& bvh, const OptimalContractionConfig& config)
      : bvh_(bvh), config_(config) {}

  double cost(uint32_t node) const {
    const double area = bvh_.nodes[node].bounds.half_area();
    double least = std::numeric_limits<double>::infinity();
    if (primitives_below(bvh_, node) <= config_.leaf_width) least = area * config_.leaf_cost;
    for (const std::vector<uint32_t>& cut : cuts(node)) {
      if (cut.size() < 2 || cut.size() > config_.width) continue;
      double sum = area * config_.node_cost;
      for (const uint32_t child : cut) sum += cost(child);
      least = std::min(least, sum);
    }
    return least;
  }

 private:
  /// All sets of nodes at and below a node that have each leaf below exactly one of them.
  std::vector<std::vector<uint32_t>> cuts(uint32_t node) const {
    std::vector<std::vector<uint32_t>> all = {{node}};
    if (bvh_.nodes[node].is_leaf()) return all;
    const uint32_t first = bvh_.nodes[node].first;
    for (const std::vector<uint32_t>& left : cuts(first)) {
      for (const std::vector<uint32_t>& right : cuts(first + 1)) {
        all.push_back(left);
        all.back().insert(all.back().end(), right.begin(), right.end());
      }
    }
    return all;
  }

  const BinaryBvh& bvh_;
  OptimalContractionConfig config_;
};

class OptimalContractionTest : public testing::Test {
 protected:
  OptimalContractionTest() : memory_(nullptr, nullptr, nullptr) {}

  /// A tree of any shape: leaves of one to leaf_size primitives in boxes of random sizes.
  BinaryBvh random_tree(uint32_t leaf_count, uint32_t leaf_size, Random& random) {
    BinaryBvh bvh;
    bvh.nodes = kiwami::Array<BinaryNode>(memory_, 2 * leaf_count - 1);
    next_node_ = 1;
    next_primitive_ = 0;
    grow(bvh, 0, leaf_count, leaf_size, random);
    bvh.primitive_ids = kiwami::Array<uint32_t>(memory_, next_primitive_);
    for (uint32_t i = 0; i < next_primitive_; ++i) bvh.primitive_ids[i] = i;
    return bvh;
  }

  BinaryBvh build(const Mesh& mesh, uint32_t leaf_size) {
    kiwami::BinnedSahBuilder::Config config;
    config.max_leaf_size = config.block_size = leaf_size;
    auto primitives = primitives_of(mesh, memory_);
    return kiwami::BinnedSahBuilder::build(std::move(primitives), config, memory_, Threads(1));
  }

  Contraction contract_optimally(const BinaryBvh& bvh, const OptimalContractionConfig& config) {
    return kiwami::contract_optimally(bvh, config, memory_, one_thread_);
  }

  kiwami::Memory memory_;
  Threads one_thread_{1};

 private:
  void grow(BinaryBvh& bvh, uint32_t index, uint32_t leaves, uint32_t leaf_size, Random& random) {
    BinaryNode& node = bvh.nodes[index];
    node.bounds = kiwami::Bounds::empty();
    if (leaves == 1) {
      for (int corner = 0; corner < 2; ++corner) {
        node.bounds.extend(
            kiwami::Vec3f{random.symmetric(), random.symmetric(), random.symmetric()});
      }
      node.first = next_primitive_;
      node.count = 1 + static_cast<uint32_t>(random.below(leaf_size));
      next_primitive_ += node.count;
      return;
    }
    node.first = next_node_;
    node.count = 0;
    next_node_ += 2;
    const uint32_t left = 1 + static_cast<uint32_t>(random.below(leaves - 1));
    grow(bvh, node.first, left, leaf_size, random);
    grow(bvh, node.first + 1, leaves - left, leaf_size, random);
    for (uint32_t child = 0; child < 2; ++child) {
      node.bounds.extend(bvh.nodes[node.first + child].bounds);
    }
  }

  uint32_t next_node_ = 0;
  uint32_t next_primitive_ = 0;
};

/// Checks the shape, and that each binary leaf is below exactly one leaf; returns the cost.
double check(const BinaryBvh& bvh, const Contraction& contraction,
             const OptimalContractionConfig& config) {
  std::vector<uint32_t> owners(bvh.primitive_ids.size(), 0);
  std::vector<uint32_t> parents(contraction.nodes.size(), 0);
  double node_area = 0.0, leaf_area = 0.0;
  for (const ContractedSlot& slot : contraction.slots) {
    const double area = bvh.nodes[slot.binary_node].bounds.half_area();
    if (!slot.is_leaf()) {
      ++parents[slot.child];
      node_area += area;
      continue;
    }
    leaf_area += area;
    const uint32_t count = primitives_below(bvh, slot.binary_node);
    EXPECT_LE(count, config.leaf_width);
    EXPECT_EQ(contraction.leaf_sizes[slot.child & ~kiwami::kLeafFlag], count);
    kiwami::for_each_leaf(bvh, slot.binary_node, [&](const BinaryNode& leaf) {
      for (uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) ++owners[i];
    });
  }
  for (const uint32_t count : owners) EXPECT_EQ(count, 1u);
  for (const uint32_t count : parents) EXPECT_EQ(count, 1u);
  for (const ContractedNode& node : contraction.nodes) {
    EXPECT_GE(node.slot_count, 2u);
    EXPECT_LE(node.slot_count, config.width);
  }
  EXPECT_NEAR(contraction.node_area, node_area, 1e-9 * node_area);
  EXPECT_NEAR(contraction.leaf_area, leaf_area, 1e-9 * leaf_area);
  return config.node_cost * node_area + config.leaf_cost * leaf_area;
}

TEST_F(OptimalContractionTest, NoContractionOfASmallTreeCostsLess) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  Random random(seed());
  const float leaf_costs[] = {0.25f, 1.0f, 3.0f};
  for (uint32_t leaves = 1; leaves <= 9; ++leaves) {
    for (uint32_t trial = 0; trial < 12; ++trial) {
      const BinaryBvh bvh = random_tree(leaves, 3, random);
      for (const uint32_t width : {2u, 3u, 4u, 8u}) {
        const OptimalContractionConfig config = {width, std::max(width, 3u), 1.0f,
                                                 leaf_costs[trial % 3]};
        const double cost = check(bvh, contract_optimally(bvh, config), config);
        const double least = BruteForce(bvh, config).cost(0);
        EXPECT_NEAR(cost, least, 1e-12 * least) << leaves << " leaves, width " << width;
      }
    }
  }
}

TEST_F(OptimalContractionTest, CostsNoMoreThanSurfaceArea) {
  const Mesh meshes[] = {terrain(40), soup(5000, seed()), spheres(5000, seed())};
  for (const Mesh& mesh : meshes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const uint32_t leaf_size : {1u, width}) {
        const BinaryBvh bvh = build(mesh, leaf_size);
        const OptimalContractionConfig config = {width, width, 1.0f, 1.0f};
        const double optimal = check(bvh, contract_optimally(bvh, config), config);
        const double greedy =
            check(bvh, kiwami::contract(bvh, width, memory_, one_thread_), config);
        EXPECT_LT(optimal, greedy) << "width " << width << ", leaves of " << leaf_size;
      }
    }
  }
}

TEST_F(OptimalContractionTest, CollapsesWhereALeafIsCheaper) {
  const BinaryBvh bvh = build(soup(8, seed()), 1);
  const Contraction cheap = contract_optimally(bvh, {8, 8, 1.0f, 0.5f});
  EXPECT_TRUE(cheap.nodes.empty());
  ASSERT_EQ(cheap.leaf_sizes.size(), 1u);
  EXPECT_EQ(cheap.leaf_sizes[0], 8u);
  const Contraction narrow = contract_optimally(bvh, {8, 1, 1.0f, 0.5f});
  EXPECT_EQ(narrow.nodes.size(), 1u);
  EXPECT_EQ(narrow.leaf_sizes.size(), 8u);
}

TEST_F(OptimalContractionTest, WithoutAreaNodesAreFull) {
  Mesh points;
  for (int i = 0; i < 4096; ++i) points.add({1, 2, 3}, {1, 2, 3}, {1, 2, 3});
  const BinaryBvh bvh = build(points, 1);
  const OptimalContractionConfig config = {8, 8, 1.0f, 1.0f};
  const Contraction contraction = contract_optimally(bvh, config);
  check(bvh, contraction, config);
  EXPECT_EQ(contraction.leaf_sizes.size(), 512u);
  EXPECT_EQ(contraction.nodes.size(), 73u);
}

TEST_F(OptimalContractionTest, FillingDividesLeavesAndNothingElse) {
  for (const Mesh& mesh : {terrain(60), soup(8000, seed()), spheres(8000, seed())}) {
    for (const uint32_t width : {8u, 16u}) {
      const BinaryBvh bvh = build(mesh, 2);
      OptimalContractionConfig config = {width, width, 1.0f, 1.0f};
      const Contraction plain = contract_optimally(bvh, config);
      config.fill_nodes = true;
      const Contraction filled = contract_optimally(bvh, config);
      const double least = check(bvh, plain, config);
      const double cost = check(bvh, filled, config);
      EXPECT_EQ(filled.nodes.size(), plain.nodes.size());
      EXPECT_EQ(filled.node_area, plain.node_area);
      EXPECT_GT(filled.leaf_sizes.size(), plain.leaf_sizes.size());
      EXPECT_GE(cost, least);
      EXPECT_LE(cost, 1.02 * least) << "width " << width;
      for (const ContractedNode& node : filled.nodes) {
        if (node.slot_count == width || node.slot_count < width / 2 + 2) continue;
        // Whatever is left open has no leaf that could be divided.
        for (uint32_t i = 0; i < node.slot_count; ++i) {
          const ContractedSlot& slot = filled.slots[node.first_slot + i];
          EXPECT_TRUE(!slot.is_leaf() || bvh.nodes[slot.binary_node].is_leaf());
        }
      }
    }
  }
}

TEST_F(OptimalContractionTest, IsTheSameOnAnyNumberOfThreads) {
  const BinaryBvh bvh = build(spheres(20000, seed()), 2);
  const OptimalContractionConfig config;
  const kiwami::Parallel threads(0, run_on_plain_threads, nullptr, 4);
  const Contraction one = contract_optimally(bvh, config);
  const Contraction many = kiwami::contract_optimally(bvh, config, memory_, threads);
  ASSERT_EQ(one.slots.size(), many.slots.size());
  for (size_t i = 0; i < one.slots.size(); ++i) {
    ASSERT_EQ(one.slots[i].binary_node, many.slots[i].binary_node);
    ASSERT_EQ(one.slots[i].child, many.slots[i].child);
  }
  EXPECT_EQ(one.node_area, many.node_area);
}

}  // namespace
}  // namespace kiwami_tests

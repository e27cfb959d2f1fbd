// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "builders/binned_sah_builder.h"
#include "bvh/verify_binary.h"
#include "support/environment.h"
#include "unit/tree_scenes.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::BinnedSahBuilder;
using kiwami::Bounds;
using kiwami::BuildPrimitive;
using Config = BinnedSahBuilder::Config;

Config config_of(uint32_t max_leaf_size) {
  Config config;
  config.max_leaf_size = config.block_size = max_leaf_size;
  return config;
}

/// The split that the surface area heuristic wants, found by trying every plane on every axis with
/// plain loops over all primitives.
class ExhaustiveSplit {
 public:
  ExhaustiveSplit(const std::vector<BuildPrimitive>& primitives, const Config& config)
      : primitives_(primitives), config_(config) {
    const auto count = static_cast<uint32_t>(primitives.size());
    const uint32_t bins = BinnedSahBuilder::bins_of(count, 1, config);
    for (int axis = 0; axis < 3; ++axis) {
      for (uint32_t bin = 0; bin + 1 < bins; ++bin) try_plane(axis, bin, bins);
    }
  }

  bool found() const { return cost_ < std::numeric_limits<double>::infinity(); }

  bool pays() const {
    return found() && area() > 0.0 &&
           config_.node_cost * area() + config_.leaf_cost * cost_ <
               config_.leaf_cost * area() * blocks(primitives_.size());
  }

  const std::vector<uint32_t>& left_ids() const { return left_ids_; }

 private:
  double blocks(size_t count) const {
    return static_cast<double>((count + config_.block_size - 1) / config_.block_size);
  }

  double area() const {
    Bounds box = Bounds::empty();
    for (const BuildPrimitive& primitive : primitives_) box.extend(primitive.bounds());
    return box.half_area();
  }

  void try_plane(int axis, uint32_t last_left_bin, uint32_t bins) {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (const BuildPrimitive& primitive : primitives_) {
      low = std::min(low, primitive.doubled_centroid()[axis]);
      high = std::max(high, primitive.doubled_centroid()[axis]);
    }
    if (!(high - low > 1e-34f)) return;
    const float scale = static_cast<float>(bins) * (1.0f - 1e-6f) / (high - low);
    Bounds box[2] = {Bounds::empty(), Bounds::empty()};
    size_t count[2] = {0, 0};
    std::vector<uint32_t> left;
    for (const BuildPrimitive& primitive : primitives_) {
      const auto bin = static_cast<uint32_t>((primitive.doubled_centroid()[axis] - low) * scale);
      ASSERT_LT(bin, bins);
      const int side = bin > last_left_bin;
      box[side].extend(primitive.bounds());
      ++count[side];
      if (side == 0) left.push_back(primitive.id);
    }
    if (count[0] == 0 || count[1] == 0) return;
    const double cost =
        area() > 0.0 ? box[0].half_area() * blocks(count[0]) + box[1].half_area() * blocks(count[1])
                     : static_cast<double>(std::max(count[0], count[1]));
    if (cost < cost_) {
      cost_ = cost;
      left_ids_ = left;
    }
  }

  const std::vector<BuildPrimitive>& primitives_;
  const Config& config_;
  double cost_ = std::numeric_limits<double>::infinity();
  std::vector<uint32_t> left_ids_;
};

class BinaryBuilder : public testing::Test {
 protected:
  BinaryBuilder() : memory_(nullptr, nullptr, nullptr) {}

  /// Builds and verifies.
  BinaryBvh build(const Mesh& mesh, const Config& config, const kiwami::Parallel& parallel) {
    BinaryBvh bvh =
        BinnedSahBuilder::build(primitives_of(mesh, memory_), config, memory_, parallel);
    const Array<BuildPrimitive> original = primitives_of(mesh, memory_);
    kiwami::verify_binary_bvh(bvh, original.data(), original.size(), config.max_leaf_size, memory_);
    return bvh;
  }

  kiwami::Memory memory_;
  Threads one_thread_{1};
};

std::vector<uint32_t> ids_below(const BinaryBvh& bvh, uint32_t index) {
  const BinaryNode& node = bvh.nodes[index];
  if (node.is_leaf()) {
    const uint32_t* ids = bvh.primitive_ids.data() + node.first;
    return {ids, ids + node.count};
  }
  std::vector<uint32_t> ids = ids_below(bvh, node.first);
  const std::vector<uint32_t> right = ids_below(bvh, node.first + 1);
  ids.insert(ids.end(), right.begin(), right.end());
  return ids;
}

/// Compares each decision of a tree with the exhaustive one; returns how many splits it compared.
int compare_splits(const BinaryBvh& bvh, uint32_t index, const Array<BuildPrimitive>& by_id,
                   const Config& config) {
  const std::vector<uint32_t> ids = ids_below(bvh, index);
  std::vector<BuildPrimitive> primitives;
  for (const uint32_t id : ids) primitives.push_back(by_id[id]);
  const ExhaustiveSplit oracle(primitives, config);
  const BinaryNode& node = bvh.nodes[index];
  if (node.is_leaf()) {
    EXPECT_FALSE(oracle.pays()) << "leaf " << index << " of " << node.count << " should be split";
    return 0;
  }
  EXPECT_TRUE(ids.size() > config.max_leaf_size || oracle.pays()) << "node " << index;
  // Two primitives are split without asking for a plane, and so is what no plane can split.
  int compared = 0;
  if (ids.size() > 2 && oracle.found()) {
    std::vector<uint32_t> left = ids_below(bvh, node.first), expected = oracle.left_ids();
    std::sort(left.begin(), left.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(left, expected) << "node " << index << " over " << ids.size() << " primitives";
    compared = 1;
  }
  return compared + compare_splits(bvh, node.first, by_id, config) +
         compare_splits(bvh, node.first + 1, by_id, config);
}

TEST_F(BinaryBuilder, EachSplitIsTheBestOfAllPlanes) {
  RecordProperty("seed", std::to_string(seed()));
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  int compared = 0;
  for (const uint32_t leaf_size : {1u, 4u, 8u}) {
    for (uint32_t count : {3u, 10u, 40u, 150u, 300u}) {
      const Mesh mesh = soup(count, seed() + count);
      const Config config = config_of(leaf_size);
      const BinaryBvh bvh = build(mesh, config, one_thread_);
      compared += compare_splits(bvh, 0, primitives_of(mesh, memory_), config);
    }
  }
  EXPECT_GT(compared, 400);
}

TEST_F(BinaryBuilder, EachSplitNearTheRootIsTheBestOfAllPlanes) {
  const Mesh mesh = spheres(400, seed());
  Config config = config_of(4);
  config.subtree_size = 32;
  const BinaryBvh bvh = build(mesh, config, one_thread_);
  EXPECT_GT(compare_splits(bvh, 0, primitives_of(mesh, memory_), config), 50);
}

TEST_F(BinaryBuilder, NoPrimitivesGiveNoNodes) {
  const BinaryBvh bvh = build(Mesh{}, Config{}, one_thread_);
  EXPECT_TRUE(bvh.nodes.empty());
  EXPECT_TRUE(bvh.primitive_ids.empty());
}

TEST_F(BinaryBuilder, DegenerateInputsGiveValidTrees) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    for (const uint32_t leaf_size : {1u, 2u, 8u, 16u}) {
      SCOPED_TRACE(named.name + ", leaves of " + std::to_string(leaf_size));
      Config config = config_of(leaf_size);
      EXPECT_NO_THROW(build(named.mesh, config, one_thread_));
      config.subtree_size = 16;
      config.reassigns = leaf_size != 1;
      EXPECT_NO_THROW(build(named.mesh, config, one_thread_));
    }
  }
}

TEST_F(BinaryBuilder, EqualCentroidsAreHalvedInWholeBlocks) {
  Mesh mesh;
  for (int i = 0; i < 100; ++i) mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 2});
  const BinaryBvh bvh = build(mesh, config_of(8), one_thread_);
  int partial = 0;
  for (const BinaryNode& node : bvh.nodes) partial += node.is_leaf() && node.count != 8;
  EXPECT_EQ(partial, 1);
}

TEST_F(BinaryBuilder, DepthStaysInRangeWhereEachSplitTakesOneAway) {
  // Powers of 16 put all but one centroid into the first bin, again and again.
  Mesh mesh;
  for (int i = 0; i < 30; ++i) {
    for (int copy = 0; copy < 300; ++copy) {
      const float x = std::ldexp(1.0f, 4 * i - 60);
      mesh.add({x, 0, 0}, {x, 1, 0}, {x, 0, 1});
    }
  }
  EXPECT_NO_THROW(build(mesh, config_of(1), one_thread_));
}

void expect_same(const BinaryBvh& a, const BinaryBvh& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  ASSERT_EQ(a.primitive_ids.size(), b.primitive_ids.size());
  EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.bytes()), 0);
  EXPECT_EQ(std::memcmp(a.primitive_ids.data(), b.primitive_ids.data(), a.primitive_ids.bytes()),
            0);
}

TEST_F(BinaryBuilder, TreesAreEqualOnAnyNumberOfThreads) {
  const kiwami::Parallel plain_threads(0, run_on_plain_threads, nullptr, 4);
  const Mesh meshes[] = {terrain(120), soup(30000, seed()), spheres(30000, seed())};
  for (const Mesh& mesh : meshes) {
    for (const uint32_t leaf_size : {1u, 8u}) {
      Config config = config_of(leaf_size);
      config.reassigns = leaf_size == 8;
      const BinaryBvh reference = build(mesh, config, one_thread_);
      for (const unsigned threads : {2u, 4u}) {
        expect_same(build(mesh, config, Threads(threads)), reference);
      }
      expect_same(build(mesh, config, plain_threads), reference);
    }
  }
}

TEST_F(BinaryBuilder, BinsAreHalvedWithDepthDownToEight) {
  Config config;
  config.bin_count = 32;
  EXPECT_EQ(BinnedSahBuilder::bins_of(100000, 40, config), 32u);
  config.bin_halving_depth = 2;
  const uint32_t expected[] = {32, 32, 16, 16, 8, 8, 8};
  for (uint32_t i = 0; i < 7; ++i) {
    EXPECT_EQ(BinnedSahBuilder::bins_of(100000, i + 1, config), expected[i]) << "depth " << i + 1;
  }
  EXPECT_EQ(BinnedSahBuilder::bins_of(100000, 72, config), 8u);
  EXPECT_EQ(BinnedSahBuilder::bins_of(10, 1, config), 6u);
  config.bin_count = 4;
  EXPECT_EQ(BinnedSahBuilder::bins_of(100000, 9, config), 4u);
}

TEST_F(BinaryBuilder, APrimitiveThatFitsTheOtherSideBetterIsReassigned) {
  // A flat stack, a long row of small triangles beside it, and a triangle that sticks out of the
  // stack with its centroid at the row: there it would make the box of the whole row wide.
  Mesh mesh;
  std::vector<uint32_t> stack, row;
  for (uint32_t i = 0; i < 20; ++i) {
    const float z = 0.04f * static_cast<float>(i);
    mesh.add({2.9f, 0, z}, {3.1f, 0, z}, {3, 10, z});
    stack.push_back(i);
  }
  for (uint32_t i = 20; i < 28; ++i) {
    const float y = 10.0f * static_cast<float>(i) - 230.0f;
    mesh.add({7, y, 0}, {8, y, 0.5f}, {7, y + 1, 0.7f});
    row.push_back(i);
  }
  mesh.add({3, 5, 0.3f}, {12, 5, 0.3f}, {12, 5.1f, 0.3f});
  stack.push_back(28);
  row.push_back(28);
  Config config = config_of(1);
  const auto ids_beside_it = [&](bool reassigns) {
    config.reassigns = reassigns;
    const BinaryBvh bvh = build(mesh, config, one_thread_);
    std::vector<uint32_t> ids = ids_below(bvh, 1);
    if (std::find(ids.begin(), ids.end(), 28u) == ids.end()) ids = ids_below(bvh, 2);
    std::sort(ids.begin(), ids.end());
    return ids;
  };
  EXPECT_EQ(ids_beside_it(false), row);
  EXPECT_EQ(ids_beside_it(true), stack);
}

/// Of the split at the root.
double root_cost(const BinaryBvh& bvh, const Config& config) {
  double cost = 0.0;
  for (uint32_t child = 1; child < 3; ++child) {
    const auto count = static_cast<uint32_t>(ids_below(bvh, child).size());
    cost += static_cast<double>(bvh.nodes[child].bounds.half_area()) *
            ((count + config.block_size - 1) / config.block_size);
  }
  return cost;
}

TEST_F(BinaryBuilder, ReassignmentNeverCostsMore) {
  int cheaper = 0;
  for (uint32_t trial = 0; trial < 100; ++trial) {
    const Mesh mesh = soup(200 + trial, seed() + trial);
    Config config = config_of(4);
    for (const uint32_t subtree_size : {~0u, 16u}) {
      config.subtree_size = subtree_size;
      config.reassigns = false;
      const double plain = root_cost(build(mesh, config, one_thread_), config);
      config.reassigns = true;
      const double reassigned = root_cost(build(mesh, config, one_thread_), config);
      EXPECT_LE(reassigned, plain);
      cheaper += reassigned < plain;
    }
  }
  EXPECT_GT(cheaper, 10);
}

/// The shape alone: leaves as runs of ids, left to right, with their depths.
void append_shape(const BinaryBvh& bvh, uint32_t index, uint32_t depth,
                  std::vector<uint32_t>& shape) {
  const BinaryNode& node = bvh.nodes[index];
  if (!node.is_leaf()) {
    append_shape(bvh, node.first, depth + 1, shape);
    append_shape(bvh, node.first + 1, depth + 1, shape);
    return;
  }
  shape.insert(shape.end(), {depth, node.count});
  const std::vector<uint32_t> ids = ids_below(bvh, index);
  shape.insert(shape.end(), ids.begin(), ids.end());
}

TEST_F(BinaryBuilder, ShapeDoesNotDependOnWhereSubtreesBegin) {
  for (const Mesh& mesh : {soup(20000, seed()), terrain(90)}) {
    for (const bool reassigns : {false, true}) {
      std::vector<uint32_t> reference;
      for (const uint32_t subtree_size : {~0u, 10000u, 1000u, 20u}) {
        Config config = config_of(8);
        config.subtree_size = subtree_size;
        config.reassigns = reassigns;
        config.bin_halving_depth = reassigns ? 3 : 0;
        std::vector<uint32_t> shape;
        append_shape(build(mesh, config, one_thread_), 0, 1, shape);
        if (reference.empty()) reference = shape;
        EXPECT_EQ(shape, reference) << "subtrees of " << subtree_size;
      }
    }
  }
}

}  // namespace
}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
#include "optimizers/reinsertion.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <vector>

#include "builders/binned_sah_builder.h"
#include "bvh/verify_binary.h"
#include "optimizers/linked_tree.h"
#include "support/environment.h"
#include "support/random.h"
#include "unit/tree_scenes.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::LinkedTree;

class Reinsertion : public testing::Test {
 protected:
  void SetUp() override {
    RecordProperty("seed", std::to_string(seed()));
    std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  }

  BinaryBvh build(const Mesh& mesh, uint32_t max_leaf_size) {
    kiwami::BinnedSahBuilder::Config config;
    config.max_leaf_size = config.block_size = max_leaf_size;
    return kiwami::BinnedSahBuilder::build(primitives_of(mesh, memory_), config, memory_,
                                           Threads(1));
  }

  void verify(const BinaryBvh& bvh, const Mesh& mesh, uint32_t max_leaf_size) {
    const auto primitives = primitives_of(mesh, memory_);
    kiwami::verify_binary_bvh(bvh, primitives.data(), primitives.size(), max_leaf_size, memory_);
  }

  kiwami::Memory memory_{nullptr, nullptr, nullptr};
};

/// The area of all inner nodes, by a walk of its own.
double inner_area(const BinaryBvh& bvh, uint32_t node = 0) {
  const BinaryNode& top = bvh.nodes[node];
  if (top.is_leaf()) return 0.0;
  return top.bounds.half_area() + inner_area(bvh, top.first) + inner_area(bvh, top.first + 1);
}

TEST_F(Reinsertion, MovesAddWhatTheySay) {
  Random random(seed());
  for (int trial = 0; trial < 300; ++trial) {
    const Mesh mesh = soup(20, seed() + trial);
    BinaryBvh bvh = build(mesh, 1);
    LinkedTree tree(bvh, memory_);
    const uint32_t node = 1 + random.below(tree.size() - 1), target = random.below(tree.size());
    const bool is_allowed =
        !tree.is_below(target, node) && target != tree.parent(node) && target != tree.sibling(node);
    if (!is_allowed) continue;
    const double before = inner_area(bvh);
    const double added = tree.move(node, target);
    EXPECT_NEAR(inner_area(bvh) - before, added, 1e-5 * before);
    tree.finish();
    verify(bvh, mesh, 1);
  }
}

TEST_F(Reinsertion, EndsWhereNoMoveOfOneNodePays) {
  for (int trial = 0; trial < 20; ++trial) {
    const Mesh mesh = soup(14, seed() + 1000 + trial);
    BinaryBvh bvh = build(mesh, 1);
    kiwami::optimize_by_parallel_reinsertion(bvh, {100, 1.0f}, memory_, Threads(1));
    verify(bvh, mesh, 1);
    const double least = inner_area(bvh);
    // Every move there is, each made and measured on a tree of its own.
    const auto size = static_cast<uint32_t>(bvh.nodes.size());
    for (uint32_t node = 1; node < size; ++node) {
      for (uint32_t target = 0; target < size; ++target) {
        BinaryBvh copy{kiwami::Array<BinaryNode>(memory_, size),
                       kiwami::Array<uint32_t>(memory_, bvh.primitive_ids.size())};
        std::copy(bvh.nodes.begin(), bvh.nodes.end(), copy.nodes.begin());
        std::copy(bvh.primitive_ids.begin(), bvh.primitive_ids.end(), copy.primitive_ids.begin());
        LinkedTree tree(copy, memory_);
        if (tree.is_below(target, node) || target == tree.parent(node) ||
            target == tree.sibling(node)) {
          continue;
        }
        tree.move(node, target);
        EXPECT_GE(inner_area(copy), least * (1.0 - 1e-5)) << "node " << node << " to " << target;
      }
    }
  }
}

TEST_F(Reinsertion, LowersTheCostOfEveryScene) {
  const Mesh meshes[] = {soup(20000, seed()), terrain(80), spheres(20000, seed())};
  for (const Mesh& mesh : meshes) {
    for (const uint32_t leaf_size : {1u, 4u}) {
      BinaryBvh bvh = build(mesh, leaf_size);
      const double before = inner_area(bvh);
      kiwami::optimize_by_parallel_reinsertion(bvh, {}, memory_, Threads(2));
      verify(bvh, mesh, leaf_size);
      EXPECT_LE(inner_area(bvh), before);
      std::printf("leaves of %u: %.1f %% of the area\n", leaf_size, 100 * inner_area(bvh) / before);
    }
  }
}

TEST_F(Reinsertion, MendsATreeThatWasBuiltBlindly) {
  const Mesh mesh = soup(500, seed());
  BinaryBvh good = build(mesh, 1), bad = build(mesh, 1);
  // The same tree over shuffled primitives, with the boxes that follow.
  Random random(seed());
  for (size_t i = bad.primitive_ids.size(); i > 1; --i) {
    std::swap(bad.primitive_ids[i - 1], bad.primitive_ids[random.below(static_cast<uint32_t>(i))]);
  }
  const auto primitives = primitives_of(mesh, memory_);
  for (size_t i = bad.nodes.size(); i-- > 0;) {
    BinaryNode& node = bad.nodes[i];
    if (node.is_leaf()) {
      node.bounds = primitives[bad.primitive_ids[node.first]].bounds();
    } else {
      node.bounds = bad.nodes[node.first].bounds;
      node.bounds.extend(bad.nodes[node.first + 1].bounds);
    }
  }
  const double before = inner_area(bad);
  kiwami::optimize_by_parallel_reinsertion(bad, {200, 1.0f}, memory_, Threads(1));
  verify(bad, mesh, 1);
  EXPECT_LT(inner_area(bad), 0.5 * before);
  EXPECT_LT(inner_area(bad), 1.3 * inner_area(good));
}

TEST_F(Reinsertion, IsTheSameOnAnyNumberOfThreads) {
  const Mesh mesh = soup(30000, seed());
  BinaryBvh expected = build(mesh, 4);
  kiwami::optimize_by_parallel_reinsertion(expected, {}, memory_, Threads(1));
  const kiwami::Parallel plain(0, run_on_plain_threads, nullptr, 8);
  BinaryBvh bvh = build(mesh, 4);
  kiwami::optimize_by_parallel_reinsertion(bvh, {}, memory_, plain);
  ASSERT_EQ(bvh.nodes.size(), expected.nodes.size());
  EXPECT_EQ(std::memcmp(bvh.nodes.data(), expected.nodes.data(), bvh.nodes.bytes()), 0);
  EXPECT_EQ(std::memcmp(bvh.primitive_ids.data(), expected.primitive_ids.data(),
                        bvh.primitive_ids.bytes()),
            0);
}

TEST_F(Reinsertion, DegenerateTreesStayValid) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    BinaryBvh bvh = build(named.mesh, 1);
    kiwami::optimize_by_parallel_reinsertion(bvh, {8, 1.0f}, memory_, Threads(1));
    verify(bvh, named.mesh, 1);
  }
}

}  // namespace
}  // namespace kiwami_tests

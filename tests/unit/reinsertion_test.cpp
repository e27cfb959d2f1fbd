// SPDX-License-Identifier: Apache-2.0
#include "optimizers/reinsertion.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <set>

#include "optimizers/linked_tree.h"
#include "optimizers/sequential_reinsertion.h"
#include "optimizers/whole_blocks.h"
#include "support/environment.h"
#include "support/random.h"
#include "unit/binary_tree_test.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::LinkedTree;

class Reinsertion : public BinaryTreeTest {};

/// Costs that make no subtree a block.
constexpr kiwami::SahCosts kNoBlocks = {1.0f, 1.0f, 1};

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
    BinaryBvh bvh = build_binned(mesh, 1);
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

TEST_F(Reinsertion, ChangesCanBeUndone) {
  Random random(seed() + 7);
  for (int trial = 0; trial < 100; ++trial) {
    const Mesh mesh = soup(20, seed() + trial);
    BinaryBvh bvh = build_binned(mesh, 1);
    LinkedTree tree(bvh, memory_);
    const BinaryBvh before = copy(bvh);
    tree.begin_changes();
    const uint32_t node = 1 + random.below(tree.size() - 1);
    const BinaryNode moved = tree[node];
    double added = 0.0;
    const uint32_t pair = tree.take_out(node, added);
    tree.put_beside(moved, pair, 0, added);
    tree.undo_changes();
    EXPECT_TRUE(are_equal(bvh, before));
    for (uint32_t slot = 0; slot < tree.size(); ++slot) {
      if (tree[slot].is_leaf()) continue;
      EXPECT_EQ(tree.parent(tree[slot].first), slot);
      EXPECT_EQ(tree.parent(tree[slot].first + 1), slot);
    }
  }
}

TEST_F(Reinsertion, SequentialPutsASubtreeWhereItAddsLeast) {
  // A leaf of a good tree is put into the wrong half: it must go back to its neighbours.
  Mesh mesh;
  for (int i = 0; i < 16; ++i) {
    const float x = i < 8 ? static_cast<float>(i) : 1000.0f + static_cast<float>(i);
    mesh.add({x, 0, 0}, {x + 0.5f, 0, 0}, {x, 1, 1});
  }
  BinaryBvh bvh = build_binned(mesh, 1);
  const double good = inner_area(bvh);
  {
    LinkedTree tree(bvh, memory_);
    uint32_t near = 0, far = 0;
    for (uint32_t slot = 1; slot < tree.size(); ++slot) {
      if (!tree[slot].is_leaf()) continue;
      (tree[slot].bounds.lower.x < 500.0f ? near : far) = slot;
    }
    tree.move(near, far);
    tree.finish();
  }
  EXPECT_GT(inner_area(bvh), 1.5 * good);
  kiwami::optimize_by_reinsertion(bvh, {0.1f, 1000, kNoBlocks}, memory_);
  verify(bvh, mesh, 1);
  EXPECT_LE(inner_area(bvh), 1.01 * good);
}

TEST_F(Reinsertion, SequentialLowersTheCostOfEveryScene) {
  const Mesh meshes[] = {soup(5000, seed()), terrain(50), spheres(5000, seed())};
  for (const Mesh& mesh : meshes) {
    for (const uint32_t leaf_size : {1u, 4u}) {
      BinaryBvh bvh = build_binned(mesh, leaf_size);
      const double before = inner_area(bvh);
      kiwami::optimize_by_reinsertion(bvh, {}, memory_);
      verify(bvh, mesh, leaf_size);
      EXPECT_LT(inner_area(bvh), before);
      std::printf("leaves of %u: %.1f %% of the area\n", leaf_size, 100 * inner_area(bvh) / before);
    }
  }
}

/// The triangles below a node of a tree of single triangles.
std::set<uint32_t> ids_below(const BinaryBvh& bvh, uint32_t slot) {
  std::set<uint32_t> ids;
  kiwami::for_each_leaf(bvh, slot,
                        [&](const BinaryNode& leaf) { ids.insert(bvh.primitive_ids[leaf.first]); });
  return ids;
}

TEST_F(Reinsertion, FullBlocksStayWhole) {
  const Mesh mesh = terrain(40);
  BinaryBvh bvh = build_binned(mesh, 1);
  BinaryBvh marked = copy(bvh);
  const kiwami::WholeBlocks blocks(marked, {}, memory_);
  std::set<std::set<uint32_t>> whole;
  for (uint32_t slot = 0; slot < bvh.nodes.size(); ++slot) {
    if (!marked.nodes[slot].is_leaf() || bvh.nodes[slot].is_leaf()) continue;
    EXPECT_TRUE(blocks.is_inside(bvh.nodes[slot].first));
    EXPECT_FALSE(blocks.is_inside(slot));
    const std::set<uint32_t> ids = ids_below(bvh, slot);
    EXPECT_GT(ids.size(), 4u);
    EXPECT_LE(ids.size(), 8u);
    whole.insert(ids);
  }
  EXPECT_GT(whole.size(), 100u);
  kiwami::WholeBlocks::release(marked);
  EXPECT_TRUE(are_equal(marked, bvh));

  const double before = inner_area(bvh);
  kiwami::optimize_by_reinsertion(bvh, {}, memory_);
  EXPECT_LE(inner_area(bvh), before);
  for (uint32_t slot = 0; slot < bvh.nodes.size(); ++slot) whole.erase(ids_below(bvh, slot));
  EXPECT_TRUE(whole.empty());
}

TEST_F(Reinsertion, EndsWhereNoMoveOfOneNodePays) {
  for (int trial = 0; trial < 20; ++trial) {
    const Mesh mesh = soup(14, seed() + 1000 + trial);
    BinaryBvh bvh = build_binned(mesh, 1);
    kiwami::optimize_by_parallel_reinsertion(bvh, {100, 1.0f, kNoBlocks}, memory_, Threads(1));
    verify(bvh, mesh, 1);
    const double least = inner_area(bvh);
    // Every move there is, each made and measured on a tree of its own.
    const auto size = static_cast<uint32_t>(bvh.nodes.size());
    for (uint32_t node = 1; node < size; ++node) {
      for (uint32_t target = 0; target < size; ++target) {
        BinaryBvh moved = copy(bvh);
        LinkedTree tree(moved, memory_);
        if (tree.is_below(target, node) || target == tree.parent(node) ||
            target == tree.sibling(node)) {
          continue;
        }
        tree.move(node, target);
        EXPECT_GE(inner_area(moved), least * (1.0 - 1e-5)) << "node " << node << " to " << target;
      }
    }
  }
}

TEST_F(Reinsertion, LowersTheCostOfEveryScene) {
  const Mesh meshes[] = {soup(20000, seed()), terrain(80), spheres(20000, seed())};
  for (const Mesh& mesh : meshes) {
    for (const uint32_t leaf_size : {1u, 4u}) {
      BinaryBvh bvh = build_binned(mesh, leaf_size);
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
  BinaryBvh good = build_binned(mesh, 1), bad = build_binned(mesh, 1);
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
  kiwami::optimize_by_parallel_reinsertion(bad, {200, 1.0f, kNoBlocks}, memory_, Threads(1));
  verify(bad, mesh, 1);
  EXPECT_LT(inner_area(bad), 0.5 * before);
  EXPECT_LT(inner_area(bad), 1.3 * inner_area(good));
}

TEST_F(Reinsertion, IsTheSameOnAnyNumberOfThreads) {
  const Mesh mesh = soup(30000, seed());
  BinaryBvh expected = build_binned(mesh, 4);
  kiwami::optimize_by_parallel_reinsertion(expected, {}, memory_, Threads(1));
  const kiwami::Parallel plain(0, run_on_plain_threads, nullptr, 8);
  BinaryBvh bvh = build_binned(mesh, 4);
  kiwami::optimize_by_parallel_reinsertion(bvh, {}, memory_, plain);
  EXPECT_TRUE(are_equal(bvh, expected));
}

TEST_F(Reinsertion, DegenerateTreesStayValid) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    BinaryBvh bvh = build_binned(named.mesh, 1);
    kiwami::optimize_by_parallel_reinsertion(bvh, {8, 1.0f}, memory_, Threads(1));
    verify(bvh, named.mesh, 1);
    bvh = build_binned(named.mesh, 1);
    kiwami::optimize_by_reinsertion(bvh, {}, memory_);
    verify(bvh, named.mesh, 1);
  }
}

}  // namespace
}  // namespace kiwami_tests

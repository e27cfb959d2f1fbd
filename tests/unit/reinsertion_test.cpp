// SPDX-License-Identifier: Apache-2.0
#include "optimizers/reinsertion.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "optimizers/linked_tree.h"
#include "support/environment.h"
#include "support/random.h"
#include "unit/binary_tree_test.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::LinkedTree;

class Reinsertion : public BinaryTreeTest {};

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

TEST_F(Reinsertion, EndsWhereNoMoveOfOneNodePays) {
  for (int trial = 0; trial < 20; ++trial) {
    const Mesh mesh = soup(14, seed() + 1000 + trial);
    BinaryBvh bvh = build_binned(mesh, 1);
    kiwami::optimize_by_parallel_reinsertion(bvh, {100, 1.0f}, memory_, Threads(1));
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
  kiwami::optimize_by_parallel_reinsertion(bad, {200, 1.0f}, memory_, Threads(1));
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
  }
}

}  // namespace
}  // namespace kiwami_tests

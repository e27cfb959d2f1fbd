// SPDX-License-Identifier: Apache-2.0
// Treelets: optimal and agglomerative restructuring.
#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "builders/lbvh_builder.h"
#include "bvh/sah_cost.h"
#include "bvh/tree_edit.h"
#include "optimizers/agglomerative_treelet.h"
#include "optimizers/treelet_restructuring.h"
#include "support/environment.h"
#include "unit/binary_tree_test.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::Bounds;
using kiwami::Parallel;
using kiwami::TreeletConfig;

using Optimize = void (*)(BinaryBvh&, const TreeletConfig&, kiwami::Memory&, const Parallel&);
constexpr Optimize kBoth[] = {kiwami::optimize_by_treelets,
                              kiwami::optimize_by_agglomerative_treelets};

class Treelet : public BinaryTreeTest {
 protected:
  BinaryBvh build(const Mesh& mesh) {
    return kiwami::LbvhBuilder::build(primitives_of(mesh, memory_), {}, memory_, Threads(1));
  }
};

/// Single primitives as leaves of cost 0: so the cost is the area of the inner nodes.
TreeletConfig plain(uint32_t leaf_count, uint32_t rounds) {
  TreeletConfig config;
  config.leaf_count = leaf_count;
  config.rounds = rounds;
  config.costs = {1.0f, 0.0f, 1};
  config.max_leaf_size = 1;
  return config;
}

double inner_area(const BinaryBvh& bvh, uint32_t index = 0) {
  const kiwami::BinaryNode& node = bvh.nodes[index];
  if (node.is_leaf()) return 0.0;
  return node.bounds.half_area() + inner_area(bvh, node.first) + inner_area(bvh, node.first + 1);
}

/// The least inner area of all trees over some boxes: each tree of the first k boxes gives those of
/// k + 1, with the new box beside one of its nodes.
class AllTrees {
 public:
  explicit AllTrees(std::vector<Bounds> boxes) : boxes_(std::move(boxes)) {
    nodes_.push_back({boxes_[0], -1, -1});
    insert_from(1, 0);
  }

  double least() const { return least_; }
  size_t count() const { return count_; }

 private:
  struct Node {
    Bounds box;
    int left, right;
  };

  void insert_from(size_t next, int root) {
    if (next == boxes_.size()) {
      double area = 0.0;
      fit(root, area);
      least_ = std::min(least_, area);
      ++count_;
      return;
    }
    const auto leaf = static_cast<int>(nodes_.size()), inner = leaf + 1;
    nodes_.resize(nodes_.size() + 2);
    for (int beside = 0; beside < leaf; ++beside) {
      const int parent = parent_of(beside, leaf);
      node(leaf) = {boxes_[next], -1, -1};
      node(inner) = {{}, beside, leaf};
      relink(parent, beside, inner);
      insert_from(next + 1, parent < 0 ? inner : root);
      relink(parent, inner, beside);
    }
    nodes_.resize(static_cast<size_t>(leaf));
  }

  Node& node(int index) { return nodes_[static_cast<size_t>(index)]; }

  /// -1 of the root. Only the first nodes are linked.
  int parent_of(int child, int linked) {
    for (int i = 0; i < linked; ++i) {
      if (node(i).left == child || node(i).right == child) return i;
    }
    return -1;
  }

  void relink(int parent, int from, int to) {
    if (parent < 0) return;
    (node(parent).left == from ? node(parent).left : node(parent).right) = to;
  }

  Bounds fit(int index, double& area) {
    const Node top = node(index);
    if (top.left < 0) return top.box;
    Bounds box = fit(top.left, area);
    box.extend(fit(top.right, area));
    area += box.half_area();
    return box;
  }

  std::vector<Bounds> boxes_;
  std::vector<Node> nodes_;
  double least_ = std::numeric_limits<double>::infinity();
  size_t count_ = 0;
};

TEST_F(Treelet, SmallTreesBecomeTheBestOfAll) {
  const size_t counts[] = {0, 1, 1, 3, 15, 105, 945, 10395};
  for (uint32_t count = 3; count <= 7; ++count) {
    for (uint64_t trial = 0; trial < 10; ++trial) {
      const Mesh mesh = soup(count, seed() + trial);
      std::vector<Bounds> boxes;
      for (const auto& primitive : primitives_of(mesh, memory_)) {
        boxes.push_back(primitive.bounds());
      }
      const AllTrees all(boxes);
      EXPECT_EQ(all.count(), counts[count]);
      BinaryBvh bvh = build(mesh);
      kiwami::optimize_by_treelets(bvh, plain(count, 1), memory_, Threads(1));
      verify(bvh, mesh, 1);
      EXPECT_NEAR(inner_area(bvh), all.least(), 1e-6 * all.least()) << count;
    }
  }
}

TEST_F(Treelet, WithThreeLeavesBothWaysAreOne) {
  const Mesh mesh = soup(500, seed());
  BinaryBvh optimal = build(mesh), agglomerative = build(mesh);
  const double before = inner_area(optimal);
  kiwami::optimize_by_treelets(optimal, plain(3, 1), memory_, Threads(1));
  kiwami::optimize_by_agglomerative_treelets(agglomerative, plain(3, 1), memory_, Threads(1));
  EXPECT_LT(inner_area(optimal), before);
  EXPECT_NEAR(inner_area(optimal), inner_area(agglomerative), 1e-6 * before);
}

TEST_F(Treelet, LowersTheCostInEachRound) {
  for (const Mesh& mesh : {soup(20000, seed()), spheres(20000, seed()), terrain(80)}) {
    for (const Optimize optimize : kBoth) {
      const double before = inner_area(build(mesh));
      double last = before;
      for (const uint32_t rounds : {1u, 2u, 3u}) {
        BinaryBvh bvh = build(mesh);
        optimize(bvh, plain(7, rounds), memory_, Threads(2));
        verify(bvh, mesh, 1);
        EXPECT_LE(inner_area(bvh), last * (1.0 + 1e-9));
        last = inner_area(bvh);
      }
      std::printf("%.1f %% of the area\n", 100 * last / before);
      EXPECT_LT(last, 0.95 * before);
    }
  }
}

TEST_F(Treelet, LeavesAreCountedInBlocks) {
  const Mesh mesh = soup(5000, seed());
  TreeletConfig config;
  config.costs = {0.5f, 1.0f, 8};
  for (const Optimize optimize : kBoth) {
    BinaryBvh bvh = build(mesh), collapsed = build(mesh);
    kiwami::collapse_leaves(collapsed, 8, config.costs, memory_);
    optimize(bvh, config, memory_, Threads(1));
    kiwami::collapse_leaves(bvh, 8, config.costs, memory_);
    verify(bvh, mesh, 8);
    EXPECT_LT(sah_cost(bvh, config.costs), 0.97 * sah_cost(collapsed, config.costs));
  }
}

TEST_F(Treelet, IsTheSameOnAnyNumberOfThreads) {
  const Mesh mesh = soup(30000, seed());
  const Parallel plain_threads(0, run_on_plain_threads, nullptr, 8);
  for (const Optimize optimize : kBoth) {
    BinaryBvh expected = build(mesh), bvh = build(mesh);
    optimize(expected, {}, memory_, Threads(1));
    optimize(bvh, {}, memory_, plain_threads);
    EXPECT_TRUE(are_equal(bvh, expected));
  }
}

TEST_F(Treelet, DegenerateTreesStayValid) {
  for (const Optimize optimize : kBoth) {
    for (const NamedMesh& named : degenerate_meshes(seed())) {
      SCOPED_TRACE(named.name);
      BinaryBvh bvh = build(named.mesh);
      optimize(bvh, {}, memory_, Threads(1));
      verify(bvh, named.mesh, 1);
    }
    BinaryBvh empty;
    optimize(empty, {}, memory_, Threads(1));
    EXPECT_TRUE(empty.nodes.empty());
  }
}

}  // namespace
}  // namespace kiwami_tests

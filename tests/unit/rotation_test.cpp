// SPDX-License-Identifier: Apache-2.0
#include "optimizers/rotation.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <utility>

#include "builders/lbvh_builder.h"
#include "support/environment.h"
#include "unit/binary_tree_test.h"

namespace kiwami_tests {
namespace {

using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::Bounds;

class Rotation : public BinaryTreeTest {
 protected:
  /// A tree that leaves much to rotate.
  BinaryBvh build(const Mesh& mesh) {
    return kiwami::LbvhBuilder::build(primitives_of(mesh, memory_), {}, memory_, Threads(1));
  }
};

/// The area of all inner nodes, their boxes made anew from the leaves.
double inner_area(const BinaryBvh& bvh, Bounds& box, uint32_t index = 0) {
  const BinaryNode& node = bvh.nodes[index];
  box = node.bounds;
  if (node.is_leaf()) return 0.0;
  Bounds right;
  const double left_area = inner_area(bvh, box, node.first);
  const double right_area = inner_area(bvh, right, node.first + 1);
  box.extend(right);
  return left_area + right_area + box.half_area();
}

double inner_area(const BinaryBvh& bvh) {
  Bounds box;
  return inner_area(bvh, box);
}

TEST_F(Rotation, EndsWhereNoRotationPays) {
  for (int trial = 0; trial < 20; ++trial) {
    const Mesh mesh = soup(40, seed() + trial);
    BinaryBvh bvh = build(mesh);
    kiwami::optimize_by_rotation(bvh, {1000, {1.0f, 1.0f, 1}}, memory_);
    verify(bvh, mesh, 1);
    const double least = inner_area(bvh);
    const auto try_swap = [&](uint32_t a, uint32_t b) {
      BinaryBvh rotated = copy(bvh);
      std::swap(rotated.nodes[a], rotated.nodes[b]);
      EXPECT_GE(inner_area(rotated), least * (1.0 - 1e-6)) << a << " with " << b;
    };
    for (const BinaryNode& node : bvh.nodes) {
      if (node.is_leaf()) continue;
      for (uint32_t child = node.first; child < node.first + 2; ++child) {
        const uint32_t sibling = child == node.first ? child + 1 : child - 1;
        if (bvh.nodes[sibling].is_leaf()) continue;
        for (uint32_t i = 0; i < 2; ++i) {
          const uint32_t below = bvh.nodes[sibling].first + i;
          try_swap(child, below);
          if (bvh.nodes[child].is_leaf()) continue;
          try_swap(bvh.nodes[child].first, below);
        }
      }
    }
  }
}

TEST_F(Rotation, LowersTheCostInEachRound) {
  for (const Mesh& mesh : {soup(20000, seed()), spheres(20000, seed()), terrain(80)}) {
    const double before = inner_area(build(mesh));
    double last = before;
    for (const uint32_t rounds : {1u, 2u, 4u}) {
      BinaryBvh bvh = build(mesh);
      kiwami::optimize_by_rotation(bvh, {rounds, {1.0f, 1.0f, 1}}, memory_);
      verify(bvh, mesh, 1);
      EXPECT_LE(inner_area(bvh), last);
      last = inner_area(bvh);
    }
    std::printf("%.1f %% of the area\n", 100 * last / before);
    EXPECT_LT(last, 0.99 * before);
  }
}

TEST_F(Rotation, DegenerateTreesStayValid) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    BinaryBvh bvh = build(named.mesh);
    kiwami::optimize_by_rotation(bvh, {}, memory_);
    verify(bvh, named.mesh, 1);
  }
}

}  // namespace
}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
#include "optimizers/rotation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "builders/lbvh_builder.h"
#include "bvh/verify_binary.h"
#include "support/environment.h"
#include "unit/tree_scenes.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::Bounds;

class Rotation : public testing::Test {
 protected:
  void SetUp() override {
    RecordProperty("seed", std::to_string(seed()));
    std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  }

  /// A tree that leaves much to rotate.
  BinaryBvh build(const Mesh& mesh) {
    return kiwami::LbvhBuilder::build(primitives_of(mesh, memory_), {}, memory_, Threads(1));
  }

  void verify(const BinaryBvh& bvh, const Mesh& mesh) {
    const auto primitives = primitives_of(mesh, memory_);
    kiwami::verify_binary_bvh(bvh, primitives.data(), primitives.size(), 1, memory_);
  }

  BinaryBvh copy(const BinaryBvh& bvh) {
    BinaryBvh made{Array<BinaryNode>(memory_, bvh.nodes.size()),
                   Array<uint32_t>(memory_, bvh.primitive_ids.size())};
    std::copy(bvh.nodes.begin(), bvh.nodes.end(), made.nodes.begin());
    std::copy(bvh.primitive_ids.begin(), bvh.primitive_ids.end(), made.primitive_ids.begin());
    return made;
  }

  kiwami::Memory memory_{nullptr, nullptr, nullptr};
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
    kiwami::optimize_by_rotation(bvh, {1000}, memory_);
    verify(bvh, mesh);
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
      kiwami::optimize_by_rotation(bvh, {rounds}, memory_);
      verify(bvh, mesh);
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
    verify(bvh, named.mesh);
  }
}

}  // namespace
}  // namespace kiwami_tests

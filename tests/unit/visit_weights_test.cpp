// SPDX-License-Identifier: Apache-2.0
// How likely rays visit the nodes of a binary tree, and the contraction that goes by it.
#include "wide/visit_weights.h"

#include <gtest/gtest.h>

#include <cstring>

#include "support/environment.h"
#include "unit/binary_tree_test.h"
#include "wide/optimal_contraction.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::RepresentativeRay;

class VisitWeights : public BinaryTreeTest {
 protected:
  Array<float> measure(const BinaryBvh& bvh, const TreeScene& scene,
                       const Array<RepresentativeRay>& rays, const kiwami::Parallel& parallel) {
    return kiwami::measure_visit_weights(bvh, scene.source(), {rays.data(), rays.size()}, 2.0f,
                                         memory_, parallel);
  }
};

/// Whether a ray meets a box between its beginning and end, by its slabs, one after the other.
bool meets(const RepresentativeRay& ray, double end, const kiwami::Bounds& box) {
  double enters = ray.tmin, leaves = end;
  for (int axis = 0; axis < 3; ++axis) {
    const double origin = ray.origin[axis], direction = ray.direction[axis];
    if (direction == 0.0) {
      if (origin < box.lower[axis] || origin > box.upper[axis]) return false;
      continue;
    }
    const double lower = (box.lower[axis] - origin) / direction;
    const double upper = (box.upper[axis] - origin) / direction;
    enters = std::max(enters, std::min(lower, upper));
    leaves = std::min(leaves, std::max(lower, upper));
  }
  return enters <= leaves;
}

TEST_F(VisitWeights, CountWhatRaysMeetUpToTheirHit) {
  const Mesh mesh = soup(300, seed());
  const TreeScene scene("soup", mesh);
  const BinaryBvh bvh = build_binned(mesh, 4);
  const auto rays = kiwami::sample_rays(scene.source(), 200, memory_);
  const Array<float> weights = measure(bvh, scene, rays, Threads(2));
  std::vector<double> visits(bvh.nodes.size(), 0.0);
  for (const RepresentativeRay& ray : rays) {
    const kiwami::StatisticalRay exact(ray, {0, 0, 0});
    double end = ray.tmax;
    for (uint32_t i = 0; i < scene.count(); ++i) {
      kiwami::Vec3f corner[3];
      scene.source().corners_of(i, corner);
      end = std::min(end, exact.meet(corner));
    }
    for (size_t i = 0; i < visits.size(); ++i) {
      if (meets(ray, end, bvh.nodes[i].bounds)) visits[i] += 1.0;
    }
  }
  std::vector<double> expected(visits.size(), 1.0);
  for (size_t i = 0; i < expected.size(); ++i) {
    const BinaryNode& node = bvh.nodes[i];
    EXPECT_NEAR(weights[i], expected[i], 1e-4 * expected[i]) << i;
    if (node.is_leaf()) continue;
    for (uint32_t child = node.first; child < node.first + 2; ++child) {
      const double ratio =
          double{bvh.nodes[child].bounds.half_area()} / double{node.bounds.half_area()};
      expected[child] = expected[i] * (visits[child] + 2.0 * ratio) / (visits[i] + 2.0);
    }
  }
}

TEST_F(VisitWeights, AreTheSameOnAnyNumberOfThreads) {
  const Mesh mesh = soup(5000, seed());
  const TreeScene scene("soup", mesh);
  const BinaryBvh bvh = build_binned(mesh, 4);
  const auto rays = kiwami::sample_rays(scene.source(), 3000, memory_);
  const kiwami::Parallel plain(0, run_on_plain_threads, nullptr, 8);
  const Array<float> one = measure(bvh, scene, rays, Threads(1));
  const Array<float> many = measure(bvh, scene, rays, plain);
  EXPECT_EQ(std::memcmp(one.data(), many.data(), one.bytes()), 0);
}

TEST_F(VisitWeights, WithoutRaysAreAreas) {
  const Mesh mesh = soup(2000, seed());
  const TreeScene scene("soup", mesh);
  const BinaryBvh bvh = build_binned(mesh, 4);
  const Array<float> weights = measure(bvh, scene, {}, Threads(1));
  const float root_area = bvh.nodes[0].bounds.half_area();
  for (size_t i = 0; i < weights.size(); ++i) {
    const float area = bvh.nodes[i].bounds.half_area() / root_area;
    EXPECT_NEAR(weights[i], area, 1e-4f * area);
  }
}

TEST_F(VisitWeights, TakeThePlaceOfAreasInTheContraction) {
  const Mesh mesh = soup(2000, seed());
  const BinaryBvh bvh = build_binned(mesh, 4);
  Array<float> weights(memory_, bvh.nodes.size());
  for (size_t i = 0; i < weights.size(); ++i) {
    weights[i] = bvh.nodes[i].bounds.half_area() * 0.25f;
  }
  const auto contract = [&](const Array<float>& of) {
    return kiwami::contract_optimally(bvh, {8, 8, 1.0f, 1.0f, true, {of.data(), of.size()}},
                                      memory_, Threads(1));
  };
  const auto are_same = [](const kiwami::Contraction& a, const kiwami::Contraction& b) {
    return a.slots.size() == b.slots.size() &&
           std::memcmp(a.slots.data(), b.slots.data(), a.slots.bytes()) == 0;
  };
  const kiwami::Contraction by_area = contract({});
  EXPECT_TRUE(are_same(contract(weights), by_area));
  // Other weights, another tree.
  for (size_t i = 0; i < weights.size(); ++i) weights[i] = i % 3 == 0 ? 1.0f : 0.1f;
  EXPECT_FALSE(are_same(contract(weights), by_area));
}

TEST_F(VisitWeights, DegenerateTreesAreWeighed) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    const TreeScene scene(named.name, named.mesh);
    const BinaryBvh bvh = build_binned(named.mesh, 4);
    const auto rays = kiwami::sample_rays(scene.source(), 100, memory_);
    for (const float weight : measure(bvh, scene, rays, Threads(1))) {
      EXPECT_GE(weight, 0.0f);
      EXPECT_LE(weight, 1.0f);
    }
  }
}

}  // namespace
}  // namespace kiwami_tests

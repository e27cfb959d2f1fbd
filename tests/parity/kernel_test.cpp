// SPDX-License-Identifier: Apache-2.0
// The kernels alone, over trees that the library did not build, against the plain oracle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "parity/kernel_check.h"
#include "parity/kernel_tables.h"
#include "parity/test_tree.h"
#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/plain_oracle.h"

namespace kiwami_tests {
namespace {

/// Rays that are answered by the plain loop at once.
constexpr uint64_t kRaysPerBlock = 50000;

/// Compares all kernels on about count rays at a scene. The plain loop, which takes most of the
/// time, answers each ray once for all of them.
void compare_all(const Scene& scene, uint64_t count, uint64_t stream) {
  const PlainOracle oracle(scene);
  const TestTree trees[] = {TestTree(scene, 4), TestTree(scene, 8), TestTree(scene, 16)};
  for (uint64_t begin = 0; begin < count; begin += kRaysPerBlock) {
    const uint64_t rays = std::min(count - begin, kRaysPerBlock);
    const Expected expected =
        expected_of(oracle, scene, rays, Random(seed(), stream + (begin << 16)));
    for (const NamedKernels& kernels : all_kernels()) {
      const TestTree& tree = trees[kernels.width == 4 ? 0 : kernels.width == 8 ? 1 : 2];
      const std::string found = difference(kernels, tree.view(), expected);
      EXPECT_TRUE(found.empty()) << kernels.name << ", scene " << scene.name
                                 << ", KIWAMI_SEED=" << seed() << "\n"
                                 << found;
    }
  }
}

TEST(AllKernels, AgreeWithThePlainOracleOnAdversarialScenes) {
  const auto scenes = static_cast<uint32_t>(case_budget(200));
  const uint64_t rays = ray_budget(100000) / scenes + 1;
  for (uint32_t i = 0; i < scenes; ++i) compare_all(adversarial_scene(i, seed()), rays, i);
  std::printf("%u scenes, %llu rays on each of %zu kernel sets, KIWAMI_SEED=%llu\n", scenes,
              static_cast<unsigned long long>(rays * scenes), all_kernels().size(),
              static_cast<unsigned long long>(seed()));
}

TEST(AllKernels, AgreeWithThePlainOracleOnClosedMeshes) {
  for (const ClosedMesh& closed : closed_meshes()) {
    compare_all(scene_of(closed), ray_budget(10000) / 70 + 1, 0);
  }
}

/// A bundle of size * size rays from a point near the mesh through a window of it, row by row: as
/// coherent as those of a camera.
Expected coherent_rays(const PlainOracle& oracle, const Mesh& mesh, int size, Random& random) {
  const Point eye = mesh.vertices[random.below(mesh.vertices.size())] +
                    Point{random.symmetric(), random.symmetric(), random.symmetric()} * 2.0f;
  const Point target = mesh.vertices[random.below(mesh.vertices.size())];
  const Point right{random.symmetric(), random.symmetric(), random.symmetric()};
  const Point up{random.symmetric(), random.symmetric(), random.symmetric()};
  Expected expected;
  for (int i = 0; i < size * size; ++i) {
    const Point d = (target - eye) + right * (0.3f * static_cast<float>(i % size) / size) +
                    up * (0.3f * static_cast<float>(i / size) / size);
    expected.rays.push_back({eye.x, eye.y, eye.z, 0.0f, d.x, d.y, d.z, INFINITY, 0.0f, ~0u, 0, 0});
    expected.hits.push_back(oracle.closest_hit(expected.rays.back()));
    expected.counts.push_back(oracle.all_hits(expected.rays.back()));
  }
  return expected;
}

TEST(AllKernels, AgreeWithThePlainOracleOnCoherentRays) {
  Random random(seed());
  for (const ClosedMesh& closed : closed_meshes()) {
    const Scene scene = scene_of(closed);
    const PlainOracle oracle(scene);
    for (uint64_t bundle = 0; bundle < ray_budget(20000) / 2000 + 1; ++bundle) {
      const Expected expected = coherent_rays(oracle, scene.meshes.front(), 16, random);
      for (const NamedKernels& kernels : all_kernels()) {
        EXPECT_EQ(difference(kernels, TestTree(scene, kernels.width).view(), expected), "")
            << "KIWAMI_SEED=" << seed();
      }
    }
  }
}

/// Rays along an axis, from so far that the mesh is a point to them, through so many of its vertices.
/// Each that hits is followed by one whose interval is the hit alone: a box that is left too early
/// by a single rounding is missed.
Expected far_axis_rays(const PlainOracle& oracle, const Mesh& mesh, size_t vertex_count) {
  Expected expected;
  const auto add = [&](const kiwami_ray& ray) {
    expected.rays.push_back(ray);
    expected.hits.push_back(oracle.closest_hit(ray));
    expected.counts.push_back(oracle.all_hits(ray));
  };
  for (size_t i = 0; i < std::min(vertex_count, mesh.vertices.size()); ++i) {
    const Point& vertex = mesh.vertices[i];
    for (int axis = 0; axis < 3; ++axis) {
      for (const float side : {-16.0f, 16.0f}) {
        Point origin = vertex, direction{-0.0f, 0.0f, -0.0f};
        origin[axis] = side;
        direction[axis] = side < 0 ? 1.0f : -1.0f;
        kiwami_ray ray{origin.x,    origin.y, origin.z, -INFINITY, direction.x, direction.y,
                       direction.z, INFINITY, 0.0f,     ~0u,       0,           0};
        add(ray);
        if (expected.counts.back() == 0) continue;
        ray.tmin = ray.tmax = expected.hits.back().t;
        add(ray);
        ray.tmax = INFINITY;
        add(ray);
      }
    }
  }
  return expected;
}

TEST(AllKernels, MeetATinyMeshFromFarAlongAnAxis) {
  for (const float size : {0x1p-30f, 0x1p-66f, 0x1p-100f}) {
    Random random(seed());
    Mesh mesh;
    for (int i = 0; i < 200; ++i) {
      const auto point = [&] {
        // Now and then in one plane, so that boxes are flat and faces lie on their sides.
        const float y = random.one_in(2) ? 0x1p-19f : random.symmetric();
        return Point{random.symmetric(), y, random.symmetric()} * size;
      };
      const Point corner = point();
      mesh.add(corner, corner + point() * 0.1f, corner + point() * 0.1f);
    }
    const Scene scene{"tiny", {mesh}};
    const Expected expected = far_axis_rays(PlainOracle(scene), mesh, ray_budget(600));
    for (const NamedKernels& kernels : all_kernels()) {
      EXPECT_EQ(difference(kernels, TestTree(scene, kernels.width).view(), expected), "")
          << "KIWAMI_SEED=" << seed();
    }
  }
}

class Kernels : public testing::TestWithParam<NamedKernels> {};

TEST_P(Kernels, AreCaughtWhenABoxIsTooSmall) {
  const Scene scene = scene_of(closed_meshes().front());
  TestTree tree(scene, GetParam().width);
  const Expected expected = expected_of(PlainOracle(scene), scene, 4000, Random(5));
  ASSERT_EQ(difference(GetParam(), tree.view(), expected), "");
  tree.shrink_box(0, 0.01f);
  EXPECT_NE(difference(GetParam(), tree.view(), expected), "");
}

TEST_P(Kernels, AreCaughtWhenTheOracleHasTheInclusiveEdgeRule) {
  const Scene scene = scene_of(closed_meshes().front());
  const PlainOracle wrong(scene, EdgeRule::kInclusive);
  const TestTree tree(scene, GetParam().width);
  EXPECT_NE(difference(GetParam(), tree.view(), expected_of(wrong, scene, 2000, Random(6))), "");
}

INSTANTIATE_TEST_SUITE_P(All, Kernels, testing::ValuesIn(all_kernels()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace kiwami_tests

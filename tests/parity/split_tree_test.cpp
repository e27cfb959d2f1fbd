// SPDX-License-Identifier: Apache-2.0
// Trees in which triangles stand in several leaves (spatial splits), by all kernels against the
// plain loop: every answer, each triangle counted once, each hit in a box of its triangle.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "parity/kernel_check.h"
#include "parity/kernel_tables.h"
#include "parity/split_scene.h"
#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/plain_oracle.h"
#include "support/random.h"
#include "support/ray_generator.h"

namespace kiwami_tests {
namespace {

/// "" where all kernels answer as expected.
std::string difference_of_all(const SplitScene& split, const Expected& expected) {
  for (const NamedKernels& kernels : all_kernels()) {
    const std::string found = difference(kernels, split.view(kernels.width), expected);
    if (!found.empty()) return std::string(kernels.name) + ", " + found;
  }
  return "";
}

/// The planes on which the boxes of the wide tree end, in the frame of the scene.
std::vector<float> planes_of(const SplitScene& split, int axis) {
  std::vector<float> planes = {0.0f};
  const kiwami::SceneView& view = split.view(8);
  const auto* const nodes = reinterpret_cast<const kiwami::WideNode<8>*>(view.tree.memory);
  for (uint32_t i = 0; i < split.info(8).node_count; ++i) {
    for (int slot = 0; slot < 8; ++slot) {
      for (int side = 0; side < 2; ++side) {
        const float plane = nodes[i].bounds[axis][side][slot] + view.tree.centre[axis];
        if (std::fabs(plane) <= KIWAMI_MAX_COORDINATE) planes.push_back(plane);
      }
    }
  }
  return planes;
}

/// Rays through points of triangles, of their edges among them, that lie on the sides of boxes.
std::vector<kiwami_ray> rays_at_planes(const Scene& scene, const SplitScene& split, size_t count,
                                       Random random) {
  std::vector<kiwami_ray> rays;
  std::vector<float> planes[3];
  for (int axis = 0; axis < 3; ++axis) planes[axis] = planes_of(split, axis);
  const Mesh& mesh = scene.meshes[0];
  while (rays.size() < count) {
    const int axis = random.between(0, 2);
    const auto corner = mesh.corners(random.below(static_cast<uint32_t>(mesh.triangles.size())));
    const float plane = planes[axis][random.below(static_cast<uint32_t>(planes[axis].size()))];
    const Point a = corner[0], b = corner[1], c = corner[2];
    const float ratio = (plane - a[axis]) / (b[axis] - a[axis]);
    Point target = a + (b - a) * (ratio >= 0 && ratio <= 1 ? ratio : random.unit());
    if (random.one_in(2)) target = target + (c - target) * random.unit();
    target[axis] = plane;
    Point origin = {random.symmetric(), random.symmetric(), random.symmetric()};
    origin = random.one_in(2) ? origin * 3.0f : a + (origin - a) * 0x1p-4f;
    rays.push_back(ray_from(origin, target - origin));
  }
  return rays;
}

Expected with_answers(const PlainOracle& oracle, std::vector<kiwami_ray> rays) {
  Expected expected;
  expected.rays = std::move(rays);
  for (const kiwami_ray& ray : expected.rays) {
    expected.hits.push_back(oracle.closest_hit(ray));
    expected.counts.push_back(oracle.all_hits(ray));
  }
  return expected;
}

TEST(SplitTrees, AgreeWithThePlainLoopOnAdversarialScenes) {
  const auto scenes = static_cast<uint32_t>(case_budget(60));
  const uint64_t rays = ray_budget(30000) / scenes + 1;
  uint64_t extra = 0;
  for (uint32_t i = 0; i < scenes; ++i) {
    const Scene scene = adversarial_scene(i, seed());
    const SplitScene split(scene);
    extra += split.extra_references();
    const Expected expected = expected_of(PlainOracle(scene), scene, rays, Random(seed(), 500 + i));
    EXPECT_EQ(difference_of_all(split, expected), "")
        << "scene " << scene.name << ", KIWAMI_SEED=" << seed();
  }
  std::printf("%llu references beyond one a triangle\n", static_cast<unsigned long long>(extra));
  EXPECT_GT(extra, 0u);
}

TEST(SplitTrees, AgreeWithThePlainLoopOnClosedMeshesAndAtTheSidesOfBoxes) {
  uint64_t extra = 0;
  for (const ClosedMesh& closed : closed_meshes()) {
    const Scene scene = scene_of(closed);
    const PlainOracle oracle(scene);
    const SplitScene split(scene);
    extra += split.extra_references();
    const Expected expected =
        expected_of(oracle, scene, ray_budget(10000) / 7 + 1, Random(seed(), 600));
    EXPECT_EQ(difference_of_all(split, expected), "")
        << "scene " << scene.name << ", KIWAMI_SEED=" << seed();
    const size_t count = ray_budget(10000) / 7 + 1;
    const Expected at_planes =
        with_answers(oracle, rays_at_planes(scene, split, count, Random(seed(), 601)));
    EXPECT_EQ(difference_of_all(split, at_planes), "")
        << "at planes, scene " << scene.name << ", KIWAMI_SEED=" << seed();
  }
  EXPECT_GT(extra, 0u);
}

/// Were the kernels not told that triangles stand in several leaves, they would count them twice.
TEST(SplitTrees, AreCaughtWhereTrianglesAreCountedTwice) {
  const Scene scene = scene_of(closed_meshes().front());
  const SplitScene split(scene);
  const Expected expected = expected_of(PlainOracle(scene), scene, 4000, Random(5));
  for (const NamedKernels& kernels : all_kernels()) {
    kiwami::SceneView view = split.view(kernels.width);
    EXPECT_EQ(difference(kernels, view, expected), "") << kernels.name;
    view.tree.has_duplicates = 0;
    EXPECT_NE(difference(kernels, view, expected), "") << kernels.name;
  }
}

}  // namespace
}  // namespace kiwami_tests

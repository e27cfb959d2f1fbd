// SPDX-License-Identifier: Apache-2.0
// The textbook structures that the library is measured against find what trying every triangle
// finds.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "measure/baselines/baseline_peer.h"
#include "measure/baselines/structure.h"
#include "measure/library.h"
#include "measure/ray_sets.h"
#include "scene/procedural.h"

namespace kiwami::tools {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

class Baseline : public testing::TestWithParam<NamedStructure> {};

float distance_of(const BaselineHit& hit) {
  return hit.triangle == KIWAMI_INVALID_ID ? kInfinity : hit.t;
}

/// The distance to the nearest of all triangles.
float try_all(const std::vector<PreparedTriangle>& triangles, const kiwami_ray& given) {
  const PreparedRay ray(given);
  BaselineHit hit = no_hit(given);
  for (const PreparedTriangle& triangle : triangles) {
    triangle.intersect(ray.origin, ray.direction, ray.tmin, hit);
  }
  return distance_of(hit);
}

std::vector<PreparedTriangle> prepare(const std::vector<Corners>& triangles) {
  std::vector<PreparedTriangle> prepared;
  for (const Corners& corners : triangles) prepared.emplace_back(corners, 0);
  return prepared;
}

Box bounds_of_all(const std::vector<Corners>& triangles) {
  Box box = empty_box();
  for (const Corners& corners : triangles) grow(box, box_of(corners));
  return triangles.empty() ? Box{{-1, -1, -1}, {1, 1, 1}} : box;
}

/// How many rays hit something. Every answer must be that of trying all triangles.
size_t expect_right(const Structure& structure, const std::vector<Corners>& triangles,
                    const std::vector<kiwami_ray>& rays) {
  const std::vector<PreparedTriangle> prepared = prepare(triangles);
  std::vector<BaselineHit> hits(rays.size());
  std::vector<uint8_t> occluded(rays.size());
  structure.closest_hits(rays, hits);
  structure.any_hits(rays, occluded);
  size_t hit_count = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const float expected = try_all(prepared, rays[i]);
    // Of triangles at one place either may be met, their distances rounded apart.
    const float answer = distance_of(hits[i]);
    EXPECT_TRUE(answer == expected || std::abs(answer - expected) <= 1e-6f * expected)
        << "ray " << i << ": " << answer << ", expected " << expected;
    EXPECT_EQ(occluded[i], expected < kInfinity ? 1 : 0) << "ray " << i;
    if (hits[i].triangle == KIWAMI_INVALID_ID) continue;
    ++hit_count;
    EXPECT_LT(hits[i].triangle, triangles.size());
    const PreparedRay ray(rays[i]);
    BaselineHit again = no_hit(rays[i]);
    EXPECT_TRUE(PreparedTriangle(triangles[hits[i].triangle], 0)
                    .intersect(ray.origin, ray.direction, ray.tmin, again));
    EXPECT_EQ(again.t, hits[i].t);
  }
  return hit_count;
}

std::vector<kiwami_ray> rays_for(const std::vector<Corners>& triangles, size_t count) {
  return random_rays(bounds_of_all(triangles), count, 1).rays;
}

TEST_P(Baseline, FindsWhatTryingAllTrianglesFinds) {
  for (const char* name : {"soup:1500:1", "sphere:3", "terrain:20", "hairball:2000"}) {
    SCOPED_TRACE(name);
    const std::vector<Corners> triangles = list_triangles(flatten(*make_procedural_scene(name)));
    const auto structure = GetParam().build(triangles);
    EXPECT_GT(structure->bytes(), triangles.size() * sizeof(Corners));
    EXPECT_GT(expect_right(*structure, triangles, rays_for(triangles, 3000)), 5u);
  }
}

TEST_P(Baseline, FindsThemAlongTheAxes) {
  const SceneFile file = *make_procedural_scene("soup:800:2");
  const std::vector<Corners> triangles = list_triangles(file);
  const auto structure = GetParam().build(triangles);
  const Box box = bounds_of_all(triangles);
  std::vector<kiwami_ray> rays = axis_rays(file, box, 1000, 1).rays;
  // Those through vertices meet edges, where the usual test is of two minds.
  std::erase_if(rays, [&](const kiwami_ray& ray) {
    const PreparedRay prepared(ray);
    for (const Corners& corners : triangles) {
      for (const Vec3 corner : corners) {
        const Vec3 offset = cross(corner - prepared.origin, prepared.direction);
        if (length(offset) == 0.0f) return true;
      }
    }
    return false;
  });
  ASSERT_GT(rays.size(), 300u);
  EXPECT_GT(expect_right(*structure, triangles, rays), 100u);
}

TEST_P(Baseline, HandlesNothingAndOneTriangle) {
  const Corners corners = {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};
  for (const size_t count : {0u, 1u}) {
    const std::vector<Corners> triangles(count, corners);
    const auto structure = GetParam().build(triangles);
    const std::vector<kiwami_ray> rays = {
        make_ray({0.2f, 0.2f, 1.0f}, {0, 0, -1}, 0.0f, kInfinity),
        make_ray({0.2f, 0.2f, 1.0f}, {0, 0, -1}, 0.0f, 0.5f),
        make_ray({0.2f, 0.2f, 1.0f}, {0, 0, -1}, 1.5f, kInfinity),
        make_ray({0.9f, 0.9f, 1.0f}, {0, 0, -1}, 0.0f, kInfinity),
        make_ray({0.2f, 0.2f, -3.0f}, {0.01f, 0, 1}, 0.0f, kInfinity)};
    EXPECT_EQ(expect_right(*structure, triangles, rays), count * 2);
  }
}

TEST_P(Baseline, HandlesTrianglesThatNoPlaneDivides) {
  const Corners corners = {Vec3{0, 0, 0}, Vec3{1, 0, 0.1f}, Vec3{0, 1, 0.2f}};
  std::vector<Corners> triangles(300, corners);
  {
    const auto structure = GetParam().build(triangles);
    EXPECT_GT(expect_right(*structure, triangles, rays_for(triangles, 300)), 10u);
  }
  // All in one plane, and some that are points.
  triangles = list_triangles(*make_procedural_scene("soup:300:3"));
  for (size_t i = 0; i < triangles.size(); ++i) {
    for (Vec3& corner : triangles[i]) corner.z = 0.5f;
    if (i % 3 == 0) triangles[i] = {triangles[i][0], triangles[i][0], triangles[i][0]};
  }
  const auto structure = GetParam().build(triangles);
  const std::vector<kiwami_ray> rays = random_rays({{-1, -1, 0}, {1, 1, 1}}, 500, 2).rays;
  EXPECT_GT(expect_right(*structure, triangles, rays), 50u);
}

TEST_P(Baseline, CountsWhatItDoes) {
  const std::vector<Corners> triangles = list_triangles(*make_procedural_scene("sphere:4"));
  const auto structure = GetParam().build(triangles);
  const std::vector<kiwami_ray> rays = rays_for(triangles, 500);
  const StepCounts closest = structure->count(rays, false);
  const StepCounts any = structure->count(rays, true);
  EXPECT_GT(closest.steps, rays.size());
  EXPECT_GT(closest.triangle_tests, rays.size() / 2);
  EXPECT_LT(closest.triangle_tests, rays.size() * triangles.size() / 20);
  EXPECT_LE(any.triangle_tests, closest.triangle_tests);
}

INSTANTIATE_TEST_SUITE_P(All, Baseline, testing::ValuesIn(kStructures),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(TriangleList, LeavesOutWhatTheLibraryLeavesOut) {
  SceneFile file = *make_procedural_scene("sphere:0");
  file.meshes[0].vertices[0] = std::numeric_limits<float>::quiet_NaN();
  file.meshes[0].vertices[4] = 2.0f * KIWAMI_MAX_COORDINATE;
  const Device device(KIWAMI_ISA_SCALAR, 1);
  const BuiltScene scene(device, file);
  const std::vector<Corners> triangles = list_triangles(file);
  EXPECT_EQ(triangles.size(), scene.info().triangle_count);
  EXPECT_LT(triangles.size(), 20u);
  EXPECT_GT(triangles.size(), 0u);
}

TEST(BinaryPeer, AnswersAsTheLibraryOnAnyNumberOfThreads) {
  const SceneFile file = *make_procedural_scene("terrain:30");
  const Device device(KIWAMI_ISA_SCALAR, 1);
  const BuiltScene scene(device, file);
  const std::vector<kiwami_ray> rays = random_rays(bounds_of(scene.info()), 9000, 3).rays;
  std::vector<kiwami_hit> hits(rays.size());
  scene.closest_hits(rays, hits);
  const auto peer = make_binary_peer(file);
  EXPECT_GT(peer->bytes(), 0u);
  EXPECT_GT(peer->build_seconds(), 0.0);
  for (const bool any_hit : {false, true}) {
    const auto run = peer->entrances(rays, any_hit, true).at(0).prepare();
    for (const uint32_t threads : {1u, 3u}) {
      run->reset();
      EXPECT_EQ(run->distance(0), kInfinity);
      run->trace(threads);
      size_t different = 0;
      for (size_t i = 0; i < rays.size(); ++i) {
        // The library culls where a ray asks for it; the peer does not.
        if (rays[i].flags != 0) continue;
        const float expected = any_hit && is_hit(hits[i]) ? 0.0f : hits[i].t;
        const float answer = run->distance(i);
        if (answer != expected && !(std::abs(answer - expected) < 1e-4f)) ++different;
      }
      EXPECT_LE(different, 1u);
    }
  }
}

}  // namespace
}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
// Scenes whose vertices move: after every refit the answers are those of a scene that was made anew.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <thread>

#include "api/changes.h"
#include "support/environment.h"

namespace kiwami_api_tests {
namespace {

using kiwami_tests::seed;

class RefitTest : public testing::TestWithParam<uint32_t> {};

TEST_P(RefitTest, GivesTheAnswersOfANewScene) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  Random random(seed());
  const Device device = make_device();
  const std::vector<kiwami_ray> rays = random_rays(3000, seed());
  Triangles triangles = random_triangles(2000, seed());
  kiwami_triangle_mesh_desc desc = triangles.desc();
  desc.flags = GetParam();
  const Geometry mesh = make_mesh(device, desc);
  const Scene scene = make_scene(device, mesh);
  EXPECT_EQ(info_of(scene).refit_count, 0u);
  uint64_t refits = 0;
  for (const float distance : {0.0f, 0.01f, 0.3f, 2.0f}) {
    move_all(triangles, distance, random);
    ASSERT_EQ(update(mesh, triangles), KIWAMI_OK) << last_error();
    ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK) << last_error();
    EXPECT_EQ(info_of(scene).refit_count, ++refits);
    expect_valid(scene);
    EXPECT_TRUE(are_equal(closest_hits(scene, rays), fresh_hits(device, triangles, rays)))
        << distance;
  }
  EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(info_of(scene).refit_count, 0u);
  EXPECT_TRUE(are_equal(closest_hits(scene, rays), fresh_hits(device, triangles, rays)));
}

INSTANTIATE_TEST_SUITE_P(Buffers, RefitTest,
                         testing::Values(0u, uint32_t{KIWAMI_MESH_SHARE_BUFFERS}));

TEST(Refit, GivesTheAnswersOfANewSceneInTreesOfEveryKind) {
  Random random(seed());
  const Device device = make_device();
  const std::vector<kiwami_ray> rays = random_rays(1000, seed());
  for (const uint32_t width : {4u, 8u, 16u}) {
    for (const uint32_t builder : {KIWAMI_BUILDER_LBVH, KIWAMI_BUILDER_SPATIAL_SPLIT}) {
      Triangles triangles = random_triangles(700, seed() + width);
      const Geometry mesh = make_mesh(device, triangles.desc());
      const Scene scene = make_scene(device);
      kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BVH_WIDTH, width);
      kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BUILDER, builder);
      kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_VALIDATE_BUILD, 1);
      kiwami_scene_attach(scene.get(), mesh.get(), nullptr);
      ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
      for (const float distance : {0.02f, 0.5f}) {
        move_all(triangles, distance, random);
        ASSERT_EQ(update(mesh, triangles), KIWAMI_OK);
        ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK) << last_error();
        EXPECT_TRUE(are_equal(closest_hits(scene, rays), fresh_hits(device, triangles, rays)));
      }
      EXPECT_EQ(info_of(scene).refit_count, 2u);
    }
  }
}

TEST(Refit, LetsTrianglesVanishAndComeBack) {
  Random random(seed());
  const Device device = make_device();
  const std::vector<kiwami_ray> rays = random_rays(2000, seed());
  const Triangles original = random_triangles(500, seed());
  const Geometry mesh = make_mesh(device, original.desc());
  const Scene scene = make_scene(device, mesh);
  const std::vector<kiwami_hit> before = closest_hits(scene, rays);
  for (const uint32_t one_in : {20u, 1u}) {
    Triangles holed = original;
    for (float& coordinate : holed.vertices) {
      if (random.one_in(one_in)) coordinate = random.one_in(2) ? NAN : kInfinity;
    }
    ASSERT_EQ(update(mesh, holed), KIWAMI_OK);
    ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK) << last_error();
    EXPECT_EQ(info_of(scene).refit_count, 1u);
    const Scene fresh = make_scene(device, make_mesh(device, holed.desc()));
    EXPECT_EQ(info_of(scene).triangle_count, info_of(fresh).triangle_count);
    EXPECT_EQ(info_of(scene).skipped_count, info_of(fresh).skipped_count);
    EXPECT_EQ(info_of(scene).bounds_min[0], info_of(fresh).bounds_min[0]);
    expect_valid(scene);
    EXPECT_TRUE(are_equal(closest_hits(scene, rays), closest_hits(fresh, rays)));
    ASSERT_EQ(update(mesh, original), KIWAMI_OK);
    ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK) << last_error();
    EXPECT_TRUE(are_equal(closest_hits(scene, rays), before));
    ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  }
}

TEST(Refit, BuildsWhereATriangleHasNoPlaceInTheTree) {
  const Device device = make_device();
  const std::vector<kiwami_ray> rays = random_rays(1000, seed());
  const Triangles original = random_triangles(300, seed());
  Triangles holed = original;
  holed.vertices[9 * 17 + 4] = NAN;
  holed.vertices[9 * 299] = NAN;
  const Geometry mesh = make_mesh(device, holed.desc());
  const Scene scene = make_scene(device, mesh);
  EXPECT_EQ(info_of(scene).skipped_count, 2u);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(info_of(scene).refit_count, 1u);
  ASSERT_EQ(update(mesh, original), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(info_of(scene).refit_count, 0u);
  EXPECT_EQ(info_of(scene).skipped_count, 0u);
  EXPECT_TRUE(are_equal(closest_hits(scene, rays), fresh_hits(device, original, rays)));
}

TEST(Refit, BuildsTheFirstTimeAndWhereGeometriesCameOrWent) {
  const Device device = make_device();
  const Geometry near = make_mesh(device, square(1).desc());
  const Geometry far = make_mesh(device, square(2).desc());
  const Scene scene = make_scene(device);
  uint32_t id = 0;
  ASSERT_EQ(kiwami_scene_attach(scene.get(), far.get(), &id), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK) << last_error();
  EXPECT_EQ(closest_hit(scene, ray_along_z(0.5f, 0.25f)).t, 2.0f);
  ASSERT_EQ(kiwami_scene_attach(scene.get(), near.get(), &id), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(info_of(scene).refit_count, 0u);
  EXPECT_EQ(closest_hit(scene, ray_along_z(0.5f, 0.25f)).t, 1.0f);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(info_of(scene).refit_count, 1u);
  ASSERT_EQ(kiwami_scene_detach(scene.get(), id), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(info_of(scene).refit_count, 0u);
  EXPECT_EQ(closest_hit(scene, ray_along_z(0.5f, 0.25f)).t, 2.0f);
}

TEST(Refit, NeedsNoNewMemoryFrameByFrame) {
  Random random(seed());
  CountingAllocator allocator;
  kiwami_device_desc desc = default_device();
  allocator.install(desc);
  {
    const Device device = make_device(desc);
    Triangles triangles = random_triangles(5000, seed());
    const Geometry mesh = make_mesh(device, triangles.desc());
    const Scene scene = make_scene(device, mesh);
    size_t live = 0;
    for (int frame = 0; frame < 6; ++frame) {
      move_all(triangles, 0.01f, random);
      ASSERT_EQ(update(mesh, triangles), KIWAMI_OK);
      ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
      if (frame == 2) live = allocator.live_bytes;
      if (frame > 2) {
        EXPECT_EQ(allocator.live_bytes, live);
      }
    }
    const size_t with_two = allocator.live_bytes;
    ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
    EXPECT_LT(allocator.live_bytes, with_two);
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
}

TEST(Refit, LeavesTheTreeThatSomebodyHoldsAsItWas) {
  Random random(seed());
  const Device device = make_device();
  Triangles triangles = random_triangles(400, seed());
  const Geometry mesh = make_mesh(device, triangles.desc());
  const Scene scene = make_scene(device, mesh);
  std::vector<Bvh> held;
  std::vector<std::vector<kiwami_bvh_node>> nodes;
  for (int frame = 0; frame < 5; ++frame) {
    held.push_back(bvh_of(scene));
    nodes.push_back(nodes_of(held.back()));
    move_all(triangles, 0.2f, random);
    ASSERT_EQ(update(mesh, triangles), KIWAMI_OK);
    ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  }
  for (size_t i = 0; i < held.size(); ++i) {
    EXPECT_EQ(kiwami_bvh_validate(held[i].get()), KIWAMI_OK) << last_error();
    const std::vector<kiwami_bvh_node> now = nodes_of(held[i]);
    ASSERT_EQ(now.size(), nodes[i].size());
    EXPECT_EQ(std::memcmp(now.data(), nodes[i].data(), now.size() * sizeof now[0]), 0);
  }
}

TEST(Refit, EveryFailureLeavesTheLastStructureInUse) {
  const std::vector<kiwami_ray> rays = random_rays(200, seed());
  CountingAllocator allocator;
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  allocator.install(desc);
  {
    const Device device = make_device(desc);
    Triangles triangles = random_triangles(300, seed());
    const Geometry mesh = make_mesh(device, triangles.desc());
    const Scene scene = make_scene(device, mesh);
    const std::vector<kiwami_hit> before = closest_hits(scene, rays);
    Random random(seed());
    move_all(triangles, 0.3f, random);
    size_t failures = 0;
    for (size_t later = 0;; ++later) {
      allocator.first_failure = allocator.calls + later;
      kiwami_result result = update(mesh, triangles);
      if (result == KIWAMI_OK) result = kiwami_scene_refit(scene.get());
      allocator.first_failure = std::numeric_limits<size_t>::max();
      if (result == KIWAMI_OK) break;
      ASSERT_EQ(result, KIWAMI_ERROR_OUT_OF_MEMORY) << last_error();
      ASSERT_TRUE(are_equal(closest_hits(scene, rays), before)) << later;
      ++failures;
    }
    EXPECT_GT(failures, 3u);
    EXPECT_TRUE(are_equal(closest_hits(scene, rays), fresh_hits(device, triangles, rays)));
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
  EXPECT_EQ(allocator.mismatches, 0u);
}

TEST(Refit, AFailingRunnerLeavesTheLastStructureInUse) {
  kiwami_device_desc desc = default_device();
  ThreadRunner runner;
  runner.install(desc, 2);
  const Device device = make_device(desc);
  const std::vector<kiwami_ray> rays = random_rays(200, seed());
  Triangles triangles = random_triangles(20000, seed());
  triangles.indices.resize(3 * 20000);
  kiwami_triangle_mesh_desc mesh_desc = triangles.desc();
  mesh_desc.flags = KIWAMI_MESH_SHARE_BUFFERS;
  const Geometry mesh = make_mesh(device, mesh_desc);
  const Scene scene = make_scene(device, mesh);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);  // so that there are two structures
  const std::vector<kiwami_hit> before = closest_hits(scene, rays);
  Triangles moved = triangles;
  Random random(seed());
  move_all(moved, 0.3f, random);
  ASSERT_EQ(update(mesh, moved), KIWAMI_OK);
  runner.status = 3;
  EXPECT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_ERROR_CALLBACK);
  runner.status = 0;
  EXPECT_TRUE(are_equal(closest_hits(scene, rays), before));
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_TRUE(are_equal(closest_hits(scene, rays), fresh_hits(device, moved, rays)));
}

TEST(Refit, ScenesOfOneMeshAreTracedWhileAnotherMoves) {
  const Device device = make_device();
  Triangles triangles = random_triangles(3000, seed());
  const Geometry mesh = make_mesh(device, triangles.desc());
  const Scene still = make_scene(device, mesh);
  const Scene moving = make_scene(device, mesh);
  const std::vector<kiwami_ray> rays = random_rays(500, seed());
  const std::vector<kiwami_hit> expected = closest_hits(still, rays);
  std::atomic<bool> is_done{false};
  std::atomic<int> differences{0};
  std::thread tracer([&] {
    while (!is_done) {
      if (!are_equal(closest_hits(still, rays), expected)) ++differences;
    }
  });
  Random random(seed());
  for (int frame = 0; frame < 20; ++frame) {
    move_all(triangles, 0.05f, random);
    EXPECT_EQ(update(mesh, triangles), KIWAMI_OK);
    EXPECT_EQ(frame % 7 == 3 ? kiwami_scene_commit(moving.get()) : kiwami_scene_refit(moving.get()),
              KIWAMI_OK);
  }
  is_done = true;
  tracer.join();
  EXPECT_EQ(differences, 0);
  EXPECT_TRUE(are_equal(closest_hits(moving, rays), fresh_hits(device, triangles, rays)));
}

TEST(Refit, ChangedIndicesThatNameNoVertexAreAnError) {
  const Device device = make_device();
  Triangles triangles = square(1);
  kiwami_triangle_mesh_desc desc = triangles.desc();
  desc.flags = KIWAMI_MESH_SHARE_BUFFERS;
  const Geometry mesh = make_mesh(device, desc);
  const Scene scene = make_scene(device, mesh);
  triangles.indices[4] = 4;
  EXPECT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("index 1 of triangle 1 of geometry 0 is 4"), std::string::npos);
  EXPECT_EQ(closest_hit(scene, ray_along_z(0.5f, 0.25f)).t, 1.0f);
}

}  // namespace
}  // namespace kiwami_api_tests

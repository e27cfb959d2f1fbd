// SPDX-License-Identifier: Apache-2.0
// Scenes with a tree for each mesh: the answers are those of one tree, and a commit builds what has
// changed alone. (Their sequences of changes are in refit_test.cpp.)
#include <gtest/gtest.h>

#include <cmath>
#include <thread>

#include "api/api_support.h"
#include "support/environment.h"
#include "support/random.h"

namespace kiwami_api_tests {
namespace {

using kiwami_tests::Random;
using kiwami_tests::seed;

Scene make_two_level(const Device& device, uint32_t width = 0) {
  Scene scene = make_scene(device);
  EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_TWO_LEVEL, 1), KIWAMI_OK);
  EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BVH_WIDTH, width), KIWAMI_OK);
  return scene;
}

/// Clusters of triangles, some of which touch or equal each other, so that hits tie.
std::vector<Triangles> objects(size_t count, uint32_t triangles, uint64_t number) {
  Random random(number);
  std::vector<Triangles> made;
  for (size_t i = 0; i < count; ++i) {
    if (i != 0 && random.one_in(8)) {
      made.push_back(made[random.below(static_cast<uint32_t>(i))]);
      continue;
    }
    Triangles object = random_triangles(triangles, random.bits());
    const float centre[3] = {random.symmetric(), random.symmetric(), random.symmetric()};
    for (size_t k = 0; k < object.vertices.size(); ++k) {
      object.vertices[k] = centre[k % 3] + 0.2f * object.vertices[k];
    }
    made.push_back(std::move(object));
  }
  return made;
}

TEST(TwoLevel, GivesTheAnswersOfOneTreeOnEveryIsaAndWidth) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  const std::vector<kiwami_ray> rays = random_rays(2000, seed());
  const std::vector<Triangles> all = objects(60, 40, seed());
  std::vector<kiwami_hit> expected;
  for (uint32_t isa = KIWAMI_ISA_SCALAR; isa <= KIWAMI_ISA_AVX512; ++isa) {
    kiwami_device_desc desc = default_device();
    desc.isa = isa;
    kiwami_device* handle = nullptr;
    if (kiwami_device_create(&desc, &handle) != KIWAMI_OK) continue;
    const Device device(handle);
    for (const uint32_t width : {4u, 8u, 16u}) {
      const Scene one = make_scene(device);
      const Scene two = make_two_level(device, width);
      for (size_t i = 0; i < all.size(); ++i) {
        kiwami_triangle_mesh_desc mesh_desc = all[i].desc();
        if (i % 7 == 3) mesh_desc.mask = 5;
        const Geometry mesh = make_mesh(device, mesh_desc);
        kiwami_scene_attach(one.get(), mesh.get(), nullptr);
        kiwami_scene_attach(two.get(), mesh.get(), nullptr);
      }
      kiwami_scene_set_parameter(one.get(), KIWAMI_PARAMETER_BVH_WIDTH, width);
      ASSERT_EQ(kiwami_scene_commit(one.get()), KIWAMI_OK) << last_error();
      ASSERT_EQ(kiwami_scene_commit(two.get()), KIWAMI_OK) << last_error();
      EXPECT_EQ(kiwami_scene_validate(two.get()), KIWAMI_OK) << last_error();
      if (expected.empty()) expected = closest_hits(one, rays);
      EXPECT_TRUE(are_equal(closest_hits(one, rays), expected));
      EXPECT_TRUE(are_equal(closest_hits(two, rays), expected)) << "isa " << isa << ", " << width;
      std::vector<uint8_t> of_one(rays.size()), of_two(rays.size());
      kiwami_any_hit(one.get(), rays.data(), 0, of_one.data(), 0, rays.size(), nullptr);
      kiwami_any_hit(two.get(), rays.data(), 0, of_two.data(), 0, rays.size(), nullptr);
      EXPECT_EQ(of_one, of_two);
    }
  }
}

TEST(TwoLevel, TellsWhatItIsMadeOf) {
  const Device device = make_device();
  const Scene two = make_two_level(device);
  const Scene one = make_scene(device);
  for (const Triangles& object : objects(20, 50, seed())) {
    const Geometry mesh = make_mesh(device, object.desc());
    kiwami_scene_attach(two.get(), mesh.get(), nullptr);
    kiwami_scene_attach(one.get(), mesh.get(), nullptr);
  }
  ASSERT_EQ(kiwami_scene_commit(two.get()), KIWAMI_OK) << last_error();
  ASSERT_EQ(kiwami_scene_commit(one.get()), KIWAMI_OK);
  const kiwami_scene_info info = info_of(two), other = info_of(one);
  EXPECT_EQ(info.triangle_count, other.triangle_count);
  EXPECT_EQ(info.reference_count, other.reference_count);
  EXPECT_GT(info.node_count, 20u);
  EXPECT_GT(info.bvh_depth, 1u);
  EXPECT_GT(info.total_bytes, info.node_bytes + info.leaf_bytes);
  EXPECT_GT(info.sah_cost, 0.0);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(info.bounds_min[axis], other.bounds_min[axis]);
    EXPECT_EQ(info.bounds_max[axis], other.bounds_max[axis]);
  }
  kiwami_bvh* bvh = nullptr;
  EXPECT_EQ(kiwami_scene_get_bvh(two.get(), &bvh), KIWAMI_ERROR_INVALID_STATE);
  EXPECT_NE(last_error().find("KIWAMI_PARAMETER_TWO_LEVEL"), std::string::npos) << last_error();
}

TEST(TwoLevel, ACommitBuildsOnlyWhatHasChanged) {
  CountingAllocator allocator;
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  allocator.install(desc);
  {
    const Device device = make_device(desc);
    const std::vector<kiwami_ray> rays = random_rays(500, seed());
    const Scene scene = make_two_level(device);
    std::vector<Triangles> all = objects(400, 30, seed());
    std::vector<Geometry> meshes;
    for (const Triangles& object : all) {
      meshes.push_back(make_mesh(device, object.desc()));
      kiwami_scene_attach(scene.get(), meshes.back().get(), nullptr);
    }
    const size_t before = allocator.calls;
    ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
    const size_t of_all = allocator.calls - before;
    Random random(seed());
    for (const auto commit : {kiwami_scene_commit, kiwami_scene_refit}) {
      const uint32_t changed = random.below(400);
      for (float& coordinate : all[changed].vertices) coordinate += 0.05f * random.symmetric();
      kiwami_triangle_mesh_update_vertices(meshes[changed].get(), all[changed].vertices.data(), 0,
                                           0);
      const size_t start = allocator.calls;
      ASSERT_EQ(commit(scene.get()), KIWAMI_OK) << last_error();
      EXPECT_LT(20 * (allocator.calls - start), of_all);
      EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
      const Scene fresh = make_scene(device);
      for (const Geometry& mesh : meshes) {
        kiwami_scene_attach(fresh.get(), mesh.get(), nullptr);
      }
      ASSERT_EQ(kiwami_scene_commit(fresh.get()), KIWAMI_OK);
      EXPECT_TRUE(are_equal(closest_hits(scene, rays), closest_hits(fresh, rays)));
    }
    // Other parameters: all is built anew.
    kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_MAX_LEAF_SIZE, 2);
    const size_t start = allocator.calls;
    ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
    EXPECT_GT(2 * (allocator.calls - start), of_all);
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
}

TEST(TwoLevel, FailuresLeaveTheLastStructureInUseAndLeakNothing) {
  CountingAllocator allocator;
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  allocator.install(desc);
  {
    const Device device = make_device(desc);
    const std::vector<kiwami_ray> rays = random_rays(200, seed());
    const Scene scene = make_two_level(device);
    for (const Triangles& object : objects(10, 20, seed())) {
      kiwami_scene_attach(scene.get(), make_mesh(device, object.desc()).get(), nullptr);
    }
    ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
    const std::vector<kiwami_hit> before = closest_hits(scene, rays);
    for (const Triangles& object : objects(3, 20, seed() + 1)) {
      kiwami_scene_attach(scene.get(), make_mesh(device, object.desc()).get(), nullptr);
    }
    size_t failures = 0;
    for (size_t later = 0;; ++later) {
      const size_t live = allocator.live_bytes;
      allocator.first_failure = allocator.calls + later;
      const kiwami_result result = kiwami_scene_commit(scene.get());
      allocator.first_failure = std::numeric_limits<size_t>::max();
      if (result == KIWAMI_OK) break;
      ASSERT_EQ(result, KIWAMI_ERROR_OUT_OF_MEMORY) << last_error();
      ASSERT_EQ(allocator.live_bytes, live) << later;
      if (later % 8 == 0) {
        ASSERT_TRUE(are_equal(closest_hits(scene, rays), before));
      }
      ++failures;
    }
    EXPECT_GT(failures, 10u);
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
}

TEST(TwoLevel, EmptyMeshesAndNothingAtAll) {
  const Device device = make_device();
  const Scene scene = make_two_level(device);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
  EXPECT_EQ(closest_hit(scene, ray_along_z(0, 0)).primitive_id, KIWAMI_INVALID_ID);
  kiwami_scene_attach(scene.get(), make_mesh(device, default_mesh()).get(), nullptr);
  Triangles nothing = square(1);
  for (float& coordinate : nothing.vertices) coordinate = NAN;
  kiwami_scene_attach(scene.get(), make_mesh(device, nothing.desc()).get(), nullptr);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
  EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
  EXPECT_EQ(info_of(scene).skipped_count, 2u);
  EXPECT_EQ(closest_hit(scene, ray_along_z(0, 0)).primitive_id, KIWAMI_INVALID_ID);
  kiwami_scene_attach(scene.get(), make_mesh(device, square(2).desc()).get(), nullptr);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(closest_hit(scene, ray_along_z(0.5f, 0.25f)).geometry_id, 2u);
}

TEST(TwoLevel, OneSceneIsTracedWhileAnotherOfTheSameMeshesChanges) {
  const Device device = make_device();
  const Scene still = make_two_level(device), moving = make_two_level(device);
  std::vector<Triangles> all = objects(30, 50, seed());
  std::vector<Geometry> meshes;
  for (const Triangles& object : all) {
    meshes.push_back(make_mesh(device, object.desc()));
    kiwami_scene_attach(still.get(), meshes.back().get(), nullptr);
    kiwami_scene_attach(moving.get(), meshes.back().get(), nullptr);
  }
  ASSERT_EQ(kiwami_scene_commit(still.get()), KIWAMI_OK);
  const std::vector<kiwami_ray> rays = random_rays(300, seed());
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
    const uint32_t changed = random.below(30);
    for (float& coordinate : all[changed].vertices) coordinate += 0.05f * random.symmetric();
    kiwami_triangle_mesh_update_vertices(meshes[changed].get(), all[changed].vertices.data(), 0, 0);
    EXPECT_EQ(frame % 2 ? kiwami_scene_commit(moving.get()) : kiwami_scene_refit(moving.get()),
              KIWAMI_OK);
  }
  is_done = true;
  tracer.join();
  EXPECT_EQ(differences, 0);
}

}  // namespace
}  // namespace kiwami_api_tests

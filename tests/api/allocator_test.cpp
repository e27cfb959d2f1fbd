// SPDX-License-Identifier: Apache-2.0
// The caller's allocator: everything comes from it and goes back, and every failure is survived.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "api/api_support.h"
#include "support/figures.h"
#include "support/rich_lights.h"
#include "support/rich_scene.h"

namespace kiwami_api_tests {
namespace {

using namespace kiwami_tests;

/// Writes a tree as compressed nodes.
kiwami_result run_export(const kiwami_bvh* bvh) {
  size_t nodes = 0, primitives = 0;
  const kiwami_result result =
      kiwami_bvh_export_counts(bvh, KIWAMI_EXPORT_COMPRESSED8, &nodes, &primitives);
  if (result != KIWAMI_OK) return result;
  std::vector<kiwami_compressed8_node> to(nodes);
  std::vector<kiwami_bvh_primitive> names(primitives);
  return kiwami_bvh_export(bvh, KIWAMI_EXPORT_COMPRESSED8, to.data(), nodes * sizeof to[0],
                           names.data(), primitives);
}

/// Saves to memory of 1 MiB and loads what was saved. Returns the first error.
kiwami_result run_files(kiwami_device* device, const kiwami_scene* scene, const kiwami_bvh* bvh) {
  std::vector<unsigned char> file(size_t{1} << 20);
  kiwami_save_desc save;
  kiwami_load_desc load;
  kiwami_file_info info{};
  kiwami_scene* loaded_scene = nullptr;
  kiwami_bvh* loaded_bvh = nullptr;
  info.struct_size = sizeof info;
  kiwami_save_desc_init(&save, sizeof save);
  kiwami_load_desc_init(&load, sizeof load);
  load.data = save.data = file.data();
  save.capacity = file.size();
  kiwami_result result = kiwami_scene_save(scene, &save, &load.size);
  if (result == KIWAMI_OK) result = kiwami_file_get_info(device, &load, &info);
  if (result == KIWAMI_OK) result = kiwami_scene_load(device, &load, &loaded_scene);
  if (result == KIWAMI_OK) result = kiwami_scene_commit(loaded_scene);
  if (result == KIWAMI_OK) result = kiwami_bvh_save(bvh, &save, &load.size);
  if (result == KIWAMI_OK) result = kiwami_bvh_load(device, &load, &loaded_bvh);
  kiwami_scene_release(loaded_scene);
  kiwami_bvh_release(loaded_bvh);
  return result;
}

/// Looks at the tree of a scene, and builds and moves another one. Returns the first error.
kiwami_result run_trees(kiwami_device* device, const kiwami_scene* scene, kiwami_geometry* mesh) {
  kiwami_bvh* of_scene = nullptr;
  kiwami_bvh* built = nullptr;
  kiwami_bvh_desc desc;
  const kiwami_parameter_value leaf_size = {KIWAMI_PARAMETER_MAX_LEAF_SIZE, 0, 3};
  kiwami_bvh_desc_init(&desc, sizeof desc);
  desc.geometry = mesh;
  desc.width = 8;
  desc.parameters = &leaf_size;
  desc.parameter_count = 1;
  kiwami_result result = kiwami_scene_get_bvh(scene, &of_scene);
  if (result == KIWAMI_OK) result = kiwami_bvh_measure(of_scene, nullptr, nullptr, nullptr, 0);
  if (result == KIWAMI_OK) result = kiwami_bvh_build(device, &desc, &built);
  if (result == KIWAMI_OK) result = kiwami_bvh_refit(built, nullptr, 0, 0);
  if (result == KIWAMI_OK) result = kiwami_bvh_validate(built);
  if (result == KIWAMI_OK) result = run_export(built);
  if (result == KIWAMI_OK) result = run_files(device, scene, built);
  kiwami_bvh_release(of_scene);
  kiwami_bvh_release(built);
  return result;
}

/// Makes a device, two meshes and a scene, commits twice and releases all. Returns the first error.
kiwami_result run_life(CountingAllocator& allocator, const Triangles& triangles) {
  kiwami_device_desc device_desc = default_device();
  device_desc.thread_count = 1;  // so that the number of an allocation is the same in each run
  allocator.install(device_desc);
  kiwami_device* device = nullptr;
  kiwami_geometry* mesh = nullptr;
  kiwami_scene* scene = nullptr;
  const kiwami_triangle_mesh_desc mesh_desc = triangles.desc();
  kiwami_result result = kiwami_device_create(&device_desc, &device);
  if (result == KIWAMI_OK) result = kiwami_triangle_mesh_create(device, &mesh_desc, &mesh);
  if (result == KIWAMI_OK) result = kiwami_scene_create(device, &scene);
  if (result == KIWAMI_OK) result = kiwami_scene_attach(scene, mesh, nullptr);
  if (result == KIWAMI_OK) result = kiwami_scene_commit(scene);
  if (result == KIWAMI_OK) result = kiwami_scene_validate(scene);
  if (result == KIWAMI_OK) result = run_trees(device, scene, mesh);
  if (result == KIWAMI_OK) result = kiwami_scene_attach(scene, mesh, nullptr);
  if (result == KIWAMI_OK) result = kiwami_scene_commit(scene);
  kiwami_scene_release(scene);
  kiwami_geometry_release(mesh);
  kiwami_device_release(device);
  return result;
}

/// Makes a distribution by each method and draws from it. Returns the first error.
kiwami_result run_distributions(kiwami_device* device) {
  const float weights[] = {1.0f, 0.0f, 3.0f, 0.25f, 7.0f};
  kiwami_result result = KIWAMI_OK;
  for (const uint32_t method : {uint32_t{KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST},
                                uint32_t{KIWAMI_DISTRIBUTION_ALIAS_TABLE}}) {
    kiwami_distribution_desc desc;
    kiwami_distribution* distribution = nullptr;
    const double random = 0.5;
    kiwami_draw draw;
    kiwami_distribution_desc_init(&desc, sizeof desc);
    desc.method = method;
    desc.weights = weights;
    desc.weight_count = 5;
    if (result == KIWAMI_OK) result = kiwami_distribution_create(device, &desc, &distribution);
    if (result == KIWAMI_OK) {
      result = kiwami_distribution_sample(distribution, &random, 0, &draw, 0, 1);
    }
    kiwami_distribution_release(distribution);
  }
  return result;
}

/// Commits, refits and changes a set of lights with instances. Returns the first error.
kiwami_result run_lights(kiwami_device* device) {
  kiwami_light_tree* lights = nullptr;
  const float power = 2.0f;
  kiwami_result result = make_rich_lights(device, {4, 3, true}, &lights);
  if (result == KIWAMI_OK) result = kiwami_light_tree_refit(lights);
  if (result == KIWAMI_OK) result = kiwami_light_tree_set_powers(lights, 1, &power, 0, 1);
  if (result == KIWAMI_OK) result = kiwami_light_tree_commit(lights);
  kiwami_light_tree_release(lights);
  return result;
}

/// Commits a scene of geometries of all kinds twice, by rays of its own. Returns the first error.
kiwami_result run_kinds(kiwami_device* device) {
  const kiwami_ray rays[] = {ray_along_z(0.1f, 0.2f), ray_along_z(-0.3f, 0.2f)};
  kiwami_scene* scene = nullptr;
  kiwami_result result = make_rich_scene(device, {kRichAll, 4, 3}, &scene);
  if (result == KIWAMI_OK) {
    result = kiwami_scene_set_parameter(scene, KIWAMI_PARAMETER_CONTRACTION,
                                        KIWAMI_CONTRACTION_RAY_DISTRIBUTION);
  }
  if (result == KIWAMI_OK) result = kiwami_scene_set_representative_rays(scene, rays, 0, 2);
  if (result == KIWAMI_OK) result = kiwami_scene_commit(scene);
  if (result == KIWAMI_OK) result = kiwami_scene_validate(scene);
  if (result == KIWAMI_OK) result = kiwami_scene_refit(scene);
  kiwami_scene_release(scene);
  return result;
}

/// Calls run with a device whose allocation `failure` and all after it fail.
template <typename Run>
void expect_survives_failures(Run&& run) {
  size_t failure = 0;
  for (kiwami_result result = KIWAMI_ERROR_OUT_OF_MEMORY; result != KIWAMI_OK; ++failure) {
    CountingAllocator allocator;
    kiwami_device_desc desc = default_device();
    desc.thread_count = 1;
    allocator.install(desc);
    {
      const Device device = make_device(desc);
      allocator.first_failure = allocator.calls + failure;
      result = run(device.get());
      ASSERT_TRUE(result == KIWAMI_OK || result == KIWAMI_ERROR_OUT_OF_MEMORY) << last_error();
    }
    ASSERT_EQ(allocator.live_bytes, 0u) << failure;
    ASSERT_EQ(allocator.live_blocks, 0u) << failure;
    ASSERT_EQ(allocator.mismatches, 0u) << failure;
  }
  EXPECT_GT(failure, 5u);
  kiwami_tests::print_figure("allocations failed, one run each", failure - 1);
}

TEST(Allocator, EveryFailureOfADistributionIsAnError) {
  expect_survives_failures(run_distributions);
}

TEST(Allocator, EveryFailureOfASetOfLightsIsAnError) { expect_survives_failures(run_lights); }

TEST(Allocator, EveryFailureOfASceneOfAllKindsIsAnError) { expect_survives_failures(run_kinds); }

TEST(Allocator, GetsEveryByteBackInTheSizeItGave) {
  CountingAllocator allocator;
  ASSERT_EQ(run_life(allocator, random_triangles(2000, 4)), KIWAMI_OK) << last_error();
  EXPECT_GT(allocator.calls, 10u);
  EXPECT_EQ(allocator.live_bytes, 0u);
  EXPECT_EQ(allocator.live_blocks, 0u);
  EXPECT_EQ(allocator.mismatches, 0u);
}

TEST(Allocator, EveryFailureIsAnErrorAndLeaksNothing) {
  const Triangles triangles = random_triangles(500, 4);
  CountingAllocator whole;
  ASSERT_EQ(run_life(whole, triangles), KIWAMI_OK) << last_error();
  for (size_t failure = 0; failure < whole.calls; ++failure) {
    CountingAllocator allocator;
    allocator.first_failure = failure;
    ASSERT_EQ(run_life(allocator, triangles), KIWAMI_ERROR_OUT_OF_MEMORY) << failure;
    EXPECT_EQ(last_error().rfind("allocation of ", 0), 0u) << last_error();
    EXPECT_NE(last_error().find(" bytes "), std::string::npos) << last_error();
    EXPECT_EQ(allocator.live_bytes, 0u) << failure;
    EXPECT_EQ(allocator.live_blocks, 0u) << failure;
    EXPECT_EQ(allocator.mismatches, 0u) << failure;
  }
  kiwami_tests::print_figure("allocations failed, one run each", whole.calls);
}

TEST(Allocator, FailuresOnManyThreadsLeakNothing) {
  const Triangles triangles = random_triangles(30000, 4);
  CountingAllocator allocator;
  kiwami_device_desc desc = default_device();
  ThreadRunner runner;
  runner.threads = 4;
  runner.install(desc, 4);
  allocator.install(desc);
  {
    const Device device = make_device(desc);
    const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
    const kiwami_ray ray = random_rays(1, 4)[0];
    const kiwami_hit before = closest_hit(scene, ray);
    const size_t live = allocator.live_bytes;
    size_t failures = 0;
    // Every allocation is failed by the test before; here some suffice, closer at the beginning.
    for (size_t later = 0;; later += 1 + later / 4) {
      allocator.first_failure = allocator.calls + later;
      const kiwami_result result = kiwami_scene_commit(scene.get());
      if (result == KIWAMI_OK) break;
      ASSERT_EQ(result, KIWAMI_ERROR_OUT_OF_MEMORY) << last_error();
      ASSERT_EQ(allocator.live_bytes, live) << "after failure " << later;
      ++failures;
    }
    EXPECT_GT(failures, 5u);
    EXPECT_TRUE(are_equal({closest_hit(scene, ray)}, {before}));
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
  EXPECT_EQ(allocator.mismatches, 0u);
}

kiwami_device_info info_of(const Device& device) {
  kiwami_device_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(kiwami_device_get_info(device.get(), &info), KIWAMI_OK) << last_error();
  return info;
}

TEST(MemoryLimit, IsKeptToTheByteByEveryBuild) {
  const Triangles triangles = random_triangles(5000, 4);
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  uint64_t needed = 0;
  {
    const Device device = make_device(desc);
    EXPECT_EQ(info_of(device).memory_limit, 0u);
    const uint64_t empty = info_of(device).memory_bytes;
    {
      const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
      needed = info_of(device).memory_peak_bytes;
      EXPECT_GE(info_of(device).memory_bytes, info_of(scene).total_bytes);
      EXPECT_LE(info_of(device).memory_bytes, info_of(scene).total_bytes + 16384);
      EXPECT_GE(needed, info_of(scene).peak_build_bytes);
    }
    EXPECT_EQ(info_of(device).memory_bytes, empty);
    EXPECT_EQ(info_of(device).memory_peak_bytes, needed);
  }
  const uint64_t device_bytes = info_of(make_device(desc)).memory_bytes;
  for (const uint64_t limit : {needed - device_bytes, needed - device_bytes - 1}) {
    desc.memory_limit = limit;
    const Device device = make_device(desc);
    EXPECT_EQ(info_of(device).memory_limit, limit);
    const Scene scene = make_scene(device);
    const Geometry mesh = make_mesh(device, triangles.desc());
    ASSERT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    if (limit == needed - device_bytes) {
      EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
    } else {
      EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_ERROR_OUT_OF_MEMORY);
      EXPECT_NE(last_error().find("expected at most desc.memory_limit, which is " +
                                  std::to_string(limit)),
                std::string::npos)
          << last_error();
    }
    EXPECT_LE(info_of(device).memory_peak_bytes, limit + device_bytes);
  }
}

TEST(MemoryLimit, LeavesWhatWasCommittedUsable) {
  kiwami_device_desc desc = default_device();
  desc.memory_limit = 400000;
  const Device device = make_device(desc);
  const Scene scene = make_scene(device, make_mesh(device, square(1).desc()));
  const kiwami_hit before = closest_hit(scene, ray_along_z(0.2f, 0.1f));
  const uint64_t bytes = info_of(device).memory_bytes;
  {
    const Geometry large = make_mesh(device, random_triangles(4000, 2).desc());
    ASSERT_EQ(kiwami_scene_attach(scene.get(), large.get(), nullptr), KIWAMI_OK) << last_error();
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_ERROR_OUT_OF_MEMORY);
    ASSERT_EQ(kiwami_scene_detach(scene.get(), 1), KIWAMI_OK);
  }
  kiwami_triangle_mesh_desc huge = default_mesh();
  const std::vector<float> vertices(300000);
  huge.vertices = vertices.data();
  huge.vertex_count = vertices.size() / 3;
  kiwami_geometry* none = nullptr;
  EXPECT_EQ(kiwami_triangle_mesh_create(device.get(), &huge, &none), KIWAMI_ERROR_OUT_OF_MEMORY);
  EXPECT_EQ(none, nullptr);
  EXPECT_LE(info_of(device).memory_bytes, bytes + 1024);
  EXPECT_TRUE(are_equal({closest_hit(scene, ray_along_z(0.2f, 0.1f))}, {before}));
  EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
}

TEST(Allocator, MisalignedBlocksAreRefused) {
  CountingAllocator allocator;
  allocator.misplacement = 1;
  kiwami_device_desc desc = default_device();
  allocator.install(desc);
  kiwami_device* device = nullptr;
  EXPECT_EQ(kiwami_device_create(&desc, &device), KIWAMI_ERROR_CALLBACK);
  EXPECT_EQ(last_error().rfind("allocate returned ", 0), 0u) << last_error();
  EXPECT_EQ(allocator.live_blocks, 0u);
}

}  // namespace
}  // namespace kiwami_api_tests

// SPDX-License-Identifier: Apache-2.0
// Commits that tell how far they are, and commits that are cancelled.
#include <gtest/gtest.h>

#include <mutex>
#include <thread>

#include "api/api_support.h"
#include "support/environment.h"

namespace kiwami_api_tests {
namespace {

using kiwami_tests::seed;

/// Notes what it is told; cancels at the call of a number.
struct Listener {
  size_t cancel_at = std::numeric_limits<size_t>::max();
  std::vector<double> fractions;
  std::atomic<int> inside{0};
  std::atomic<bool> met_another{false};
  const ThreadRunner* runner = nullptr;
  size_t loops_at_cancel = 0;

  static int32_t call(void* user, double fraction) {
    Listener& self = *static_cast<Listener*>(user);
    if (self.inside.fetch_add(1) != 0) self.met_another = true;
    self.fractions.push_back(fraction);
    const bool cancels = self.fractions.size() > self.cancel_at;
    if (cancels && self.runner) self.loops_at_cancel = self.runner->loops;
    self.inside.fetch_sub(1);
    return cancels ? -3 : 0;
  }
};

void expect_rising(const Listener& listener) {
  ASSERT_FALSE(listener.fractions.empty());
  EXPECT_EQ(listener.fractions.front(), 0.0);
  double last = 0.0;
  for (const double fraction : listener.fractions) {
    EXPECT_GE(fraction, last);
    EXPECT_LE(fraction, 1.0);
    last = fraction;
  }
  EXPECT_FALSE(listener.met_another);
}

constexpr uint32_t kBuilders[] = {
    KIWAMI_BUILDER_BINNED_SAH, KIWAMI_BUILDER_LBVH,          KIWAMI_BUILDER_PLOC,
    KIWAMI_BUILDER_SWEEP_SAH,  KIWAMI_BUILDER_SPATIAL_SPLIT, KIWAMI_BUILDER_AGGLOMERATIVE,
    KIWAMI_BUILDER_STR};

TEST(Progress, RisesToOneInEveryPipeline) {
  const Device device = make_device();
  const Geometry mesh = make_mesh(device, random_triangles(2000, seed()).desc());
  for (const uint32_t builder : kBuilders) {
    const Scene scene = make_scene(device);
    kiwami_scene_attach(scene.get(), mesh.get(), nullptr);
    kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BUILDER, builder);
    Listener listener;
    ASSERT_EQ(kiwami_scene_set_progress(scene.get(), &Listener::call, &listener), KIWAMI_OK);
    ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
    expect_rising(listener);
    EXPECT_EQ(listener.fractions.back(), 1.0);
    EXPECT_GT(listener.fractions.size(), 3u);
    listener.fractions.clear();
    ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
    expect_rising(listener);
    EXPECT_EQ(listener.fractions.back(), 1.0);
    // Nobody is told any more.
    const size_t calls = listener.fractions.size();
    ASSERT_EQ(kiwami_scene_set_progress(scene.get(), nullptr, nullptr), KIWAMI_OK);
    ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
    EXPECT_EQ(listener.fractions.size(), calls);
  }
}

TEST(Progress, ACancelledCommitLeavesTheLastStructureAndNoMemory) {
  CountingAllocator allocator;
  kiwami_device_desc desc = default_device();
  ThreadRunner runner;
  runner.threads = 3;
  runner.install(desc, 3);
  allocator.install(desc);
  const std::vector<kiwami_ray> rays = random_rays(300, seed());
  {
    const Device device = make_device(desc);
    const Geometry mesh = make_mesh(device, random_triangles(20000, seed()).desc());
    for (const uint32_t builder : kBuilders) {
      const Scene scene = make_scene(device, make_mesh(device, random_triangles(500, 3).desc()));
      const std::vector<kiwami_hit> before = closest_hits(scene, rays);
      kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BUILDER, builder);
      kiwami_scene_attach(scene.get(), mesh.get(), nullptr);
      const size_t live = allocator.live_bytes;
      size_t cancelled = 0;
      for (size_t call = 0;; call += 1 + call / 2) {
        Listener listener;
        listener.cancel_at = call;
        listener.runner = &runner;
        kiwami_scene_set_progress(scene.get(), &Listener::call, &listener);
        const kiwami_result result = kiwami_scene_commit(scene.get());
        if (result == KIWAMI_OK) break;
        ASSERT_EQ(result, KIWAMI_ERROR_CANCELLED) << last_error();
        EXPECT_NE(last_error().find("progress function"), std::string::npos);
        // No loop begins any more.
        EXPECT_EQ(runner.loops, listener.loops_at_cancel);
        EXPECT_EQ(listener.fractions.size(), call + 1);
        ASSERT_EQ(allocator.live_bytes, live);
        ASSERT_TRUE(are_equal(closest_hits(scene, rays), before));
        ++cancelled;
      }
      EXPECT_GT(cancelled, 2u);
      // Edited, the scene commits as ever.
      kiwami_scene_set_progress(scene.get(), nullptr, nullptr);
      ASSERT_EQ(kiwami_scene_detach(scene.get(), 1), KIWAMI_OK);
      ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
      EXPECT_TRUE(are_equal(closest_hits(scene, rays), before));
    }
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
  EXPECT_EQ(allocator.mismatches, 0u);
}

TEST(Progress, ACancelledRefitLeavesTheLastStructure) {
  const Device device = make_device();
  const std::vector<kiwami_ray> rays = random_rays(300, seed());
  Triangles triangles = random_triangles(3000, seed());
  const Geometry mesh = make_mesh(device, triangles.desc());
  const Scene scene = make_scene(device, mesh);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  const std::vector<kiwami_hit> before = closest_hits(scene, rays);
  for (float& coordinate : triangles.vertices) coordinate *= 0.5f;
  kiwami_triangle_mesh_update_vertices(mesh.get(), triangles.vertices.data(), 0, 0);
  for (size_t call = 0;; ++call) {
    Listener listener;
    listener.cancel_at = call;
    kiwami_scene_set_progress(scene.get(), &Listener::call, &listener);
    const kiwami_result result = kiwami_scene_refit(scene.get());
    if (result == KIWAMI_OK) break;
    ASSERT_EQ(result, KIWAMI_ERROR_CANCELLED) << last_error();
    ASSERT_TRUE(are_equal(closest_hits(scene, rays), before));
  }
  EXPECT_TRUE(
      are_equal(closest_hits(scene, rays),
                closest_hits(make_scene(device, make_mesh(device, triangles.desc())), rays)));
}

TEST(Progress, OneSceneIsTracedWhileAnotherIsCommittedAndCancelled) {
  const Device device = make_device();
  const Geometry mesh = make_mesh(device, random_triangles(5000, seed()).desc());
  const Scene still = make_scene(device, mesh);
  const Scene changing = make_scene(device, mesh);
  const std::vector<kiwami_ray> rays = random_rays(500, seed());
  const std::vector<kiwami_hit> expected = closest_hits(still, rays);
  std::atomic<bool> is_done{false};
  std::atomic<int> differences{0};
  std::thread tracer([&] {
    while (!is_done) {
      if (!are_equal(closest_hits(still, rays), expected)) ++differences;
    }
  });
  for (size_t round = 0; round < 12; ++round) {
    Listener listener;
    listener.cancel_at = round % 4 == 3 ? 1000000 : round;
    kiwami_scene_set_progress(changing.get(), &Listener::call, &listener);
    const kiwami_result result = kiwami_scene_commit(changing.get());
    EXPECT_TRUE(result == KIWAMI_OK || result == KIWAMI_ERROR_CANCELLED) << last_error();
  }
  is_done = true;
  tracer.join();
  EXPECT_EQ(differences, 0);
}

TEST(Progress, ASceneIsNeeded) {
  EXPECT_EQ(kiwami_scene_set_progress(nullptr, &Listener::call, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("scene is NULL"), std::string::npos);
}

}  // namespace
}  // namespace kiwami_api_tests

// SPDX-License-Identifier: Apache-2.0
// The caller's own threads.
#include <gtest/gtest.h>

#include <thread>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

class RunnerTest : public testing::Test {
 protected:
  Device device_of(ThreadRunner& runner, uint32_t width) {
    kiwami_device_desc desc = default_device();
    runner.install(desc, width);
    return make_device(desc);
  }

  const Triangles triangles_ = random_triangles(30000, 11);
  const std::vector<kiwami_ray> rays_ = random_rays(20000, 12);
};

TEST_F(RunnerTest, GivesTheSameBitsOnEveryNumberOfThreads) {
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  const Device serial = make_device(desc);
  const std::vector<kiwami_hit> expected =
      closest_hits(make_scene(serial, make_mesh(serial, triangles_.desc())), rays_);
  for (unsigned threads : {1u, 2u, 3u, 8u}) {
    ThreadRunner runner;
    runner.threads = threads;
    const Device device = device_of(runner, threads + 1);
    const Scene scene = make_scene(device, make_mesh(device, triangles_.desc()));
    EXPECT_GT(runner.loops, 1u);
    EXPECT_TRUE(are_equal(closest_hits(scene, rays_), expected)) << threads;
  }
}

TEST_F(RunnerTest, IsUsedWhenItsWidthIsUnknown) {
  ThreadRunner runner;
  const Device device = device_of(runner, 0);
  kiwami_device_info info{};
  info.struct_size = sizeof info;
  kiwami_device_get_info(device.get(), &info);
  EXPECT_GE(info.thread_count, 2u);
  const Scene scene = make_scene(device, make_mesh(device, triangles_.desc()));
  EXPECT_GT(runner.loops, 0u);
}

TEST_F(RunnerTest, ItsFailureIsReportedAndTheLastCommitStays) {
  ThreadRunner runner;
  const Device device = device_of(runner, 2);
  const Scene scene = make_scene(device, make_mesh(device, triangles_.desc()));
  const std::vector<kiwami_hit> before = closest_hits(scene, rays_);
  runner.status = -42;
  EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_ERROR_CALLBACK);
  EXPECT_EQ(last_error(device.get()), "runner returned -42, expected 0");
  std::vector<kiwami_hit> hits(rays_.size());
  EXPECT_EQ(kiwami_closest_hit(scene.get(), rays_.data(), 0, hits.data(), 0, rays_.size(), nullptr),
            KIWAMI_ERROR_CALLBACK);
  runner.status = 0;
  EXPECT_TRUE(are_equal(closest_hits(scene, rays_), before));
}

TEST_F(RunnerTest, TasksThatItLeavesOutAreNoticed) {
  ThreadRunner runner;
  const Device device = device_of(runner, 2);
  const Scene scene = make_scene(device, make_mesh(device, triangles_.desc()));
  runner.skipped_calls = 1;
  std::vector<kiwami_hit> hits(rays_.size());
  EXPECT_EQ(kiwami_closest_hit(scene.get(), rays_.data(), 0, hits.data(), 0, rays_.size(), nullptr),
            KIWAMI_ERROR_CALLBACK);
  EXPECT_EQ(last_error(device.get()), "runner made 19 calls of its task, expected 20");
}

TEST_F(RunnerTest, IsLeftAloneBySmallBatchesAndOnRequest) {
  ThreadRunner runner;
  const Device device = device_of(runner, 2);
  const Scene scene = make_scene(device, make_mesh(device, triangles_.desc()));
  const size_t before = runner.loops;
  std::vector<kiwami_hit> hits(rays_.size());
  kiwami_query query;
  kiwami_query_init(&query, sizeof query);
  query.flags = KIWAMI_QUERY_CALLING_THREAD;
  kiwami_closest_hit(scene.get(), rays_.data(), 0, hits.data(), 0, rays_.size(), &query);
  kiwami_closest_hit(scene.get(), rays_.data(), 0, hits.data(), 0, 1000, nullptr);
  EXPECT_EQ(runner.loops, before);
  kiwami_closest_hit(scene.get(), rays_.data(), 0, hits.data(), 0, rays_.size(), nullptr);
  EXPECT_EQ(runner.loops, before + 1);
}

TEST_F(RunnerTest, ManyThreadsMayTraceOneScene) {
  ThreadRunner runner;
  const Device device = device_of(runner, 2);
  const Scene scene = make_scene(device, make_mesh(device, triangles_.desc()));
  const std::vector<kiwami_hit> expected = closest_hits(scene, rays_);
  std::vector<std::vector<kiwami_hit>> hits(4, std::vector<kiwami_hit>(rays_.size()));
  std::vector<std::thread> threads;
  for (auto& own : hits) {
    threads.emplace_back([&] {
      kiwami_closest_hit(scene.get(), rays_.data(), 0, own.data(), 0, rays_.size(), nullptr);
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& own : hits) EXPECT_TRUE(are_equal(own, expected));
}

}  // namespace
}  // namespace kiwami_api_tests

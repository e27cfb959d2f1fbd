// SPDX-License-Identifier: Apache-2.0
// The measuring code measures, and the comparison sees every bit.
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <thread>

#include "measure/answers.h"
#include "measure/contest.h"
#include "measure/ray_sets.h"
#include "scene/procedural.h"

namespace kiwami::tools {
namespace {

SceneFile sphere() {
  SceneFile scene;
  scene.meshes.push_back(make_sphere(2));
  return scene;
}

TEST(Contest, TakesTheLowerMiddleValue) {
  EXPECT_EQ(median({3.0}), 3.0);
  EXPECT_EQ(median({9.0, 1.0, 5.0}), 5.0);
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 2.0);
}

TEST(Contest, RunsEachContenderOnceARoundAndTellsTheSlowOne) {
  std::vector<size_t> runs(2, 0);
  const std::vector<std::function<void()>> contenders = {
      [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }, [] {}};
  const std::vector<double> seconds =
      interleaved_medians(contenders, 3, [&](size_t i) { ++runs[i]; });
  EXPECT_EQ(runs, (std::vector<size_t>{3, 3}));
  EXPECT_GE(seconds[0], 0.02);
  EXPECT_LT(seconds[1], seconds[0]);
}

TEST(Contest, TheProcessorsClockDoesNotCountSleep) {
  const auto none = [] {};
  volatile uint64_t sum = 0;
  const std::vector<Contender> contenders = {
      {none, [] { std::this_thread::sleep_for(std::chrono::milliseconds(50)); }, none},
      {none,
       [&] {
         for (uint64_t i = 0; i < 3000000; ++i) sum = sum + i;
       },
       none}};
  const auto seconds = interleaved_seconds(contenders, 2, Clock::kProcessor);
  for (const double asleep : seconds[0]) EXPECT_LT(asleep, 0.02);
  for (const double busy : seconds[1]) EXPECT_GT(busy, 1e-4);
}

TEST(SharedWork, SavesWhatOtherProcessorsWouldHaveDone) {
  struct Loop {
    SharedWork work{2};
    std::vector<size_t> order;
    size_t inner = 0;

    static void spin(void* data, size_t index) {
      static_cast<Loop*>(data)->order.push_back(index);
      const double start = seconds_now(Clock::kProcessor);
      while (seconds_now(Clock::kProcessor) - start < 0.004) {
      }
    }
    /// A loop within a task.
    static void nest(void* data, size_t) {
      SharedWork::run(&static_cast<Loop*>(data)->work, static_cast<Loop*>(data)->inner, spin, data);
    }
  };
  Loop four;
  EXPECT_EQ(SharedWork::run(&four.work, 4, Loop::spin, &four), 0);
  EXPECT_EQ(four.order, (std::vector<size_t>{0, 1, 2, 3}));
  EXPECT_NEAR(four.work.saved_seconds(), 0.008, 0.003);
  Loop three;
  SharedWork::run(&three.work, 3, Loop::spin, &three);
  EXPECT_NEAR(three.work.saved_seconds(), 0.004, 0.003);
  Loop single;
  SharedWork::run(&single.work, 1, Loop::spin, &single);
  EXPECT_EQ(single.work.saved_seconds(), 0.0);
  // A single task leaves the processors to its loop; of several, each has one to itself.
  Loop nested;
  nested.inner = 2;
  SharedWork::run(&nested.work, 1, Loop::nest, &nested);
  EXPECT_NEAR(nested.work.saved_seconds(), 0.004, 0.003);
  SharedWork::run(&nested.work, 2, Loop::nest, &nested);
  EXPECT_NEAR(nested.work.saved_seconds(), 0.012, 0.006);
  EXPECT_EQ(nested.order.size(), 6u);
}

TEST(Contest, EachBitChangesTheHash) {
  std::vector<kiwami_hit> hits(3);
  std::memset(hits.data(), 0, hits.size() * sizeof hits[0]);
  const uint64_t expected = hash_hits(hits);
  auto* bytes = reinterpret_cast<unsigned char*>(hits.data());
  for (size_t bit = 0; bit < hits.size() * sizeof hits[0] * 8; ++bit) {
    bytes[bit / 8] ^= static_cast<unsigned char>(1u << bit % 8);
    EXPECT_NE(hash_hits(hits), expected);
    bytes[bit / 8] ^= static_cast<unsigned char>(1u << bit % 8);
  }
  EXPECT_EQ(hash_hits(hits), expected);
}

TEST(Answers, ADifferenceInAnyBitIsFound) {
  const SceneFile file = sphere();
  const Device device(KIWAMI_ISA_SCALAR, 1);
  const BuiltScene scene(device, file);
  const std::vector<RaySet> sets = {random_rays(bounds_of(scene.info()), 40, 1),
                                    random_rays(bounds_of(scene.info()), 40, 2)};
  const Answers expected = trace_answers(scene, sets);
  EXPECT_FALSE(first_difference(expected, expected).has_value());
  for (size_t set = 0; set < 2; ++set) {
    for (const size_t ray : {size_t{0}, size_t{17}, size_t{39}}) {
      for (size_t bit = 0; bit < sizeof(kiwami_hit) * 8; ++bit) {
        Answers changed = expected;
        auto* bytes = reinterpret_cast<unsigned char*>(&changed.hits[set][ray]);
        bytes[bit / 8] ^= static_cast<unsigned char>(1u << bit % 8);
        const std::optional<Difference> difference = first_difference(expected, changed);
        ASSERT_TRUE(difference.has_value());
        EXPECT_EQ(difference->set, set);
        EXPECT_EQ(difference->ray, ray);
        EXPECT_FALSE(difference->of_any_hit);
      }
      Answers changed = expected;
      changed.occluded[set][ray] ^= 1;
      const std::optional<Difference> difference = first_difference(expected, changed);
      ASSERT_TRUE(difference.has_value());
      EXPECT_EQ(difference->ray, ray);
      EXPECT_TRUE(difference->of_any_hit);
    }
  }
}

TEST(RaySets, AreFilledAndDependOnTheirSeed) {
  const SceneFile file = sphere();
  const Device device(KIWAMI_ISA_SCALAR, 1);
  const BuiltScene scene(device, file);
  const Box box = bounds_of(scene.info());
  const RaySet primary = primary_rays(Camera(default_view(file, box, 1.5f), 30, 20));
  EXPECT_EQ(primary.rays.size(), 600u);
  const auto bytes = [](const RaySet& set) {
    std::string text(set.rays.size() * sizeof(kiwami_ray), '\0');
    std::memcpy(text.data(), set.rays.data(), text.size());
    return text;
  };
  const auto check = [&](const auto& make) {
    EXPECT_EQ(make(1).rays.size(), 500u);
    EXPECT_EQ(bytes(make(1)), bytes(make(1)));
    EXPECT_NE(bytes(make(1)), bytes(make(2)));
  };
  check([&](uint64_t seed) { return bounce_rays(scene, primary.rays, 500, seed); });
  check([&](uint64_t seed) { return random_rays(box, 500, seed); });
  check([&](uint64_t seed) { return axis_rays(file, box, 500, seed); });
  check([&](uint64_t seed) { return aimed_rays(file, box, 500, seed); });
}

TEST(RaySets, TheFittedCameraSeesTheWholeSphere) {
  const SceneFile file = sphere();
  const Device device(KIWAMI_ISA_SCALAR, 1);
  const BuiltScene scene(device, file);
  for (const auto& [width, height] : {std::pair{60u, 40u}, {40u, 60u}}) {
    const float aspect = static_cast<float>(width) / static_cast<float>(height);
    const Camera camera(default_view(file, bounds_of(scene.info()), aspect), width, height);
    const RaySet primary = primary_rays(camera);
    std::vector<kiwami_hit> hits(primary.rays.size());
    scene.closest_hits(primary.rays, hits);
    size_t count = 0;
    for (uint32_t y = 0; y < height; ++y) {
      for (uint32_t x = 0; x < width; ++x) {
        const bool hit = is_hit(hits[size_t{y} * width + x]);
        const bool border = x == 0 || y == 0 || x == width - 1 || y == height - 1;
        EXPECT_FALSE(hit && border) << x << ", " << y;
        count += hit ? 1 : 0;
      }
    }
    EXPECT_GT(count, size_t{width} * height / 10);
  }
}

TEST(RaySets, BouncesLeaveTheOutsideOfASphereForGood) {
  const SceneFile file = sphere();
  const Device device(KIWAMI_ISA_SCALAR, 1);
  const BuiltScene scene(device, file);
  const RaySet primary =
      primary_rays(Camera(default_view(file, bounds_of(scene.info()), 1.0f), 40, 40));
  const RaySet bounces = bounce_rays(scene, primary.rays, 2000, 5);
  std::vector<uint8_t> occluded(bounces.rays.size());
  scene.any_hits(bounces.rays, occluded);
  for (size_t i = 0; i < occluded.size(); ++i) EXPECT_EQ(occluded[i], 0) << i;
}

}  // namespace
}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
// Scenes whose instances move: at each time a ray meets just what it meets in the scene that is
// frozen then, to the bit, by every call, on every ISA and width; the frozen ones are judged in
// double precision, as those in instances_test.cpp. And what moves has the place that its formulas
// say.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/instance_bounds.h"
#include "parity/all_answers.h"
#include "parity/committed_tree.h"
#include "parity/kernel_tables.h"
#include "support/environment.h"
#include "support/quaternion.h"
#include "support/ray_generator.h"
#include "support/report.h"
#include "support/scene_graph.h"

namespace kiwami_tests {
namespace {

/// Rays that are aimed at the triangles of a frozen world, at its time.
std::vector<kiwami_ray> rays_into(const std::vector<WorldTriangle>& world, float time, size_t count,
                                  Random& random) {
  std::vector<kiwami_ray> rays;
  while (rays.size() < count) {
    Point target{}, origin{};
    const auto& triangle = world[random.below(static_cast<uint32_t>(world.size()))];
    float u = random.unit(), v = random.unit();
    if (random.one_in(4)) u = 0;
    if (random.one_in(4)) v = 0;
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<size_t>(k);
      target[k] = static_cast<float>(
          triangle.corner[0][axis] + u * (triangle.corner[1][axis] - triangle.corner[0][axis]) +
          (1 - u) * v * (triangle.corner[2][axis] - triangle.corner[0][axis]));
      origin[k] = random.symmetric() * 6.0f;
    }
    if (random.one_in(8)) origin = origin * random.power_of_two(1, 12);
    kiwami_ray ray = ray_from(origin, target - origin);
    if (random.one_in(4)) ray.mask = 1u << random.below(8);
    if (random.one_in(8)) ray.tmax = random.unit() * 2;
    ray.time = time;
    rays.push_back(ray);
  }
  return rays;
}

uint64_t margin_violations(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays) {
  kiwami::TraversalCounters counters{};
  run_general<kiwami_hit>(kernels_of(scene).general.closest_hit_counted, view_of(scene), rays,
                          counters);
  return counters.margin_violations;
}

class MovingGraphs : public testing::TestWithParam<uint32_t> {};

TEST_P(MovingGraphs, MeetWhatTheFrozenGraphHas) {
  std::printf("KIWAMI_SEED=%llu\n", static_cast<unsigned long long>(seed()));
  Random random(seed(), 500 + GetParam());
  const uint64_t graph_count = case_budget(GetParam() < 4 ? 4 : 2);
  const size_t ray_count = ray_budget(1200) / graph_count / 8 + 1;
  size_t hits = 0, rays_traced = 0;
  for (uint64_t number = 0; number < graph_count; ++number) {
    const SceneGraph graph = in_motion(random_scene_graph(random, GetParam(), 300), random);
    const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
    const std::vector<SceneHandle> reference_scenes = build(device.get(), graph, 0);
    std::vector<std::vector<kiwami_ray>> rays;
    std::vector<std::vector<NamedAnswers>> expected;
    for (const float time : {0.0f, 1.0f, 0.5f, random.unit(), random.unit(), 1.3f, -0.2f}) {
      const SceneGraph still = frozen(graph, device.get(), reference_scenes, time);
      const std::vector<WorldTriangle> world = flatten(still);
      if (world.empty()) continue;
      rays.push_back(rays_into(world, time, ray_count, random));
      const std::vector<SceneHandle> still_scenes = build(device.get(), still, 0);
      expected.push_back(all_answers(still_scenes.back().get(), rays.back()));
      hits += hit_count(expected.back());
      rays_traced += rays.back().size();
    }
    uint32_t rebraid = KIWAMI_REBRAID_OFF;
    for (const NamedKernels& kernels : all_kernels()) {
      const DeviceHandle own_device = make_device(kernels.isa, 1);
      const std::vector<SceneHandle> scenes =
          build(own_device.get(), graph, kernels.width, rebraid++ % 3);
      for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(difference(all_answers(scenes.back().get(), rays[i]), expected[i]), "")
            << kernels.name << ", KIWAMI_SEED=" << seed() << ", graph " << number << ", time "
            << rays[i].front().time;
        EXPECT_EQ(margin_violations(scenes.back().get(), rays[i]), 0u) << kernels.name;
      }
    }
  }
  std::printf("%zu of %zu rays hit\n", hits, rays_traced);
  EXPECT_GT(hits, rays_traced / 4);
}

INSTANTIATE_TEST_SUITE_P(Depth, MovingGraphs, testing::Values(1u, 2u, 4u, 8u));

TEST(MovingGraphJudge, NoticesAnotherTime) {
  Random random(seed(), 520);
  const SceneGraph graph = in_motion(random_scene_graph(random, 2, 600), random);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const std::vector<SceneHandle> scenes = build(device.get(), graph, 0);
  const SceneGraph still = frozen(graph, device.get(), scenes, 0.5f);
  std::vector<kiwami_ray> rays = rays_into(flatten(still), 0.5f, 300, random);
  const std::vector<SceneHandle> still_scenes = build(device.get(), still, 0);
  const auto expected = all_answers(still_scenes.back().get(), rays);
  ASSERT_EQ(difference(all_answers(scenes.back().get(), rays), expected), "");
  for (kiwami_ray& ray : rays) ray.time = std::nextafter(0.5f, 1.0f);
  EXPECT_NE(difference(all_answers(scenes.back().get(), rays), expected), "");
}

TEST(MovingInstanceTransforms, FollowTheFormulasInDoublePrecision) {
  std::printf("KIWAMI_SEED=%llu\n", static_cast<unsigned long long>(seed()));
  Random random(seed(), 530);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const SceneHandle scene = make_scene(device.get(), Scene{}, {});
  kiwami_scene* shown = scene.get();
  for (uint64_t i = case_budget(300); i != 0; --i) {
    kiwami_quaternion_transform steps[2] = {};
    for (auto& step : steps) {
      float* const entries = &step.scale_x;
      for (int k = 0; k < 3; ++k) entries[k] = 0.5f + random.unit();
      for (int k = 3; k < 16; ++k) entries[k] = random.symmetric();
    }
    if (random.one_in(4)) {
      // Nearly the same, nearly opposite.
      float* const q = &steps[1].quaternion_r;
      const float sign = random.one_in(2) ? 1.0f : -1.0f;
      for (int k = 0; k < 4; ++k) q[k] = sign * (&steps[0].quaternion_r)[k];
      q[1] += random.symmetric() * random.power_of_two(-24, -2);
    }
    kiwami_moving_instances_desc desc;
    check(kiwami_moving_instances_desc_init(&desc, sizeof desc));
    desc.scenes = &shown;
    desc.scene_count = 1;
    desc.transforms = steps;
    desc.count = 1;
    desc.format = KIWAMI_TRANSFORM_QUATERNION;
    kiwami_geometry* geometry = nullptr;
    check(kiwami_moving_instances_create(device.get(), &desc, &geometry));
    const float time = random.one_in(8) ? 1.0f : random.unit();
    float matrix[12];
    check(kiwami_instances_transform(geometry, 0, time, matrix));
    kiwami_geometry_release(geometry);
    const std::array<double, 12> expected = matrix_between(steps[0], steps[1], double{time});
    for (size_t k = 0; k < 12; ++k) {
      ASSERT_NEAR(double{matrix[k]}, expected[k], 2e-6)
          << "KIWAMI_SEED=" << seed() << ", time " << time;
    }
  }
}

/// The greatest condition number on the way is never above its bound.
TEST(MovingInstanceBounds, HoldTheConditionAtAllTimes) {
  std::printf("KIWAMI_SEED=%llu\n", static_cast<unsigned long long>(seed()));
  Random random(seed(), 540);
  int capped = 0, tight = 0;
  const int count = static_cast<int>(case_budget(300));
  for (int i = 0; i < count; ++i) {
    float steps[24];
    for (int step = 0; step < 2; ++step) {
      float stretch[3];
      for (float& factor : stretch) factor = random.power_of_two(i % 2 == 0 ? -2 : -14, 0);
      for (int k = 0; k < 12; ++k) {
        // Half of them turn little, so that they stay away from singular ones.
        const float noise = (i % 4 < 2 ? 0.2f : 1.0f) * random.symmetric();
        steps[12 * step + k] = (noise + (k % 5 == 0 ? 1.0f : 0.0f)) * stretch[k / 4];
      }
    }
    const kiwami::MotionLimits limits =
        kiwami::MotionLimits::of(steps, 1, kiwami::TransformFormat::kMatrix);
    double greatest = 0.0;
    for (int k = 0; k <= 2000; ++k) {
      float rows[12], inverse[4][3];
      kiwami::matrix_between(steps, kiwami::TransformFormat::kMatrix,
                             static_cast<float>(k) / 2000.0f, rows);
      if (!kiwami::invert_for_rays(rows, inverse)) continue;
      const kiwami::Affine map = kiwami::map_of(inverse);
      greatest =
          std::fmax(greatest, kiwami::row_sum_norm(map) * kiwami::row_sum_norm(inverse_of(map)));
    }
    ASSERT_LE(greatest, limits.condition) << "KIWAMI_SEED=" << seed() << ", case " << i;
    if (limits.condition == kiwami::kMaxCondition) ++capped;
    if (limits.condition < 4.0 * greatest) ++tight;
  }
  std::printf("%d bounds, %d at the limit, %d less than four times what is there\n", count, capped,
              tight);
  EXPECT_GT(tight, count / 8);
  EXPECT_LT(capped, count);
}

}  // namespace
}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
// Moving meshes: a ray at a time meets just what it meets in meshes that do not move and have the
// vertices of that time, bit for bit, on every ISA and width.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "parity/committed_tree.h"
#include "parity/kernel_tables.h"
#include "support/adversarial_scenes.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/plain_oracle.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

/// One geometry: steps of vertices.
struct MovingMesh {
  Mesh mesh;  ///< its first step; what does not move
  std::vector<std::vector<Point>> steps;
  float begin = 0.0f, end = 1.0f;

  kiwami_geometry* make(kiwami_device* device) const {
    std::vector<Point> vertices;
    for (const auto& step : steps) vertices.insert(vertices.end(), step.begin(), step.end());
    kiwami_moving_mesh_desc desc;
    check(kiwami_moving_mesh_desc_init(&desc, sizeof desc));
    desc.vertices = vertices.data();
    desc.vertex_count = mesh.vertices.size();
    desc.indices = mesh.triangles.data();
    desc.triangle_count = mesh.triangles.size();
    desc.step_count = static_cast<uint32_t>(steps.size());
    desc.time_begin = begin;
    desc.time_end = end;
    desc.mask = mesh.mask;
    kiwami_geometry* geometry = nullptr;
    check(kiwami_moving_mesh_create(device, &desc, &geometry));
    return geometry;
  }

  /// The mesh at a time, by the formula of the documentation; without triangles where it is not.
  Mesh frozen(float time) const {
    Mesh still = mesh;
    if (!(begin <= time && time <= end)) {
      still.triangles.clear();
      return still;
    }
    const auto n = static_cast<float>(steps.size() - 1);
    const float s = (time - begin) / (end - begin) * n;
    const auto step = static_cast<size_t>(std::fmin(std::floor(s), n - 1.0f));
    const float f = s - static_cast<float>(step);
    for (size_t i = 0; i < still.vertices.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        const float a = (1.0f - f) * steps[step][i][axis], b = f * steps[step + 1][i][axis];
        still.vertices[i][axis] = a + b;
      }
    }
    // What is bad at any step is bad at all; the others keep their numbers.
    const auto nowhere = static_cast<uint32_t>(still.vertices.size());
    still.vertices.push_back({std::nanf(""), 0, 0});
    for (auto& triangle : still.triangles) {
      const bool is_bad = std::any_of(steps.begin(), steps.end(), [&](const auto& vertices) {
        return std::any_of(triangle.begin(), triangle.end(), [&](uint32_t corner) {
          const Point p = vertices[corner];
          return !(std::fabs(p.x) <= 0x1p60f && std::fabs(p.y) <= 0x1p60f &&
                   std::fabs(p.z) <= 0x1p60f);
        });
      });
      if (is_bad) triangle = {nowhere, nowhere, nowhere};
    }
    return still;
  }
};

/// A mesh of which some vertices go their own ways.
MovingMesh moving(const Mesh& mesh, uint32_t step_count, Random& random) {
  MovingMesh made{mesh, {mesh.vertices}};
  float extent = 0.0f;
  for (const Point& p : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::isfinite(p[axis])) extent = std::max(extent, std::fabs(p[axis]));
    }
  }
  const float reach = std::min(extent, 0x1p58f) * (random.one_in(2) ? 0.01f : 0.8f);
  const Point way = {random.symmetric(), random.symmetric(), random.symmetric()};
  for (uint32_t step = 1; step < step_count; ++step) {
    std::vector<Point> vertices = made.steps.back();
    for (Point& p : vertices) {
      p = p + way * (reach / static_cast<float>(step_count));
      if (random.one_in(8)) {
        p = p + Point{random.symmetric(), random.symmetric(), random.symmetric()} * (0.3f * reach);
      }
    }
    if (step == 1 && !vertices.empty() && random.one_in(4)) {
      vertices[random.below(static_cast<uint32_t>(vertices.size()))].y = std::nanf("");
    }
    made.steps.push_back(vertices);
  }
  return made;
}

struct Motion {
  std::vector<MovingMesh> meshes;

  /// With all steps of the vertices, for what aims rays.
  Scene targets() const {
    Scene scene;
    for (const MovingMesh& mesh : meshes) {
      for (const auto& step : mesh.steps) {
        Mesh at = mesh.mesh;
        at.vertices = step;
        scene.meshes.push_back(at);
      }
    }
    return scene;
  }

  Scene frozen(float time) const {
    Scene scene;
    for (const MovingMesh& mesh : meshes) scene.meshes.push_back(mesh.frozen(time));
    return scene;
  }
};

Motion random_motion(uint32_t number) {
  Random random(seed(), 3000 + number);
  const Scene scene = adversarial_scene(number, seed() + 7);
  constexpr uint32_t counts[] = {2, 3, 5, 2, 9, 129};
  Motion motion;
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    // Now and then meshes with other steps and another range beside each other.
    const uint32_t steps = counts[(number + (number % 3 == 1 ? i : 0)) % 6];
    MovingMesh mesh = moving(scene.meshes[i], steps, random);
    if (number % 4 == 2) mesh.begin = -0.5f * random.unit();
    if (number % 4 >= 2 && i % 2 == 1) mesh.end = 0.3f + random.unit();
    motion.meshes.push_back(mesh);
  }
  return motion;
}

SceneHandle make_moving(kiwami_device* device, const Motion& motion, const BuildOptions& options) {
  SceneHandle scene = make_scene(device, Scene{}, options);
  for (const MovingMesh& mesh : motion.meshes) {
    kiwami_geometry* geometry = mesh.make(device);
    check(kiwami_scene_attach(scene.get(), geometry, nullptr));
    kiwami_geometry_release(geometry);
  }
  check(kiwami_scene_commit(scene.get()));
  return scene;
}

/// Rays at one time, and what they meet.
struct Moment {
  std::vector<kiwami_ray> rays;
  std::vector<std::vector<kiwami_hit>> hits;
};

Moment moment_of(const Motion& motion, RayGenerator& generator, float time, size_t count,
                 Random& random) {
  const PlainOracle oracle(motion.frozen(time));
  Moment moment;
  const auto add = [&](kiwami_ray ray) {
    ray.time = time;
    moment.rays.push_back(ray);
    moment.hits.push_back(oracle.hits(ray));
  };
  while (moment.rays.size() < count) {
    add(generator.next());
    if (moment.hits.back().empty()) continue;
    add(with_interval_at(moment.rays.back(), moment.hits.back().front().t, random));
  }
  return moment;
}

std::string difference(const kiwami_scene* scene, const Moment& moment) {
  const std::vector<kiwami_hit> closest = closest_hits(scene, moment.rays);
  const std::vector<uint8_t> any = any_hits(scene, moment.rays);
  std::vector<uint32_t> counts(moment.rays.size());
  check(kiwami_count_hits(scene, moment.rays.data(), 0, counts.data(), 0, counts.size(), nullptr));
  for (size_t i = 0; i < moment.rays.size(); ++i) {
    const auto& hits = moment.hits[i];
    const kiwami_hit right = hits.empty() ? missing_hit() : hits.front();
    if (is_same(closest[i], right) && any[i] == (hits.empty() ? 0 : 1) &&
        counts[i] == hits.size()) {
      continue;
    }
    return "time " + std::to_string(moment.rays[i].time) + ", " + describe(moment.rays[i]) +
           "\n  frozen " + describe(right) + ", " + std::to_string(hits.size()) +
           " hits\n  answer " + describe(closest[i]) + ", " + std::to_string(counts[i]) + " hits";
  }
  return "";
}

std::string difference_counted(const NamedKernels& named, const kiwami::SceneView& view,
                               const Moment& moment) {
  std::vector<kiwami_hit> hits(moment.rays.size());
  kiwami::TraversalCounters counters{};
  named.kernels.general.closest_hit_counted(
      view,
      {reinterpret_cast<const unsigned char*>(moment.rays.data()), sizeof(kiwami_ray),
       reinterpret_cast<unsigned char*>(hits.data()), sizeof(kiwami_hit), hits.size()},
      {}, counters);
  for (size_t i = 0; i < hits.size(); ++i) {
    const kiwami_hit right = moment.hits[i].empty() ? missing_hit() : moment.hits[i].front();
    if (!is_same(hits[i], right)) return "counted answer " + describe(hits[i]);
  }
  if (counters.margin_violations == 0) return "";
  return std::to_string(counters.margin_violations) + " hits outside their leaf's box";
}

class MotionParity : public testing::TestWithParam<uint32_t> {};

TEST_P(MotionParity, MeetsWhatTheFrozenMeshHas) {
  const DeviceHandle device = make_device(GetParam(), 1);
  const auto scenes = static_cast<uint32_t>(case_budget(20));
  const size_t rays = ray_budget(8000) / scenes / 8 + 1;
  uint64_t hits = 0;
  for (uint32_t i = 0; i < scenes; ++i) {
    const Motion motion = random_motion(i);
    Random random(seed(), 4000 + i);
    const Scene targets = motion.targets();
    RayGenerator generator(targets, Random(random.bits(), 1));
    const uint32_t widths[] = {4, 8, 16};
    const SceneHandle scene =
        make_moving(device.get(), motion, {widths[i % 3], i % 2 == 0, 0, true});
    for (const float time :
         {0.0f, 1.0f, 0.5f, random.unit(), random.unit(), random.unit(), 1.25f, std::nanf("")}) {
      const Moment moment = moment_of(motion, generator, time, rays, random);
      for (const auto& of_ray : moment.hits) hits += of_ray.size();
      ASSERT_EQ(difference(scene.get(), moment), "") << "scene " << i << ", KIWAMI_SEED=" << seed();
      for (const NamedKernels& named : all_kernels()) {
        if (named.isa != GetParam() || named.width != widths[i % 3]) continue;
        ASSERT_EQ(difference_counted(named, view_of(scene.get()), moment), "")
            << named.name << ", scene " << i << ", KIWAMI_SEED=" << seed();
      }
    }
  }
  EXPECT_GT(hits, scenes * rays);
}

TEST_P(MotionParity, NoticesAnotherTime) {
  const DeviceHandle device = make_device(GetParam(), 1);
  const Motion motion = random_motion(0);
  const SceneHandle scene = make_moving(device.get(), motion, {});
  Random random(seed(), 1);
  const Scene targets = motion.targets();
  RayGenerator generator(targets, Random(5, 1));
  Moment moment = moment_of(motion, generator, 0.5f, 500, random);
  ASSERT_EQ(difference(scene.get(), moment), "");
  for (kiwami_ray& ray : moment.rays) ray.time = 0.6f;
  EXPECT_NE(difference(scene.get(), moment), "");
}

INSTANTIATE_TEST_SUITE_P(All, MotionParity, testing::ValuesIn(available_isas()),
                         [](const auto& test) { return std::string(kiwami_isa_name(test.param)); });

}  // namespace
}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
// Random graphs of scenes: every ISA and width to the bit, and against the flattened world in
// double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "parity/committed_tree.h"
#include "parity/kernel_tables.h"
#include "support/environment.h"
#include "support/ray_generator.h"
#include "support/report.h"
#include "support/scene_graph.h"

namespace kiwami_tests {
namespace {

using Vector = std::array<double, 3>;

Vector operator-(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double length(const Vector& a) { return std::sqrt(dot(a, a)); }

/// Where a ray passes a triangle of the world.
struct Passage {
  double t;
  double inside;  ///< distance of the point from the nearest edge; negative: outside
  double slope;   ///< how far t moves when the plane moves by one
};

Passage pass(const kiwami_ray& ray, const WorldTriangle& triangle) {
  const Vector origin = {ray.origin_x, ray.origin_y, ray.origin_z};
  const Vector direction = {ray.direction_x, ray.direction_y, ray.direction_z};
  const auto& [a, b, c] = triangle.corner;
  const Vector normal = cross(b - a, c - a);
  const double along = dot(normal, direction);
  Passage passage;
  passage.t = dot(normal, a - origin) / along;
  passage.slope = length(normal) / std::fabs(along);
  Vector point;
  for (size_t k = 0; k < 3; ++k) point[k] = origin[k] + passage.t * direction[k];
  passage.inside = 1e300;
  for (size_t k = 0; k < 3; ++k) {
    const Vector& p = triangle.corner[k];
    const Vector edge = triangle.corner[(k + 1) % 3] - p;
    const double side = dot(cross(edge, point - p), normal);
    passage.inside = std::min(passage.inside, side / (length(edge) * length(normal)));
  }
  return passage;
}

/// The world of a graph.
class World {
 public:
  explicit World(const SceneGraph& graph) : triangles_(flatten(graph)), depth_(graph.depth()) {
    for (const WorldTriangle& triangle : triangles_) {
      for (const Vector& corner : triangle.corner) {
        for (const double coordinate : corner) size_ = std::max(size_, std::fabs(coordinate));
      }
    }
  }

  const std::vector<WorldTriangle>& triangles() const { return triangles_; }
  double size() const { return size_; }

  /// How far the roundings on the way may move a hit on a triangle.
  double slack(const kiwami_ray& ray, const WorldTriangle& triangle) const {
    const double origin =
        std::max({std::fabs(ray.origin_x), std::fabs(ray.origin_y), std::fabs(ray.origin_z)});
    return 0x1p-20 * (depth_ + 1) * triangle.condition * (origin + size_);
  }

  const WorldTriangle* find(const kiwami_hit& hit, const uint32_t* path) const {
    for (const WorldTriangle& triangle : triangles_) {
      if (triangle.geometry_id != hit.geometry_id || triangle.primitive_id != hit.primitive_id) {
        continue;
      }
      bool is_same_path = true;
      for (size_t i = 0; i < KIWAMI_MAX_INSTANCE_DEPTH; ++i) {
        const uint32_t number = i < triangle.path.size() ? triangle.path[i] : KIWAMI_INVALID_ID;
        is_same_path = is_same_path && path[i] == number;
      }
      if (is_same_path) return &triangle;
    }
    return nullptr;
  }

 private:
  std::vector<WorldTriangle> triangles_;
  uint32_t depth_;
  double size_ = 0;
};

struct Tally {
  size_t hits = 0, misses = 0, judged = 0;
};

/// "" unless double precision contradicts an answer.
std::string contradiction(const World& world, const kiwami_ray& ray, const kiwami_hit& hit,
                          const uint32_t* path, Tally& tally) {
  double nearest = hit.t;  // Less what rounding allows.
  if (hit.primitive_id != KIWAMI_INVALID_ID) {
    ++tally.hits;
    const WorldTriangle* triangle = world.find(hit, path);
    if (!triangle) return "names no triangle of the world";
    if ((triangle->mask & ray.mask) == 0) return "is masked";
    const Passage passage = pass(ray, *triangle);
    const double slack = world.slack(ray, *triangle);
    const double t_slack = slack * passage.slope + 1e-6 * std::fabs(passage.t);
    // A triangle that is seen from its edge says little.
    if (slack * passage.slope < 0.01 * world.size()) {
      if (passage.inside < -4 * slack * std::max(1.0, passage.slope)) return "is outside";
      if (std::fabs(passage.t - double{hit.t}) > 4 * t_slack) return "is elsewhere";
      ++tally.judged;
    }
    nearest -= 4 * t_slack;
  } else {
    ++tally.misses;
    nearest = ray.tmax;
  }
  for (const WorldTriangle& triangle : world.triangles()) {
    if ((triangle.mask & ray.mask) == 0) continue;
    const Passage passage = pass(ray, triangle);
    const double slack = world.slack(ray, triangle) * std::max(1.0, passage.slope);
    if (!(passage.inside > 4 * slack) || !(slack < 0.01 * world.size())) continue;
    if (passage.t > ray.tmin + 4 * slack && passage.t < nearest - 4 * slack) {
      return "overlooks a nearer triangle";
    }
  }
  return "";
}

std::vector<kiwami_ray> rays_into(const World& world, size_t count, Random& random) {
  std::vector<kiwami_ray> rays;
  const auto size = static_cast<float>(world.size());
  while (rays.size() < count) {
    const auto& triangle =
        world.triangles()[random.below(static_cast<uint32_t>(world.triangles().size()))];
    float u = random.unit(), v = random.unit();
    // Vertices, edges, and points of the inside.
    if (random.one_in(4)) u = 0;
    if (random.one_in(4)) v = 0;
    Point target{}, origin{};
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<size_t>(k);
      target[k] = static_cast<float>(
          triangle.corner[0][axis] + u * (triangle.corner[1][axis] - triangle.corner[0][axis]) +
          (1 - u) * v * (triangle.corner[2][axis] - triangle.corner[0][axis]));
      origin[k] = random.symmetric() * size;
    }
    // From far away, too: farther than the boxes allow for by themselves.
    if (random.one_in(8)) origin = origin * random.power_of_two(1, 12);
    kiwami_ray ray = ray_from(origin, target - origin);
    if (random.one_in(4)) ray.mask = 1u << random.below(8);
    if (random.one_in(8)) ray.tmax = random.unit() * 2;
    rays.push_back(ray);
  }
  return rays;
}

struct Answers {
  std::vector<kiwami_hit> hits;
  std::vector<uint32_t> paths;
  std::vector<uint8_t> any;
  std::vector<uint32_t> counts;
};

Answers trace(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays) {
  const size_t count = rays.size();
  Answers answers{std::vector<kiwami_hit>(count),
                  std::vector<uint32_t>(count * KIWAMI_MAX_INSTANCE_DEPTH),
                  std::vector<uint8_t>(count), std::vector<uint32_t>(count)};
  kiwami_query query;
  check(kiwami_query_init(&query, sizeof query));
  query.instance_paths = answers.paths.data();
  check(kiwami_closest_hit(scene, rays.data(), 0, answers.hits.data(), 0, count, &query));
  check(kiwami_any_hit(scene, rays.data(), 0, answers.any.data(), 0, count, nullptr));
  check(kiwami_count_hits(scene, rays.data(), 0, answers.counts.data(), 0, count, nullptr));
  return answers;
}

uint64_t margin_violations(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays) {
  kiwami::TraversalCounters counters{};
  run_general<kiwami_hit>(kernels_of(scene).general.closest_hit_counted, view_of(scene), rays,
                          counters);
  run_general<uint8_t>(kernels_of(scene).general.any_hit_counted, view_of(scene), rays, counters);
  return counters.margin_violations;
}

class SceneGraphs : public testing::TestWithParam<uint32_t> {};

TEST_P(SceneGraphs, AgreeWithTheFlattenedWorldOnEveryIsa) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  Random random(seed(), GetParam());
  const uint64_t graph_count = case_budget(12);
  const size_t ray_count = ray_budget(20000) / graph_count / 8 + 1;
  Tally tally;
  for (uint64_t number = 0; number < graph_count && !HasFailure(); ++number) {
    const SceneGraph graph = random_scene_graph(random, GetParam(), 2000);
    ASSERT_EQ(graph.depth(), GetParam());
    const World world(graph);
    const std::vector<kiwami_ray> rays = rays_into(world, ray_count, random);
    Answers reference;
    uint32_t rebraid = KIWAMI_REBRAID_OFF;  // The answers are those of any other mode.
    for (const NamedKernels& kernels : all_kernels()) {
      const DeviceHandle device = make_device(kernels.isa, 1);
      const std::vector<SceneHandle> scenes =
          build(device.get(), graph, kernels.width, rebraid++ % 3);
      const kiwami_scene* scene = scenes.back().get();
      const Answers answers = trace(scene, rays);
      EXPECT_EQ(margin_violations(scene, rays), 0u) << kernels.name;
      if (reference.hits.empty()) reference = answers;
      for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(is_same(answers.hits[i], reference.hits[i]))
            << kernels.name << ", " << describe(rays[i]) << "\n  " << describe(answers.hits[i])
            << "\n  scalar " << describe(reference.hits[i]);
        ASSERT_EQ(answers.any[i] != 0, answers.hits[i].primitive_id != KIWAMI_INVALID_ID);
        ASSERT_EQ(answers.any[i] != 0, answers.counts[i] != 0);
      }
      EXPECT_EQ(answers.paths, reference.paths) << kernels.name;
      EXPECT_EQ(answers.counts, reference.counts) << kernels.name;
    }
    for (size_t i = 0; i < rays.size() && !HasFailure(); ++i) {
      EXPECT_EQ(contradiction(world, rays[i], reference.hits[i],
                              &reference.paths[i * KIWAMI_MAX_INSTANCE_DEPTH], tally),
                "")
          << "KIWAMI_SEED=" << seed() << ", graph " << number << ", " << describe(rays[i]) << "\n  "
          << describe(reference.hits[i]);
    }
  }
  std::printf("%zu hits, %zu of them judged, %zu misses\n", tally.hits, tally.judged, tally.misses);
  EXPECT_GT(tally.judged, tally.hits / 2);
  EXPECT_GT(tally.hits, tally.misses);
}

INSTANTIATE_TEST_SUITE_P(Depth, SceneGraphs, testing::Range(1u, 9u));

/// The judge notices wrong answers.
TEST(SceneGraphJudge, NoticesInjectedErrors) {
  Random random(seed(), 77);
  size_t hits = 0, lost = 0, moved = 0, renamed = 0;
  for (int number = 0; number < 4; ++number) {
    const SceneGraph graph = random_scene_graph(random, 2, 500);
    const World world(graph);
    const std::vector<kiwami_ray> rays = rays_into(world, 300, random);
    const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
    const std::vector<SceneHandle> scenes = build(device.get(), graph, 0);
    const Answers answers = trace(scenes.back().get(), rays);
    for (size_t i = 0; i < rays.size(); ++i) {
      const kiwami_hit& hit = answers.hits[i];
      const uint32_t* path = &answers.paths[i * KIWAMI_MAX_INSTANCE_DEPTH];
      if (hit.primitive_id == KIWAMI_INVALID_ID) continue;
      Tally tally;
      ++hits;
      kiwami_hit wrong = hit;
      wrong.primitive_id = KIWAMI_INVALID_ID;
      lost += !contradiction(world, rays[i], wrong, path, tally).empty();
      wrong = hit;
      wrong.t *= 1.01f;
      moved += !contradiction(world, rays[i], wrong, path, tally).empty();
      uint32_t other[KIWAMI_MAX_INSTANCE_DEPTH];
      std::copy_n(path, KIWAMI_MAX_INSTANCE_DEPTH, other);
      other[0] = other[0] == 0 ? 1 : 0;
      renamed += !contradiction(world, rays[i], hit, other, tally).empty();
    }
  }
  EXPECT_GT(hits, 200u);
  EXPECT_GT(lost, hits / 2);
  EXPECT_GT(moved, hits / 2);
  EXPECT_GT(renamed, hits / 2);
}

}  // namespace
}  // namespace kiwami_tests

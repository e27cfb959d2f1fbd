// SPDX-License-Identifier: Apache-2.0
// The plain oracle, judged by what must hold whatever the arithmetic: closed meshes have an inside.
#include "support/plain_oracle.h"

#include <gtest/gtest.h>

#include "support/environment.h"
#include "support/feature_rays.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

uint64_t odd_counts(const ClosedMesh& closed, EdgeRule rule, uint64_t rays) {
  const Scene scene = scene_of(closed);
  const PlainOracle oracle(scene, rule);
  FeatureRayGenerator generator(closed, Random(seed(), 1));
  uint64_t odd = 0;
  for (uint64_t i = 0; i < rays; ++i) {
    const kiwami_ray ray = i % 2 ? generator.line() : generator.outside_segment();
    odd += oracle.all_hits(ray) % 2;
  }
  return odd;
}

TEST(ClosedMeshes, AreClosed) {
  for (const ClosedMesh& closed : closed_meshes())
    EXPECT_TRUE(is_closed(closed.mesh)) << closed.name;
}

TEST(PlainOracle, CrossesClosedMeshesAnEvenNumberOfTimes) {
  for (const ClosedMesh& closed : closed_meshes()) {
    EXPECT_EQ(odd_counts(closed, EdgeRule::kOwned, ray_budget(10000) / 7), 0u) << closed.name;
  }
}

TEST(PlainOracle, WithTheInclusiveEdgeRuleDoesNot) {
  for (const ClosedMesh& closed : closed_meshes()) {
    EXPECT_GT(odd_counts(closed, EdgeRule::kInclusive, 2000), 20u) << closed.name;
  }
}

TEST(PlainOracle, HitsFromInside) {
  for (const ClosedMesh& closed : closed_meshes()) {
    const Scene scene = scene_of(closed);
    const PlainOracle oracle(scene);
    FeatureRayGenerator generator(closed, Random(seed(), 2));
    for (int i = 0; i < 1000; ++i) {
      const kiwami_ray ray = generator.inside_ray();
      const kiwami_hit hit = oracle.closest_hit(ray);
      ASSERT_NE(hit.primitive_id, KIWAMI_INVALID_ID) << closed.name << ": " << describe(ray);
      ASSERT_EQ(oracle.all_hits(ray) % 2, 1u) << closed.name << ": " << describe(ray);
    }
  }
}

/// The cosine between ray and normal in double, from the original vertices.
double facing(const Mesh& mesh, const kiwami_hit& hit, const kiwami_ray& ray) {
  const auto corner = mesh.corners(hit.primitive_id);
  double e[3], f[3];
  for (int axis = 0; axis < 3; ++axis) {
    e[axis] = static_cast<double>(corner[1][axis]) - static_cast<double>(corner[0][axis]);
    f[axis] = static_cast<double>(corner[2][axis]) - static_cast<double>(corner[0][axis]);
  }
  const double d[3] = {ray.direction_x, ray.direction_y, ray.direction_z};
  double dot = 0.0, normal_square = 0.0, direction_square = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const double normal = e[a] * f[b] - e[b] * f[a];
    dot += normal * d[axis];
    normal_square += normal * normal;
    direction_square += d[axis] * d[axis];
  }
  return dot / std::sqrt(normal_square * direction_square);
}

TEST(PlainOracle, CullsTheSideThatTheNormalSays) {
  uint32_t fronts = 0, backs = 0;
  for (const ClosedMesh& closed : closed_meshes()) {
    // Elsewhere the rounded vertices of a sliver may run the other way round.
    if (closed.name != "sphere" && closed.name != "torus" && closed.name != "integer box") continue;
    const Scene scene = scene_of(closed);
    const PlainOracle oracle(scene);
    FeatureRayGenerator generator(closed, Random(seed(), 3));
    for (int i = 0; i < 1000; ++i) {
      kiwami_ray ray = i % 2 ? generator.inside_ray() : generator.outside_segment();
      const kiwami_hit any_side = oracle.closest_hit(ray);
      if (any_side.primitive_id == KIWAMI_INVALID_ID) continue;
      const double cosine = facing(closed.mesh, any_side, ray);
      if (std::fabs(cosine) < 0.01) continue;
      const bool is_front = cosine < 0.0;
      (is_front ? fronts : backs) += 1;
      ray.flags = is_front ? KIWAMI_RAY_CULL_BACK_FACES : KIWAMI_RAY_CULL_FRONT_FACES;
      ASSERT_TRUE(is_same(oracle.closest_hit(ray), any_side)) << describe(ray);
      ray.flags = is_front ? KIWAMI_RAY_CULL_FRONT_FACES : KIWAMI_RAY_CULL_BACK_FACES;
      ASSERT_NE(oracle.closest_hit(ray).primitive_id, any_side.primitive_id) << describe(ray);
    }
  }
  EXPECT_GT(fronts, 500u);
  EXPECT_GT(backs, 500u);
}

}  // namespace
}  // namespace kiwami_tests

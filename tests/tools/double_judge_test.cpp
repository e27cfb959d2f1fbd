// SPDX-License-Identifier: Apache-2.0
// The judge of disagreements sides with neither library: it knows an edge from an inside, and it
// convicts wrong answers.
#include "measure/double_judge.h"

#include <gtest/gtest.h>

#include <limits>

#include "measure/camera.h"

namespace kiwami::tools {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Two parallel triangles at z = 0 and z = 1, seen along z, and a third one that touches the first
/// at an edge.
SceneFile two_layers() {
  Mesh mesh;
  mesh.vertices = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 1, 4, 0, 1, 0, 4, 1, 4, 4, 0};
  mesh.indices = {0, 1, 2, 3, 4, 5, 1, 6, 2};
  SceneFile scene;
  scene.meshes.push_back(mesh);
  return scene;
}

kiwami_ray down_at(float x, float y) { return make_ray({x, y, -2}, {0, 0, 1}, 0, kInfinity); }

kiwami_hit hit_of(uint32_t primitive, float t) {
  return {t, 0, 0, 0, 0, 1, primitive, 0, KIWAMI_INVALID_ID};
}

kiwami_hit miss() {
  return {kInfinity, 0, 0, 0, 0, 0, KIWAMI_INVALID_ID, KIWAMI_INVALID_ID, KIWAMI_INVALID_ID};
}

TEST(DoubleJudge, KnowsInsideEdgeAndOutside) {
  const SceneFile scene = two_layers();
  EXPECT_EQ(judge_triangle(scene, down_at(1, 1), hit_of(0, 2)).passage, Passage::kInside);
  EXPECT_EQ(judge_triangle(scene, down_at(1, 1), hit_of(0, 2)).t, 2.0);
  EXPECT_EQ(judge_triangle(scene, down_at(0, 1), hit_of(0, 2)).passage, Passage::kOnEdge);
  EXPECT_EQ(judge_triangle(scene, down_at(2, 2), hit_of(0, 2)).passage, Passage::kOnEdge);
  EXPECT_EQ(judge_triangle(scene, down_at(4, 0), hit_of(0, 2)).passage, Passage::kOnEdge);
  EXPECT_EQ(judge_triangle(scene, down_at(-0.001f, 1), hit_of(0, 2)).passage, Passage::kOutside);
  EXPECT_EQ(judge_triangle(scene, down_at(8, -4), hit_of(0, 2)).passage, Passage::kOutside);
}

TEST(DoubleJudge, AcceptsEqualAnswers) {
  const SceneFile scene = two_layers();
  EXPECT_EQ(compare_hits(scene, down_at(1, 1), hit_of(0, 2), hit_of(0, 2)),
            Agreement::kSamePrimitive);
  EXPECT_EQ(compare_hits(scene, down_at(9, 9), miss(), miss()), Agreement::kBothMiss);
  EXPECT_EQ(compare_hits(scene, down_at(2, 2), hit_of(0, 2), hit_of(2, 2)),
            Agreement::kSameDistance);
}

TEST(DoubleJudge, ConvictsUsOfWrongAnswers) {
  const SceneFile scene = two_layers();
  const kiwami_ray inside = down_at(1, 1);
  const kiwami_ray outside = down_at(-1, 1);
  EXPECT_EQ(compare_hits(scene, inside, miss(), hit_of(0, 2)), Agreement::kWrong);
  EXPECT_EQ(compare_hits(scene, inside, hit_of(1, 3), hit_of(0, 2)), Agreement::kWrong);
  EXPECT_EQ(compare_hits(scene, outside, hit_of(0, 2), miss()), Agreement::kWrong);
  EXPECT_EQ(compare_hits(scene, inside, hit_of(0, 2.1f), hit_of(0, 2)), Agreement::kWrong);
  EXPECT_EQ(compare_hits(scene, inside, hit_of(0, 1.5f), miss()), Agreement::kWrong);
  EXPECT_EQ(compare_hits(scene, inside, hit_of(1, 1.5f), hit_of(0, 2)), Agreement::kWrong);
}

TEST(DoubleJudge, ConvictsTheReferenceOfWrongAnswers) {
  const SceneFile scene = two_layers();
  const kiwami_ray inside = down_at(1, 1);
  EXPECT_EQ(compare_hits(scene, inside, hit_of(0, 2), miss()), Agreement::kReferenceMissed);
  EXPECT_EQ(compare_hits(scene, inside, hit_of(0, 2), hit_of(1, 3)), Agreement::kReferenceMissed);
  EXPECT_EQ(compare_hits(scene, down_at(-1, 1), miss(), hit_of(0, 2)),
            Agreement::kReferenceFalseHit);
  EXPECT_EQ(compare_hits(scene, inside, hit_of(0, 2), hit_of(0, 2.1f)),
            Agreement::kReferenceDistanceOff);
}

TEST(DoubleJudge, LeavesEdgesAndEndsToEither) {
  const SceneFile scene = two_layers();
  EXPECT_EQ(compare_hits(scene, down_at(0, 1), miss(), hit_of(0, 2)), Agreement::kOnEdge);
  EXPECT_EQ(compare_hits(scene, down_at(0, 1), hit_of(0, 2), miss()), Agreement::kOnEdge);
  kiwami_ray ending = down_at(1, 1);
  ending.tmax = 2.0f;
  EXPECT_EQ(compare_hits(scene, ending, miss(), hit_of(0, 2)), Agreement::kAtRayEnd);
  EXPECT_EQ(compare_hits(scene, ending, hit_of(0, 2), miss()), Agreement::kAtRayEnd);
}

}  // namespace
}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#include "measure/coarse_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "scene/procedural.h"

namespace kiwami_tests {
namespace {

using namespace kiwami::tools;

SceneFile scene_of(Mesh mesh) {
  SceneFile file;
  file.meshes.push_back(std::move(mesh));
  return file;
}

TEST(CoarseShape, OfASmallSceneIsTheScene) {
  const Mesh sphere = make_sphere(2);
  const CoarseShape shape = coarse_shape(scene_of(sphere), sphere.triangle_count());
  ASSERT_EQ(shape.triangle_count(), sphere.triangle_count());
  for (size_t i = 0; i < shape.indices.size(); ++i) {
    for (size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(shape.vertices[size_t{shape.indices[i]} * 3 + axis],
                sphere.vertices[size_t{sphere.indices[i]} * 3 + axis]);
    }
  }
}

TEST(CoarseShape, OfALargeSceneIsNearlyAsLargeAsAllowed) {
  const Mesh sphere = make_sphere(6);
  for (const uint64_t most : {200, 1000, 6000}) {
    const CoarseShape shape = coarse_shape(scene_of(sphere), most);
    EXPECT_LE(shape.triangle_count(), most);
    EXPECT_GE(shape.triangle_count(), most / 2);
    ASSERT_LT(*std::max_element(shape.indices.begin(), shape.indices.end()),
              shape.vertices.size() / 3);
    // It is still a sphere of radius 1, and still whole: Euler's formula of closed surfaces.
    for (size_t i = 0; i < shape.vertices.size(); i += 3) {
      const Vec3 vertex{shape.vertices[i], shape.vertices[i + 1], shape.vertices[i + 2]};
      EXPECT_NEAR(length(vertex), 1.0f, 1e-5f);
    }
    const auto vertices = static_cast<double>(shape.vertices.size()) / 3.0;
    EXPECT_NEAR(vertices / static_cast<double>(shape.triangle_count()), 0.5, 0.05);
  }
}

TEST(CoarseShape, LeavesOutWhatCannotBeHit) {
  Mesh mesh = make_sphere(0);
  mesh.vertices[0] = std::numeric_limits<float>::quiet_NaN();
  // Five of the icosahedron's triangles meet at a vertex.
  EXPECT_EQ(coarse_shape(scene_of(mesh), 1000).triangle_count(), 15u);
  mesh.vertices.assign(mesh.vertices.size(), std::numeric_limits<float>::infinity());
  EXPECT_EQ(coarse_shape(scene_of(mesh), 1000).triangle_count(), 0u);
  EXPECT_EQ(coarse_shape(scene_of(mesh), 0).triangle_count(), 0u);
}

TEST(CoarseShape, ManyTrianglesAtOnePointLeaveNothing) {
  Mesh mesh = make_sphere(3);
  std::fill(mesh.vertices.begin(), mesh.vertices.end(), 5.0f);
  EXPECT_EQ(coarse_shape(scene_of(mesh), 10).triangle_count(), 0u);
}

TEST(CoarseShape, TakesTheLargestCoordinates) {
  Mesh mesh = make_sphere(4);
  for (float& coordinate : mesh.vertices) coordinate *= 0x1p60f / 1.001f;
  const CoarseShape shape = coarse_shape(scene_of(mesh), 500);
  EXPECT_GE(shape.triangle_count(), 250u);
  EXPECT_LE(shape.triangle_count(), 500u);
}

}  // namespace
}  // namespace kiwami_tests

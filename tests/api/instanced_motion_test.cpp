// SPDX-License-Identifier: Apache-2.0
// Meshes that move, seen through instances: at each time as without the instances, re-braided or
// not.
#include <gtest/gtest.h>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

constexpr uint32_t kEdge = 12;
constexpr uint32_t kTriangles = kEdge * kEdge;

float height_of(uint32_t triangle, float time) {
  return time * static_cast<float>(10 + 7 * (triangle % 13));
}

/// A square of separate triangles that fall apart: each rises to a height of its own.
std::vector<float> rising_triangles() {
  std::vector<float> vertices;
  for (uint32_t step = 0; step < 2; ++step) {
    for (uint32_t i = 0; i < kTriangles; ++i) {
      const auto x = static_cast<float>(i % kEdge), y = static_cast<float>(i / kEdge);
      const float z = static_cast<float>(step) * height_of(i, 1.0f);
      vertices.insert(vertices.end(), {x, y, z, x + 0.9f, y, z, x, y + 0.9f, z});
    }
  }
  return vertices;
}

/// The first of the triangles.
Geometry make_moving(const Device& device, uint32_t count = kTriangles) {
  const std::vector<float> vertices = rising_triangles();
  kiwami_moving_mesh_desc desc;
  EXPECT_EQ(kiwami_moving_mesh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.vertices = vertices.data();
  desc.vertex_count = uint64_t{3} * kTriangles;
  desc.triangle_count = count;
  desc.step_count = 2;
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_moving_mesh_create(device.get(), &desc, &geometry), KIWAMI_OK) << last_error();
  return Geometry(geometry);
}

/// Instances of the scene that overlap: each is moved by half a square more along x.
Geometry make_instances(const Device& device, const Scene& child, uint32_t count) {
  std::vector<float> matrices;
  for (uint32_t i = 0; i < count; ++i) {
    const float shift = 0.5f * static_cast<float>(kEdge * i);
    matrices.insert(matrices.end(), {1, 0, 0, shift, 0, 1, 0, 0, 0, 0, 1, 0});
  }
  kiwami_scene* const scenes[] = {child.get()};
  kiwami_instances_desc desc;
  EXPECT_EQ(kiwami_instances_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.scenes = scenes;
  desc.scene_count = 1;
  desc.transforms = matrices.data();
  desc.count = count;
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_instances_create(device.get(), &desc, &geometry), KIWAMI_OK) << last_error();
  return Geometry(geometry);
}

/// A short ray down onto the middle of each triangle of the first instance, at some times: so short
/// that it meets nothing but a box around where the triangle is then.
std::vector<kiwami_ray> rays_from_above() {
  std::vector<kiwami_ray> rays;
  for (const float time : {0.0f, 0.3f, 0.5f, 1.0f}) {
    for (uint32_t i = 0; i < kTriangles; ++i) {
      kiwami_ray ray =
          ray_along_z(static_cast<float>(i % kEdge) + 0.25f, static_cast<float>(i / kEdge) + 0.25f);
      ray.origin_z = height_of(i, time) + 1.0f;
      ray.direction_z = -1.0f;
      ray.tmax = 2.0f;
      ray.time = time;
      rays.push_back(ray);
    }
  }
  return rays;
}

class InstancedMotion : public testing::TestWithParam<int> {
 protected:
  Scene make_scene_of(const Geometry& instances, int mode) const {
    Scene scene = make_scene(device_);
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_REBRAID, mode), KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_REBRAID_BUDGET, 20),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_attach(scene.get(), instances.get(), nullptr), KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
    EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
    return scene;
  }

  const Device device_ = make_device();
};

TEST_P(InstancedMotion, IsThatOfTheSceneItself) {
  const Scene child = make_scene(device_, make_moving(device_));
  const std::vector<kiwami_ray> rays = rays_from_above();
  const std::vector<kiwami_hit> expected = closest_hits(child, rays);
  const Scene scene = make_scene_of(make_instances(device_, child, 1), GetParam());
  const std::vector<kiwami_hit> hits = closest_hits(scene, rays);
  for (size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(expected[i].primitive_id, i % kTriangles);
    ASSERT_EQ(hits[i].primitive_id, expected[i].primitive_id) << "ray " << i;
    ASSERT_EQ(hits[i].t, expected[i].t) << "ray " << i;
  }
}

TEST_P(InstancedMotion, OverlapsAsWithoutRebraiding) {
  const Scene child = make_scene(device_, make_moving(device_));
  const std::vector<kiwami_ray> rays = rays_from_above();
  const auto hits_of = [&](int mode) {
    return closest_hits(make_scene_of(make_instances(device_, child, 3), mode), rays);
  };
  EXPECT_TRUE(are_equal(hits_of(GetParam()), hits_of(KIWAMI_REBRAID_OFF)));
}

/// The root of its tree is a leaf: no node holds its boxes.
TEST_P(InstancedMotion, OfASingleTriangleBesideOthersThatRest) {
  Scene child = make_scene(device_, make_moving(device_, 1));
  std::vector<float> resting;
  for (uint32_t i = 0; i < 64; ++i) {
    const float x = static_cast<float>(i % 8) - 20.0f, y = static_cast<float>(i / 8);
    resting.insert(resting.end(), {x, y, 0, x + 0.9f, y, 0, x, y + 0.9f, 0});
  }
  kiwami_triangle_mesh_desc desc;
  ASSERT_EQ(kiwami_triangle_mesh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.vertices = resting.data();
  desc.vertex_count = resting.size() / 3;
  desc.triangle_count = resting.size() / 9;
  const Geometry mesh = make_mesh(device_, desc);
  ASSERT_EQ(kiwami_scene_attach(child.get(), mesh.get(), nullptr), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(child.get()), KIWAMI_OK);
  std::vector<kiwami_ray> rays;
  for (const kiwami_ray& ray : rays_from_above()) {
    if (ray.origin_x < 1.0f && ray.origin_y < 1.0f) rays.push_back(ray);
  }
  const Scene scene = make_scene_of(make_instances(device_, child, 3), GetParam());
  const std::vector<kiwami_hit> expected = closest_hits(child, rays);
  const std::vector<kiwami_hit> hits = closest_hits(scene, rays);
  for (size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(expected[i].primitive_id, 0u);
    ASSERT_EQ(hits[i].primitive_id, 0u) << "time " << rays[i].time;
    ASSERT_EQ(hits[i].t, expected[i].t) << "time " << rays[i].time;
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, InstancedMotion,
                         testing::Values(int{KIWAMI_REBRAID_OFF}, int{KIWAMI_REBRAID_FULL},
                                         int{KIWAMI_REBRAID_ROOTS}));

}  // namespace
}  // namespace kiwami_api_tests

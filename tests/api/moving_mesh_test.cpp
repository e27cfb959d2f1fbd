// SPDX-License-Identifier: Apache-2.0
// Moving meshes through the C interface: their descriptions, and what rays find at their times.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

/// The triangle (0, 0), (1, 0), (0, 1), at z = 0 first, then at these z.
struct Lift {
  std::vector<float> vertices;
  uint32_t steps = 1;

  explicit Lift(const std::vector<float>& heights) {
    for (const float z : heights) {
      vertices.insert(vertices.end(), {0, 0, z, 1, 0, z, 0, 1, z});
    }
    steps = static_cast<uint32_t>(heights.size());
  }

  kiwami_moving_mesh_desc desc() const {
    kiwami_moving_mesh_desc desc;
    EXPECT_EQ(kiwami_moving_mesh_desc_init(&desc, sizeof desc), KIWAMI_OK);
    desc.vertices = vertices.data();
    desc.vertex_count = 3;
    desc.triangle_count = 1;
    desc.step_count = steps;
    return desc;
  }
};

Geometry make(const Device& device, const kiwami_moving_mesh_desc& desc) {
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_moving_mesh_create(device.get(), &desc, &geometry), KIWAMI_OK) << last_error();
  return Geometry(geometry);
}

float height_at(const Scene& scene, float time) {
  kiwami_ray ray = ray_along_z(0.25f, 0.25f);
  ray.origin_z = -10;
  ray.time = time;
  return closest_hit(scene, ray).t - 10.0f;
}

TEST(MovingMesh, IsWhereTheTimeSays) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make(device, Lift({0, 4, 6}).desc()));
  EXPECT_EQ(height_at(scene, 0.0f), 0.0f);
  EXPECT_EQ(height_at(scene, 0.25f), 2.0f);
  EXPECT_EQ(height_at(scene, 0.5f), 4.0f);
  EXPECT_EQ(height_at(scene, 0.75f), 5.0f);
  EXPECT_EQ(height_at(scene, 1.0f), 6.0f);
  EXPECT_EQ(height_at(scene, 1.01f), kInfinity);
  EXPECT_EQ(height_at(scene, -0.01f), kInfinity);
  EXPECT_EQ(height_at(scene, std::nanf("")), kInfinity);
  const kiwami_scene_info info = info_of(scene);
  EXPECT_EQ(info.bounds_min[2], 0.0f);
  EXPECT_EQ(info.bounds_max[2], 6.0f);
  EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK);
}

TEST(MovingMesh, HasItsOwnRangeOfTime) {
  const Device device = make_device();
  const Lift lift({0, 4});
  kiwami_moving_mesh_desc desc = lift.desc();
  desc.time_begin = -1.0f;
  desc.time_end = 3.0f;
  const Scene scene = make_scene(device, make(device, desc));
  EXPECT_EQ(height_at(scene, -1.0f), 0.0f);
  EXPECT_EQ(height_at(scene, 0.0f), 1.0f);
  EXPECT_EQ(height_at(scene, 3.0f), 4.0f);
  EXPECT_EQ(height_at(scene, 3.5f), kInfinity);
}

TEST(MovingMesh, StandsBesideOthers) {
  const Device device = make_device();
  const Lift first({0, 4}), second({8, 8, 2});
  kiwami_moving_mesh_desc second_desc = second.desc();
  second_desc.mask = 2;
  const Triangles still = square(5);
  const Scene scene = make_scene(device);
  for (const Geometry& geometry :
       {make(device, first.desc()), make_mesh(device, still.desc()), make(device, second_desc)}) {
    ASSERT_EQ(kiwami_scene_attach(scene.get(), geometry.get(), nullptr), KIWAMI_OK);
  }
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  kiwami_ray ray = ray_along_z(0.25f, 0.25f);
  ray.time = 1.0f;
  ray.tmin = 1.0f;
  EXPECT_EQ(closest_hit(scene, ray).geometry_id, 2u);
  EXPECT_EQ(closest_hit(scene, ray).t, 2.0f);
  ray.mask = 1;
  EXPECT_EQ(closest_hit(scene, ray).geometry_id, 0u);
  ray.time = 0.5f;
  ray.tmin = 3.0f;
  EXPECT_EQ(closest_hit(scene, ray).geometry_id, 1u);
}

TEST(MovingMesh, SharesBuffersAtAnyAddressAndStride) {
  const Device device = make_device();
  std::vector<unsigned char> bytes(1 + 100 + 3 * 13);
  const Lift lift({0, 4});
  for (size_t step = 0; step < 2; ++step) {
    for (size_t i = 0; i < 3; ++i) {
      std::memcpy(bytes.data() + 1 + 100 * step + 13 * i, &lift.vertices[3 * (3 * step + i)], 12);
    }
  }
  const uint32_t indices[3] = {0, 1, 2};
  kiwami_moving_mesh_desc desc = lift.desc();
  desc.vertices = bytes.data();
  desc.vertex_offset = 1;
  desc.vertex_stride = 13;
  desc.step_stride = 100;
  desc.indices = indices;
  for (const uint32_t flags : {uint32_t{KIWAMI_MOVING_MESH_SHARE_BUFFERS}, 0u}) {
    desc.flags = flags;
    const Scene scene = make_scene(device, make(device, desc));
    if (flags == 0) std::fill(bytes.begin(), bytes.end(), 0xFF);
    EXPECT_EQ(height_at(scene, 0.5f), 2.0f);
  }
}

TEST(MovingMesh, WithABadStepIsSkipped) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make(device, Lift({0, std::nanf(""), 6}).desc()));
  EXPECT_EQ(height_at(scene, 0.0f), kInfinity);
  EXPECT_EQ(info_of(scene).skipped_count, 1u);
}

class MovingMeshErrors : public testing::Test {
 protected:
  void expect(kiwami_result result, const std::string& part) {
    kiwami_geometry* geometry = reinterpret_cast<kiwami_geometry*>(this);
    EXPECT_EQ(kiwami_moving_mesh_create(device_.get(), &desc_, &geometry), result);
    EXPECT_EQ(geometry, nullptr);
    EXPECT_NE(last_error().find(part), std::string::npos) << last_error();
    desc_ = lift_.desc();
  }

  Device device_ = make_device();
  Lift lift_ = Lift({0, 1});
  kiwami_moving_mesh_desc desc_ = lift_.desc();
};

TEST_F(MovingMeshErrors, NameTheField) {
  desc_.flags = 2;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x2");
  desc_.step_count = 1;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.step_count is 1");
  desc_.step_count = 130;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.step_count is 130");
  desc_.time_end = 0.0f;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.time_begin is 0 and desc.time_end 0");
  desc_.time_begin = std::nanf("");
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "expected finite times");
  desc_.time_end = kInfinity;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "expected finite times");
  desc_.vertices = nullptr;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.vertices is NULL");
  desc_.vertex_stride = 8;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "vertex_stride is 8");
  desc_.step_stride = ~uint64_t{0} / 2;
  desc_.step_count = 9;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "address space");
  desc_.triangle_count = 2;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.triangle_count is 2");
  const uint32_t indices[3] = {0, 1, 3};
  desc_.indices = indices;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "index 2 of triangle 0 is 3");
  desc_.triangle_count = uint64_t{1} << 31;
  expect(KIWAMI_ERROR_TOO_LARGE, "desc.triangle_count is 2147483648");
}

/// Triangles that change sides meet in the middle, where boxes between both ends would be as wide as
/// at these; those that go side by side need no more boxes.
TEST(MovingMesh, TimeIsDividedWhereThatPays) {
  const Device device = make_device();
  const auto scene_of = [&](float side_at_end) {
    std::vector<float> vertices;
    for (const float side : {1.0f, side_at_end}) {
      for (int i = 0; i < 512; ++i) {
        const float x = side * (static_cast<float>(i) - 255.5f), y = static_cast<float>(i % 32);
        vertices.insert(vertices.end(), {x, y, 0, x + 0.5f, y, 0, x, y + 0.5f, 0});
      }
    }
    kiwami_moving_mesh_desc desc;
    EXPECT_EQ(kiwami_moving_mesh_desc_init(&desc, sizeof desc), KIWAMI_OK);
    desc.vertices = vertices.data();
    desc.vertex_count = 3 * 512;
    desc.triangle_count = 512;
    Scene scene = make_scene(device, make(device, desc));
    EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
    return scene;
  };
  const Scene together = scene_of(1.0f), apart = scene_of(-1.0f);
  EXPECT_GT(info_of(apart).total_bytes, info_of(together).total_bytes);
  // Halfway all are in one column, and rays beside it visit the root alone.
  kiwami_ray ray = ray_along_z(30.0f, 7.25f);
  ray.origin_z = -10.0f;
  ray.time = 0.5f;
  kiwami_visits visits{};
  visits.struct_size = sizeof visits;
  ASSERT_EQ(kiwami_scene_count_visits(apart.get(), &ray, 0, 1, 0, &visits, nullptr, 0), KIWAMI_OK);
  EXPECT_EQ(visits.node_visits, 1u);
  ray = ray_along_z(0.1f, 7.1f);
  ray.origin_z = -10.0f;
  ray.time = 0.5f;
  EXPECT_EQ(closest_hit(apart, ray).t, 10.0f);
}

/// Triangles in a grid, each of which goes to the place of another.
kiwami_visits visits_of_exchange(const Device& device, double divides,
                                 std::vector<kiwami_hit>& hits) {
  constexpr uint32_t kSide = 16, kCount = kSide * kSide;
  std::vector<float> vertices;
  for (uint32_t step = 0; step < 2; ++step) {
    for (uint32_t i = 0; i < kCount; ++i) {
      const uint32_t place = step == 0 ? i : (i * 37 + 11) % kCount;
      const auto x = static_cast<float>(place % kSide), y = static_cast<float>(place / kSide);
      vertices.insert(vertices.end(), {x, y, 0, x + 0.5f, y, 0, x, y + 0.5f, 0});
    }
  }
  kiwami_moving_mesh_desc desc;
  EXPECT_EQ(kiwami_moving_mesh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.vertices = vertices.data();
  desc.vertex_count = 3 * kCount;
  desc.triangle_count = kCount;
  desc.step_count = 2;
  const Scene scene = make_scene(device, make(device, desc));
  EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_DIVIDE_TIME, divides),
            KIWAMI_OK);
  EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
  EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
  std::vector<kiwami_ray> rays;
  for (uint32_t i = 0; i < kCount; ++i) {
    rays.push_back(
        ray_along_z(0.1f + static_cast<float>(i % kSide), 0.1f + static_cast<float>(i / kSide)));
    rays.back().origin_z = -10;
    rays.back().time = static_cast<float>(i % 9) / 8.0f;
  }
  hits = closest_hits(scene, rays);
  kiwami_visits visits{};
  visits.struct_size = sizeof visits;
  EXPECT_EQ(
      kiwami_scene_count_visits(scene.get(), rays.data(), 0, rays.size(), 0, &visits, nullptr, 0),
      KIWAMI_OK)
      << last_error();
  return visits;
}

TEST(MovingMesh, HasBoxesForHalvesOfTimeUnlessToldNot) {
  const Device device = make_device();
  std::vector<kiwami_hit> whole_hits, halves_hits;
  const kiwami_visits whole = visits_of_exchange(device, 0, whole_hits);
  const kiwami_visits halves = visits_of_exchange(device, 1, halves_hits);
  EXPECT_LT(halves.node_visits, whole.node_visits);
  EXPECT_LT(halves.leaf_visits, whole.leaf_visits);
  ASSERT_EQ(whole_hits.size(), halves_hits.size());
  EXPECT_EQ(
      std::memcmp(whole_hits.data(), halves_hits.data(), whole_hits.size() * sizeof(kiwami_hit)),
      0);
}

}  // namespace
}  // namespace kiwami_api_tests

// SPDX-License-Identifier: Apache-2.0
// Spheres, discs and curve segments through the C interface: their descriptions, and what rays
// find.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

template <typename Desc>
Desc defaults(kiwami_result (*init)(Desc*, size_t)) {
  Desc desc;
  EXPECT_EQ(init(&desc, sizeof desc), KIWAMI_OK);
  return desc;
}

kiwami_spheres_desc spheres_of(const std::vector<float>& points) {
  kiwami_spheres_desc desc = defaults(kiwami_spheres_desc_init);
  desc.points = points.data();
  desc.sphere_count = points.size() / 4;
  return desc;
}

kiwami_discs_desc discs_of(const std::vector<float>& points, const std::vector<float>& normals) {
  kiwami_discs_desc desc = defaults(kiwami_discs_desc_init);
  desc.points = points.data();
  desc.normals = normals.data();
  desc.disc_count = points.size() / 4;
  return desc;
}

kiwami_curves_desc curves_of(const std::vector<float>& points) {
  kiwami_curves_desc desc = defaults(kiwami_curves_desc_init);
  desc.points = points.data();
  desc.point_count = points.size() / 4;
  desc.segment_count = desc.point_count - 1;
  return desc;
}

Geometry make(const Device& device, const kiwami_spheres_desc& desc) {
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_spheres_create(device.get(), &desc, &geometry), KIWAMI_OK) << last_error();
  return Geometry(geometry);
}
Geometry make(const Device& device, const kiwami_discs_desc& desc) {
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_discs_create(device.get(), &desc, &geometry), KIWAMI_OK) << last_error();
  return Geometry(geometry);
}
Geometry make(const Device& device, const kiwami_curves_desc& desc) {
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_curves_create(device.get(), &desc, &geometry), KIWAMI_OK) << last_error();
  return Geometry(geometry);
}

uint32_t count_of(const Scene& scene, const kiwami_ray& ray) {
  uint32_t count = ~0u;
  EXPECT_EQ(kiwami_count_hits(scene.get(), &ray, 0, &count, 0, 1, nullptr), KIWAMI_OK);
  return count;
}

bool is_occluded(const Scene& scene, const kiwami_ray& ray) {
  uint8_t occluded = 2;
  EXPECT_EQ(kiwami_any_hit(scene.get(), &ray, 0, &occluded, 0, 1, nullptr), KIWAMI_OK);
  return occluded == 1;
}

/// A ray along +z from z = -8.
kiwami_ray ray_at(float x, float y) {
  kiwami_ray ray = ray_along_z(x, y);
  ray.origin_z = -8;
  return ray;
}

TEST(Spheres, AreGoneAfterTheRefitsThatFollowTheirEnd) {
  const Device device = make_device();
  const Triangles triangles = square(1);
  Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
  const std::vector<float> points = {5, 5, 0, 1};
  const Geometry spheres = make(device, spheres_of(points));
  uint32_t id = 0;
  ASSERT_EQ(kiwami_scene_attach(scene.get(), spheres.get(), &id), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_TRUE(is_occluded(scene, ray_at(5, 5)));
  ASSERT_EQ(kiwami_scene_detach(scene.get(), id), KIWAMI_OK);
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK) << last_error();
    EXPECT_FALSE(is_occluded(scene, ray_at(5, 5))) << i;
    EXPECT_TRUE(is_occluded(scene, ray_at(0.5f, -0.25f))) << i;
  }
}

TEST(Spheres, AreEnteredAndLeft) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make(device, spheres_of({1, 2, 3, 2})));
  kiwami_ray ray = ray_at(1, 2);
  kiwami_hit hit = closest_hit(scene, ray);
  EXPECT_EQ(hit.t, 9.0f);
  EXPECT_EQ(hit.normal_z, -2.0f);
  EXPECT_EQ(hit.primitive_id, 0u);
  EXPECT_EQ(hit.geometry_id, 0u);
  EXPECT_EQ(hit.instance_id, KIWAMI_INVALID_ID);
  EXPECT_EQ(hit.u, 0.0f);
  EXPECT_EQ(count_of(scene, ray), 2u);
  EXPECT_TRUE(is_occluded(scene, ray));
  // From inside, the far side.
  ray.tmin = 10.0f;
  hit = closest_hit(scene, ray);
  EXPECT_EQ(hit.t, 13.0f);
  EXPECT_EQ(hit.normal_z, 2.0f);
  EXPECT_EQ(count_of(scene, ray), 1u);
  // Between the two.
  ray.tmax = 12.0f;
  EXPECT_EQ(closest_hit(scene, ray).primitive_id, KIWAMI_INVALID_ID);
  EXPECT_EQ(count_of(scene, ray), 0u);
  EXPECT_FALSE(is_occluded(scene, ray));
}

TEST(Spheres, ShowTheirFrontFromOutside) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make(device, spheres_of({0, 0, 0, 1})));
  kiwami_ray ray = ray_at(0, 0);
  ray.flags = KIWAMI_RAY_CULL_BACK_FACES;
  EXPECT_EQ(closest_hit(scene, ray).t, 7.0f);
  EXPECT_EQ(count_of(scene, ray), 1u);
  ray.flags = KIWAMI_RAY_CULL_FRONT_FACES;
  EXPECT_EQ(closest_hit(scene, ray).t, 9.0f);
}

TEST(Spheres, AreCrossedTwiceHoweverSmallAndFar) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make(device, spheres_of({0, 0, 0x1p30f, 0x1p-10f})));
  const kiwami_ray ray = ray_at(0, 0);
  ASSERT_EQ(count_of(scene, ray), 2u);
  kiwami_ray rest = ray;
  rest.tmin = std::nextafter(closest_hit(scene, rest).t, kInfinity);
  const kiwami_hit second = closest_hit(scene, rest);
  EXPECT_EQ(second.t, rest.tmin);
  rest.tmin = std::nextafter(second.t, kInfinity);
  EXPECT_EQ(closest_hit(scene, rest).primitive_id, KIWAMI_INVALID_ID);
}

TEST(Spheres, ThatAreNoneAreSkipped) {
  const Device device = make_device();
  const float nan = std::nanf("");
  const Scene scene = make_scene(
      device, make(device, spheres_of({nan,     0,  0, 1,       0,         0, 0, nan, 0, 0,
                                       0,       -1, 0, 0,       kInfinity, 1, 0, 0,   0, kInfinity,
                                       0x1p60f, 0,  0, 0x1p50f, 0,         0, 4, 1})));
  const kiwami_hit hit = closest_hit(scene, ray_at(0, 0));
  EXPECT_EQ(hit.primitive_id, 6u);
  EXPECT_EQ(hit.t, 11.0f);
  EXPECT_EQ(count_of(scene, ray_at(0, 0)), 2u);
  EXPECT_EQ(info_of(scene).skipped_count, 6u);
}

TEST(Spheres, LieAtAnyAddressAndStride) {
  const Device device = make_device();
  for (const uint32_t flags : {0u, uint32_t{KIWAMI_SHAPES_SHARE_BUFFERS}}) {
    std::vector<unsigned char> bytes(1 + 2 * 21 + 16 - 21);
    const float points[2][4] = {{0, 0, 0, 1}, {5, 0, 0, 1}};
    std::memcpy(bytes.data() + 1, points[0], 16);
    std::memcpy(bytes.data() + 1 + 21, points[1], 16);
    kiwami_spheres_desc desc = defaults(kiwami_spheres_desc_init);
    desc.points = bytes.data();
    desc.point_offset = 1;
    desc.point_stride = 21;
    desc.sphere_count = 2;
    desc.flags = flags;
    const Scene scene = make_scene(device, make(device, desc));
    if (flags == 0) std::fill(bytes.begin(), bytes.end(), 0xFF);
    EXPECT_EQ(closest_hit(scene, ray_at(5, 0)).primitive_id, 1u);
    EXPECT_EQ(closest_hit(scene, ray_at(0, 0)).primitive_id, 0u);
  }
}

TEST(Discs, AreMetOnceFromBothSides) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make(device, discs_of({0, 0, 0, 2}, {0, 0, -3})));
  kiwami_ray ray = ray_at(1, 0);
  kiwami_hit hit = closest_hit(scene, ray);
  EXPECT_EQ(hit.t, 8.0f);
  EXPECT_EQ(hit.u, 0.25f);
  EXPECT_EQ(hit.normal_z, -3.0f);
  EXPECT_EQ(count_of(scene, ray), 1u);
  ray.flags = KIWAMI_RAY_CULL_FRONT_FACES;
  EXPECT_EQ(count_of(scene, ray), 0u);
  ray.direction_z = -1;
  ray.origin_z = 8;
  EXPECT_EQ(closest_hit(scene, ray).t, 8.0f);
  // The rim is not part of it, nor is anything beyond.
  EXPECT_EQ(count_of(scene, ray_at(2, 0)), 0u);
  EXPECT_EQ(count_of(scene, ray_at(1.5f, 1.5f)), 0u);
}

TEST(Discs, WithoutANormalAreSkipped) {
  const Device device = make_device();
  const Scene scene =
      make_scene(device, make(device, discs_of({0, 0, 0, 2, 0, 0, 1, 2, 0, 0, 2, 2},
                                               {0, 0, 0, 0, std::nanf(""), 1, 0, 0, 1})));
  EXPECT_EQ(closest_hit(scene, ray_at(0, 0)).primitive_id, 2u);
  EXPECT_EQ(info_of(scene).skipped_count, 2u);
}

TEST(Curves, TellWhereAlongTheSegmentTheyAreMet) {
  const Device device = make_device();
  const Scene scene =
      make_scene(device, make(device, curves_of({-4, 0, 0, 1, 4, 0, 0, 1, 4, 6, 0, 0.5f})));
  kiwami_hit hit = closest_hit(scene, ray_at(2, 0));
  EXPECT_EQ(hit.t, 7.0f);
  EXPECT_EQ(hit.u, 0.75f);
  EXPECT_EQ(hit.v, 0.0f);
  EXPECT_EQ(hit.primitive_id, 0u);
  EXPECT_EQ(hit.normal_x, 0.0f);
  EXPECT_EQ(hit.normal_z, -1.0f);
  EXPECT_EQ(count_of(scene, ray_at(2, 0)), 2u);
  // The round end.
  hit = closest_hit(scene, ray_at(-4.6f, 0));
  EXPECT_FLOAT_EQ(hit.t, 7.2f);
  EXPECT_EQ(hit.u, 0.0f);
  // The joint belongs to both, the first segment being the least.
  EXPECT_EQ(closest_hit(scene, ray_at(4, 0)).primitive_id, 0u);
  EXPECT_EQ(count_of(scene, ray_at(4, 0)), 4u);
  // The second segment becomes thinner.
  hit = closest_hit(scene, ray_at(4, 3));
  EXPECT_EQ(hit.primitive_id, 1u);
  EXPECT_NEAR(hit.t, 8.0 - 0.75, 0.01);
  EXPECT_NEAR(hit.u, 0.5, 0.02);
}

TEST(Curves, TakeTheirSegmentsFromIndices) {
  const Device device = make_device();
  const std::vector<float> points = {0, 0, 0, 1, 4, 0, 0, 1, 0, 8, 0, 1, 4, 8, 0, 1};
  const std::vector<uint32_t> indices = {2, 0};
  kiwami_curves_desc desc = curves_of(points);
  desc.indices = indices.data();
  desc.segment_count = 2;
  const Scene scene = make_scene(device, make(device, desc));
  EXPECT_EQ(closest_hit(scene, ray_at(2, 8)).primitive_id, 0u);
  EXPECT_EQ(closest_hit(scene, ray_at(2, 0)).primitive_id, 1u);
  EXPECT_EQ(count_of(scene, ray_at(2, 4)), 0u);
}

TEST(Shapes, AreMetByTheRaysOfTheirMask) {
  const Device device = make_device();
  const std::vector<float> points = {0, 0, 0, 1};
  kiwami_spheres_desc desc = spheres_of(points);
  desc.mask = 6;
  const Scene scene = make_scene(device, make(device, desc));
  kiwami_ray ray = ray_at(0, 0);
  ray.mask = 1;
  EXPECT_EQ(count_of(scene, ray), 0u);
  ray.mask = 5;
  EXPECT_EQ(count_of(scene, ray), 2u);
}

TEST(Shapes, StandBesideTrianglesInOneScene) {
  const Device device = make_device();
  const Triangles triangles = square(0);
  const std::vector<float> sphere = {0, 0, 3, 1}, disc = {0, 0, -2, 1}, normal = {0, 0, 1};
  const std::vector<float> curve = {-1, 0, 6, 0.5f, 1, 0, 6, 0.5f};
  const Scene scene = make_scene(device);
  for (const Geometry& geometry :
       {make(device, spheres_of(sphere)), make_mesh(device, triangles.desc()),
        make(device, curves_of(curve)), make(device, discs_of(disc, normal))}) {
    ASSERT_EQ(kiwami_scene_attach(scene.get(), geometry.get(), nullptr), KIWAMI_OK);
  }
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  kiwami_ray ray = ray_at(0.25f, 0.125f);
  EXPECT_EQ(count_of(scene, ray), 6u);
  uint32_t order[6];
  for (uint32_t& geometry : order) {
    const kiwami_hit hit = closest_hit(scene, ray);
    geometry = hit.geometry_id;
    ray.tmin = std::nextafter(hit.t, kInfinity);
  }
  const uint32_t expected[6] = {3, 1, 0, 0, 2, 2};
  EXPECT_EQ(std::memcmp(order, expected, sizeof order), 0);
  const kiwami_scene_info info = info_of(scene);
  EXPECT_EQ(info.bounds_min[2], -2.0f);
  EXPECT_GE(info.bounds_max[2], 6.5f);
  EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK);
}

TEST(Shapes, OfNoNumberAreAnEmptyScene) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make(device, defaults(kiwami_spheres_desc_init)));
  EXPECT_EQ(count_of(scene, ray_at(0, 0)), 0u);
}

class ShapeErrors : public testing::Test {
 protected:
  template <typename Create, typename Desc>
  void expect(Create create, const Desc& desc, kiwami_result result, const std::string& part) {
    kiwami_geometry* geometry = reinterpret_cast<kiwami_geometry*>(this);
    EXPECT_EQ(create(device_.get(), &desc, &geometry), result);
    EXPECT_EQ(geometry, nullptr);
    EXPECT_NE(last_error().find(part), std::string::npos) << last_error();
  }

  Device device_ = make_device();
  std::vector<float> points_ = {0, 0, 0, 1, 1, 0, 0, 1};
  std::vector<float> normals_ = {0, 0, 1, 0, 0, 1};
};

TEST_F(ShapeErrors, NameTheField) {
  kiwami_spheres_desc spheres = spheres_of(points_);
  spheres.flags = 2;
  expect(kiwami_spheres_create, spheres, KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x2");
  spheres = spheres_of(points_);
  spheres.reserved = 7;
  expect(kiwami_spheres_create, spheres, KIWAMI_ERROR_INVALID_ARGUMENT, "desc.reserved is 7");
  spheres = spheres_of(points_);
  spheres.points = nullptr;
  expect(kiwami_spheres_create, spheres, KIWAMI_ERROR_INVALID_ARGUMENT, "desc.points is NULL");
  spheres = spheres_of(points_);
  spheres.point_stride = 12;
  expect(kiwami_spheres_create, spheres, KIWAMI_ERROR_INVALID_ARGUMENT, "point_stride is 12");
  spheres = spheres_of(points_);
  spheres.point_stride = ~uint64_t{0};
  expect(kiwami_spheres_create, spheres, KIWAMI_ERROR_INVALID_ARGUMENT, "address space");
  spheres.sphere_count = uint64_t{1} << 31;
  expect(kiwami_spheres_create, spheres, KIWAMI_ERROR_TOO_LARGE, "sphere_count is 2147483648");

  kiwami_discs_desc discs = discs_of(points_, normals_);
  discs.normals = nullptr;
  expect(kiwami_discs_create, discs, KIWAMI_ERROR_INVALID_ARGUMENT, "desc.normals is NULL");
  discs = discs_of(points_, normals_);
  discs.normal_stride = 8;
  expect(kiwami_discs_create, discs, KIWAMI_ERROR_INVALID_ARGUMENT, "normal_stride is 8");
  discs.disc_count = uint64_t{1} << 31;
  expect(kiwami_discs_create, discs, KIWAMI_ERROR_TOO_LARGE, "disc_count is");

  kiwami_curves_desc curves = curves_of(points_);
  curves.segment_count = 2;
  expect(kiwami_curves_create, curves, KIWAMI_ERROR_INVALID_ARGUMENT, "segment_count is 2");
  const uint32_t index = 1;
  curves = curves_of(points_);
  curves.indices = &index;
  expect(kiwami_curves_create, curves, KIWAMI_ERROR_INVALID_ARGUMENT, "index 0 is 1");
  curves.index_stride = 3;
  expect(kiwami_curves_create, curves, KIWAMI_ERROR_INVALID_ARGUMENT, "index_stride is 3");
  curves = curves_of(points_);
  curves.point_count = uint64_t{1} << 32;
  expect(kiwami_curves_create, curves, KIWAMI_ERROR_TOO_LARGE, "point_count is");
}

TEST_F(ShapeErrors, NameTheArgument) {
  const kiwami_spheres_desc spheres = spheres_of(points_);
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_spheres_create(nullptr, &spheres, &geometry), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_spheres_create(device_.get(), nullptr, &geometry),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_spheres_create(device_.get(), &spheres, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace kiwami_api_tests

// SPDX-License-Identifier: Apache-2.0
// Attributes, points and origins at hits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "api/api_support.h"
#include "support/environment.h"
#include "support/plain_oracle.h"
#include "support/random.h"
#include "support/report.h"

namespace kiwami_api_tests {
namespace {

using kiwami_tests::Mesh;
using kiwami_tests::PlainOracle;
using kiwami_tests::Point;
using kiwami_tests::Random;

Point cross(Point a, Point b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A triangle of any size, place and shape: needles and flat ones among them.
std::array<Point, 3> some_triangle(Random& random) {
  const auto vector = [&](float size) {
    return Point{random.symmetric(), random.symmetric(), random.symmetric()} * size;
  };
  const float size = random.power_of_two(-20, 20);
  const Point a = vector(random.one_in(3) ? size * random.power_of_two(0, 14) : size);
  const Point b = a + vector(size);
  const float thin = random.one_in(3) ? random.power_of_two(-16, 0) : 1.0f;
  Point c = a + vector(size);
  if (random.one_in(3))
    c = (random.one_in(2) ? a : a + (b - a) * random.unit()) + vector(size * thin);
  std::array<Point, 3> corner = {a, b, c};
  if (random.one_in(4)) {
    const int axis = random.between(0, 2);
    for (Point& p : corner) p[axis] = a[axis];
  }
  return corner;
}

/// Weights inside, on sides and at corners.
void choose_weights(Random& random, float& u, float& v) {
  u = random.one_in(4) ? static_cast<float>(random.below(2)) : random.unit();
  v = random.one_in(4) ? 0.0f : random.unit() * (1.0f - u);
}

/// A direction to any side, many along the triangle or nearly so.
Point some_direction(Random& random, const std::array<Point, 3>& corner) {
  const auto length = [](Point p) { return std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z); };
  const Point b = corner[1] - corner[0], c = corner[2] - corner[0], normal = cross(b, c);
  const float normal_length = length(normal);
  if (random.one_in(2) || !(normal_length > 0.0f)) {
    return {random.symmetric(), random.symmetric(), random.symmetric()};
  }
  Point along = b * random.symmetric() + c * random.symmetric();
  along = along * (1.0f / std::max(length(along), 1e-30f));
  const float tilt = random.one_in(4) ? 0.0f : random.power_of_two(-30, 0);
  return along + normal * ((random.one_in(2) ? tilt : -tilt) / normal_length);
}

struct Departures {
  Mesh mesh;
  std::vector<kiwami_hit> hits;
  std::vector<Point> directions;
};

Departures some_departures(size_t count, Random random) {
  Departures all;
  for (uint32_t i = 0; i < count; ++i) {
    const auto corner = some_triangle(random);
    all.mesh.add(corner[0], corner[1], corner[2]);
    kiwami_hit hit = kiwami_tests::missing_hit();
    choose_weights(random, hit.u, hit.v);
    hit.primitive_id = i;
    hit.geometry_id = 0;
    all.hits.push_back(hit);
    all.directions.push_back(some_direction(random, corner));
  }
  return all;
}

Scene scene_of(const Device& device, const Mesh& mesh) {
  kiwami_triangle_mesh_desc desc = default_mesh();
  desc.vertices = mesh.vertices.data();
  desc.vertex_count = mesh.vertices.size();
  desc.indices = mesh.triangles.data();
  desc.triangle_count = mesh.triangles.size();
  return make_scene(device, make_mesh(device, desc));
}

kiwami_ray ray_of(Point origin, Point direction) {
  return {origin.x,    origin.y,  origin.z, 0.0f, direction.x, direction.y,
          direction.z, kInfinity, 0.0f,     ~0u,  0,           0};
}

/// Whether a ray meets a triangle of the mesh, by a plain loop over that triangle alone.
bool meets(const Mesh& mesh, uint32_t triangle, const kiwami_ray& ray) {
  Mesh alone;
  const auto corner = mesh.corners(triangle);
  alone.add(corner[0], corner[1], corner[2]);
  return PlainOracle({"alone", {alone}}).any_hit(ray);
}

TEST(OffsetOrigins, AreNeverBeforeTheirOwnTriangle) {
  const Departures all =
      some_departures(kiwami_tests::ray_budget(300000), Random(kiwami_tests::seed(), 40));
  const size_t count = all.hits.size();
  const Device device = make_device();
  const Scene scene = scene_of(device, all.mesh);
  std::vector<Point> points(count), origins(count);
  ASSERT_EQ(kiwami_hit_points(scene.get(), all.hits.data(), 0, count, &points[0].x, 0, nullptr, 0),
            KIWAMI_OK)
      << last_error();
  ASSERT_EQ(kiwami_offset_origins(scene.get(), all.hits.data(), 0, &all.directions[0].x, 0, count,
                                  &origins[0].x, 0),
            KIWAMI_OK)
      << last_error();
  size_t from_points = 0, unmoved = 0;
  for (size_t i = 0; i < count; ++i) {
    const auto number = static_cast<uint32_t>(i);
    from_points += meets(all.mesh, number, ray_of(points[i], all.directions[i]));
    if (origins[i] == points[i]) {
      ++unmoved;  // a triangle without a plane
      continue;
    }
    const kiwami_ray ray = ray_of(origins[i], all.directions[i]);
    ASSERT_FALSE(meets(all.mesh, number, ray))
        << "KIWAMI_SEED=" << kiwami_tests::seed() << ", " << kiwami_tests::describe(ray);
  }
  std::printf("%zu of %zu rays from the points themselves meet their triangles; %zu have no side\n",
              from_points, count, unmoved);
  EXPECT_GT(from_points, count / 50);
  EXPECT_LT(unmoved, count / 50);
}

TEST(OffsetOrigins, KeepTheLibraryFromMeetingTheTriangleAgain) {
  const Departures all = some_departures(3000, Random(kiwami_tests::seed(), 41));
  const size_t count = all.hits.size();
  for (const uint32_t isa : {KIWAMI_ISA_SCALAR, KIWAMI_ISA_AUTO}) {
    const Device device = make_device(isa);
    const Scene scene = scene_of(device, all.mesh);
    std::vector<Point> origins(count);
    ASSERT_EQ(kiwami_offset_origins(scene.get(), all.hits.data(), 0, &all.directions[0].x, 0, count,
                                    &origins[0].x, 0),
              KIWAMI_OK);
    std::vector<kiwami_ray> rays;
    for (size_t i = 0; i < count; ++i) rays.push_back(ray_of(origins[i], all.directions[i]));
    std::vector<uint64_t> offsets(count + 1);
    ASSERT_EQ(kiwami_multi_hit(scene.get(), rays.data(), 0, count, 0, nullptr, 0, offsets.data(),
                               nullptr),
              KIWAMI_OK);
    std::vector<kiwami_hit> hits(offsets.back());
    ASSERT_EQ(kiwami_multi_hit(scene.get(), rays.data(), 0, count, 0, hits.data(), hits.size(),
                               offsets.data(), nullptr),
              KIWAMI_OK);
    for (size_t i = 0; i < count; ++i) {
      for (uint64_t k = offsets[i]; k < offsets[i + 1]; ++k) {
        ASSERT_NE(hits[k].primitive_id, i) << kiwami_tests::describe(rays[i]);
      }
    }
  }
}

/// Far less than what a hundred thousandth of the triangle, or a few units in the last place, are.
TEST(OffsetOrigins, StayNearTheirPoints) {
  const Departures all = some_departures(20000, Random(kiwami_tests::seed(), 42));
  const size_t count = all.hits.size();
  const Device device = make_device();
  const Scene scene = scene_of(device, all.mesh);
  std::vector<Point> points(count), origins(count);
  kiwami_hit_points(scene.get(), all.hits.data(), 0, count, &points[0].x, 0, nullptr, 0);
  kiwami_offset_origins(scene.get(), all.hits.data(), 0, &all.directions[0].x, 0, count,
                        &origins[0].x, 0);
  for (size_t i = 0; i < count; ++i) {
    const auto corner = all.mesh.corners(i);
    float extent = 0.0f, place = 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < 3; ++k) {
        extent = std::max(extent, std::fabs(corner[k][axis] - points[i][axis]));
        place = std::max(place, std::fabs(corner[k][axis]));
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_LE(std::fabs(origins[i][axis] - points[i][axis]), extent * 4e-6f + place * 3e-7f);
    }
  }
}

TEST(HitPoints, AreWithinTheirErrors) {
  const Departures all = some_departures(100000, Random(kiwami_tests::seed(), 43));
  const size_t count = all.hits.size();
  const Device device = make_device();
  const Scene scene = scene_of(device, all.mesh);
  std::vector<Point> points(count), errors(count);
  ASSERT_EQ(
      kiwami_hit_points(scene.get(), all.hits.data(), 0, count, &points[0].x, 0, &errors[0].x, 0),
      KIWAMI_OK);
  for (size_t i = 0; i < count; ++i) {
    const auto corner = all.mesh.corners(i);
    const long double u = all.hits[i].u, v = all.hits[i].v;
    for (int axis = 0; axis < 3; ++axis) {
      const long double exact =
          (1 - u - v) * corner[0][axis] + u * corner[1][axis] + v * corner[2][axis];
      const long double off = std::fabs(exact - points[i][axis]);
      ASSERT_LE(off, errors[i][axis]);
      const float greatest = std::max(
          {std::fabs(corner[0][axis]), std::fabs(corner[1][axis]), std::fabs(corner[2][axis])});
      ASSERT_LE(errors[i][axis], 0x1p-23f * greatest + 0x1p-140f);
    }
  }
}

TEST(HitPoints, AreNotANumberForAMissAndGoToAnyStride) {
  const Device device = make_device();
  const Triangles triangles = square(1);
  const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
  const std::vector<kiwami_hit> hits =
      closest_hits(scene, {ray_along_z(0.5f, 0.25f), ray_along_z(9, 9)});
  float points[10];
  std::fill(std::begin(points), std::end(points), 7.0f);
  ASSERT_EQ(kiwami_hit_points(scene.get(), hits.data(), 0, 2, points, 20, nullptr, 0), KIWAMI_OK);
  EXPECT_EQ(points[0], 0.5f);
  EXPECT_EQ(points[1], 0.25f);
  EXPECT_EQ(points[2], 1.0f);
  EXPECT_EQ(points[3], 7.0f);
  EXPECT_TRUE(std::isnan(points[5]) && std::isnan(points[6]) && std::isnan(points[7]));
  float directions[6] = {0, 0, -1, 0, 0, -1}, origins[6];
  ASSERT_EQ(kiwami_offset_origins(scene.get(), hits.data(), 0, directions, 0, 2, origins, 0),
            KIWAMI_OK);
  EXPECT_LT(origins[2], 1.0f);
  EXPECT_GT(origins[2], 0.9999f);
  EXPECT_TRUE(std::isnan(origins[3]));
  directions[2] = 1;
  kiwami_offset_origins(scene.get(), hits.data(), 0, directions, 0, 1, origins, 0);
  EXPECT_GT(origins[2], 1.0f);
}

TEST(HitPoints, RefuseHitsThatAreNotOfTheScene) {
  const Device device = make_device();
  const Triangles triangles = square(1);
  const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
  kiwami_hit hits[2] = {kiwami_tests::missing_hit(),
                        closest_hits(scene, {ray_along_z(0, 0.5f)})[0]};
  float points[6];
  const auto call = [&] {
    return kiwami_hit_points(scene.get(), hits, 0, 2, points, 0, nullptr, 0);
  };
  EXPECT_EQ(call(), KIWAMI_OK);
  hits[1].primitive_id = 2;
  EXPECT_EQ(call(), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(),
            "hits[1].primitive_id is 2, expected below the 2 triangles of geometry 0");
  hits[1].geometry_id = 1;
  EXPECT_EQ(call(), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(),
            "hits[1].geometry_id is 1, expected the number of a triangle mesh of the scene");
  hits[1].instance_id = 3;
  EXPECT_EQ(call(), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "hits[1].instance_id is 3, expected a hit outside of instances");
  EXPECT_EQ(kiwami_hit_points(make_scene(device).get(), hits, 0, 2, points, 0, nullptr, 0),
            KIWAMI_ERROR_INVALID_STATE);
  EXPECT_EQ(kiwami_offset_origins(scene.get(), hits, 0, nullptr, 0, 2, points, 0),
            KIWAMI_ERROR_INVALID_ARGUMENT);
}

/// A square with attributes of two channels.
class Interpolate : public testing::Test {
 protected:
  kiwami_interpolation desc() {
    kiwami_interpolation desc;
    kiwami_interpolation_init(&desc, sizeof desc);
    desc.channels = 2;
    desc.attributes = attributes_;
    desc.attribute_count = 4;
    desc.primitive_id = {&hits_[0].primitive_id, sizeof(kiwami_hit)};
    desc.u = {&hits_[0].u, sizeof(kiwami_hit)};
    desc.v = {&hits_[0].v, sizeof(kiwami_hit)};
    desc.values = values_;
    return desc;
  }

  void expect_refused(const kiwami_interpolation& desc, const char* sentence) {
    EXPECT_EQ(kiwami_interpolate(mesh_.get(), &desc, 3), KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_STREQ(last_error().c_str(), sentence);
  }

  const Device device_ = make_device();
  const Triangles triangles_ = square(0);
  const Geometry mesh_ = make_mesh(device_, triangles_.desc());
  float attributes_[8] = {0.1f, 10, 0.7f, 20, 0.3f, 40, 0.9f, 80};
  kiwami_hit hits_[3] = {kiwami_tests::missing_hit(), kiwami_tests::missing_hit(),
                         kiwami_tests::missing_hit()};
  float values_[6] = {9, 9, 9, 9, 9, 9};

  void SetUp() override {
    hits_[0].primitive_id = 0;
    hits_[2].primitive_id = 1;
    hits_[0].geometry_id = hits_[2].geometry_id = 0;
    hits_[0].u = 0.25f;
    hits_[0].v = 0.375f;
    hits_[2].u = 0.1f;
    hits_[2].v = 0.2f;
  }
};

TEST_F(Interpolate, FollowsItsFormulaToTheBitWithDerivatives) {
  float by_u[9], by_v[6];
  kiwami_interpolation all = desc();
  all.derivatives_u = by_u;
  all.derivative_u_stride = 12;
  all.derivatives_v = by_v;
  ASSERT_EQ(kiwami_interpolate(mesh_.get(), &all, 3), KIWAMI_OK) << last_error();
  for (const int i : {0, 2}) {
    const uint32_t* index = &triangles_.indices[3 * hits_[i].primitive_id];
    for (int channel = 0; channel < 2; ++channel) {
      const float a = attributes_[2 * index[0] + channel];
      const float b = attributes_[2 * index[1] + channel];
      const float c = attributes_[2 * index[2] + channel];
      const float u = hits_[i].u, v = hits_[i].v;
      const float w = (1.0f - u) - v;
      const float first = w * a, second = u * b, third = v * c;
      EXPECT_EQ(values_[2 * i + channel], (first + second) + third);
      EXPECT_EQ(by_u[3 * i + channel], b - a);
      EXPECT_EQ(by_v[2 * i + channel], c - a);
    }
  }
  EXPECT_EQ(values_[2], 0.0f);
  EXPECT_EQ(values_[3], 0.0f);
}

TEST_F(Interpolate, TakesAnIndexBufferOfItsOwnAndAnyAddress) {
  unsigned char bytes[1 + 4 * 11];
  for (int i = 0; i < 4; ++i) std::memcpy(bytes + 1 + 11 * i, &attributes_[2 * i], 8);
  const uint32_t indices[6] = {3, 3, 3, 1, 1, 1};
  kiwami_interpolation own = desc();
  own.attributes = bytes;
  own.attribute_offset = 1;
  own.attribute_stride = 11;
  own.indices = indices;
  ASSERT_EQ(kiwami_interpolate(mesh_.get(), &own, 3), KIWAMI_OK) << last_error();
  EXPECT_EQ(values_[1], 80.0f);
  EXPECT_EQ(values_[5], 20.0f);
}

TEST_F(Interpolate, LeavesElementsOfOtherMeshesAlone) {
  kiwami_interpolation some = desc();
  hits_[2].geometry_id = 5;
  some.geometry_id = {&hits_[0].geometry_id, sizeof(kiwami_hit)};
  some.geometry = 5;
  ASSERT_EQ(kiwami_interpolate(mesh_.get(), &some, 3), KIWAMI_OK);
  EXPECT_EQ(values_[0], 9.0f);
  EXPECT_EQ(values_[2], 9.0f);
  EXPECT_NE(values_[4], 9.0f);
}

TEST_F(Interpolate, GivesTheSameInLargeBatches) {
  const size_t count = 50000;
  std::vector<kiwami_hit> hits(count, hits_[0]);
  Random random(kiwami_tests::seed(), 44);
  for (kiwami_hit& hit : hits) {
    hit.primitive_id = random.below(2);
    choose_weights(random, hit.u, hit.v);
  }
  std::vector<float> values(2 * count);
  kiwami_interpolation all = desc();
  all.primitive_id = {&hits[0].primitive_id, sizeof(kiwami_hit)};
  all.u = {&hits[0].u, sizeof(kiwami_hit)};
  all.v = {&hits[0].v, sizeof(kiwami_hit)};
  all.values = values.data();
  ASSERT_EQ(kiwami_interpolate(mesh_.get(), &all, count), KIWAMI_OK);
  for (const size_t i : {size_t{0}, size_t{4096}, count - 1}) {
    kiwami_interpolation one = all;
    one.primitive_id.data = &hits[i].primitive_id;
    one.u.data = &hits[i].u;
    one.v.data = &hits[i].v;
    one.values = values_;
    ASSERT_EQ(kiwami_interpolate(mesh_.get(), &one, 1), KIWAMI_OK);
    EXPECT_EQ(std::memcmp(values_, &values[2 * i], 8), 0);
  }
}

TEST_F(Interpolate, BadArgumentsAreNamed) {
  EXPECT_EQ(kiwami_interpolation_init(nullptr, 8), KIWAMI_ERROR_INVALID_ARGUMENT);
  kiwami_interpolation bad = desc();
  EXPECT_EQ(kiwami_interpolate(nullptr, &bad, 3), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_interpolate(mesh_.get(), nullptr, 3), KIWAMI_ERROR_INVALID_ARGUMENT);
  bad.channels = 0;
  expect_refused(bad, "interpolation.channels is 0, expected 1 to 1024");
  bad = desc();
  bad.attribute_count = 3;
  expect_refused(bad,
                 "corner 2 of triangle 1 has attribute 3, expected below the attribute_count of 3");
  bad = desc();
  bad.value_stride = 7;
  expect_refused(bad, "the stride of interpolation.values is 7, expected at least 8, or 0 for 8");
  bad = desc();
  bad.u.data = nullptr;
  expect_refused(bad, "interpolation.u.data is NULL, expected a valid pointer");
  bad = desc();
  hits_[2].primitive_id = 2;
  expect_refused(bad, "element 2 of primitive_id is 2, expected below the 2 triangles of the mesh");
  EXPECT_EQ(kiwami_interpolate(mesh_.get(), &bad, 0), KIWAMI_OK);
}

}  // namespace
}  // namespace kiwami_api_tests

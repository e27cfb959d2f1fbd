// SPDX-License-Identifier: Apache-2.0
// User geometries: cubes that callbacks bound and intersect.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <set>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

/// Cubes of edge 1, whose lower corners have whole coordinates. A ray along an axis meets each
/// twice, through its faces.
struct Cubes {
  std::vector<std::array<float, 3>> corners;
  int32_t bounds_result = 0;
  int32_t intersect_result = 0;
  uint32_t failing_primitive = ~0u;  ///< alone has intersect_result
  std::atomic<size_t> bounds_calls{0}, intersect_calls{0}, destroy_calls{0};
  std::atomic<size_t> bounded{0};
  std::mutex mutex;
  std::set<uint32_t> geometry_ids;

  kiwami_user_geometry_desc desc() {
    kiwami_user_geometry_desc desc;
    EXPECT_EQ(kiwami_user_geometry_desc_init(&desc, sizeof desc), KIWAMI_OK);
    desc.count = corners.size();
    desc.bounds = bounds;
    desc.intersect = intersect;
    desc.destroy = destroy;
    desc.user = this;
    return desc;
  }

  static int32_t bounds(void* user, uint32_t first, uint32_t count, float* out) {
    Cubes& cubes = *static_cast<Cubes*>(user);
    ++cubes.bounds_calls;
    cubes.bounded += count;
    for (uint32_t i = 0; i < count; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        out[6 * i + axis] = cubes.corners[first + i][axis];
        out[6 * i + 3 + axis] = cubes.corners[first + i][axis] + 1.0f;
      }
    }
    return cubes.bounds_result;
  }

  void cross(const kiwami_ray& ray, uint32_t id, kiwami_user_intersection& call) {
    const float origin[3] = {ray.origin_x, ray.origin_y, ray.origin_z};
    const float direction[3] = {ray.direction_x, ray.direction_y, ray.direction_z};
    float near = -kInfinity, far = kInfinity;
    int near_axis = 0, far_axis = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float low = corners[id][axis] - origin[axis];
      if (direction[axis] == 0.0f) {
        if (low > 0.0f || low + 1.0f < 0.0f) return;
        continue;
      }
      const float a = low / direction[axis], b = (low + 1.0f) / direction[axis];
      if (std::min(a, b) > near) near = std::min(a, b), near_axis = axis;
      if (std::max(a, b) < far) far = std::max(a, b), far_axis = axis;
    }
    if (!(near < far)) return;
    for (const bool is_entry : {true, false}) {
      kiwami_user_hit& hit = call.hits[call.hit_count++];
      hit = {};
      hit.t = is_entry ? near : far;
      hit.u = is_entry ? 0.25f : 0.75f;
      const int axis = is_entry ? near_axis : far_axis;
      const float outward = (direction[axis] > 0.0f) == is_entry ? -1.0f : 1.0f;
      (axis == 0 ? hit.normal_x : axis == 1 ? hit.normal_y : hit.normal_z) = outward;
      hit.primitive_id = id;
    }
  }

  static int32_t intersect(void* user, kiwami_user_intersection* call) {
    Cubes& cubes = *static_cast<Cubes*>(user);
    ++cubes.intersect_calls;
    {
      const std::lock_guard<std::mutex> lock(cubes.mutex);
      cubes.geometry_ids.insert(call->geometry_id);
    }
    bool fails = false;
    for (uint32_t i = 0; i < call->primitive_count; ++i) {
      const uint32_t id = call->primitive_ids[i];
      fails |= id == cubes.failing_primitive;
      cubes.cross(*call->ray, id, *call);
    }
    return cubes.failing_primitive == ~0u || fails ? cubes.intersect_result : 0;
  }

  static void destroy(void* user) { ++static_cast<Cubes*>(user)->destroy_calls; }
};

/// A row of cubes along z, a gap of 1 between them.
void make_row(Cubes& cubes, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i)
    cubes.corners.push_back({0, 0, 2.0f * static_cast<float>(i)});
}

Geometry make(const Device& device, const kiwami_user_geometry_desc& desc) {
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_user_geometry_create(device.get(), &desc, &geometry), KIWAMI_OK) << last_error();
  return Geometry(geometry);
}

kiwami_ray row_ray() {
  kiwami_ray ray = ray_along_z(0.5f, 0.5f);
  ray.origin_z = -1;
  return ray;
}

uint32_t count_of(const Scene& scene, const kiwami_ray& ray) {
  uint32_t count = ~0u;
  EXPECT_EQ(kiwami_count_hits(scene.get(), &ray, 0, &count, 0, 1, nullptr), KIWAMI_OK);
  return count;
}

TEST(UserGeometry, IsMetByAllQueries) {
  const Device device = make_device();
  Cubes cubes;
  make_row(cubes, 100);
  const Scene scene = make_scene(device, make(device, cubes.desc()));
  EXPECT_EQ(cubes.bounded, 100u);
  kiwami_ray ray = row_ray();
  kiwami_hit hit = closest_hit(scene, ray);
  EXPECT_EQ(hit.t, 1.0f);
  EXPECT_EQ(hit.u, 0.25f);
  EXPECT_EQ(hit.normal_z, -1.0f);
  EXPECT_EQ(hit.primitive_id, 0u);
  EXPECT_EQ(hit.geometry_id, 0u);
  EXPECT_EQ(hit.instance_id, KIWAMI_INVALID_ID);
  EXPECT_EQ(count_of(scene, ray), 200u);
  ray.tmin = 100.5f;
  ray.tmax = 104.5f;
  hit = closest_hit(scene, ray);
  EXPECT_EQ(hit.t, 101.0f);
  EXPECT_EQ(hit.primitive_id, 50u);
  EXPECT_EQ(count_of(scene, ray), 4u);
  uint8_t occluded = 2;
  EXPECT_EQ(kiwami_any_hit(scene.get(), &ray, 0, &occluded, 0, 1, nullptr), KIWAMI_OK);
  EXPECT_EQ(occluded, 1u);
  ray.tmin = 102.5f;
  ray.tmax = 102.75f;
  EXPECT_EQ(count_of(scene, ray), 0u);
  EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK);
}

TEST(UserGeometry, ShowsItsSides) {
  const Device device = make_device();
  Cubes cubes;
  make_row(cubes, 3);
  const Scene scene = make_scene(device, make(device, cubes.desc()));
  kiwami_ray ray = row_ray();
  ray.flags = KIWAMI_RAY_CULL_BACK_FACES;
  EXPECT_EQ(count_of(scene, ray), 3u);
  ray.flags = KIWAMI_RAY_CULL_FRONT_FACES;
  EXPECT_EQ(closest_hit(scene, ray).t, 2.0f);
}

TEST(UserGeometry, StandsBesideOthersOfItsKindAndMasksThem) {
  const Device device = make_device();
  Cubes first, second;
  make_row(first, 9);
  make_row(second, 9);
  for (auto& corner : second.corners) corner[2] += 1.0f;
  kiwami_user_geometry_desc second_desc = second.desc();
  second_desc.mask = 2;
  const Scene scene = make_scene(device);
  const Triangles triangles = square(0.5f);
  for (const Geometry& geometry : {make(device, first.desc()), make_mesh(device, triangles.desc()),
                                   make(device, second_desc)}) {
    ASSERT_EQ(kiwami_scene_attach(scene.get(), geometry.get(), nullptr), KIWAMI_OK);
  }
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  kiwami_ray ray = row_ray();
  EXPECT_EQ(count_of(scene, ray), 37u);
  EXPECT_EQ(first.geometry_ids, std::set<uint32_t>{0});
  EXPECT_EQ(second.geometry_ids, std::set<uint32_t>{2});
  // Faces in one plane: the lower geometry is less.
  ray.tmin = 1.75f;
  EXPECT_EQ(closest_hit(scene, ray).geometry_id, 0u);
  ray.mask = 1;
  EXPECT_EQ(count_of(scene, ray), 17u);
}

TEST(UserGeometry, WhoseBoundsAreNoneIsSkipped) {
  const Device device = make_device();
  Cubes cubes;
  make_row(cubes, 3);
  cubes.corners[0][1] = std::nanf("");
  cubes.corners[2][0] = kInfinity;
  const Scene scene = make_scene(device, make(device, cubes.desc()));
  EXPECT_EQ(closest_hit(scene, row_ray()).primitive_id, 1u);
  EXPECT_EQ(count_of(scene, row_ray()), 2u);
}

TEST(UserGeometry, EndsWithItsLastReference) {
  const Device device = make_device();
  Cubes cubes;
  make_row(cubes, 3);
  Geometry geometry = make(device, cubes.desc());
  Scene scene = make_scene(device, geometry);
  geometry.reset();
  EXPECT_EQ(cubes.destroy_calls, 0u);
  scene.reset();
  EXPECT_EQ(cubes.destroy_calls, 1u);
}

TEST(UserGeometry, WhoseBoundsFailLeavesTheSceneAsItWas) {
  const Device device = make_device();
  Cubes cubes;
  make_row(cubes, 3);
  const Scene scene = make_scene(device, make(device, cubes.desc()));
  cubes.bounds_result = -7;
  EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_ERROR_CALLBACK);
  EXPECT_NE(last_error().find("returned -7"), std::string::npos) << last_error();
  EXPECT_EQ(count_of(scene, row_ray()), 6u);
  cubes.bounds_result = 1;
  EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
}

TEST(UserGeometry, WhoseIntersectionFailsFailsTheCallAndNoOtherRay) {
  const Device device = make_device();
  Cubes cubes;
  for (int i = 0; i < 64; ++i) cubes.corners.push_back({10.0f * static_cast<float>(i), 0, 0});
  const Scene scene = make_scene(device, make(device, cubes.desc()));
  cubes.intersect_result = -1;
  cubes.failing_primitive = 63;
  std::vector<kiwami_ray> rays;
  for (int i = 0; i < 64; ++i) {
    kiwami_ray ray = row_ray();
    ray.origin_x = 10.0f * static_cast<float>(i) + 0.5f;
    rays.push_back(ray);
  }
  std::vector<kiwami_hit> hits(rays.size());
  EXPECT_EQ(kiwami_closest_hit(scene.get(), rays.data(), 0, hits.data(), 0, rays.size(), nullptr),
            KIWAMI_ERROR_CALLBACK);
  EXPECT_NE(last_error().find("callback"), std::string::npos) << last_error();
  for (uint32_t i = 0; i < 40; ++i) EXPECT_EQ(hits[i].primitive_id, i);
  std::vector<uint8_t> any(rays.size());
  EXPECT_EQ(kiwami_any_hit(scene.get(), rays.data(), 0, any.data(), 0, rays.size(), nullptr),
            KIWAMI_ERROR_CALLBACK);
  std::vector<uint32_t> counts(rays.size());
  EXPECT_EQ(kiwami_count_hits(scene.get(), rays.data(), 0, counts.data(), 0, rays.size(), nullptr),
            KIWAMI_ERROR_CALLBACK);
  // Those that do not come near it.
  EXPECT_EQ(kiwami_any_hit(scene.get(), rays.data(), 0, any.data(), 0, 40, nullptr), KIWAMI_OK);
  cubes.intersect_result = 0;
  EXPECT_EQ(count_of(scene, rays[63]), 2u);
}

TEST(UserGeometry, IsAskedFromSeveralThreads) {
  kiwami_device_desc desc = default_device();
  desc.thread_count = 2;
  const Device device = make_device(desc);
  Cubes cubes;
  for (int i = 0; i < 20000; ++i) {
    cubes.corners.push_back({static_cast<float>(i % 200) * 2, static_cast<float>(i / 200) * 2, 0});
  }
  const Scene scene = make_scene(device, make(device, cubes.desc()));
  EXPECT_EQ(cubes.bounded, 20000u);
  EXPECT_GT(cubes.bounds_calls, 20000u / 256);
  std::vector<kiwami_ray> rays;
  for (int i = 0; i < 20000; ++i) {
    kiwami_ray ray = row_ray();
    ray.origin_x = cubes.corners[static_cast<size_t>(i)][0] + 0.5f;
    ray.origin_y = cubes.corners[static_cast<size_t>(i)][1] + 0.5f;
    rays.push_back(ray);
  }
  const std::vector<kiwami_hit> hits = closest_hits(scene, rays);
  for (uint32_t i = 0; i < hits.size(); ++i) ASSERT_EQ(hits[i].primitive_id, i);
}

class UserGeometryErrors : public testing::Test {
 protected:
  void expect(kiwami_result result, const std::string& part) {
    kiwami_geometry* geometry = reinterpret_cast<kiwami_geometry*>(this);
    EXPECT_EQ(kiwami_user_geometry_create(device_.get(), &desc_, &geometry), result);
    EXPECT_EQ(geometry, nullptr);
    EXPECT_NE(last_error().find(part), std::string::npos) << last_error();
    EXPECT_EQ(cubes_.destroy_calls, 0u);
    desc_ = cubes_.desc();
  }

  Device device_ = make_device();
  Cubes cubes_;
  kiwami_user_geometry_desc desc_ = cubes_.desc();
};

TEST_F(UserGeometryErrors, NameTheField) {
  desc_.flags = 1;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x1");
  desc_.reserved = 2;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.reserved is 2");
  desc_.bounds = nullptr;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.bounds is NULL");
  desc_.intersect = nullptr;
  expect(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.intersect is NULL");
  desc_.count = uint64_t{1} << 31;
  expect(KIWAMI_ERROR_TOO_LARGE, "desc.count is 2147483648");
}

}  // namespace
}  // namespace kiwami_api_tests

// SPDX-License-Identifier: Apache-2.0
// Scenes: numbers of geometries, parameters, commits that fail, what info says.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

uint32_t attach(const Scene& scene, const Geometry& geometry) {
  uint32_t id = KIWAMI_INVALID_ID;
  EXPECT_EQ(kiwami_scene_attach(scene.get(), geometry.get(), &id), KIWAMI_OK) << last_error();
  return id;
}

void detach(const Scene& scene, uint32_t id) {
  EXPECT_EQ(kiwami_scene_detach(scene.get(), id), KIWAMI_OK) << last_error();
}

void commit(const Scene& scene) {
  EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
}

class SceneTest : public testing::Test {
 protected:
  Geometry square_at(float z) { return make_mesh(device_, square(z).desc()); }

  Device device_ = make_device();
  Scene scene_ = make_scene(device_);
  const kiwami_ray ray_ = ray_along_z(0.5f, 0.25f);
};

TEST_F(SceneTest, GeometriesGetTheLowestFreeNumber) {
  const Geometry mesh = square_at(1);
  for (uint32_t id = 0; id < 40; ++id) EXPECT_EQ(attach(scene_, mesh), id);
  detach(scene_, 17);
  detach(scene_, 3);
  detach(scene_, 39);
  EXPECT_EQ(attach(scene_, mesh), 3u);
  EXPECT_EQ(attach(scene_, mesh), 17u);
  EXPECT_EQ(attach(scene_, mesh), 39u);
  EXPECT_EQ(attach(scene_, mesh), 40u);
}

TEST_F(SceneTest, HitsReportTheGeometryAndTheNearestOne) {
  attach(scene_, square_at(9));
  const uint32_t near_id = attach(scene_, square_at(2));
  attach(scene_, square_at(5));
  commit(scene_);
  const kiwami_hit hit = closest_hit(scene_, ray_);
  EXPECT_EQ(hit.t, 2.0f);
  EXPECT_EQ(hit.geometry_id, near_id);
  EXPECT_EQ(hit.instance_id, KIWAMI_INVALID_ID);
}

TEST_F(SceneTest, OfEqualDistancesTheLowestNumberWins) {
  const Geometry mesh = square_at(2);
  for (int i = 0; i < 20; ++i) attach(scene_, mesh);
  detach(scene_, 0);
  detach(scene_, 1);
  commit(scene_);
  EXPECT_EQ(closest_hit(scene_, ray_).geometry_id, 2u);
}

TEST_F(SceneTest, ADetachedGeometryIsHitUntilTheNextCommit) {
  Geometry mesh = square_at(2);
  const uint32_t id = attach(scene_, mesh);
  commit(scene_);
  mesh.reset();
  detach(scene_, id);
  EXPECT_EQ(closest_hit(scene_, ray_).geometry_id, id);
  attach(scene_, square_at(7));
  EXPECT_EQ(closest_hit(scene_, ray_).t, 2.0f);
  EXPECT_EQ(kiwami_scene_validate(scene_.get()), KIWAMI_OK) << last_error();
  commit(scene_);
  EXPECT_EQ(closest_hit(scene_, ray_).t, 7.0f);
}

TEST_F(SceneTest, AnEmptySceneIsAllMisses) {
  commit(scene_);
  EXPECT_EQ(closest_hit(scene_, ray_).t, kInfinity);
  EXPECT_EQ(kiwami_scene_validate(scene_.get()), KIWAMI_OK) << last_error();
  const kiwami_scene_info info = info_of(scene_);
  EXPECT_EQ(info.triangle_count, 0u);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(info.bounds_min[axis], kInfinity);
    EXPECT_EQ(info.bounds_max[axis], -kInfinity);
  }
}

TEST_F(SceneTest, AFailedCommitLeavesTheLastOneInUse) {
  Triangles triangles = square(3);
  kiwami_triangle_mesh_desc desc = triangles.desc();
  desc.flags = KIWAMI_MESH_SHARE_BUFFERS;
  attach(scene_, make_mesh(device_, desc));
  attach(scene_, square_at(1));
  commit(scene_);
  triangles.indices[3] = 1000;
  EXPECT_EQ(kiwami_scene_commit(scene_.get()), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()),
            "index 0 of triangle 1 of geometry 0 is 1000, expected less than its vertex count, "
            "which is 4");
  EXPECT_EQ(closest_hit(scene_, ray_).t, 1.0f);
  triangles.indices[3] = 0;
  detach(scene_, 1);
  commit(scene_);
  EXPECT_EQ(closest_hit(scene_, ray_).t, 3.0f);
}

TEST_F(SceneTest, InfoDescribesTheStructure) {
  const uint32_t count = 20000;
  const Triangles triangles = random_triangles(count, 5);
  attach(scene_, make_mesh(device_, triangles.desc()));
  for (double width : {4, 8, 16}) {
    kiwami_scene_set_parameter(scene_.get(), KIWAMI_PARAMETER_BVH_WIDTH, width);
    kiwami_scene_set_parameter(scene_.get(), KIWAMI_PARAMETER_VALIDATE_BUILD, 1);
    commit(scene_);
    const kiwami_scene_info info = info_of(scene_);
    EXPECT_EQ(info.bvh_width, width);
    EXPECT_EQ(info.triangle_count, count);
    EXPECT_GE(info.leaf_block_count * info.leaf_width, count);
    EXPECT_GT(info.bvh_depth, 1u);
    EXPECT_GT(info.node_fill, 0.5);
    EXPECT_LE(info.node_fill, 1.0);
    EXPECT_LE(info.leaf_fill, 1.0);
    EXPECT_DOUBLE_EQ(info.leaf_fill,
                     double(count) / (double(info.leaf_block_count) * info.leaf_width));
    EXPECT_GE(info.total_bytes, info.node_bytes + info.leaf_bytes + 48 * uint64_t{count});
    EXPECT_GE(info.peak_build_bytes, info.total_bytes);
    EXPECT_GT(info.sah_cost, 0.0);
    EXPECT_GT(info.build_seconds, 0.0);
    EXPECT_GE(info.bounds_min[0], -1.2f);
    EXPECT_LT(info.bounds_min[0], -0.9f);
  }
}

TEST_F(SceneTest, SharedBuffersAreNotCountedAndCopiesCountOnce) {
  const Triangles triangles = random_triangles(1000, 6);
  const Geometry copied = make_mesh(device_, triangles.desc());
  attach(scene_, copied);
  attach(scene_, copied);
  commit(scene_);
  kiwami_triangle_mesh_desc desc = triangles.desc();
  desc.flags = KIWAMI_MESH_SHARE_BUFFERS;
  const Geometry shared = make_mesh(device_, desc);
  const Scene other = make_scene(device_);
  attach(other, shared);
  attach(other, shared);
  commit(other);
  EXPECT_EQ(info_of(scene_).total_bytes - info_of(other).total_bytes,
            4 * (triangles.vertices.size() + triangles.indices.size()));
}

/// The numbers of KIWAMI_PARAMETER_*, which have gaps.
std::vector<uint32_t> parameter_numbers() {
  std::vector<uint32_t> numbers;
  for (uint32_t number = 0; number < 256; ++number) {
    if (kiwami_parameter_bounds(number, nullptr, nullptr, nullptr) == KIWAMI_OK) {
      numbers.push_back(number);
    }
  }
  return numbers;
}

TEST_F(SceneTest, ParametersHaveBoundsAndDefaults) {
  EXPECT_GE(parameter_numbers().size(), 10u);
  for (const uint32_t parameter : parameter_numbers()) {
    double lowest, highest, preset;
    ASSERT_EQ(kiwami_parameter_bounds(parameter, &lowest, &highest, &preset), KIWAMI_OK);
    ASSERT_EQ(kiwami_parameter_bounds(parameter, nullptr, nullptr, nullptr), KIWAMI_OK);
    EXPECT_LE(lowest, preset);
    EXPECT_LE(preset, highest);
    for (double value : {lowest, highest, preset}) {
      EXPECT_EQ(kiwami_scene_set_parameter(scene_.get(), parameter, value), KIWAMI_OK);
    }
    for (double value : {lowest - 1, highest + 1, double(kInfinity), double(NAN)}) {
      EXPECT_EQ(kiwami_scene_set_parameter(scene_.get(), parameter, value),
                KIWAMI_ERROR_INVALID_ARGUMENT)
          << parameter << " " << value;
    }
  }
  EXPECT_EQ(kiwami_parameter_bounds(0, nullptr, nullptr, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_parameter_bounds(255, nullptr, nullptr, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "parameter is 255, expected one of KIWAMI_PARAMETER_*");
}

TEST_F(SceneTest, ParameterErrorsNameTheValue) {
  const auto expect = [&](uint32_t parameter, double value, const char* sentence) {
    EXPECT_EQ(kiwami_scene_set_parameter(scene_.get(), parameter, value),
              KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(last_error(device_.get()), sentence);
  };
  expect(KIWAMI_PARAMETER_BVH_WIDTH, 5,
         "value is 5 for KIWAMI_PARAMETER_BVH_WIDTH, expected 0, 4, 8 or 16");
  expect(KIWAMI_PARAMETER_MERGE_RING, 2.5,
         "value is 2.5 for parameter 3, expected a whole number from 1 to 64");
  expect(KIWAMI_PARAMETER_NODE_COST, 0, "value is 0 for parameter 6, expected 0.01 to 100");
  expect(77, 0, "parameter is 77, expected one of KIWAMI_PARAMETER_*");
  EXPECT_EQ(kiwami_scene_set_parameter(nullptr, 1, 4), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "scene is NULL, expected a valid pointer");
}

TEST_F(SceneTest, EveryBoundOfEveryParameterBuildsTheSameAnswers) {
  const Triangles triangles = random_triangles(300, 8);
  const std::vector<kiwami_ray> rays = random_rays(500, 9);
  const Geometry mesh = make_mesh(device_, triangles.desc());
  const std::vector<kiwami_hit> expected = closest_hits(make_scene(device_, mesh), rays);
  for (const uint32_t parameter : parameter_numbers()) {
    double bounds[2];
    kiwami_parameter_bounds(parameter, &bounds[0], &bounds[1], nullptr);
    for (double value : bounds) {
      const Scene scene = make_scene(device_);
      attach(scene, mesh);
      kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_VALIDATE_BUILD, 1);
      kiwami_scene_set_parameter(scene.get(), parameter, value);
      commit(scene);
      EXPECT_TRUE(are_equal(closest_hits(scene, rays), expected)) << parameter << " " << value;
    }
  }
}

TEST_F(SceneTest, NullAndForeignArguments) {
  const Geometry mesh = square_at(1);
  kiwami_scene* made = nullptr;
  EXPECT_EQ(kiwami_scene_create(nullptr, &made), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "device is NULL, expected a valid pointer");
  EXPECT_EQ(kiwami_scene_create(device_.get(), nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "scene is NULL, expected a valid pointer");
  EXPECT_EQ(kiwami_scene_attach(nullptr, mesh.get(), nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "scene is NULL, expected a valid pointer");
  EXPECT_EQ(kiwami_scene_attach(scene_.get(), nullptr, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "geometry is NULL, expected a valid pointer");
  EXPECT_EQ(kiwami_scene_detach(nullptr, 0), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "scene is NULL, expected a valid pointer");
  EXPECT_EQ(kiwami_scene_commit(nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_scene_validate(nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  kiwami_scene_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(kiwami_scene_get_info(nullptr, &info), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_scene_get_info(scene_.get(), nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "info is NULL, expected a valid pointer");
  kiwami_scene_retain(nullptr);
  kiwami_scene_release(nullptr);

  const Device other = make_device();
  const Scene foreign = make_scene(other);
  EXPECT_EQ(kiwami_scene_attach(foreign.get(), mesh.get(), nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(other.get()),
            "geometry is of another device, expected one of the scene's device");
}

TEST_F(SceneTest, NothingIsKnownBeforeTheFirstCommit) {
  kiwami_scene_info info{};
  info.struct_size = sizeof info;
  const std::string sentence =
      "scene was never committed, expected a successful kiwami_scene_commit before";
  EXPECT_EQ(kiwami_scene_get_info(scene_.get(), &info), KIWAMI_ERROR_INVALID_STATE);
  EXPECT_EQ(last_error(device_.get()), sentence);
  EXPECT_EQ(kiwami_scene_validate(scene_.get()), KIWAMI_ERROR_INVALID_STATE);
  EXPECT_EQ(last_error(device_.get()), sentence);
}

TEST_F(SceneTest, HandlesMayGoInAnyOrder) {
  Geometry mesh = square_at(2);
  attach(scene_, mesh);
  mesh.reset();
  device_.reset();
  commit(scene_);
  EXPECT_EQ(closest_hit(scene_, ray_).t, 2.0f);
}

}  // namespace
}  // namespace kiwami_api_tests

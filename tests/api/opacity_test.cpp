// SPDX-License-Identifier: Apache-2.0
// Opacity micromaps of meshes: when scenes see them, and what is refused.
#include <gtest/gtest.h>

#include <array>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

class OpacityApi : public testing::Test {
 protected:
  kiwami_opacity_desc desc() const {
    kiwami_opacity_desc desc;
    kiwami_opacity_desc_init(&desc, sizeof desc);
    desc.maps = maps_.data();
    desc.map_count = maps_.size();
    return desc;
  }
  void expect_refused(const kiwami_opacity_desc& desc, const char* sentence) {
    EXPECT_EQ(kiwami_triangle_mesh_set_opacity(mesh_.get(), &desc), KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_STREQ(last_error().c_str(), sentence);
  }
  bool is_hit(const Scene& scene) const {
    return closest_hit(scene, ray_along_z(0.5f, -0.25f)).primitive_id != KIWAMI_INVALID_ID;
  }

  std::array<unsigned char, 2> maps_ = {0, 0};  ///< transparent, of level 0
  const Device device_ = make_device();
  const Triangles triangles_ = square(1);
  const Geometry mesh_ = make_mesh(device_, triangles_.desc());
};

TEST_F(OpacityApi, IsSeenFromTheNextCommitOn) {
  const Scene scene = make_scene(device_, mesh_);
  EXPECT_TRUE(is_hit(scene));
  const kiwami_opacity_desc transparent = desc();
  ASSERT_EQ(kiwami_triangle_mesh_set_opacity(mesh_.get(), &transparent), KIWAMI_OK);
  EXPECT_TRUE(is_hit(scene));
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_FALSE(is_hit(scene));
  maps_ = {1, 1};  // copies were made
  EXPECT_FALSE(is_hit(scene));
  ASSERT_EQ(kiwami_triangle_mesh_set_opacity(mesh_.get(), nullptr), KIWAMI_OK);
  EXPECT_FALSE(is_hit(scene));
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_TRUE(is_hit(scene));
}

TEST_F(OpacityApi, IsSeenFromTheNextRefitOn) {
  const Scene scene = make_scene(device_, mesh_);
  // Refits by turns use the memory of the last one but one.
  for (int i = 0; i < 4; ++i) {
    const kiwami_opacity_desc transparent = desc();
    ASSERT_EQ(kiwami_triangle_mesh_set_opacity(mesh_.get(), i % 4 < 2 ? &transparent : nullptr),
              KIWAMI_OK);
    for (int repeat = 0; repeat < 3; ++repeat) {
      ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
      EXPECT_EQ(is_hit(scene), i % 4 >= 2);
    }
  }
  EXPECT_EQ(info_of(scene).refit_count, 12u);
}

TEST_F(OpacityApi, BadArgumentsAreNamed) {
  EXPECT_EQ(kiwami_opacity_desc_init(nullptr, 64), KIWAMI_ERROR_INVALID_ARGUMENT);
  kiwami_opacity_desc bad = desc();
  EXPECT_EQ(kiwami_triangle_mesh_set_opacity(nullptr, &bad), KIWAMI_ERROR_INVALID_ARGUMENT);
  bad.format = 3;
  expect_refused(bad,
                 "desc.format is 3, expected KIWAMI_OPACITY_2_STATES or KIWAMI_OPACITY_4_STATES");
  bad = desc();
  bad.level = 7;
  expect_refused(bad, "desc.level is 7, expected at most 6");
  bad = desc();
  bad.map_count = 1;
  expect_refused(bad,
                 "desc.map_count is 1 and desc.indices is NULL, expected a map for each of the 2 "
                 "triangles");
  bad = desc();
  bad.maps = nullptr;
  expect_refused(bad, "desc.maps is NULL, expected a valid pointer");
  bad = desc();
  bad.level = 3;
  bad.map_stride = 7;
  expect_refused(bad, "the stride of desc.maps is 7, expected at least 8, or 0 for 8");
  bad = desc();
  const uint32_t indices[2] = {KIWAMI_OPACITY_ALL_OPAQUE, 2};
  bad.indices = indices;
  expect_refused(bad,
                 "index 1 of desc.indices is 2, expected below the map_count of 2, or one of "
                 "KIWAMI_OPACITY_ALL_*");
  bad.map_count = 0;
  bad.maps = nullptr;
  const uint32_t whole[2] = {KIWAMI_OPACITY_ALL_OPAQUE, KIWAMI_OPACITY_ALL_TRANSPARENT};
  bad.indices = whole;
  EXPECT_EQ(kiwami_triangle_mesh_set_opacity(mesh_.get(), &bad), KIWAMI_OK);
  bad.map_count = uint64_t{1} << 32;
  bad.maps = &bad;
  bad.map_stride = 1;
  EXPECT_EQ(kiwami_triangle_mesh_set_opacity(mesh_.get(), &bad), KIWAMI_ERROR_TOO_LARGE);
}

TEST_F(OpacityApi, EveryFailedAllocationLeavesTheMeshAsItWas) {
  CountingAllocator allocator;
  kiwami_device_desc device_desc = default_device();
  allocator.install(device_desc);
  {
    const Device device = make_device(device_desc);
    const Geometry mesh = make_mesh(device, triangles_.desc());
    const kiwami_opacity_desc transparent = desc();
    const size_t live = allocator.live_bytes;
    for (size_t later = 0;; ++later) {
      allocator.first_failure = allocator.calls + later;
      const kiwami_result result = kiwami_triangle_mesh_set_opacity(mesh.get(), &transparent);
      if (result == KIWAMI_OK) break;
      ASSERT_EQ(result, KIWAMI_ERROR_OUT_OF_MEMORY);
      ASSERT_EQ(allocator.live_bytes, live);
    }
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
}

}  // namespace
}  // namespace kiwami_api_tests

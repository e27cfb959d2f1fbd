// SPDX-License-Identifier: Apache-2.0
// Structs of older and newer callers: struct_size smaller and larger than the library's own.
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

/// A struct with room behind it, as a newer version of the header would have it.
template <typename Struct>
struct Grown {
  Struct known;
  uint64_t future[2];
};

template <typename Struct>
void expect_init(kiwami_result (*init)(Struct*, size_t), size_t minimum) {
  Grown<Struct> grown;
  std::memset(static_cast<void*>(&grown), 0xAB, sizeof grown);
  ASSERT_EQ(init(&grown.known, sizeof grown), KIWAMI_OK) << last_error();
  EXPECT_EQ(grown.known.struct_size, sizeof grown);
  EXPECT_EQ(grown.future[0], 0u);
  EXPECT_EQ(grown.future[1], 0u);

  std::memset(static_cast<void*>(&grown), 0xAB, sizeof grown);
  ASSERT_EQ(init(&grown.known, minimum), KIWAMI_OK) << last_error();
  EXPECT_EQ(grown.known.struct_size, minimum);
  const unsigned char* bytes = reinterpret_cast<const unsigned char*>(&grown);
  EXPECT_EQ(bytes[minimum], 0xAB) << "a byte beyond the caller's struct was written";

  EXPECT_EQ(init(&grown.known, minimum - 1), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("size is " + std::to_string(minimum - 1)), std::string::npos);
  EXPECT_EQ(init(nullptr, sizeof(Struct)), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("is NULL"), std::string::npos);
}

TEST(Descriptor, InitFillsWhatTheCallerHas) {
  expect_init(kiwami_device_desc_init, 16);
  expect_init(kiwami_triangle_mesh_desc_init, 8);
  expect_init(kiwami_spheres_desc_init, 8);
  expect_init(kiwami_discs_desc_init, 8);
  expect_init(kiwami_curves_desc_init, 8);
  expect_init(kiwami_user_geometry_desc_init, 8);
  expect_init(kiwami_moving_mesh_desc_init, 8);
  expect_init(kiwami_moving_instances_desc_init, 8);
  expect_init(kiwami_ray_fields_init, 8);
  expect_init(kiwami_hit_fields_init, 8);
  expect_init(kiwami_query_init, 8);
}

TEST(Descriptor, AnOlderAndShorterOneHasDefaultsForTheRest) {
  kiwami_device_desc desc = default_device();
  desc.isa = KIWAMI_ISA_SCALAR;
  std::memset(static_cast<void*>(&desc.runner), 0xAB, sizeof desc - 16);  // not the caller's
  desc.struct_size = 16;
  const Device device = make_device(desc);
  kiwami_device_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(kiwami_device_get_info(device.get(), &info), KIWAMI_OK);
  EXPECT_EQ(info.isa, uint32_t{KIWAMI_ISA_SCALAR});
}

TEST(Descriptor, ANewerOneMayHoldOnlyZerosBeyond) {
  Grown<kiwami_device_desc> grown;
  ASSERT_EQ(kiwami_device_desc_init(&grown.known, sizeof grown), KIWAMI_OK);
  kiwami_device* device = nullptr;
  ASSERT_EQ(kiwami_device_create(&grown.known, &device), KIWAMI_OK) << last_error();
  kiwami_device_release(device);

  grown.future[1] = 5;
  EXPECT_EQ(kiwami_device_create(&grown.known, &device), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(device, nullptr);
  EXPECT_EQ(last_error(), "desc has a value at byte " +
                              std::to_string(sizeof(kiwami_device_desc) + 8) +
                              ", where this library knows no field, expected 0");
}

TEST(Descriptor, ASizeThatNoVersionHasIsAnError) {
  kiwami_device* device = nullptr;
  for (uint32_t size : {0u, 8u, 12u, 20u, 65544u, 0xABABABA8u}) {
    kiwami_device_desc desc = default_device();
    desc.struct_size = size;
    EXPECT_EQ(kiwami_device_create(&desc, &device), KIWAMI_ERROR_INVALID_ARGUMENT) << size;
    EXPECT_EQ(last_error(), "desc.struct_size is " + std::to_string(size) +
                                ", expected a multiple of 8 from 16 to 65536");
  }
}

TEST(Descriptor, AMeshFollowsTheSameRule) {
  const Device device = make_device();
  const Triangles triangles = square(1);
  Grown<kiwami_triangle_mesh_desc> grown{};
  grown.known = triangles.desc();
  grown.known.struct_size = sizeof grown;
  kiwami_geometry* geometry = nullptr;
  ASSERT_EQ(kiwami_triangle_mesh_create(device.get(), &grown.known, &geometry), KIWAMI_OK);
  kiwami_geometry_release(geometry);
  grown.future[0] = uint64_t{1} << 63;
  EXPECT_EQ(kiwami_triangle_mesh_create(device.get(), &grown.known, &geometry),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("at byte 87"), std::string::npos) << last_error();

  // Without its last fields a mesh has a mask of all ones.
  kiwami_triangle_mesh_desc shorter = triangles.desc();
  shorter.struct_size = offsetof(kiwami_triangle_mesh_desc, mask);
  shorter.mask = 0;
  const Scene scene = make_scene(device, make_mesh(device, shorter));
  EXPECT_EQ(closest_hit(scene, ray_along_z(0.5f, 0.25f)).t, 1.0f);
}

TEST(Info, FillsTheFieldsThatFit) {
  const Device device = make_device();
  const Triangles triangles = square(1);
  const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
  std::vector<unsigned char> bytes(sizeof(kiwami_scene_info), 0xAB);
  for (uint32_t size : {8u, 16u, 20u, 24u}) {
    std::fill(bytes.begin(), bytes.end(), 0xAB);
    kiwami_scene_info* info = reinterpret_cast<kiwami_scene_info*>(bytes.data());
    info->struct_size = size;
    ASSERT_EQ(kiwami_scene_get_info(scene.get(), info), KIWAMI_OK) << last_error();
    EXPECT_EQ(info->struct_size, size);
    EXPECT_NE(info->bvh_width, 0xABABABABu);
    for (size_t i = size; i < bytes.size(); ++i) ASSERT_EQ(bytes[i], 0xAB) << size << " " << i;
    if (size == 20) {
      EXPECT_EQ(bytes[16], 0xAB) << "half a field was written";
    }
    if (size == 24) {
      EXPECT_EQ(info->triangle_count, 2u);
    }
  }
}

TEST(Info, RejectsASizeThatIsTooSmall) {
  const Device device = make_device();
  kiwami_device_info info{};
  info.struct_size = 7;
  EXPECT_EQ(kiwami_device_get_info(device.get(), &info), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device.get()), "info.struct_size is 7, expected 8 to 65536");
  EXPECT_EQ(kiwami_device_get_info(device.get(), nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "info is NULL, expected a valid pointer");
  EXPECT_EQ(kiwami_device_get_info(nullptr, &info), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "device is NULL, expected a valid pointer");
}

}  // namespace
}  // namespace kiwami_api_tests

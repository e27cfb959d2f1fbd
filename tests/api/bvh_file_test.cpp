// SPDX-License-Identifier: Apache-2.0
// Trees of kiwami_bvh_build that are saved and come back.
#include <gtest/gtest.h>

#include <cstring>

#include "api/io_support.h"

namespace kiwami_api_tests {
namespace {

/// Boxes of random triangles, the third of them turned inside out.
std::vector<float> random_boxes(uint32_t count) {
  const Triangles triangles = random_triangles(count, 11);
  std::vector<float> boxes;
  for (uint32_t i = 0; i < count; ++i) {
    const float* corner = triangles.vertices.data() + size_t{9} * i;
    for (int axis = 0; axis < 3; ++axis) {
      boxes.push_back(std::min({corner[axis], corner[3 + axis], corner[6 + axis]}));
    }
    for (int axis = 0; axis < 3; ++axis) {
      boxes.push_back(std::max({corner[axis], corner[3 + axis], corner[6 + axis]}));
    }
  }
  if (count > 2) std::swap(boxes[12], boxes[15]);
  return boxes;
}

Bvh build(const Device& device, kiwami_bvh_desc desc) {
  kiwami_bvh* bvh = nullptr;
  EXPECT_EQ(kiwami_bvh_build(device.get(), &desc, &bvh), KIWAMI_OK) << last_error();
  return Bvh(bvh);
}

kiwami_bvh_desc desc_of(const std::vector<float>& boxes, uint32_t width) {
  kiwami_bvh_desc desc;
  EXPECT_EQ(kiwami_bvh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.boxes = boxes.data();
  desc.box_count = boxes.size() / 6;
  desc.width = width;
  return desc;
}

template <typename T>
bool equal_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same_tree(const Bvh& a, const Bvh& b) {
  EXPECT_TRUE(equal_bytes(nodes_of(a), nodes_of(b)));
  EXPECT_TRUE(equal_bytes(primitives_of(a), primitives_of(b)));
  const kiwami_bvh_info x = info_of(a), y = info_of(b);
  EXPECT_EQ(x.width, y.width);
  EXPECT_EQ(x.leaf_width, y.leaf_width);
  EXPECT_EQ(x.depth, y.depth);
  EXPECT_EQ(x.leaf_count, y.leaf_count);
  EXPECT_EQ(x.skipped_count, y.skipped_count);
  EXPECT_EQ(x.build_seconds, y.build_seconds);
  EXPECT_EQ(kiwami_bvh_validate(b.get()), KIWAMI_OK) << last_error();
}

TEST(BvhFile, OverBoxesComesBackTheSame) {
  const Device device = make_device();
  for (const uint32_t count : {0u, 1u, 2u, 700u}) {
    for (const uint32_t width : {2u, 8u}) {
      std::vector<float> boxes = random_boxes(count);
      const Bvh bvh = build(device, desc_of(boxes, width));
      for (const uint32_t flags : {0u, uint32_t{KIWAMI_LOAD_TRUSTED}}) {
        Bvh loaded;
        ASSERT_EQ(load(device, saved(bvh), flags, loaded), KIWAMI_OK) << last_error();
        expect_same_tree(bvh, loaded);
        EXPECT_EQ(saved(loaded), saved(bvh));
      }
    }
  }
}

TEST(BvhFile, CanBeRefitted) {
  const Device device = make_device();
  std::vector<float> boxes = random_boxes(300);
  const Bvh bvh = build(device, desc_of(boxes, 4));
  Bvh loaded;
  ASSERT_EQ(load(device, saved(bvh), KIWAMI_LOAD_TRUSTED, loaded), KIWAMI_OK) << last_error();
  for (float& coordinate : boxes) coordinate += 1.0f;
  for (kiwami_bvh* tree : {bvh.get(), loaded.get()}) {
    ASSERT_EQ(kiwami_bvh_refit(tree, boxes.data(), 0, boxes.size() / 6), KIWAMI_OK) << last_error();
  }
  expect_same_tree(bvh, loaded);
}

TEST(BvhFile, OverAMeshComesBackTheSame) {
  const Device device = make_device();
  Triangles triangles = random_triangles(400, 12);
  triangles.vertices[30] = kInfinity;
  const Geometry mesh = make_mesh(device, triangles.desc());
  kiwami_bvh_desc desc;
  ASSERT_EQ(kiwami_bvh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.geometry = mesh.get();
  desc.width = 8;
  const Bvh bvh = build(device, desc);
  Bvh loaded;
  ASSERT_EQ(load(device, saved(bvh), 0, loaded), KIWAMI_OK) << last_error();
  expect_same_tree(bvh, loaded);
  EXPECT_EQ(kiwami_bvh_refit(loaded.get(), nullptr, 0, 0), KIWAMI_OK) << last_error();
  kiwami_bvh_measures measures{};
  measures.struct_size = sizeof measures;
  EXPECT_EQ(kiwami_bvh_measure(loaded.get(), nullptr, &measures, nullptr, 0), KIWAMI_OK);
  EXPECT_GT(measures.epo, 0.0);
}

TEST(BvhFile, OfASceneIsRefused) {
  const Device device = make_device();
  const Bvh bvh = bvh_of(make_mixed_scene(device, 10, 8));
  const kiwami_save_desc save = default_save();
  EXPECT_EQ(kiwami_bvh_save(bvh.get(), &save, nullptr), KIWAMI_ERROR_INVALID_STATE);
  EXPECT_EQ(last_error(),
            "the tree is that of a scene, expected one of kiwami_bvh_build: save the scene");
}

TEST(BvhFile, IsToldFromASceneAndCannotBeWidened) {
  const Device device = make_device();
  const std::vector<float> boxes = random_boxes(10);
  const Bytes file = saved(build(device, desc_of(boxes, 2)));
  Scene scene;
  EXPECT_EQ(load(device, file, 0, scene), KIWAMI_ERROR_INVALID_FILE);
  EXPECT_EQ(last_error(), "the file holds a tree, expected a scene");
  Bvh bvh;
  EXPECT_EQ(load(device, saved(make_mixed_scene(device, 10, 8)), 0, bvh),
            KIWAMI_ERROR_INVALID_FILE);
  EXPECT_EQ(last_error(), "the file holds a scene, expected a tree");
  kiwami_load_desc desc = default_load();
  desc.data = file.data();
  desc.size = file.size();
  kiwami_file_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(kiwami_file_get_info(device.get(), &desc, &info), KIWAMI_OK) << last_error();
  EXPECT_EQ(info.kind, uint32_t{KIWAMI_FILE_BVH});
  EXPECT_EQ(info.bvh_width, 2u);
  EXPECT_EQ(info.triangle_count, 9u);
  desc.bvh_width = 8;
  EXPECT_EQ(load(device, desc, bvh), KIWAMI_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace kiwami_api_tests

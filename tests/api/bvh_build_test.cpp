// SPDX-License-Identifier: Apache-2.0
// Trees over the caller's boxes and meshes: every pipeline, moved primitives, bad arguments.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Box {
  float lower[3], upper[3];
};

std::vector<Box> boxes_of(const Triangles& mesh) {
  std::vector<Box> boxes;
  for (size_t i = 0; i < mesh.indices.size() / 3; ++i) {
    Box box = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    for (size_t k = 0; k < 3; ++k) {
      const float* at = &mesh.vertices[3 * mesh.indices[3 * i + k]];
      for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::min(box.lower[axis], at[axis]);
        box.upper[axis] = std::max(box.upper[axis], at[axis]);
      }
    }
    boxes.push_back(box);
  }
  return boxes;
}

kiwami_bvh_desc default_bvh() {
  kiwami_bvh_desc desc;
  EXPECT_EQ(kiwami_bvh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  return desc;
}

kiwami_bvh_desc desc_of(const std::vector<Box>& boxes, uint32_t width) {
  kiwami_bvh_desc desc = default_bvh();
  desc.boxes = boxes.data();
  desc.box_count = boxes.size();
  desc.width = width;
  return desc;
}

Bvh build(const Device& device, const kiwami_bvh_desc& desc) {
  kiwami_bvh* bvh = nullptr;
  EXPECT_EQ(kiwami_bvh_build(device.get(), &desc, &bvh), KIWAMI_OK) << last_error();
  return Bvh(bvh);
}

void expect_valid(const Bvh& bvh) {
  EXPECT_EQ(kiwami_bvh_validate(bvh.get()), KIWAMI_OK) << last_error();
}

/// Checks that every primitive below count stands in some leaf, and none elsewhere.
void expect_all(const Bvh& bvh, uint32_t count) {
  std::vector<uint32_t> found(count);
  const std::vector<kiwami_bvh_primitive> primitives = primitives_of(bvh);
  for (const kiwami_bvh_node& node : nodes_of(bvh)) {
    if (node.child_count != 0) continue;
    for (uint32_t i = 0; i < node.primitive_count; ++i) {
      const kiwami_bvh_primitive& primitive = primitives[node.first_primitive + i];
      EXPECT_EQ(primitive.geometry_id, 0u);
      ++found.at(primitive.primitive_id);
    }
  }
  for (uint32_t i = 0; i < count; ++i) EXPECT_GE(found[i], 1u) << i;
}

bool have_equal_nodes(const Bvh& a, const Bvh& b) {
  const std::vector<kiwami_bvh_node> of_a = nodes_of(a), of_b = nodes_of(b);
  return of_a.size() == of_b.size() &&
         std::memcmp(of_a.data(), of_b.data(), of_a.size() * sizeof of_a[0]) == 0;
}

std::vector<uint32_t> methods_of(uint32_t stage) {
  std::vector<uint32_t> methods;
  for (uint32_t method = 0; method < 256; ++method) {
    if (kiwami_method_name(stage, method)) methods.push_back(method);
  }
  return methods;
}

class BvhBuildTest : public testing::Test {
 protected:
  BvhBuildTest() : device_(make_device()) {}

  void expect_error(const kiwami_bvh_desc& desc, kiwami_result result, const char* sentence) {
    kiwami_bvh* bvh = reinterpret_cast<kiwami_bvh*>(this);
    EXPECT_EQ(kiwami_bvh_build(device_.get(), &desc, &bvh), result);
    EXPECT_EQ(last_error(device_.get()), sentence);
    EXPECT_EQ(bvh, nullptr);
  }

  Device device_;
};

TEST_F(BvhBuildTest, EveryMethodAndWidthGivesValidTrees) {
  for (const uint32_t count : {0u, 1u, 2u, 3u, 17u, 300u}) {
    const Triangles mesh = random_triangles(count, 31 + count);
    const Geometry geometry = make_mesh(device_, mesh.desc());
    for (const uint32_t builder : methods_of(KIWAMI_STAGE_BUILDER)) {
      for (const uint32_t optimizer : methods_of(KIWAMI_STAGE_OPTIMIZER)) {
        for (const uint32_t width : {2u, 4u, 8u, 16u}) {
          const kiwami_parameter_value parameters[] = {
              {KIWAMI_PARAMETER_BUILDER, 0, double(builder)},
              {KIWAMI_PARAMETER_VALIDATE_BUILD, 0, 1}};
          kiwami_bvh_desc desc = default_bvh();
          desc.geometry = geometry.get();
          desc.width = width;
          desc.parameters = parameters;
          desc.parameter_count = 2;
          desc.optimizers = &optimizer;
          desc.optimizer_count = 1;
          kiwami_bvh* made = nullptr;
          const kiwami_result result = kiwami_bvh_build(device_.get(), &desc, &made);
          const Bvh bvh(made);
          // Builders that make no binary tree refuse what needs one, and say so.
          if (result == KIWAMI_ERROR_INVALID_ARGUMENT) {
            EXPECT_NE(last_error().find("binary tree"), std::string::npos) << last_error();
            continue;
          }
          ASSERT_EQ(result, KIWAMI_OK) << last_error();
          expect_all(bvh, count);
          EXPECT_EQ(info_of(bvh).width, width);
          EXPECT_LE(info_of(bvh).leaf_width, std::max(width, 4u));
        }
      }
    }
  }
}

TEST_F(BvhBuildTest, BoxesAndTheirMeshGiveOneTree) {
  const Triangles mesh = random_triangles(1000, 32);
  const std::vector<Box> boxes = boxes_of(mesh);
  const Geometry geometry = make_mesh(device_, mesh.desc());
  for (const uint32_t width : {2u, 4u, 8u, 16u}) {
    const Bvh of_boxes = build(device_, desc_of(boxes, width));
    kiwami_bvh_desc desc = default_bvh();
    desc.geometry = geometry.get();
    desc.width = width;
    const Bvh of_mesh = build(device_, desc);
    EXPECT_TRUE(have_equal_nodes(of_boxes, of_mesh)) << width;
    expect_valid(of_boxes);
    expect_all(of_boxes, 1000);
    EXPECT_EQ(info_of(of_boxes).skipped_count, 0u);
    EXPECT_GT(info_of(of_boxes).build_seconds, 0.0);
    kiwami_bvh_measures measures[2] = {};
    measures[0].struct_size = measures[1].struct_size = sizeof measures[0];
    ASSERT_EQ(kiwami_bvh_measure(of_boxes.get(), nullptr, &measures[0], nullptr, 0), KIWAMI_OK);
    ASSERT_EQ(kiwami_bvh_measure(of_mesh.get(), nullptr, &measures[1], nullptr, 0), KIWAMI_OK);
    EXPECT_EQ(measures[0].sah, measures[1].sah);
    EXPECT_EQ(measures[0].epo, 0.0);
    EXPECT_GT(measures[1].epo, 0.0);
  }
}

TEST_F(BvhBuildTest, BinaryTreesHaveTwoChildrenAndLeavesOfTheirSize) {
  const std::vector<Box> boxes = boxes_of(random_triangles(500, 33));
  for (const uint32_t leaf_size : {0u, 1u, 3u, 16u}) {
    const kiwami_parameter_value size = {KIWAMI_PARAMETER_MAX_LEAF_SIZE, 0, double(leaf_size)};
    kiwami_bvh_desc desc = desc_of(boxes, 2);
    desc.parameters = &size;
    desc.parameter_count = 1;
    const Bvh bvh = build(device_, desc);
    expect_valid(bvh);
    const uint32_t most = leaf_size ? leaf_size : 4;
    EXPECT_EQ(info_of(bvh).leaf_width, most);
    uint32_t largest = 0;
    for (const kiwami_bvh_node& node : nodes_of(bvh)) {
      if (node.child_count == 0) {
        largest = std::max(largest, node.primitive_count);
      } else {
        EXPECT_EQ(node.child_count, 2u);
      }
    }
    EXPECT_EQ(largest, most);
  }
}

TEST_F(BvhBuildTest, TreesAreTheSameForAnyNumberOfThreads) {
  const std::vector<Box> boxes = boxes_of(random_triangles(20000, 34));
  ThreadRunner runner;
  runner.threads = 5;
  kiwami_device_desc many_desc = default_device();
  runner.install(many_desc, 5);
  kiwami_device_desc one_desc = default_device();
  one_desc.thread_count = 1;
  const Device many = make_device(many_desc), one = make_device(one_desc);
  for (const uint32_t width : {2u, 8u}) {
    EXPECT_TRUE(
        have_equal_nodes(build(many, desc_of(boxes, width)), build(one, desc_of(boxes, width))));
  }
}

TEST_F(BvhBuildTest, BoxesLieAtAnyAddressAndBadOnesAreLeftOut) {
  std::vector<Box> boxes = boxes_of(random_triangles(50, 35));
  boxes[3].lower[1] = kNan;
  boxes[10].upper[2] = kInfinity;
  boxes[20].lower[0] = boxes[20].upper[0] + 1;
  boxes[49].upper[0] = 2 * KIWAMI_MAX_COORDINATE;
  constexpr size_t kStride = sizeof(Box) + 5;
  std::vector<unsigned char> bytes(boxes.size() * kStride + 1);
  for (size_t i = 0; i < boxes.size(); ++i) {
    std::memcpy(bytes.data() + 1 + i * kStride, &boxes[i], sizeof(Box));
  }
  kiwami_bvh_desc desc = default_bvh();
  desc.boxes = bytes.data() + 1;
  desc.box_stride = kStride;
  desc.box_count = boxes.size();
  const Bvh bvh = build(device_, desc);
  expect_valid(bvh);
  EXPECT_EQ(info_of(bvh).skipped_count, 4u);
  EXPECT_EQ(info_of(bvh).primitive_count, 46u);
  for (const kiwami_bvh_primitive& primitive : primitives_of(bvh)) {
    for (const uint32_t bad : {3u, 10u, 20u, 49u}) EXPECT_NE(primitive.primitive_id, bad);
  }
}

TEST_F(BvhBuildTest, DegenerateBoxesGiveValidTrees) {
  const std::vector<Box> inputs[] = {
      {},
      std::vector<Box>(1, Box{{0, 0, 0}, {0, 0, 0}}),
      std::vector<Box>(700, Box{{1, 2, 3}, {4, 5, 6}}),
      {{{-KIWAMI_MAX_COORDINATE, 0, 0}, {KIWAMI_MAX_COORDINATE, 0, 0}},
       {{0, -KIWAMI_MAX_COORDINATE, 0}, {0, KIWAMI_MAX_COORDINATE, 1e-30f}},
       {{0, 0, 0}, {0, 0, 0}}}};
  for (const std::vector<Box>& boxes : inputs) {
    for (const uint32_t width : {0u, 2u, 4u, 8u, 16u}) {
      const Bvh bvh = build(device_, desc_of(boxes, width));
      expect_valid(bvh);
      expect_all(bvh, static_cast<uint32_t>(boxes.size()));
    }
  }
}

TEST_F(BvhBuildTest, RefitMovesTheBoxesAndKeepsTheShape) {
  std::vector<Box> boxes = boxes_of(random_triangles(2000, 36));
  boxes[7].lower[0] = kNan;
  for (const uint32_t width : {2u, 8u}) {
    const Bvh bvh = build(device_, desc_of(boxes, width));
    const std::vector<kiwami_bvh_node> before = nodes_of(bvh);
    std::vector<Box> moved = boxes;
    for (size_t i = 0; i < moved.size(); ++i) {
      const float by = std::sin(static_cast<float>(i));
      for (int axis = 0; axis < 3; ++axis) {
        moved[i].lower[axis] += by;
        moved[i].upper[axis] += by;
      }
    }
    moved[7] = {{-100, -100, -100}, {100, 100, 100}};  // not in the tree, and stays out of it
    ASSERT_EQ(kiwami_bvh_refit(bvh.get(), moved.data(), 0, moved.size()), KIWAMI_OK)
        << last_error();
    expect_valid(bvh);
    std::vector<kiwami_bvh_node> after = nodes_of(bvh);
    // Each box is the exact union of those below it.
    const std::vector<kiwami_bvh_primitive> primitives = primitives_of(bvh);
    for (size_t i = 0; i < after.size(); ++i) {
      kiwami_bvh_node& node = after[i];
      for (int axis = 0; axis < 3; ++axis) {
        float lower = kInfinity, upper = -kInfinity;
        for (uint32_t p = 0; p < node.primitive_count; ++p) {
          const Box& box = moved[primitives[node.first_primitive + p].primitive_id];
          lower = std::min(lower, box.lower[axis]);
          upper = std::max(upper, box.upper[axis]);
        }
        EXPECT_EQ(node.lower[axis], lower);
        EXPECT_EQ(node.upper[axis], upper);
      }
      std::memcpy(node.lower, before[i].lower, sizeof node.lower);
      std::memcpy(node.upper, before[i].upper, sizeof node.upper);
    }
    EXPECT_EQ(std::memcmp(after.data(), before.data(), after.size() * sizeof after[0]), 0);
    // And back: the tree that was built.
    ASSERT_EQ(kiwami_bvh_refit(bvh.get(), boxes.data(), 0, boxes.size()), KIWAMI_OK);
    EXPECT_TRUE(have_equal_nodes(bvh, build(device_, desc_of(boxes, width))));
  }
}

TEST_F(BvhBuildTest, RefitReadsAMeshAnew) {
  Triangles mesh = random_triangles(300, 37);
  kiwami_triangle_mesh_desc mesh_desc = mesh.desc();
  mesh_desc.flags = KIWAMI_MESH_SHARE_BUFFERS;
  Geometry geometry = make_mesh(device_, mesh_desc);
  kiwami_bvh_desc desc = default_bvh();
  desc.geometry = geometry.get();
  desc.width = 4;
  const Bvh bvh = build(device_, desc);
  geometry.reset();
  for (float& coordinate : mesh.vertices) coordinate *= 3;
  ASSERT_EQ(kiwami_bvh_refit(bvh.get(), nullptr, 0, 0), KIWAMI_OK) << last_error();
  expect_valid(bvh);
  // What scales does not change the cost.
  kiwami_bvh_measures measures{};
  measures.struct_size = sizeof measures;
  ASSERT_EQ(kiwami_bvh_measure(bvh.get(), nullptr, &measures, nullptr, 0), KIWAMI_OK);
  for (float& coordinate : mesh.vertices) coordinate /= 3;
  mesh.vertices[0] = kNan;
  EXPECT_EQ(kiwami_bvh_refit(bvh.get(), nullptr, 0, 0), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()),
            "primitive 0 of the tree is now NaN, out of range or turned inside out, expected a "
            "box");
}

TEST_F(BvhBuildTest, BadRefitsLeaveTheTreeAsItWas) {
  std::vector<Box> boxes = boxes_of(random_triangles(40, 38));
  const Bvh bvh = build(device_, desc_of(boxes, 4));
  const auto refit = [&](const void* data, size_t stride, size_t count) {
    return kiwami_bvh_refit(bvh.get(), data, stride, count);
  };
  EXPECT_EQ(kiwami_bvh_refit(nullptr, boxes.data(), 0, 40), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(refit(nullptr, 0, 40), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(refit(boxes.data(), 23, 40), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(refit(boxes.data(), 0, 39), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()), "count is 39, expected 40, as many as were built");
  boxes[5].lower[0] = kNan;
  EXPECT_EQ(refit(boxes.data(), 0, 40), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_TRUE(
      have_equal_nodes(bvh, build(device_, desc_of(boxes_of(random_triangles(40, 38)), 4))));

  const Bvh of_scene = bvh_of(make_scene(device_, make_mesh(device_, square(1).desc())));
  expect_valid(of_scene);
  EXPECT_EQ(kiwami_bvh_refit(of_scene.get(), nullptr, 0, 0), KIWAMI_ERROR_INVALID_STATE);
}

TEST_F(BvhBuildTest, TreesOfScenesAreValid) {
  for (const uint32_t count : {0u, 1u, 9u, 3000u}) {
    const Triangles mesh = random_triangles(count, 39);
    expect_valid(bvh_of(make_scene(device_, make_mesh(device_, mesh.desc()))));
  }
}

TEST_F(BvhBuildTest, BadArguments) {
  const std::vector<Box> boxes = boxes_of(random_triangles(4, 40));
  const Geometry geometry = make_mesh(device_, square(1).desc());
  const kiwami_bvh_desc good = desc_of(boxes, 4);
  kiwami_bvh_desc desc = good;
  desc.width = 3;
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT, "desc.width is 3, expected 0, 2, 4, 8 or 16");
  desc = good;
  desc.boxes = nullptr;
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT, "desc.boxes is NULL, expected a valid pointer");
  desc = good;
  desc.box_count = uint64_t{1} << 31;
  expect_error(desc, KIWAMI_ERROR_TOO_LARGE,
               "desc.box_count is 2147483648, expected at most 2147483647");
  desc = good;
  desc.geometry = geometry.get();
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT,
               "desc has boxes and a geometry, expected one of them");
  desc = default_bvh();
  const Device other = make_device();
  const Geometry foreign = make_mesh(other, square(1).desc());
  desc.geometry = foreign.get();
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT,
               "desc.geometry is of another device, expected one of device");
  kiwami_parameter_value parameter = {KIWAMI_PARAMETER_BVH_WIDTH, 0, 4};
  desc = good;
  desc.parameter_count = 1;
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT,
               "desc.parameters is NULL, expected a valid pointer");
  desc.parameters = &parameter;
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT,
               "desc.parameters[0] is KIWAMI_PARAMETER_BVH_WIDTH, expected desc.width in its "
               "place");
  parameter = {KIWAMI_PARAMETER_BIN_COUNT, 0, 1e9};
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT,
               "value is 1e+09 for parameter 4, expected 4 to 32");
  parameter = {KIWAMI_PARAMETER_BUILDER, 0, KIWAMI_BUILDER_SPATIAL_SPLIT};
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT,
               "the builder spatial_split cuts triangles, expected a mesh in place of boxes");
  desc = good;
  const uint32_t unknown = 200;
  desc.optimizers = &unknown;
  desc.optimizer_count = 1;
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT,
               "there is no optimizer of number 200, expected one that kiwami_method_name names");
  kiwami_bvh* made = nullptr;
  EXPECT_EQ(kiwami_bvh_build(nullptr, &good, &made), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_build(device_.get(), nullptr, &made), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_build(device_.get(), &good, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_desc_init(nullptr, 80), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_validate(nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace kiwami_api_tests

// SPDX-License-Identifier: Apache-2.0
// The tree of a scene as flat nodes: what each number promises, and bad arguments.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

double half_area(const kiwami_bvh_node& node) {
  const double x = double(node.upper[0]) - double(node.lower[0]);
  const double y = double(node.upper[1]) - double(node.lower[1]);
  const double z = double(node.upper[2]) - double(node.lower[2]);
  return x * y + y * z + z * x;
}

bool contains(const kiwami_bvh_node& outer, const float lower[3], const float upper[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(outer.lower[axis] <= lower[axis] && upper[axis] <= outer.upper[axis])) return false;
  }
  return true;
}

/// Checks parents, children, depths, boxes and runs of primitives against each other.
void expect_consistent(const std::vector<kiwami_bvh_node>& nodes, const kiwami_bvh_info& info) {
  uint32_t next_child = 1, leaves = 0, depth = 0;
  for (uint32_t i = 0; i < nodes.size(); ++i) {
    const kiwami_bvh_node& node = nodes[i];
    ASSERT_LE(node.child_count, info.width);
    depth = std::max(depth, node.depth);
    if (node.child_count == 0) {
      ++leaves;
      EXPECT_EQ(node.first_child, 0u);
      EXPECT_GE(node.primitive_count, 1u);
      EXPECT_LE(node.primitive_count, info.leaf_width);
      continue;
    }
    // Breadth first: the children of all nodes follow each other.
    ASSERT_EQ(node.first_child, next_child);
    next_child += node.child_count;
    ASSERT_LE(next_child, nodes.size());
    uint32_t next_primitive = node.first_primitive;
    for (uint32_t c = node.first_child; c < next_child; ++c) {
      EXPECT_EQ(nodes[c].parent, i);
      EXPECT_EQ(nodes[c].depth, node.depth + 1);
      EXPECT_TRUE(contains(node, nodes[c].lower, nodes[c].upper));
      EXPECT_EQ(nodes[c].first_primitive, next_primitive);
      next_primitive += nodes[c].primitive_count;
    }
    EXPECT_EQ(next_primitive, node.first_primitive + node.primitive_count);
  }
  EXPECT_EQ(next_child, nodes.size());
  EXPECT_EQ(leaves, info.leaf_count);
  EXPECT_EQ(depth, info.depth);
}

class BvhTest : public testing::Test {
 protected:
  BvhTest() : device_(make_device()) {}

  Scene commit(const std::vector<Geometry>& meshes, double width, double merge) {
    Scene scene = make_scene(device_);
    for (const Geometry& mesh : meshes) {
      EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    }
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BVH_WIDTH, width),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_MERGE_LEAVES, merge),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
    return scene;
  }

  Device device_;
};

TEST_F(BvhTest, NodesAreConsistentForEveryWidthMergedOrNot) {
  std::vector<Geometry> meshes;
  meshes.push_back(make_mesh(device_, random_triangles(700, 1).desc()));
  meshes.push_back(make_mesh(device_, random_triangles(3, 2).desc()));
  for (const uint32_t width : {4u, 8u, 16u}) {
    for (const int merge : {0, 1}) {
      const Scene scene = commit(meshes, width, merge);
      const Bvh bvh = bvh_of(scene);
      const kiwami_bvh_info info = info_of(bvh);
      kiwami_scene_info scene_info{};
      scene_info.struct_size = sizeof scene_info;
      ASSERT_EQ(kiwami_scene_get_info(scene.get(), &scene_info), KIWAMI_OK);
      EXPECT_EQ(info.width, width);
      EXPECT_EQ(info.leaf_width, width);
      EXPECT_EQ(info.depth, scene_info.bvh_depth);
      EXPECT_EQ(info.primitive_count, 703u);
      EXPECT_GE(info.bytes, info.node_count * sizeof(kiwami_bvh_node));
      const std::vector<kiwami_bvh_node> nodes = nodes_of(bvh);
      expect_consistent(nodes, info);
      EXPECT_EQ(nodes[0].parent, KIWAMI_INVALID_ID);
      EXPECT_EQ(nodes[0].primitive_count, 703u);
      if (!merge) {
        EXPECT_EQ(info.node_count - info.leaf_count, scene_info.node_count);
        EXPECT_EQ(info.leaf_count, scene_info.leaf_block_count);
      }
      // Areas give the cost that the commit stated: another way to the same number.
      double cost = 0;
      for (const kiwami_bvh_node& node : nodes) cost += half_area(node);
      EXPECT_NEAR(cost / half_area(nodes[0]) / scene_info.sah_cost, 1.0, 1e-5);
    }
  }
}

TEST_F(BvhTest, EachPrimitiveStandsInOneLeafWhoseBoxContainsIt) {
  const Triangles triangles[2] = {random_triangles(500, 3), random_triangles(40, 4)};
  std::vector<Geometry> meshes;
  for (const Triangles& mesh : triangles) meshes.push_back(make_mesh(device_, mesh.desc()));
  const Bvh bvh = bvh_of(commit(meshes, 8, 1));
  const std::vector<kiwami_bvh_node> nodes = nodes_of(bvh);
  const std::vector<kiwami_bvh_primitive> primitives = primitives_of(bvh);
  std::vector<std::pair<uint32_t, uint32_t>> found;
  for (const kiwami_bvh_node& node : nodes) {
    for (uint32_t i = 0; i < node.primitive_count; ++i) {
      const kiwami_bvh_primitive& name = primitives[node.first_primitive + i];
      const Triangles& mesh = triangles[name.geometry_id];
      for (uint32_t corner = 0; corner < 3; ++corner) {
        const float* at = &mesh.vertices[3 * mesh.indices[3 * name.primitive_id + corner]];
        EXPECT_TRUE(contains(node, at, at));
      }
      if (node.child_count == 0) found.emplace_back(name.geometry_id, name.primitive_id);
    }
  }
  std::sort(found.begin(), found.end());
  ASSERT_EQ(found.size(), 540u);
  for (uint32_t i = 0; i < 540; ++i) {
    EXPECT_EQ(found[i], (i < 500 ? std::pair(0u, i) : std::pair(1u, i - 500)));
  }
}

TEST_F(BvhTest, StoredNodesAreSharedByMasksThatDoNotOverlap) {
  std::vector<Geometry> meshes;
  meshes.push_back(make_mesh(device_, random_triangles(2000, 5).desc()));
  const Bvh bvh = bvh_of(commit(meshes, 8, 1));
  std::vector<uint32_t> owned[2] = {std::vector<uint32_t>(4000), std::vector<uint32_t>(4000)};
  uint32_t shared = 0;
  for (const kiwami_bvh_node& node : nodes_of(bvh)) {
    uint32_t& slots = owned[node.child_count == 0].at(node.storage_index);
    EXPECT_EQ(slots & node.storage_mask, 0u);
    if (slots != 0) ++shared;
    slots |= node.storage_mask;
    const uint32_t count = node.child_count ? node.child_count : node.primitive_count;
    EXPECT_EQ(static_cast<uint32_t>(__builtin_popcount(node.storage_mask)), count);
  }
  EXPECT_GT(shared, 0u);
}

TEST_F(BvhTest, ScenesOfNothingAndOfOneTriangle) {
  const Bvh nothing = bvh_of(commit({}, 8, 1));
  EXPECT_EQ(info_of(nothing).node_count, 0u);
  EXPECT_EQ(info_of(nothing).primitive_count, 0u);
  EXPECT_EQ(kiwami_bvh_get_nodes(nothing.get(), 0, 0, nullptr, 0), KIWAMI_OK);
  EXPECT_EQ(kiwami_bvh_get_primitives(nothing.get(), 0, 0, nullptr, 0), KIWAMI_OK);

  std::vector<Geometry> meshes;
  meshes.push_back(make_mesh(device_, random_triangles(1, 6).desc()));
  const std::vector<kiwami_bvh_node> nodes = nodes_of(bvh_of(commit(meshes, 8, 1)));
  ASSERT_EQ(nodes.size(), 1u);
  EXPECT_EQ(nodes[0].child_count, 0u);
  EXPECT_EQ(nodes[0].primitive_count, 1u);
  EXPECT_EQ(nodes[0].depth, 0u);
}

TEST_F(BvhTest, RangesAndStrides) {
  std::vector<Geometry> meshes;
  meshes.push_back(make_mesh(device_, random_triangles(100, 7).desc()));
  const Bvh bvh = bvh_of(commit(meshes, 4, 1));
  const std::vector<kiwami_bvh_node> nodes = nodes_of(bvh);
  constexpr size_t kStride = sizeof(kiwami_bvh_node) + 3;
  std::vector<unsigned char> bytes(2 * kStride, 0xAB);
  auto* target = reinterpret_cast<kiwami_bvh_node*>(bytes.data());
  ASSERT_EQ(kiwami_bvh_get_nodes(bvh.get(), 5, 2, target, kStride), KIWAMI_OK);
  EXPECT_EQ(std::memcmp(bytes.data(), &nodes[5], sizeof nodes[5]), 0);
  EXPECT_EQ(std::memcmp(bytes.data() + kStride, &nodes[6], sizeof nodes[6]), 0);
  EXPECT_EQ(bytes[sizeof(kiwami_bvh_node)], 0xAB);

  const std::vector<kiwami_bvh_primitive> primitives = primitives_of(bvh);
  kiwami_bvh_primitive last{};
  ASSERT_EQ(kiwami_bvh_get_primitives(bvh.get(), 99, 1, &last, 0), KIWAMI_OK);
  EXPECT_EQ(last.primitive_id, primitives[99].primitive_id);
}

TEST_F(BvhTest, OutlivesItsSceneAndItsNextCommit) {
  const Geometry mesh = make_mesh(device_, random_triangles(100, 8).desc());
  Scene scene = make_scene(device_, mesh);
  const Bvh bvh = bvh_of(scene);
  const std::vector<kiwami_bvh_node> nodes = nodes_of(bvh);
  ASSERT_EQ(kiwami_scene_detach(scene.get(), 0), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(info_of(bvh_of(scene)).node_count, 0u);
  scene.reset();
  device_.reset();
  const std::vector<kiwami_bvh_node> after = nodes_of(bvh);
  ASSERT_EQ(after.size(), nodes.size());
  EXPECT_EQ(std::memcmp(after.data(), nodes.data(), nodes.size() * sizeof nodes[0]), 0);
}

TEST_F(BvhTest, BadArguments) {
  kiwami_bvh* made = nullptr;
  const Scene scene = make_scene(device_);
  EXPECT_EQ(kiwami_scene_get_bvh(nullptr, &made), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_scene_get_bvh(scene.get(), &made), KIWAMI_ERROR_INVALID_STATE);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(kiwami_scene_get_bvh(scene.get(), nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()), "bvh is NULL, expected a valid pointer");

  std::vector<Geometry> meshes;
  meshes.push_back(make_mesh(device_, random_triangles(1, 9).desc()));
  const Bvh bvh = bvh_of(commit(meshes, 8, 1));
  kiwami_bvh_node node;
  kiwami_bvh_primitive primitive;
  kiwami_bvh_info info{};
  EXPECT_EQ(kiwami_bvh_get_info(bvh.get(), &info), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_get_info(bvh.get(), nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_get_info(nullptr, &info), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_get_nodes(nullptr, 0, 0, &node, 0), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_get_nodes(bvh.get(), 0, 1, nullptr, 0), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_get_nodes(bvh.get(), 0, 1, &node, 55), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_get_nodes(bvh.get(), 1, SIZE_MAX, &node, 0), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_get_nodes(bvh.get(), 1, 1, &node, 0), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()),
            "first is 1 and count is 1, expected some of the 1 nodes of the tree");
  EXPECT_EQ(kiwami_bvh_get_primitives(bvh.get(), 0, 2, &primitive, 0),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()),
            "first is 0 and count is 2, expected some of the 1 primitives of the tree");
  kiwami_bvh_retain(nullptr);
  kiwami_bvh_release(nullptr);
}

}  // namespace
}  // namespace kiwami_api_tests

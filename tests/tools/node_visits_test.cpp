// SPDX-License-Identifier: Apache-2.0
#include "measure/node_visits.h"

#include <gtest/gtest.h>

#include <limits>

#include "measure/camera.h"
#include "measure/library.h"
#include "scene/procedural.h"

namespace kiwami_tests {
namespace {

using namespace kiwami::tools;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A tracer whose rays all end at the same distance; infinite: they hit nothing.
class Wall : public Tracer {
 public:
  explicit Wall(float distance) : distance_(distance) {}
  void closest_hits(std::span<const kiwami_ray>, std::span<kiwami_hit> hits) const override {
    for (kiwami_hit& hit : hits) {
      hit = kiwami_hit{};
      hit.t = distance_;
      hit.primitive_id = hit.geometry_id = distance_ == kInfinity ? KIWAMI_INVALID_ID : 0;
    }
  }

 private:
  float distance_;
};

kiwami_bvh_node make_node(float lower, float upper, uint32_t first_child, uint32_t child_count) {
  kiwami_bvh_node node{};
  for (int axis = 0; axis < 3; ++axis) {
    node.lower[axis] = axis == 0 ? lower : -1.0f;
    node.upper[axis] = axis == 0 ? upper : 1.0f;
  }
  node.first_child = first_child;
  node.child_count = child_count;
  return node;
}

/// A row of boxes along x: 0 to 9, in it 0 to 2, 4 to 6 and 7 to 9.
std::vector<kiwami_bvh_node> row_of_boxes() {
  return {make_node(0, 9, 1, 3), make_node(0, 2, 0, 0), make_node(4, 6, 0, 0),
          make_node(7, 9, 0, 0)};
}

using Counts = std::vector<uint64_t>;

TEST(NodeVisits, RaysCountInAllBoxesUpToTheirHit) {
  const std::vector<kiwami_ray> rays = {make_ray({-1, 0, 0}, {1, 0, 0}, 0.0f, kInfinity)};
  EXPECT_EQ(node_visits(row_of_boxes(), Wall(kInfinity), rays), (Counts{1, 1, 1, 1}));
  EXPECT_EQ(node_visits(row_of_boxes(), Wall(7.5f), rays), (Counts{1, 1, 1, 0}));
  // A hit on the box itself is a visit.
  EXPECT_EQ(node_visits(row_of_boxes(), Wall(5.0f), rays), (Counts{1, 1, 1, 0}));
  EXPECT_EQ(node_visits(row_of_boxes(), Wall(0.5f), rays), (Counts{0, 0, 0, 0}));
}

TEST(NodeVisits, RaysBeginAndEndWhereTheySay) {
  EXPECT_EQ(node_visits(row_of_boxes(), Wall(kInfinity),
                        std::vector<kiwami_ray>{make_ray({-1, 0, 0}, {1, 0, 0}, 4.0f, 7.9f)}),
            (Counts{1, 0, 1, 0}));
  EXPECT_EQ(node_visits(row_of_boxes(), Wall(kInfinity),
                        std::vector<kiwami_ray>{make_ray({3, 0, 0}, {-1, 0, 0}, 0.0f, kInfinity)}),
            (Counts{1, 1, 0, 0}));
}

TEST(NodeVisits, ADirectionAlongASlabIsDecidedByTheOrigin) {
  const std::vector<kiwami_ray> rays = {make_ray({5, 3, 0}, {0, -1, 0}, 0.0f, kInfinity),
                                        make_ray({3, 3, 1}, {0, -1, -0.0f}, 0.0f, kInfinity),
                                        make_ray({5, 3, 1.5f}, {0, -1, 0}, 0.0f, kInfinity)};
  EXPECT_EQ(node_visits(row_of_boxes(), Wall(kInfinity), rays), (Counts{2, 0, 1, 0}));
}

TEST(NodeVisits, OfNothingAreNone) {
  EXPECT_TRUE(node_visits({}, Wall(1.0f), {}).empty());
  EXPECT_EQ(node_visits(row_of_boxes(), Wall(1.0f), {}), (Counts{0, 0, 0, 0}));
}

TEST(NodeVisits, EveryHitOfARealTreeVisitsItsLeaf) {
  SceneFile file;
  file.meshes.push_back(make_sphere(3));
  const Device device(KIWAMI_ISA_SCALAR, 1);
  const BuiltScene scene(device, file);
  const MeasuredTree tree = scene.measured_tree(KIWAMI_MEASURE_WITHOUT_EPO);
  std::vector<kiwami_ray> rays;
  for (int i = 0; i < 100; ++i) {
    rays.push_back(
        make_ray({0, 0, 0}, {1.0f, 0.07f * static_cast<float>(i) - 3.0f, 0.3f}, 0.0f, kInfinity));
  }
  const Counts visits = node_visits(tree.nodes, scene, rays);
  EXPECT_EQ(visits[0], rays.size());
  uint64_t leaves = 0;
  for (size_t i = 0; i < visits.size(); ++i) {
    const uint64_t above = i == 0 ? rays.size() : visits[tree.nodes[i].parent];
    EXPECT_LE(visits[i], above);
    if (tree.nodes[i].child_count == 0) leaves += visits[i];
  }
  EXPECT_GE(leaves, rays.size());
}

}  // namespace
}  // namespace kiwami_tests

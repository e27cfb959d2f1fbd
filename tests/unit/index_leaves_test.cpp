// SPDX-License-Identifier: Apache-2.0
// Wide trees whose leaf blocks hold ids alone: over triangles, and over boxes.
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <numeric>

#include "builders/binned_sah_builder.h"
#include "builders/spatial_split_builder.h"
#include "core/error.h"
#include "optimizers/nary_reorder.h"
#include "optimizers/sato_reorder.h"
#include "support/environment.h"
#include "unit/tree_scenes.h"
#include "wide/flat_tree.h"
#include "wide/slot_owners.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::BinaryBvh;
using kiwami::BuildPrimitive;
using kiwami::ChildReference;
using kiwami::ContractionMethod;
using kiwami::LeafLayout;
using kiwami::TriangleSource;
using kiwami::WideNode;
using kiwami::WideTree;

constexpr TriangleSource kNoTriangles = {nullptr, 0};

class IndexLeaves : public testing::Test {
 protected:
  IndexLeaves() : memory_(nullptr, nullptr, nullptr) {}

  /// Every second id, the boxes of a mesh: numbers with gaps, as those of primitives that were
  /// skipped leave.
  Array<BuildPrimitive> boxes_of(const Mesh& mesh) {
    Array<BuildPrimitive> boxes = primitives_of(mesh, memory_);
    for (BuildPrimitive& box : boxes) box.id = 2 * box.id + 1;
    return boxes;
  }

  BinaryBvh build_binary(const TreeScene& scene, uint32_t width, bool splits) {
    if (splits) {
      kiwami::SpatialSplitBuilder::Config config;
      config.max_leaf_size = config.block_size = width;
      return kiwami::SpatialSplitBuilder::build(scene.primitives(memory_), scene.source(), config,
                                                memory_, one_thread_);
    }
    return build_binary(scene.primitives(memory_), width);
  }
  BinaryBvh build_binary(Array<BuildPrimitive> boxes, uint32_t width) {
    kiwami::BinnedSahBuilder::Config config;
    config.max_leaf_size = config.block_size = width;
    return kiwami::BinnedSahBuilder::build(std::move(boxes), config, memory_, one_thread_);
  }

  WideTree widen(BinaryBvh binary, const TriangleSource& source, uint32_t width,
                 LeafLayout layout) {
    kiwami::WideTreeConfig config;
    config.width = config.max_leaf_size = width;
    config.leaf_layout = layout;
    config.contraction = contraction_;
    config.rays = {rays_.data(), rays_.size()};
    return kiwami::build_wide_tree(std::move(binary), source, config, memory_, one_thread_);
  }
  WideTree widen_boxes(const Mesh& mesh, uint32_t width) {
    return widen(build_binary(boxes_of(mesh), width), kNoTriangles, width, LeafLayout::kIndices);
  }

  void verify_boxes(const WideTree& tree, const Mesh& mesh) {
    const Array<BuildPrimitive> boxes = boxes_of(mesh);
    kiwami::verify_wide_tree(tree, {boxes.data(), boxes.size()}, memory_);
  }

  kiwami::Memory memory_;
  Threads one_thread_{1};
  ContractionMethod contraction_ = ContractionMethod::kOptimal;
  Array<kiwami::RepresentativeRay> rays_;
};

/// Both trees, node for node and lane for lane; only where a leaf block lies differs.
template <int N>
void expect_equal_trees(const WideTree& triangles, const WideTree& indices) {
  ASSERT_EQ(triangles.node_count, indices.node_count);
  ASSERT_EQ(triangles.leaf_block_count, indices.leaf_block_count);
  EXPECT_EQ(triangles.leaf_bytes(), 10 * indices.leaf_bytes());
  EXPECT_EQ(indices.memory.size(), indices.node_bytes() + indices.leaf_bytes());
  EXPECT_EQ(triangles.used_slots, indices.used_slots);
  EXPECT_EQ(triangles.used_lanes, indices.used_lanes);
  EXPECT_EQ(triangles.depth, indices.depth);
  EXPECT_EQ(triangles.sah_cost, indices.sah_cost);
  const auto expect_equal_references = [&](ChildReference a, ChildReference b) {
    ASSERT_EQ(a.mask(), b.mask());
    ASSERT_EQ(a.is_leaf(), b.is_leaf());
    if (a.mask() != 0) {
      ASSERT_EQ(triangles.number_of(a), indices.number_of(b));
    }
  };
  expect_equal_references(triangles.view.root, indices.view.root);
  for (uint64_t i = 0; i < triangles.node_count; ++i) {
    const WideNode<N>&a = triangles.nodes<N>()[i], &b = indices.nodes<N>()[i];
    ASSERT_EQ(std::memcmp(a.bounds, b.bounds, sizeof a.bounds), 0);
    for (int slot = 0; slot < N; ++slot) expect_equal_references(a.child[slot], b.child[slot]);
  }
  for (uint64_t i = 0; i < triangles.leaf_block_count; ++i) {
    ASSERT_EQ(std::memcmp(triangles.leaf_ids(i), indices.leaf_ids(i), N * sizeof(uint32_t)), 0);
    ASSERT_EQ(triangles.leaf_ids(i), triangles.leaves<N>()[i].id);
  }
}

TEST_F(IndexLeaves, AreTheIdsOfTriangleLeaves) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  std::vector<NamedMesh> meshes = degenerate_meshes(seed());
  meshes.push_back({"soup", soup(3000, seed())});
  meshes.push_back({"terrain", terrain(30)});
  meshes.push_back({"empty", {}});
  for (const NamedMesh& named : meshes) {
    const TreeScene scene(named.name, named.mesh);
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const bool splits : {false, true}) {
        SCOPED_TRACE(named.name + ", width " + std::to_string(width));
        const WideTree triangles = widen(build_binary(scene, width, splits), scene.source(), width,
                                         LeafLayout::kTriangles);
        const WideTree indices =
            widen(build_binary(scene, width, splits), scene.source(), width, LeafLayout::kIndices);
        EXPECT_EQ(indices.view.leaf_layout, LeafLayout::kIndices);
        kiwami::with_width(width, [&](auto n) { expect_equal_trees<n>(triangles, indices); });
        kiwami::verify_wide_tree(indices, scene.source(), scene.count(), memory_);
      }
    }
  }
}

TEST_F(IndexLeaves, AreReorderedAndFlattenedAsTriangleLeavesAre) {
  const TreeScene scene("soup", soup(5000, seed()));
  rays_ = kiwami::sample_rays(scene.source(), 2000, memory_);
  const std::span<const kiwami::RepresentativeRay> rays = {rays_.data(), rays_.size()};
  contraction_ = ContractionMethod::kRayDistribution;
  for (const uint32_t width : {4u, 8u, 16u}) {
    WideTree trees[2];
    for (const LeafLayout layout : {LeafLayout::kTriangles, LeafLayout::kIndices}) {
      WideTree& tree = trees[static_cast<uint32_t>(layout)];
      tree = widen(build_binary(scene, width, false), scene.source(), width, layout);
      kiwami::reorder_by_rays(tree, scene.source(), rays, {}, memory_, one_thread_);
      kiwami::verify_wide_tree(tree, scene.source(), scene.count(), memory_);
    }
    kiwami::with_width(width, [&](auto n) { expect_equal_trees<n>(trees[0], trees[1]); });
    const kiwami::FlatTree a = kiwami::flatten(trees[0], memory_);
    const kiwami::FlatTree b = kiwami::flatten(trees[1], memory_);
    ASSERT_EQ(a.nodes.bytes(), b.nodes.bytes());
    EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.bytes()), 0);
    ASSERT_EQ(a.primitive_ids.size(), b.primitive_ids.size());
    EXPECT_TRUE(
        std::equal(a.primitive_ids.begin(), a.primitive_ids.end(), b.primitive_ids.begin()));
  }
}

TEST_F(IndexLeaves, HoldEachBoxOnceInATreeOverBoxes) {
  std::vector<NamedMesh> meshes = degenerate_meshes(seed());
  meshes.push_back({"spheres", spheres(3000, seed())});
  meshes.push_back({"empty", {}});
  // Rays, as a caller may set them, meet nothing that is known by its box alone.
  rays_ = Array<kiwami::RepresentativeRay>(memory_, 1);
  rays_[0] = {{0, 0, 0}, 0.0f, {0, 0, 1}, 1.0f};
  for (const NamedMesh& named : meshes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const auto contraction : {ContractionMethod::kSurfaceArea, ContractionMethod::kOptimal,
                                     ContractionMethod::kRayDistribution}) {
        SCOPED_TRACE(named.name + ", width " + std::to_string(width));
        contraction_ = contraction;
        WideTree tree = widen_boxes(named.mesh, width);
        verify_boxes(tree, named.mesh);
        kiwami::reorder_by_surface_area(tree, memory_, one_thread_);
        verify_boxes(tree, named.mesh);
        kiwami::reorder_by_rays(tree, kNoTriangles, {rays_.data(), 1}, {}, memory_, one_thread_);
        verify_boxes(tree, named.mesh);
        EXPECT_EQ(kiwami::flatten(tree, memory_).primitive_ids.size(), named.mesh.triangles.size());
      }
    }
  }
}

/// Breaks one thing in a tree over boxes; the verifier must name it.
class CorruptedBoxTree : public IndexLeaves {
 protected:
  CorruptedBoxTree() : mesh_(spheres(2000, 1)) {
    tree_ = widen_boxes(mesh_, 8);
    verify_boxes(tree_, mesh_);
  }

  void expect_verdict(const char* part) {
    try {
      verify_boxes(tree_, mesh_);
      ADD_FAILURE() << "the verifier found nothing, expected: " << part;
    } catch (const kiwami::Error& error) {
      EXPECT_EQ(error.result(), KIWAMI_ERROR_VALIDATION);
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }

  /// The first node slot that refers to a leaf.
  std::pair<uint32_t, int> find_leaf_slot() {
    for (uint32_t i = 0; i < tree_.node_count; ++i) {
      for (int slot = 0; slot < 8; ++slot) {
        const ChildReference child = tree_.nodes<8>()[i].child[slot];
        if (child.mask() != 0 && child.is_leaf()) return {i, slot};
      }
    }
    throw std::logic_error("no such slot");
  }

  Mesh mesh_;
  WideTree tree_;
};

TEST_F(CorruptedBoxTree, UnknownPrimitive) {
  tree_.leaf_ids(0)[0] = 0;
  expect_verdict("has id 0, which no primitive has");
  tree_.leaf_ids(0)[0] = 4000;
  expect_verdict("has id 4000, expected below 4000");
}
TEST_F(CorruptedBoxTree, PrimitiveElsewhere) {
  std::swap(tree_.leaf_ids(0)[0], tree_.leaf_ids(tree_.leaf_block_count - 1)[0]);
  expect_verdict("leaves its box on axis");
}
TEST_F(CorruptedBoxTree, PrimitiveTwice) {
  tree_.leaf_ids(0)[0] = tree_.leaf_ids(0)[1];
  expect_verdict("in two lanes");
}
TEST_F(CorruptedBoxTree, LeafBoxAnUlpTooSmall) {
  const auto [node, slot] = find_leaf_slot();
  float& upper = tree_.nodes<8>()[node].bounds[2][1][slot];
  upper = std::nextafter(upper, -FLT_MAX);
  expect_verdict("leaves its box on axis 2");
}
TEST_F(CorruptedBoxTree, LaneWithoutAnOwner) {
  const auto [node, slot] = find_leaf_slot();
  ChildReference& child = tree_.nodes<8>()[node].child[slot];
  ASSERT_NE(child.mask() & (child.mask() - 1), 0u);
  child = ChildReference::to_leaf(child.offset(), child.mask() & (child.mask() - 1));
  expect_verdict("contents but no owner");
}
TEST_F(CorruptedBoxTree, MissingPrimitive) {
  mesh_.triangles.push_back(mesh_.triangles[0]);
  expect_verdict("has 2000 primitives, expected 2001");
}
TEST_F(CorruptedBoxTree, LayoutThatTheViewDoesNotShare) {
  tree_.view.leaf_layout = LeafLayout::kTriangles;
  expect_verdict("the view's leaf layout is 0, expected the tree's, which is 1");
}
TEST_F(CorruptedBoxTree, LeavesOfTriangles) {
  const TreeScene scene("spheres", mesh_);
  tree_ = widen(build_binary(scene, 8, false), scene.source(), 8, LeafLayout::kTriangles);
  expect_verdict("hold triangles, expected ids alone");
}

}  // namespace
}  // namespace kiwami_tests

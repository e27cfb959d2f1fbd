// SPDX-License-Identifier: Apache-2.0
// The order of children in wide trees.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <set>
#include <tuple>

#include "builders/binned_sah_builder.h"
#include "dispatch/dispatch.h"
#include "optimizers/nary_reorder.h"
#include "optimizers/sato_reorder.h"
#include "support/environment.h"
#include "unit/binary_tree_test.h"
#include "wide/slot_owners.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::RepresentativeRay;
using kiwami::SlotOwner;
using kiwami::WideNode;
using kiwami::WideTree;

class Reorder : public BinaryTreeTest {
 protected:
  WideTree build(const TreeScene& scene, uint32_t width) {
    kiwami::BinnedSahBuilder::Config config;
    config.max_leaf_size = config.block_size = width;
    kiwami::WideTreeConfig wide;
    wide.width = width;
    wide.contraction = kiwami::ContractionMethod::kOptimal;
    wide.max_leaf_size = width;
    return kiwami::build_wide_tree(
        kiwami::BinnedSahBuilder::build(scene.primitives(memory_), config, memory_, Threads(1)),
        scene.source(), wide, memory_, Threads(1));
  }

  void verify(const WideTree& tree, const TreeScene& scene) {
    kiwami::verify_wide_tree(tree, scene.source(), scene.count(), memory_);
  }

  Array<RepresentativeRay> rays_of(const TreeScene& scene, size_t count) {
    return kiwami::sample_rays(scene.source(), count, memory_);
  }

  /// What each owner's slots hold, in no order.
  template <int N>
  auto contents(const WideTree& tree) {
    std::vector<std::set<std::tuple<uint64_t, float, float>>> of_owner;
    const WideNode<N>* nodes = tree.nodes<N>();
    for (const SlotOwner& owner : kiwami::collect_owners<N>(tree, memory_)) {
      of_owner.emplace_back();
      for (uint32_t mask = owner.mask; mask != 0; mask &= mask - 1) {
        const int slot = std::countr_zero(mask);
        const WideNode<N>& node = nodes[owner.node];
        of_owner.back().insert(
            {node.child[slot].bits, node.bounds[0][0][slot], node.bounds[1][1][slot]});
      }
    }
    return std::multiset(of_owner.begin(), of_owner.end());
  }

  /// Nodes and leaf blocks that any-hit rays visit, and how many are stopped.
  std::pair<uint64_t, size_t> visits(const WideTree& tree, const Array<RepresentativeRay>& rays) {
    std::vector<kiwami_ray> asked;
    for (const RepresentativeRay& ray : rays) {
      asked.push_back({ray.origin.x, ray.origin.y, ray.origin.z, ray.tmin, ray.direction.x,
                       ray.direction.y, ray.direction.z, ray.tmax, 0.0f, ~0u, 0, 0});
    }
    std::vector<uint8_t> answers(asked.size());
    const kiwami::GeometryRange range = {0, 0, ~0u};
    kiwami::SceneView scene{tree.view, &range, 1, 0, 0, nullptr};
    kiwami::TraversalCounters counters{};
    kiwami::kernels_of(KIWAMI_ISA_SCALAR, tree.width)
        .any_hit_counted(scene,
                         {reinterpret_cast<const unsigned char*>(asked.data()), sizeof asked[0],
                          answers.data(), 1, asked.size()},
                         counters);
    return {counters.node_visits + counters.leaf_visits,
            static_cast<size_t>(std::count(answers.begin(), answers.end(), 1))};
  }
};

TEST_F(Reorder, SatoPutsLargeBoxesFirstAndKeepsTheTopology) {
  const TreeScene scene("soup", soup(6000, seed()));
  for (const uint32_t width : {4u, 8u, 16u}) {
    kiwami::with_width(width, [&](auto n) {
      WideTree tree = build(scene, width);
      const auto before = contents<n>(tree);
      kiwami::reorder_by_surface_area(tree, memory_, Threads(2));
      verify(tree, scene);
      EXPECT_EQ(contents<n>(tree), before);
      const WideNode<n>* nodes = tree.nodes<n>();
      for (const SlotOwner& owner : kiwami::collect_owners<n>(tree, memory_)) {
        float last = std::numeric_limits<float>::infinity();
        for (uint32_t mask = owner.mask; mask != 0; mask &= mask - 1) {
          const float area = kiwami::box_of(nodes[owner.node], std::countr_zero(mask)).half_area();
          EXPECT_LE(area, last);
          last = area;
        }
      }
    });
  }
}

TEST_F(Reorder, NaryKeepsTheTopologyAndTheAnswersAndLowersVisits) {
  const struct {
    Mesh mesh;
    double most_visits;  ///< part of those before
  } cases[] = {{soup(20000, seed()), 0.97}, {spheres(20000, seed()), 1.01}};
  for (const auto& one : cases) {
    const TreeScene scene("scene", one.mesh);
    const auto rays = rays_of(scene, 5000), others = rays_of(scene, 4321);
    for (const uint32_t width : {4u, 8u, 16u}) {
      kiwami::with_width(width, [&](auto n) {
        WideTree tree = build(scene, width);
        const auto before = contents<n>(tree);
        const auto [visits_before, stopped_before] = visits(tree, others);
        kiwami::reorder_by_rays(tree, scene.source(), rays, {}, memory_, Threads(1));
        verify(tree, scene);
        EXPECT_EQ(contents<n>(tree), before);
        const auto [visits_after, stopped_after] = visits(tree, others);
        EXPECT_EQ(stopped_after, stopped_before);
        const double part = static_cast<double>(visits_after) / static_cast<double>(visits_before);
        std::printf("width %u: %.1f %% of the visits\n", width, 100.0 * part);
        EXPECT_LT(part, one.most_visits);
      });
    }
  }
}

TEST_F(Reorder, NaryIsTheSameOnAnyNumberOfThreads) {
  const TreeScene scene("soup", soup(10000, seed()));
  const auto rays = rays_of(scene, 3000);
  WideTree expected = build(scene, 8), tree = build(scene, 8);
  kiwami::reorder_by_rays(expected, scene.source(), rays, {}, memory_, Threads(1));
  const kiwami::Parallel plain(0, run_on_plain_threads, nullptr, 8);
  kiwami::reorder_by_rays(tree, scene.source(), rays, {}, memory_, plain);
  EXPECT_EQ(std::memcmp(tree.memory.data(), expected.memory.data(), tree.memory.bytes()), 0);
}

TEST_F(Reorder, NaryVisitsFirstWhatStopsTheRaysItWasGiven) {
  // Two clusters of equal triangles, far apart: rays that meet one of them alone bring it forward.
  Mesh mesh;
  for (int i = 0; i < 64; ++i) {
    const float x = i < 32 ? -100.0f : 100.0f, y = static_cast<float>(i % 32);
    mesh.add({x, y, 0}, {x + 1, y, 0}, {x, y + 1, 0});
  }
  const TreeScene scene("two clusters", mesh);
  for (const float x : {-100.0f, 100.0f}) {
    // From above, each onto a triangle of one cluster.
    Array<RepresentativeRay> rays(memory_, 1000);
    for (size_t i = 0; i < rays.size(); ++i) {
      const float y = static_cast<float>(i % 32) + 0.25f;
      rays[i] = {{x + 0.25f, y, 5.0f}, 0.0f, {0, 0, -1}, 10.0f};
    }
    WideTree tree = build(scene, 4);
    kiwami::reorder_by_rays(tree, scene.source(), rays, {}, memory_, Threads(1));
    verify(tree, scene);
    ASSERT_FALSE(tree.view.root.is_leaf());
    const int first = std::countr_zero(tree.view.root.mask());
    EXPECT_EQ(kiwami::node_at<4>(tree.view.memory, tree.view.root).bounds[0][0][first] < 0.0f,
              x < 0.0f);
  }
}

TEST_F(Reorder, DegenerateTreesStayValid) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    const TreeScene scene(named.name, named.mesh);
    const auto rays = rays_of(scene, 100);
    for (const uint32_t width : {4u, 8u, 16u}) {
      WideTree tree = build(scene, width);
      kiwami::reorder_by_rays(tree, scene.source(), rays, {}, memory_, Threads(1));
      verify(tree, scene);
      kiwami::reorder_by_surface_area(tree, memory_, Threads(1));
      verify(tree, scene);
    }
  }
  WideTree empty = kiwami::build_wide_tree({}, {nullptr, 0}, {}, memory_, Threads(1));
  kiwami::reorder_by_surface_area(empty, memory_, Threads(1));
  kiwami::reorder_by_rays(empty, {nullptr, 0}, {}, {}, memory_, Threads(1));
}

TEST_F(Reorder, SampledRaysStartOnSurfacesInProportionToTheirArea) {
  // Two squares of areas 1 and 9, in different planes.
  Mesh mesh;
  mesh.add({0, 0, 0}, {1, 0, 0}, {1, 1, 0});
  mesh.add({0, 0, 0}, {1, 1, 0}, {0, 1, 0});
  mesh.add({0, 0, 10}, {3, 0, 10}, {3, 3, 10});
  mesh.add({0, 0, 10}, {3, 3, 10}, {0, 3, 10});
  const TreeScene scene("squares", mesh);
  const auto rays = rays_of(scene, 3000);
  ASSERT_EQ(rays.size(), 3000u);
  size_t on_small = 0, upwards = 0, is_long = 0;
  for (const RepresentativeRay& ray : rays) {
    if (ray.origin.z < 5.0f) ++on_small;
    if (ray.direction.z > 0.0f) ++upwards;
    if (ray.tmax > 100.0f) ++is_long;
  }
  EXPECT_NEAR(static_cast<double>(on_small), 300.0, 2.0);
  EXPECT_NEAR(static_cast<double>(is_long), 1000.0, 1.0);
  // Half of two thirds, and of the rays to anywhere those from the small square.
  EXPECT_NEAR(static_cast<double>(upwards), 1100.0, 150.0);
  Mesh flat;
  flat.add({0, 0, 0}, {1, 0, 0}, {2, 0, 0});
  EXPECT_EQ(rays_of(TreeScene("without area", flat), 100).size(), 0u);
}

}  // namespace
}  // namespace kiwami_tests

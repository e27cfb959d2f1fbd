// SPDX-License-Identifier: Apache-2.0
// The metrics of trees against their definitions, and the counts of visits.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

using Corner = std::array<long double, 3>;
using Polygon = std::vector<Corner>;

long double area(const Polygon& polygon) {
  long double sum[3] = {0, 0, 0};
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    for (int axis = 0; axis < 3; ++axis) {
      const int y = (axis + 1) % 3, z = (axis + 2) % 3;
      const long double from_y = a[y] - polygon[0][y], from_z = a[z] - polygon[0][z];
      const long double to_y = b[y] - polygon[0][y], to_z = b[z] - polygon[0][z];
      sum[axis] += from_y * to_z - from_z * to_y;
    }
  }
  return std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / 2;
}

/// What of a polygon lies in a node's box, by one half-space after the other.
Polygon within(Polygon polygon, const kiwami_bvh_node& node) {
  for (int plane = 0; plane < 6; ++plane) {
    const int axis = plane / 2;
    const auto depth = [&](const Corner& corner) {
      return plane % 2 ? node.upper[axis] - corner[axis] : corner[axis] - node.lower[axis];
    };
    Polygon kept;
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      const long double from = depth(a), to = depth(b);
      if (from >= 0) kept.push_back(a);
      if ((from >= 0) == (to >= 0)) continue;
      Corner middle;
      for (int k = 0; k < 3; ++k) middle[k] = (a[k] * to - b[k] * from) / (to - from);
      kept.push_back(middle);
    }
    polygon = kept;
  }
  return polygon;
}

Polygon polygon_of(const Triangles& mesh, uint32_t primitive) {
  Polygon polygon;
  for (uint32_t k = 0; k < 3; ++k) {
    const float* at = &mesh.vertices[3 * mesh.indices[3 * primitive + k]];
    polygon.push_back({at[0], at[1], at[2]});
  }
  return polygon;
}

/// For each node, the surface of triangles that are not below it in its box, over all surface: the
/// definition, triangle by triangle.
std::vector<long double> foreign_surface(const Bvh& bvh, const Triangles& mesh) {
  const std::vector<kiwami_bvh_node> nodes = nodes_of(bvh);
  const std::vector<kiwami_bvh_primitive> primitives = primitives_of(bvh);
  long double whole = 0;
  std::vector<Polygon> polygons;
  for (uint32_t i = 0; i < mesh.indices.size() / 3; ++i) {
    polygons.push_back(polygon_of(mesh, i));
    whole += area(polygons.back());
  }
  std::vector<long double> foreign(nodes.size());
  for (size_t n = 0; n < nodes.size(); ++n) {
    std::vector<bool> is_below(polygons.size());
    for (uint32_t i = 0; i < nodes[n].primitive_count; ++i) {
      is_below[primitives[nodes[n].first_primitive + i].primitive_id] = true;
    }
    for (uint32_t i = 0; i < polygons.size(); ++i) {
      if (!is_below[i]) foreign[n] += area(within(polygons[i], nodes[n])) / whole;
    }
  }
  return foreign;
}

struct Measured {
  kiwami_bvh_measures totals{};
  std::vector<kiwami_bvh_node_measures> nodes;
};

Measured measure(const Bvh& bvh, double node_cost = 1, double leaf_cost = 1) {
  kiwami_bvh_measure_desc desc;
  EXPECT_EQ(kiwami_bvh_measure_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.node_cost = node_cost;
  desc.leaf_cost = leaf_cost;
  Measured measured;
  measured.totals.struct_size = sizeof measured.totals;
  measured.nodes.resize(info_of(bvh).node_count);
  EXPECT_EQ(kiwami_bvh_measure(bvh.get(), &desc, &measured.totals, measured.nodes.data(), 0),
            KIWAMI_OK)
      << last_error();
  return measured;
}

/// Long thin triangles through the whole cube beside small ones.
Triangles slivers(uint32_t count, uint64_t seed) {
  Triangles made = random_triangles(count, seed);
  for (uint32_t i = 0; i < count; i += 3) {
    for (int axis = 0; axis < 3; ++axis) {
      float& far = made.vertices[9 * i + axis];
      far = -2 * far;
    }
  }
  return made;
}

/// A row of unit squares, each in a cube of its own.
Triangles apart(uint32_t count) {
  Triangles made;
  for (uint32_t i = 0; i < count; ++i) {
    const float x = 3.0f * static_cast<float>(i);
    made.vertices.insert(made.vertices.end(), {x, 0, 0, x + 1, 0, 1, x, 1, 0});
    made.indices.insert(made.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
  }
  return made;
}

class MeasureTest : public testing::Test {
 protected:
  MeasureTest() : device_(make_device()) {}

  Scene commit(const Triangles& triangles, double width, double leaf_size) {
    return commit(device_, triangles, width, leaf_size);
  }

  static Scene commit(const Device& device, const Triangles& triangles, double width,
                      double leaf_size) {
    const Geometry mesh = make_mesh(device, triangles.desc());
    Scene scene = make_scene(device);
    EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BVH_WIDTH, width),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_MAX_LEAF_SIZE, leaf_size),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
    return scene;
  }

  Device device_;
};

TEST_F(MeasureTest, EndPointOverlapIsThatOfItsDefinition) {
  const std::pair<const char*, Triangles> meshes[] = {
      {"random", random_triangles(300, 21)}, {"slivers", slivers(200, 22)}, {"flat", square(1)}};
  for (const auto& [name, mesh] : meshes) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const uint32_t leaf_size : {1u, 0u}) {
        const Bvh bvh = bvh_of(commit(mesh, width, leaf_size));
        const std::vector<kiwami_bvh_node> nodes = nodes_of(bvh);
        const std::vector<long double> expected = foreign_surface(bvh, mesh);
        const Measured measured = measure(bvh, 2, 3);
        long double total = 0;
        for (size_t i = 0; i < nodes.size(); ++i) {
          const long double epo = expected[i] * (nodes[i].child_count ? 2 : 3);
          EXPECT_NEAR(measured.nodes[i].epo, static_cast<double>(epo), 1e-12) << name << " " << i;
          total += epo;
        }
        EXPECT_NEAR(measured.totals.epo, static_cast<double>(total), 1e-10) << name;
        if (mesh.indices.size() > 6) {
          EXPECT_GT(total, 0.01L) << name;
        }
      }
    }
  }
}

TEST_F(MeasureTest, TrianglesInSeveralLeavesAreAtHomeInEach) {
  const Triangles mesh = slivers(300, 28);
  const Geometry geometry = make_mesh(device_, mesh.desc());
  const kiwami_parameter_value builder = {KIWAMI_PARAMETER_BUILDER, 0,
                                          KIWAMI_BUILDER_SPATIAL_SPLIT};
  kiwami_bvh_desc desc;
  ASSERT_EQ(kiwami_bvh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.geometry = geometry.get();
  desc.parameters = &builder;
  desc.parameter_count = 1;
  kiwami_bvh* made = nullptr;
  ASSERT_EQ(kiwami_bvh_build(device_.get(), &desc, &made), KIWAMI_OK) << last_error();
  const Bvh bvh(made);
  ASSERT_GT(info_of(bvh).primitive_count, 300u);
  const std::vector<long double> expected = foreign_surface(bvh, mesh);
  const Measured measured = measure(bvh);
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(measured.nodes[i].epo, static_cast<double>(expected[i]), 1e-12) << i;
  }
  EXPECT_NEAR(measured.totals.surface_area, measure(bvh_of(commit(mesh, 8, 0))).totals.surface_area,
              1e-9);
  // Refit where they are, they fill whole boxes, and the tree stays valid.
  ASSERT_EQ(kiwami_bvh_refit(bvh.get(), nullptr, 0, 0), KIWAMI_OK) << last_error();
  EXPECT_EQ(kiwami_bvh_validate(bvh.get()), KIWAMI_OK) << last_error();
}

TEST_F(MeasureTest, EndPointOverlapOfTwinsAndOfTrianglesApart) {
  Triangles twins = random_triangles(1, 23);
  twins.indices.insert(twins.indices.end(), {0, 1, 2});
  const Bvh bvh = bvh_of(commit(twins, 4, 1));
  ASSERT_EQ(info_of(bvh).leaf_count, 2u);
  EXPECT_NEAR(measure(bvh, 1, 5).totals.epo, 5.0, 1e-12);
  EXPECT_EQ(measure(bvh_of(commit(apart(50), 8, 1))).totals.epo, 0.0);
}

TEST_F(MeasureTest, SurfaceAreaHeuristicOfTreesByHand) {
  // One leaf: its cost, whatever its area.
  const Measured one = measure(bvh_of(commit(square(2), 8, 0)), 7, 3);
  ASSERT_EQ(one.nodes.size(), 1u);
  EXPECT_NEAR(one.totals.sah, 3.0, 1e-12);
  EXPECT_NEAR(one.totals.leaf_area, 1.0, 1e-12);
  EXPECT_EQ(one.totals.node_area, 0.0);
  EXPECT_NEAR(one.totals.surface_area, 4.0, 1e-12);

  // Two cubes of edge 1 in a box of 4 by 1 by 1: the root's area is 18, theirs 6 each.
  const Measured two = measure(bvh_of(commit(apart(2), 4, 1)), 7, 3);
  ASSERT_EQ(two.nodes.size(), 3u);
  EXPECT_NEAR(two.nodes[0].area, 18.0, 1e-4);
  EXPECT_NEAR(two.nodes[1].area, 6.0, 1e-4);
  EXPECT_NEAR(two.totals.sah, 7.0 + 3.0 * 12 / 18, 1e-4);
  EXPECT_NEAR(two.totals.leaf_area, 12.0 / 18, 1e-4);
}

TEST_F(MeasureTest, BlocksOfALeafAreTestedOneByOne) {
  const Bvh bvh = bvh_of(commit(apart(7), 8, 0));
  kiwami_bvh_measure_desc desc;
  ASSERT_EQ(kiwami_bvh_measure_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.node_cost = 0;
  desc.block_size = 1;
  desc.flags = KIWAMI_MEASURE_WITHOUT_EPO;
  kiwami_bvh_measures singly{};
  singly.struct_size = sizeof singly;
  ASSERT_EQ(kiwami_bvh_measure(bvh.get(), &desc, &singly, nullptr, 0), KIWAMI_OK);
  const std::vector<kiwami_bvh_node> nodes = nodes_of(bvh);
  const Measured usual = measure(bvh);
  double expected = 0;
  for (size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].child_count == 0) expected += nodes[i].primitive_count * usual.nodes[i].area;
  }
  EXPECT_NEAR(singly.sah, expected / usual.nodes[0].area, 1e-9);
  EXPECT_EQ(singly.epo, 0.0);
  EXPECT_EQ(singly.surface_area, 0.0);
}

TEST_F(MeasureTest, NodesAddUpAndAgreeWithTheScene) {
  const Scene scene = commit(random_triangles(2000, 24), 8, 0);
  kiwami_scene_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(kiwami_scene_get_info(scene.get(), &info), KIWAMI_OK);
  const Measured measured = measure(bvh_of(scene));
  EXPECT_NEAR(measured.totals.sah / info.sah_cost, 1.0, 1e-5);
  EXPECT_NEAR(measured.totals.node_area + measured.totals.leaf_area, measured.totals.sah, 1e-9);
  double sah = 0, epo = 0;
  for (const kiwami_bvh_node_measures& node : measured.nodes) {
    sah += node.sah;
    epo += node.epo;
  }
  EXPECT_EQ(sah, measured.totals.sah);
  EXPECT_EQ(epo, measured.totals.epo);
}

TEST_F(MeasureTest, MeasuresAreEqualToTheBitForAnyNumberOfThreads) {
  const Triangles mesh = slivers(6000, 25);
  ThreadRunner runner;
  runner.threads = 5;
  kiwami_device_desc desc = default_device();
  runner.install(desc, 5);
  const Device many = make_device(desc);
  desc = default_device();
  desc.thread_count = 1;
  const Device one = make_device(desc);
  const Measured a = measure(bvh_of(commit(one, mesh, 8, 0)));
  const Measured b = measure(bvh_of(commit(many, mesh, 8, 0)));
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof a.nodes[0]), 0);
  EXPECT_EQ(std::memcmp(&a.totals, &b.totals, sizeof a.totals), 0);
  EXPECT_GT(a.totals.epo, 0.0);
}

TEST_F(MeasureTest, ScenesWithoutTrianglesOrArea) {
  const Measured nothing = measure(bvh_of(commit(Triangles{}, 8, 0)));
  EXPECT_EQ(nothing.totals.sah, 0.0);
  EXPECT_EQ(nothing.totals.epo, 0.0);
  Triangles points;
  for (uint32_t i = 0; i < 40; ++i) {
    points.vertices.insert(points.vertices.end(), 9, 1.0f);
    points.indices.insert(points.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
  }
  const Bvh bvh = bvh_of(commit(points, 8, 1));
  const Measured measured = measure(bvh, 2, 3);
  const kiwami_bvh_info info = info_of(bvh);
  EXPECT_EQ(measured.totals.epo, 0.0);
  EXPECT_EQ(measured.totals.surface_area, 0.0);
  EXPECT_EQ(measured.totals.leaf_area, info.leaf_count);
  EXPECT_EQ(measured.totals.sah, 2 * (info.node_count - info.leaf_count) + 3 * info.leaf_count);
}

kiwami_visits count(const Scene& scene, const std::vector<kiwami_ray>& rays, uint32_t query,
                    std::vector<kiwami_ray_visits>& each) {
  kiwami_visits visits{};
  visits.struct_size = sizeof visits;
  each.resize(rays.size());
  EXPECT_EQ(kiwami_scene_count_visits(scene.get(), rays.data(), 0, rays.size(), query, &visits,
                                      each.data(), 0),
            KIWAMI_OK)
      << last_error();
  return visits;
}

TEST_F(MeasureTest, VisitsAddUpAndHitsAreThoseOfTheTraceCalls) {
  const Scene scene = commit(random_triangles(3000, 26), 8, 0);
  const std::vector<kiwami_ray> rays = random_rays(5000, 27);
  uint64_t hits = 0;
  for (const kiwami_hit& hit : closest_hits(scene, rays)) {
    if (hit.primitive_id != KIWAMI_INVALID_ID) ++hits;
  }
  uint64_t nodes[2];
  for (const uint32_t query : {KIWAMI_COUNT_CLOSEST_HIT, KIWAMI_COUNT_ANY_HIT}) {
    std::vector<kiwami_ray_visits> each;
    const kiwami_visits visits = count(scene, rays, query, each);
    EXPECT_EQ(visits.ray_count, rays.size());
    EXPECT_EQ(visits.hit_count, hits);
    uint64_t leaves = 0;
    nodes[query] = 0;
    for (const kiwami_ray_visits& of_ray : each) {
      nodes[query] += of_ray.node_visits;
      leaves += of_ray.leaf_visits;
    }
    EXPECT_EQ(visits.node_visits, nodes[query]);
    EXPECT_EQ(visits.leaf_visits, leaves);
    EXPECT_GE(leaves, hits);
    const double mean = double(leaves) / double(rays.size());
    double squares = 0;
    for (const kiwami_ray_visits& of_ray : each) {
      squares += (of_ray.leaf_visits - mean) * (of_ray.leaf_visits - mean);
    }
    EXPECT_NEAR(visits.leaf_count_variability, std::sqrt(squares / double(rays.size())), 1e-9);
  }
  EXPECT_LT(nodes[1], nodes[0]);
}

TEST_F(MeasureTest, VisitsOfOneLeafAndOfNothing) {
  const std::vector<kiwami_ray> rays = {ray_along_z(0.5f, 0.25f), ray_along_z(9, 9)};
  std::vector<kiwami_ray_visits> each;
  const kiwami_visits one = count(commit(square(2), 8, 0), rays, KIWAMI_COUNT_CLOSEST_HIT, each);
  EXPECT_EQ(one.node_visits, 0u);
  EXPECT_EQ(one.hit_count, 1u);
  EXPECT_EQ(each[0].leaf_visits, 1u);
  const Scene empty = commit(Triangles{}, 8, 0);
  const kiwami_visits none = count(empty, rays, KIWAMI_COUNT_ANY_HIT, each);
  EXPECT_EQ(none.leaf_visits, 0u);
  EXPECT_EQ(none.leaf_count_variability, 0.0);
  EXPECT_EQ(count(empty, {}, KIWAMI_COUNT_ANY_HIT, each).ray_count, 0u);
}

TEST_F(MeasureTest, BadArguments) {
  const Scene scene = commit(square(2), 8, 0);
  const Bvh bvh = bvh_of(scene);
  kiwami_bvh_measures measures{};
  measures.struct_size = sizeof measures;
  kiwami_bvh_measure_desc desc;
  EXPECT_EQ(kiwami_bvh_measure_desc_init(nullptr, sizeof desc), KIWAMI_ERROR_INVALID_ARGUMENT);
  const auto expect = [&](const char* sentence) {
    EXPECT_EQ(kiwami_bvh_measure(bvh.get(), &desc, &measures, nullptr, 0),
              KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(last_error(device_.get()), sentence);
    ASSERT_EQ(kiwami_bvh_measure_desc_init(&desc, sizeof desc), KIWAMI_OK);
  };
  ASSERT_EQ(kiwami_bvh_measure_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.node_cost = -1;
  expect("desc.node_cost is -1, expected 0 to 1e+06");
  desc.leaf_cost = NAN;
  expect("desc.leaf_cost is nan, expected 0 to 1e+06");
  desc.flags = 2;
  expect("desc.flags is 0x2, expected KIWAMI_MEASURE_* bits");
  desc.reserved = 5;
  expect("desc.reserved is 5, expected 0");
  EXPECT_EQ(kiwami_bvh_measure(nullptr, nullptr, nullptr, nullptr, 0),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_measure(bvh.get(), nullptr, nullptr, nullptr, 0), KIWAMI_OK);
  kiwami_bvh_node_measures node;
  EXPECT_EQ(kiwami_bvh_measure(bvh.get(), nullptr, nullptr, &node, 8),
            KIWAMI_ERROR_INVALID_ARGUMENT);

  const kiwami_ray ray = ray_along_z(0, 0);
  kiwami_ray_visits each;
  const auto call = [&](const kiwami_ray* rays, uint32_t query, size_t stride) {
    return kiwami_scene_count_visits(scene.get(), rays, 0, 1, query, nullptr, &each, stride);
  };
  EXPECT_EQ(call(&ray, KIWAMI_COUNT_CLOSEST_HIT, 0), KIWAMI_OK);
  EXPECT_EQ(call(nullptr, KIWAMI_COUNT_CLOSEST_HIT, 0), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(call(&ray, KIWAMI_COUNT_CLOSEST_HIT, 7), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(call(&ray, 2, 0), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()), "query is 2, expected one of KIWAMI_COUNT_*");
  EXPECT_EQ(kiwami_scene_count_visits(make_scene(device_).get(), &ray, 0, 1, 0, nullptr, &each, 0),
            KIWAMI_ERROR_INVALID_STATE);
}

}  // namespace
}  // namespace kiwami_api_tests

// SPDX-License-Identifier: Apache-2.0
// The builders that begin with a Morton curve, each against its definition in plain loops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "builders/curve_leaves.h"
#include "builders/lbvh_builder.h"
#include "builders/morton_order.h"
#include "builders/ploc_builder.h"
#include "bvh/tree_edit.h"
#include "math/extended_morton.h"
#include "math/morton.h"
#include "parallel/radix_sort.h"
#include "support/environment.h"
#include "support/random.h"
#include "unit/binary_tree_test.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::BinaryBvh;
using kiwami::BinaryNode;
using kiwami::Bounds;
using kiwami::BuildPrimitive;
using kiwami::CurveCode;
using kiwami::LbvhBuilder;
using kiwami::MortonOrder;
using kiwami::PlocBuilder;

class MortonBuilders : public BinaryTreeTest {
 protected:
  MortonOrder order_of(const Mesh& mesh, CurveCode code = CurveCode::kPlain) {
    return sort_by_morton_code(primitives_of(mesh, memory_), memory_, one_thread_, code);
  }

  BinaryBvh lbvh(const Mesh& mesh, const LbvhBuilder::Config& config,
                 const kiwami::Parallel& parallel) {
    return LbvhBuilder::build(primitives_of(mesh, memory_), config, memory_, parallel);
  }

  BinaryBvh ploc(const Mesh& mesh, uint32_t radius, const kiwami::Parallel& parallel) {
    return PlocBuilder::build(primitives_of(mesh, memory_), {radius}, memory_, parallel);
  }

  Threads one_thread_{1};
  kiwami::Parallel many_threads_{0, run_on_plain_threads, nullptr, 8};
};

TEST_F(MortonBuilders, CodesTakeTheBitsInTurn) {
  Random random(seed());
  for (int trial = 0; trial < 1000; ++trial) {
    const uint32_t value = random.bits() >> 11;
    uint64_t expected = 0;
    for (uint32_t bit = 0; bit < 21; ++bit) expected |= uint64_t{value >> bit & 1} << (3 * bit);
    ASSERT_EQ(kiwami::spread_by_three(value), expected);
  }
  const kiwami::MortonGrid grid({{-1, 5, 2}, {1, 5, 4}});
  EXPECT_EQ(grid.code({-1, 5, 2}), 0u);
  EXPECT_EQ(grid.code({1, 5, 2}), kiwami::spread_by_three(0x1FFFFF));
  EXPECT_EQ(grid.code({-1, 5, 4}), kiwami::spread_by_three(0x1FFFFF) << 2);
}

/// An extended code bit by bit: what each bit halves, and whether the box is beyond the middle.
uint64_t extended_code_by_definition(const Bounds& centroids, double scene_diagonal,
                                     const Bounds& box) {
  double low[4], high[4], value[4];
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = centroids.lower[axis];
    high[axis] = centroids.upper[axis];
    value[axis] = box.lower[axis] + box.upper[axis];
  }
  low[3] = 0;
  high[3] = scene_diagonal;
  value[3] = std::hypot(double(box.upper.x) - box.lower.x, double(box.upper.y) - box.lower.y,
                        double(box.upper.z) - box.lower.z);
  uint64_t code = 0;
  for (int bit = 0; bit < 63; ++bit) {
    int halved = 3;
    if (bit % 4 != 3) {
      halved = high[2] - low[2] >= high[1] - low[1] ? 2 : 1;
      if (high[0] - low[0] > high[halved] - low[halved]) halved = 0;
    }
    const double middle = (low[halved] + high[halved]) / 2;
    const bool is_beyond = value[halved] >= middle;
    (is_beyond ? low : high)[halved] = middle;
    code = code << 1 | (is_beyond ? 1 : 0);
  }
  return code;
}

TEST_F(MortonBuilders, ExtendedCodesHalveTheLongestAxisAndTheSizeInTurn) {
  // Extents and places are such that nothing is rounded.
  const Bounds centroids = {{0, 0, 0}, {4096, 64, 512}};
  const Bounds objects = {{0, 0, 0}, {0, 4096, 0}};
  const kiwami::ExtendedMortonGrid grid(centroids, objects);
  Random random(seed());
  for (int trial = 0; trial < 1000; ++trial) {
    Bounds box;
    for (int axis = 0; axis < 3; ++axis) {
      const auto extent = static_cast<uint32_t>(centroids.upper[axis]);
      const auto centre = static_cast<float>(random.below(extent));
      const auto half = static_cast<float>(random.below(512));
      box.lower[axis] = centre / 2 - half;
      box.upper[axis] = centre / 2 + half;
    }
    ASSERT_EQ(grid.code(box), extended_code_by_definition(centroids, 4096, box));
  }
  // A cube without sizes is cut as by plain codes: the last axis first.
  const kiwami::ExtendedMortonGrid cube({{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {1, 1, 1}});
  EXPECT_EQ(cube.code({{0, 0, 0.5f}, {0, 0, 0.5f}}) >> 62, 1u);
  EXPECT_EQ(cube.code({{0, 0.5f, 0}, {0, 0.5f, 0}}) >> 61, 1u);
  EXPECT_EQ(cube.code({{0.5f, 0, 0}, {0.5f, 0, 0}}) >> 60, 1u);
}

TEST_F(MortonBuilders, ExtendedCodesPartLargeFromSmall) {
  // A fine object on a large floor, whose triangles all stand in one cell of a plain code.
  Mesh mesh = terrain(40);
  for (Point& vertex : mesh.vertices) vertex = vertex * 0.001f;
  for (int i = 0; i < 16; ++i) {
    const auto x = static_cast<float>(i % 4), z = static_cast<float>(i / 4);
    mesh.add({25 * x - 50, 0, 25 * z - 50}, {25 * x - 25, 0, 25 * z - 50},
             {25 * x - 25, 0, 25 * z - 25});
  }
  const double plain = sah_cost(lbvh(mesh, {}, one_thread_), {});
  const double extended =
      sah_cost(lbvh(mesh, {LbvhBuilder::Delta::kCode, CurveCode::kExtended, 1}, one_thread_), {});
  std::printf("extended %.2f, plain %.2f\n", extended, plain);
  EXPECT_LT(extended, plain);
}

TEST_F(MortonBuilders, ChunksHaveTheLeastSumOfAreas) {
  for (const uint32_t count : {1u, 2u, 5u, 100u, 5000u}) {
    for (const uint32_t most : {2u, 4u, 16u}) {
      const MortonOrder order = order_of(soup(count, seed() + count));
      // The best partition of what stands left of each place, by blocks of 4096.
      std::vector<double> least(count + 1, std::numeric_limits<double>::infinity());
      least[0] = 0;
      for (uint32_t end = 1; end <= count; ++end) {
        for (uint32_t begin = end - 1;; --begin) {
          Bounds bounds = Bounds::empty();
          for (uint32_t i = begin; i < end; ++i) bounds.extend(order.primitives[i].bounds());
          least[end] = std::min(least[end], least[begin] + double(bounds.half_area()));
          if (begin % 4096 == 0 || end - begin == most) break;
        }
      }
      const auto along =
          leaves_by_area(order_of(soup(count, seed() + count)), most, memory_, many_threads_);
      double sum = 0;
      uint32_t next = 0;
      for (size_t i = 0; i < along.leaves.size(); ++i) {
        const BinaryNode& leaf = along.leaves[i];
        ASSERT_EQ(leaf.first, next);
        ASSERT_LE(leaf.count, most);
        ASSERT_EQ(along.codes[i], order.codes[next]);
        next += leaf.count;
        sum += double(leaf.bounds.half_area());
      }
      EXPECT_EQ(next, count);
      EXPECT_NEAR(sum, least[count], 1e-9 * sum) << count << " " << most;
    }
  }
}

TEST_F(MortonBuilders, RadixSortIsAStableSort) {
  struct Element {
    uint64_t key;
    uint32_t place;
  };
  Random random(seed());
  for (const size_t count : {0u, 1u, 2u, 1000u, 100000u}) {
    Array<Element> elements(memory_, count);
    for (uint32_t i = 0; i < count; ++i) {
      elements[i] = {uint64_t{random.below(3)} << 40 | random.below(500), i};
    }
    std::vector<Element> expected(elements.begin(), elements.end());
    std::stable_sort(expected.begin(), expected.end(),
                     [](const Element& a, const Element& b) { return a.key < b.key; });
    kiwami::radix_sort(
        elements, 42, [](const Element& element) { return element.key; }, memory_, many_threads_);
    for (size_t i = 0; i < count; ++i) ASSERT_EQ(elements[i].place, expected[i].place);
  }
}

/// Boxes around points, so that their codes are those of the points.
Array<BuildPrimitive> boxes_at(const std::vector<Point>& points, kiwami::Memory& memory) {
  Array<BuildPrimitive> boxes(memory, points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const kiwami::Vec3f at = {points[i].x, points[i].y, points[i].z};
    boxes[i] = {at, static_cast<uint32_t>(i), at, 0};
  }
  return boxes;
}

/// Many points anywhere; in few places; in one cell of the curve but for one that is far away, so
/// that no leading bits tell them apart; and in small clusters, within which none do.
std::vector<std::vector<Point>> point_clouds(uint64_t seed) {
  Random random(seed);
  std::vector<std::vector<Point>> clouds(4);
  for (int i = 0; i < 30000; ++i) {
    clouds[0].push_back({random.symmetric(), random.symmetric(), random.symmetric()});
    const auto coarse = [&] { return static_cast<float>(random.below(12)); };
    clouds[1].push_back({coarse(), coarse(), coarse()});
    const auto near = [&] { return random.unit() * 1e-4f; };
    clouds[2].push_back({near(), near(), near()});
    const Point centre = clouds[0][static_cast<size_t>(i % 300)];
    clouds[3].push_back(centre + Point{near(), near(), near()});
  }
  clouds[2].push_back({1, 1, 1});
  return clouds;
}

TEST_F(MortonBuilders, SortsByCodeAndThenByTheOrderGiven) {
  for (const std::vector<Point>& points : point_clouds(seed())) {
    const MortonOrder order =
        sort_by_morton_code(boxes_at(points, memory_), memory_, many_threads_, CurveCode::kPlain);
    ASSERT_EQ(order.codes.size(), points.size());
    std::vector<bool> has(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
      const uint32_t id = order.primitives[i].id;
      ASSERT_FALSE(has[id]);
      has[id] = true;
      if (i == 0) continue;
      ASSERT_LE(order.codes[i - 1], order.codes[i]);
      if (order.codes[i - 1] == order.codes[i]) {
        ASSERT_LT(order.primitives[i - 1].id, id);
      }
    }
  }
}

/// Leaves that are made on the way up are those that are made after.
TEST_F(MortonBuilders, LbvhMakesTheLeavesThatCollapsingMakes) {
  std::vector<NamedMesh> meshes = degenerate_meshes(seed());
  const size_t degenerate_count = meshes.size();
  meshes.push_back({"soup", soup(20000, seed())});
  meshes.push_back({"terrain", terrain(90)});
  for (size_t i = 0; i < meshes.size(); ++i) {
    const NamedMesh& named = meshes[i];
    SCOPED_TRACE(named.name);
    for (const auto delta : {LbvhBuilder::Delta::kCode, LbvhBuilder::Delta::kSurfaceArea}) {
      for (const uint32_t chunk : {1u, 3u}) {
        for (const uint32_t size : {4u, 8u}) {
          const kiwami::SahCosts costs = {1.0f, 1.0f, size};
          BinaryBvh after = lbvh(named.mesh, {delta, CurveCode::kPlain, chunk}, one_thread_);
          kiwami::collapse_leaves(after, size, costs, memory_);
          const BinaryBvh bvh =
              lbvh(named.mesh, {delta, CurveCode::kPlain, chunk, size, costs}, many_threads_);
          verify(bvh, named.mesh, size);
          if (i < degenerate_count) continue;  // too deep ones are halved before or after
          EXPECT_NEAR(sah_cost(bvh, costs), sah_cost(after, costs), 1e-6 * sah_cost(after, costs));
          EXPECT_NEAR(static_cast<double>(bvh.nodes.size()),
                      static_cast<double>(after.nodes.size()),
                      1e-3 * static_cast<double>(after.nodes.size()));
        }
      }
    }
  }
}

/// The linear BVH top-down: a range is cut at its greatest border.
class LinearByDefinition {
 public:
  LinearByDefinition(const MortonOrder& order, LbvhBuilder::Delta delta)
      : order_(order), delta_(delta) {}

  std::string text(size_t begin, size_t end) const {
    if (end - begin == 1) return std::to_string(order_.primitives[begin].id);
    size_t cut = begin;
    for (size_t i = begin + 1; i + 1 < end; ++i) {
      if (border(i) > border(cut)) cut = i;
    }
    return "(" + text(begin, cut + 1) + " " + text(cut + 1, end) + ")";
  }

 private:
  std::tuple<long double, size_t, size_t> border(size_t i) const {
    const double delta =
        delta_ == LbvhBuilder::Delta::kCode
            ? static_cast<long double>(order_.codes[i] ^ order_.codes[i + 1])
            : area_of_both(order_.primitives[i].bounds(), order_.primitives[i + 1].bounds());
    return {delta, i ^ (i + 1), i};
  }

  const MortonOrder& order_;
  LbvhBuilder::Delta delta_;
};

TEST_F(MortonBuilders, LbvhCutsEveryRangeAtItsGreatestBorder) {
  for (const uint32_t count : {1u, 2u, 3u, 7u, 100u, 2000u}) {
    // Coarse triangles too, many of which share a code.
    for (const Mesh& mesh : {soup(count, seed() + count), terrain(1 + count / 100)}) {
      for (const auto code : {CurveCode::kPlain, CurveCode::kExtended}) {
        const MortonOrder order = order_of(mesh, code);
        for (const auto delta : {LbvhBuilder::Delta::kCode, LbvhBuilder::Delta::kSurfaceArea}) {
          const BinaryBvh bvh = lbvh(mesh, {delta, code, 1}, one_thread_);
          verify(bvh, mesh, 1);
          EXPECT_EQ(text_of(bvh),
                    LinearByDefinition(order, delta).text(0, order.primitives.size()));
        }
      }
    }
  }
}

/// Locally ordered clustering over a list, a round at a time.
std::string clustered_by_definition(const MortonOrder& order, size_t radius) {
  struct Cluster {
    Bounds bounds;
    std::string text;
  };
  std::vector<Cluster> clusters;
  for (const BuildPrimitive& primitive : order.primitives) {
    clusters.push_back({primitive.bounds(), std::to_string(primitive.id)});
  }
  while (clusters.size() > 1) {
    std::vector<size_t> nearest(clusters.size());
    for (size_t i = 0; i < clusters.size(); ++i) {
      std::tuple<float, size_t> least{std::numeric_limits<float>::infinity(), 0};
      for (size_t j = i < radius ? 0 : i - radius; j < clusters.size() && j <= i + radius; ++j) {
        if (j == i) continue;
        const std::tuple<float, size_t> key{area_of_both(clusters[i].bounds, clusters[j].bounds),
                                            i ^ j};
        if (key < least) {
          least = key;
          nearest[i] = j;
        }
      }
    }
    std::vector<Cluster> joined;
    for (size_t i = 0; i < clusters.size(); ++i) {
      const size_t other = nearest[i];
      if (nearest[other] != i) {
        joined.push_back(clusters[i]);
      } else if (i < other) {
        Bounds both = clusters[i].bounds;
        both.extend(clusters[other].bounds);
        joined.push_back({both, "(" + clusters[i].text + " " + clusters[other].text + ")"});
      }
    }
    clusters = std::move(joined);
  }
  return clusters.front().text;
}

TEST_F(MortonBuilders, PlocJoinsWhatIsNearest) {
  for (const uint32_t count : {1u, 2u, 3u, 9u, 500u, 4500u}) {
    for (const Mesh& mesh : {soup(count, seed() + count), terrain(1 + count / 90)}) {
      for (const uint32_t radius : {4u, 8u, 16u}) {
        const BinaryBvh bvh = ploc(mesh, radius, one_thread_);
        verify(bvh, mesh, 1);
        EXPECT_EQ(text_of(bvh), clustered_by_definition(order_of(mesh), radius)) << count;
      }
    }
  }
}

TEST_F(MortonBuilders, AreTheSameOnAnyNumberOfThreads) {
  for (const Mesh& mesh : {soup(40000, seed()), spheres(20000, seed())}) {
    const LbvhBuilder::Config chunked = {LbvhBuilder::Delta::kCode, CurveCode::kExtended, 8};
    EXPECT_TRUE(are_equal(lbvh(mesh, {}, one_thread_), lbvh(mesh, {}, many_threads_)));
    EXPECT_TRUE(are_equal(lbvh(mesh, chunked, one_thread_), lbvh(mesh, chunked, many_threads_)));
    EXPECT_TRUE(are_equal(ploc(mesh, 16, one_thread_), ploc(mesh, 16, many_threads_)));
  }
}

TEST_F(MortonBuilders, DegenerateInputsGiveValidTrees) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    for (const auto code : {CurveCode::kPlain, CurveCode::kExtended}) {
      for (const uint32_t size : {1u, 3u, 16u}) {
        for (const auto delta : {LbvhBuilder::Delta::kCode, LbvhBuilder::Delta::kSurfaceArea}) {
          verify(lbvh(named.mesh, {delta, code, size}, many_threads_), named.mesh, size);
        }
      }
    }
    verify(ploc(named.mesh, 16, many_threads_), named.mesh, 1);
  }
}

/// Runs loops on the calling thread, and counts them in *user.
int32_t count_loops(void* user, size_t count, kiwami_parallel_task task, void* data) {
  ++*static_cast<size_t*>(user);
  for (size_t i = 0; i < count; ++i) task(data, i);
  return KIWAMI_OK;
}

TEST_F(MortonBuilders, PlocDoesNotTakeARoundForEachOfBoxesInBoxes) {
  constexpr uint32_t kCount = 5000;
  Mesh mesh;
  for (uint32_t i = kCount; i > 0; --i) {
    const auto size = static_cast<float>(i);
    mesh.add({-size, -size, -size}, {size, size, size}, {0, 0, 0});
  }
  size_t loops = 0;
  const kiwami::Parallel counting(0, count_loops, &loops, 2);
  verify(ploc(mesh, 16, counting), mesh, 1);
  // One pair a round is each other's nearest, of the first and smallest ones.
  EXPECT_LT(loops, 500u);
}

TEST_F(MortonBuilders, PlocCostsLessThanLbvh) {
  for (const Mesh& mesh : {soup(20000, seed()), spheres(20000, seed())}) {
    const double linear = sah_cost(lbvh(mesh, {}, one_thread_), {});
    const double clustered = sah_cost(ploc(mesh, 16, one_thread_), {});
    std::printf("PLOC %.2f, LBVH %.2f\n", clustered, linear);
    EXPECT_LT(clustered, linear);
  }
}

}  // namespace
}  // namespace kiwami_tests

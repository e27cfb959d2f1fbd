// SPDX-License-Identifier: Apache-2.0
// The builders that begin with a Morton curve, each against its definition in plain loops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "builders/lbvh_builder.h"
#include "builders/morton_order.h"
#include "builders/ploc_builder.h"
#include "bvh/tree_edit.h"
#include "math/morton.h"
#include "parallel/radix_sort.h"
#include "support/environment.h"
#include "support/random.h"
#include "unit/binary_tree_test.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::BinaryBvh;
using kiwami::Bounds;
using kiwami::BuildPrimitive;
using kiwami::LbvhBuilder;
using kiwami::MortonOrder;
using kiwami::PlocBuilder;

class MortonBuilders : public BinaryTreeTest {
 protected:
  MortonOrder order_of(const Mesh& mesh) {
    return sort_by_morton_code(primitives_of(mesh, memory_), memory_, one_thread_);
  }

  BinaryBvh lbvh(const Mesh& mesh, LbvhBuilder::Delta delta, const kiwami::Parallel& parallel) {
    return LbvhBuilder::build(primitives_of(mesh, memory_), {delta}, memory_, parallel);
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
      const MortonOrder order = order_of(mesh);
      for (const auto delta : {LbvhBuilder::Delta::kCode, LbvhBuilder::Delta::kSurfaceArea}) {
        const BinaryBvh bvh = lbvh(mesh, delta, one_thread_);
        verify(bvh, mesh, 1);
        EXPECT_EQ(text_of(bvh), LinearByDefinition(order, delta).text(0, order.primitives.size()));
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
      for (size_t j = 0; j < clusters.size(); ++j) {
        if (j == i || std::max(i, j) - std::min(i, j) > radius) continue;
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
  for (const uint32_t count : {1u, 2u, 3u, 9u, 500u}) {
    for (const Mesh& mesh : {soup(count, seed() + count), terrain(1 + count / 30)}) {
      for (const uint32_t radius : {1u, 8u, 100u}) {
        const BinaryBvh bvh = ploc(mesh, radius, one_thread_);
        verify(bvh, mesh, 1);
        EXPECT_EQ(text_of(bvh), clustered_by_definition(order_of(mesh), radius)) << count;
      }
    }
  }
}

TEST_F(MortonBuilders, AreTheSameOnAnyNumberOfThreads) {
  for (const Mesh& mesh : {soup(40000, seed()), spheres(20000, seed())}) {
    EXPECT_TRUE(are_equal(lbvh(mesh, LbvhBuilder::Delta::kCode, one_thread_),
                          lbvh(mesh, LbvhBuilder::Delta::kCode, many_threads_)));
    EXPECT_TRUE(are_equal(ploc(mesh, 16, one_thread_), ploc(mesh, 16, many_threads_)));
  }
}

TEST_F(MortonBuilders, DegenerateInputsGiveValidTrees) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    verify(lbvh(named.mesh, LbvhBuilder::Delta::kCode, many_threads_), named.mesh, 1);
    verify(lbvh(named.mesh, LbvhBuilder::Delta::kSurfaceArea, many_threads_), named.mesh, 1);
    verify(ploc(named.mesh, 16, many_threads_), named.mesh, 1);
  }
}

TEST_F(MortonBuilders, PlocCostsLessThanLbvh) {
  for (const Mesh& mesh : {soup(20000, seed()), spheres(20000, seed())}) {
    const double linear = sah_cost(lbvh(mesh, LbvhBuilder::Delta::kCode, one_thread_), {});
    const double clustered = sah_cost(ploc(mesh, 16, one_thread_), {});
    std::printf("PLOC %.2f, LBVH %.2f\n", clustered, linear);
    EXPECT_LT(clustered, linear);
  }
}

}  // namespace
}  // namespace kiwami_tests

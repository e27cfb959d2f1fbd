// SPDX-License-Identifier: Apache-2.0
// The agglomerative builders, each against its definition in plain loops.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <tuple>
#include <vector>

#include "builders/aac_builder.h"
#include "builders/agglomerative_builder.h"
#include "builders/lbvh_builder.h"
#include "builders/morton_order.h"
#include "bvh/sah_cost.h"
#include "support/environment.h"
#include "unit/binary_tree_test.h"

namespace kiwami_tests {
namespace {

using kiwami::AacBuilder;
using kiwami::AgglomerativeBuilder;
using kiwami::BinaryBvh;
using kiwami::Bounds;
using kiwami::MortonOrder;

class ClusteringBuilders : public BinaryTreeTest {
 protected:
  MortonOrder order_of(const Mesh& mesh) {
    return sort_by_morton_code(primitives_of(mesh, memory_), memory_, one_thread_);
  }

  BinaryBvh aac(const Mesh& mesh, const AacBuilder::Config& config,
                const kiwami::Parallel& parallel) {
    return AacBuilder::build(primitives_of(mesh, memory_), config, memory_, parallel);
  }

  BinaryBvh agglomerative(const Mesh& mesh, uint32_t matrix_size,
                          const kiwami::Parallel& parallel) {
    return AgglomerativeBuilder::build(primitives_of(mesh, memory_), {matrix_size}, memory_,
                                       parallel);
  }

  Threads one_thread_{1};
  kiwami::Parallel many_threads_{0, run_on_plain_threads, nullptr, 8};
};

/// A cluster of the definitions.
struct Group {
  Bounds bounds;
  size_t count, place;
  std::string text;
};

std::vector<Group> groups_of(const MortonOrder& order, size_t begin, size_t end) {
  std::vector<Group> groups;
  for (size_t i = begin; i < end; ++i) {
    groups.push_back({order.primitives[i].bounds(), 1, i, std::to_string(order.primitives[i].id)});
  }
  return groups;
}

/// Joins the nearest of all pairs until so many are left.
std::vector<Group> joined(std::vector<Group> groups, size_t target) {
  while (groups.size() > target) {
    std::tuple<float, size_t, size_t, size_t> least{};
    size_t first = 0, second = 0;
    for (size_t i = 0; i < groups.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        const Group &a = groups[i], &b = groups[j];
        const std::tuple<float, size_t, size_t, size_t> key{area_of_both(a.bounds, b.bounds),
                                                            a.count + b.count, a.place ^ b.place,
                                                            std::min(a.place, b.place)};
        if (second != 0 && least < key) continue;
        least = key;
        first = j;
        second = i;
      }
    }
    if (groups[second].place < groups[first].place) std::swap(groups[first], groups[second]);
    Group& left = groups[first];
    const Group& right = groups[second];
    left.bounds.extend(right.bounds);
    left.count += right.count;
    left.text = "(" + left.text + " " + right.text + ")";
    groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(second));
  }
  return groups;
}

TEST_F(ClusteringBuilders, AgglomerativeJoinsTheNearestOfAllPairs) {
  for (const uint32_t count : {1u, 2u, 3u, 9u, 40u, 300u}) {
    for (const Mesh& mesh : {soup(count, seed() + count), terrain(1 + count / 30)}) {
      const MortonOrder order = order_of(mesh);
      const std::string expected = joined(groups_of(order, 0, order.codes.size()), 1)[0].text;
      // By searching alone, by both, and by the matrix alone.
      for (const uint32_t matrix_size : {1u, 20u, 1000u}) {
        const BinaryBvh bvh = agglomerative(mesh, matrix_size, many_threads_);
        verify(bvh, mesh, 1);
        EXPECT_EQ(text_of(bvh), expected) << count << " " << matrix_size;
      }
    }
  }
}

TEST_F(ClusteringBuilders, SearchingFindsWhatTheMatrixFinds) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    const BinaryBvh searched = agglomerative(named.mesh, 1, many_threads_);
    verify(searched, named.mesh, 1);
    EXPECT_TRUE(are_equal(searched, agglomerative(named.mesh, 5000, one_thread_)));
  }
}

TEST_F(ClusteringBuilders, EqualBoxesGiveABalancedTree) {
  Mesh mesh;
  for (int i = 0; i < 4096; ++i) mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 2});
  const BinaryBvh bvh = agglomerative(mesh, 1, one_thread_);
  // Depth first: the leftmost leaf ends the first path, of 12 inner nodes, two nodes a level.
  uint32_t depth = 0, node = 0;
  for (; !bvh.nodes[node].is_leaf(); node = bvh.nodes[node].first) ++depth;
  EXPECT_EQ(depth, 12u);
}

/// Approximate agglomerative clustering by its recursion.
class ApproximateByDefinition {
 public:
  ApproximateByDefinition(const MortonOrder& order, const AacBuilder::Config& config)
      : order_(order), config_(config) {}

  std::string text() const { return joined(build(0, order_.codes.size(), 62), 1)[0].text; }

 private:
  size_t kept(size_t size) const {
    const double exponent = 0.5 - config_.epsilon;
    const double wanted = std::pow(config_.cell_size, 1 - exponent) / 2 *
                          std::pow(static_cast<double>(size), exponent);
    return std::max<size_t>(1, static_cast<size_t>(std::lround(wanted)));
  }

  std::vector<Group> build(size_t begin, size_t end, int bit) const {
    if (end - begin < config_.cell_size) {
      return joined(groups_of(order_, begin, end), kept(config_.cell_size));
    }
    size_t middle = begin;
    for (; bit >= 0; --bit) {
      middle = begin;
      while (middle < end && (order_.codes[middle] >> bit & 1) == 0) ++middle;
      if (middle != begin && middle != end) break;
    }
    if (bit < 0) middle = begin + (end - begin + 1) / 2;
    std::vector<Group> both = build(begin, middle, bit - 1);
    const std::vector<Group> right = build(middle, end, bit - 1);
    both.insert(both.end(), right.begin(), right.end());
    return joined(std::move(both), kept(end - begin));
  }

  const MortonOrder& order_;
  const AacBuilder::Config& config_;
};

TEST_F(ClusteringBuilders, AacJoinsWithinCells) {
  for (const uint32_t count : {1u, 2u, 3u, 30u, 700u}) {
    for (const Mesh& mesh : {soup(count, seed() + count), terrain(1 + count / 30)}) {
      for (const auto& config : {AacBuilder::high_quality(), AacBuilder::fast()}) {
        const BinaryBvh bvh = aac(mesh, config, many_threads_);
        verify(bvh, mesh, 1);
        EXPECT_EQ(text_of(bvh), ApproximateByDefinition(order_of(mesh), config).text()) << count;
      }
    }
  }
}

TEST_F(ClusteringBuilders, AacOfOneCellIsExact) {
  const Mesh mesh = soup(1000, seed());
  EXPECT_TRUE(are_equal(aac(mesh, {2000, 0.1}, one_thread_), agglomerative(mesh, 1, one_thread_)));
}

TEST_F(ClusteringBuilders, AreTheSameOnAnyNumberOfThreads) {
  for (const Mesh& mesh : {soup(20000, seed()), spheres(20000, seed())}) {
    for (const auto& config : {AacBuilder::high_quality(), AacBuilder::fast()}) {
      EXPECT_TRUE(are_equal(aac(mesh, config, one_thread_), aac(mesh, config, many_threads_)));
    }
    EXPECT_TRUE(
        are_equal(agglomerative(mesh, 512, one_thread_), agglomerative(mesh, 512, many_threads_)));
  }
}

TEST_F(ClusteringBuilders, DegenerateInputsGiveValidTrees) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    verify(aac(named.mesh, AacBuilder::high_quality(), many_threads_), named.mesh, 1);
    verify(aac(named.mesh, AacBuilder::fast(), many_threads_), named.mesh, 1);
  }
}

TEST_F(ClusteringBuilders, CostLessThanALinearTree) {
  for (const Mesh& mesh : {soup(20000, seed()), spheres(20000, seed())}) {
    const BinaryBvh lbvh =
        kiwami::LbvhBuilder::build(primitives_of(mesh, memory_), {}, memory_, one_thread_);
    const double linear = sah_cost(lbvh, {});
    const double fast = sah_cost(aac(mesh, AacBuilder::fast(), one_thread_), {});
    const double high = sah_cost(aac(mesh, AacBuilder::high_quality(), one_thread_), {});
    const double exact = sah_cost(agglomerative(mesh, 512, one_thread_), {});
    std::printf("LBVH %.2f, AAC %.2f and %.2f, agglomerative %.2f\n", linear, fast, high, exact);
    EXPECT_LT(fast, linear);
    EXPECT_LT(high, fast);
    EXPECT_LT(exact, linear);
  }
}

}  // namespace
}  // namespace kiwami_tests

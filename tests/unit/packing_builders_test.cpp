// SPDX-License-Identifier: Apache-2.0
// Mini trees, sort-tile-recursive packing and the implicit tree, against their definitions.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "builders/lbvh_builder.h"
#include "builders/mini_tree_builder.h"
#include "builders/morton_order.h"
#include "builders/oibvh_builder.h"
#include "builders/str_builder.h"
#include "bvh/sah_cost.h"
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
using kiwami::ImplicitBvh;
using kiwami::ImplicitLayout;
using kiwami::MiniTreeBuilder;
using kiwami::MortonOrder;
using kiwami::OibvhBuilder;
using kiwami::StrBuilder;

class PackingBuilders : public BinaryTreeTest {
 protected:
  MortonOrder order_of(const Mesh& mesh) {
    return sort_by_morton_code(primitives_of(mesh, memory_), memory_, one_thread_);
  }
  BinaryBvh mini_trees(const Mesh& mesh, const MiniTreeBuilder::Config& config,
                       const kiwami::Parallel& parallel) {
    return MiniTreeBuilder::build(primitives_of(mesh, memory_), config, memory_, parallel);
  }
  BinaryBvh str(const Mesh& mesh, uint32_t page_size, const kiwami::Parallel& parallel) {
    return StrBuilder::build(primitives_of(mesh, memory_), {page_size}, memory_, parallel);
  }
  BinaryBvh oibvh(const Mesh& mesh, const kiwami::Parallel& parallel) {
    return OibvhBuilder::build(primitives_of(mesh, memory_), memory_, parallel);
  }

  Threads one_thread_{1};
  kiwami::Parallel many_threads_{0, run_on_plain_threads, nullptr, 8};
};

TEST_F(PackingBuilders, ImplicitNodesFillTheirMemoryInTheOrderOfLevels) {
  for (uint32_t count = 1; count <= 300; ++count) {
    const ImplicitLayout layout(count);
    // By definition: a node is virtual when both of its children are, a leaf when it is no place's.
    const uint32_t complete = std::bit_ceil(count);
    std::vector<char> is_virtual(2 * complete - 1);
    for (uint32_t node = 2 * complete - 1; node-- > 0;) {
      is_virtual[node] = node >= complete - 1
                             ? node - (complete - 1) >= count
                             : is_virtual[2 * node + 1] != 0 && is_virtual[2 * node + 2] != 0;
    }
    uint32_t position = 0;
    for (uint32_t node = 0; node < 2 * complete - 1; ++node) {
      ASSERT_EQ(layout.is_virtual(node), is_virtual[node] != 0) << count << " " << node;
      ASSERT_EQ(layout.is_leaf(node), node >= complete - 1);
      if (is_virtual[node] != 0) continue;
      ASSERT_EQ(layout.position(node), position++) << count << " " << node;
    }
    ASSERT_EQ(layout.node_count(), position) << count;
  }
  // The example of the paper.
  EXPECT_EQ(ImplicitLayout(11).node_count(), 23u);
}

bool overlap(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (a.lower[axis] > b.upper[axis] || b.lower[axis] > a.upper[axis]) return false;
  }
  return true;
}

TEST_F(PackingBuilders, ImplicitTraversalFindsWhatAllPrimitivesTell) {
  Random random(seed());
  size_t found_count = 0;
  for (const uint32_t count : {0u, 1u, 2u, 3u, 11u, 64u, 65u, 1000u}) {
    const MortonOrder order = order_of(soup(count, seed() + count));
    const ImplicitBvh implicit(order.primitives, memory_, many_threads_);
    for (int trial = 0; trial < 50; ++trial) {
      Bounds query = Bounds::empty();
      for (int corner = 0; corner < 2; ++corner) {
        const float x = random.symmetric(), y = random.symmetric(), z = random.symmetric();
        query.extend(kiwami::Vec3f{100 * x, 100 * y, 100 * z});
      }
      std::vector<uint32_t> expected, found;
      for (const BuildPrimitive& primitive : order.primitives) {
        if (overlap(primitive.bounds(), query)) expected.push_back(primitive.id);
      }
      implicit.traverse([&](const Bounds& bounds) { return overlap(bounds, query); },
                        [&](uint32_t id) { found.push_back(id); });
      EXPECT_EQ(found, expected) << count;
      found_count += found.size();
    }
  }
  EXPECT_GT(found_count, 100u);
}

std::string complete_text(const MortonOrder& order, size_t begin, size_t size) {
  if (begin >= order.codes.size()) return "";
  if (size == 1) return std::to_string(order.primitives[begin].id);
  const std::string left = complete_text(order, begin, size / 2);
  const std::string right = complete_text(order, begin + size / 2, size / 2);
  return right.empty() ? left : "(" + left + " " + right + ")";
}

TEST_F(PackingBuilders, OibvhIsTheCompleteTreeAlongTheCurve) {
  for (uint32_t count = 1; count <= 70; ++count) {
    const Mesh mesh = soup(count, seed() + count);
    const BinaryBvh bvh = oibvh(mesh, many_threads_);
    verify(bvh, mesh, 1);
    EXPECT_EQ(text_of(bvh), complete_text(order_of(mesh), 0, std::bit_ceil(count))) << count;
  }
}

/// The pages of sort-tile-recursive packing by recursion over the axes.
class TilesByDefinition {
 public:
  TilesByDefinition(const Array<BuildPrimitive>& primitives, size_t page_size)
      : page_size_(page_size) {
    for (const BuildPrimitive& primitive : primitives) {
      entries_.push_back({primitive.bounds(), std::to_string(primitive.id)});
    }
  }

  std::string text() {
    while (entries_.size() > 1) {
      cut(entries_, 0);
      std::vector<Entry> pages;
      for (size_t i = 0; i < entries_.size(); i += page_size_) {
        pages.push_back(halves(i, std::min(i + page_size_, entries_.size())));
      }
      entries_ = pages;
    }
    return entries_[0].text;
  }

 private:
  struct Entry {
    Bounds bounds;
    std::string text;
  };

  void cut(std::vector<Entry>& entries, int axis) const {
    std::stable_sort(entries.begin(), entries.end(), [axis](const Entry& a, const Entry& b) {
      return a.bounds.lower[axis] + a.bounds.upper[axis] <
             b.bounds.lower[axis] + b.bounds.upper[axis];
    });
    if (axis == 2) return;
    // The least number of parts along each axis left whose power is no less than all pages.
    const double pages = std::ceil(static_cast<double>(entries.size()) / double(page_size_));
    const int axes = 3 - axis;
    double other_axes = 1;
    while (std::pow(other_axes, axes) < std::pow(pages, axes - 1)) ++other_axes;
    const size_t part = page_size_ * static_cast<size_t>(other_axes);
    std::vector<Entry> cut_entries;
    for (size_t i = 0; i < entries.size(); i += part) {
      std::vector<Entry> some(entries.begin() + std::ptrdiff_t(i),
                              entries.begin() + std::ptrdiff_t(std::min(i + part, entries.size())));
      cut(some, axis + 1);
      cut_entries.insert(cut_entries.end(), some.begin(), some.end());
    }
    entries = cut_entries;
  }

  Entry halves(size_t begin, size_t end) const {
    if (end - begin == 1) return entries_[begin];
    const size_t middle = begin + (end - begin + 1) / 2;
    Entry left = halves(begin, middle);
    const Entry right = halves(middle, end);
    left.bounds.extend(right.bounds);
    left.text = "(" + left.text + " " + right.text + ")";
    return left;
  }

  size_t page_size_;
  std::vector<Entry> entries_;
};

TEST_F(PackingBuilders, StrTilesAlongEachAxis) {
  for (const uint32_t count : {1u, 2u, 8u, 9u, 100u, 3000u}) {
    const Mesh mesh = soup(count, seed() + count);
    for (const uint32_t page_size : {2u, 8u, 16u}) {
      const BinaryBvh bvh = str(mesh, page_size, many_threads_);
      verify(bvh, mesh, 1);
      EXPECT_EQ(text_of(bvh), TilesByDefinition(primitives_of(mesh, memory_), page_size).text())
          << count << " " << page_size;
    }
  }
}

/// The least cost of any split of a set of primitives by sorting them along an axis.
double least_split_cost(const std::vector<BuildPrimitive>& primitives) {
  double least = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<BuildPrimitive> sorted = primitives;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [axis](const BuildPrimitive& a, const BuildPrimitive& b) {
                       return a.doubled_centroid()[axis] < b.doubled_centroid()[axis];
                     });
    for (size_t left = 1; left < sorted.size(); ++left) {
      Bounds sides[2] = {Bounds::empty(), Bounds::empty()};
      for (size_t i = 0; i < sorted.size(); ++i) sides[i >= left].extend(sorted[i].bounds());
      const double cost = double(sides[0].half_area()) * double(left) +
                          double(sides[1].half_area()) * double(sorted.size() - left);
      least = std::min(least, cost);
    }
  }
  return least;
}

std::vector<BuildPrimitive> primitives_below(const BinaryBvh& bvh, uint32_t node,
                                             const Array<BuildPrimitive>& by_id) {
  std::vector<BuildPrimitive> primitives;
  for_each_leaf(bvh, node, [&](const BinaryNode& leaf) {
    primitives.push_back(by_id[bvh.primitive_ids[leaf.first]]);
  });
  return primitives;
}

TEST_F(PackingBuilders, PrunedToLeavesOneSweepSplitsEveryNodeAtLeastCost) {
  const Mesh mesh = soup(200, seed());
  const Array<BuildPrimitive> by_id = primitives_of(mesh, memory_);
  // Everything is pruned, or everything is one group: each is a full sweep.
  const BinaryBvh pruned = mini_trees(mesh, {16, 0.0f}, many_threads_);
  EXPECT_TRUE(are_equal(pruned, mini_trees(mesh, {512, 1.0f}, many_threads_)));
  for (uint32_t i = 0; i < pruned.nodes.size(); ++i) {
    const BinaryNode& node = pruned.nodes[i];
    if (node.is_leaf()) continue;
    double cost = 0;
    for (const uint32_t child : {node.first, node.first + 1}) {
      cost += double(pruned.nodes[child].bounds.half_area()) *
              double(primitives_below(pruned, child, by_id).size());
    }
    EXPECT_LE(cost, least_split_cost(primitives_below(pruned, i, by_id)) * (1 + 1e-9));
  }
}

TEST_F(PackingBuilders, MiniTreesKeepTheirGroupsWithoutPruning) {
  const Mesh mesh = soup(3000, seed());
  const MortonOrder order = order_of(mesh);
  // Nothing is pruned, so the leaves of each group of the curve stand side by side.
  const BinaryBvh bvh = mini_trees(mesh, {64, 2.0f}, many_threads_);
  verify(bvh, mesh, 1);
  std::set<std::set<uint32_t>> subtrees;
  for (uint32_t i = 0; i < bvh.nodes.size(); ++i) {
    std::set<uint32_t> ids;
    for_each_leaf(bvh, i,
                  [&](const BinaryNode& leaf) { ids.insert(bvh.primitive_ids[leaf.first]); });
    if (ids.size() <= 64) subtrees.insert(ids);
  }
  size_t group_count = 0;
  std::vector<std::pair<uint32_t, uint32_t>> open{{0, 3000}};
  while (!open.empty()) {
    const auto [begin, end] = open.back();
    open.pop_back();
    if (end - begin > 64) {
      const uint32_t middle = middle_of_cell(order.codes, begin, end);
      open.emplace_back(begin, middle);
      open.emplace_back(middle, end);
      continue;
    }
    std::set<uint32_t> ids;
    for (uint32_t i = begin; i < end; ++i) ids.insert(order.primitives[i].id);
    EXPECT_TRUE(subtrees.count(ids) != 0);
    ++group_count;
  }
  EXPECT_GT(group_count, 40u);
}

TEST_F(PackingBuilders, AreTheSameOnAnyNumberOfThreads) {
  for (const Mesh& mesh : {soup(40000, seed()), spheres(20000, seed())}) {
    EXPECT_TRUE(are_equal(oibvh(mesh, one_thread_), oibvh(mesh, many_threads_)));
    EXPECT_TRUE(are_equal(str(mesh, 8, one_thread_), str(mesh, 8, many_threads_)));
    EXPECT_TRUE(are_equal(mini_trees(mesh, {}, one_thread_), mini_trees(mesh, {}, many_threads_)));
  }
}

TEST_F(PackingBuilders, DegenerateInputsGiveValidTrees) {
  for (const NamedMesh& named : degenerate_meshes(seed())) {
    SCOPED_TRACE(named.name);
    verify(oibvh(named.mesh, many_threads_), named.mesh, 1);
    verify(str(named.mesh, 8, many_threads_), named.mesh, 1);
    for (const float prune_area : {0.0f, 0.01f, 1.0f}) {
      verify(mini_trees(named.mesh, {32, prune_area}, many_threads_), named.mesh, 1);
    }
  }
  EXPECT_TRUE(oibvh(Mesh(), one_thread_).nodes.empty());
  EXPECT_TRUE(str(Mesh(), 8, one_thread_).nodes.empty());
  EXPECT_TRUE(mini_trees(Mesh(), {}, one_thread_).nodes.empty());
}

TEST_F(PackingBuilders, MiniTreesComeNearAFullSweep) {
  for (const Mesh& mesh : {soup(20000, seed()), spheres(20000, seed())}) {
    const double linear = sah_cost(
        kiwami::LbvhBuilder::build(primitives_of(mesh, memory_), {}, memory_, one_thread_), {});
    const double mini = sah_cost(mini_trees(mesh, {}, one_thread_), {});
    const double full = sah_cost(mini_trees(mesh, {20000, 1.0f}, one_thread_), {});
    std::printf("LBVH %.2f, mini trees %.2f, full sweep %.2f\n", linear, mini, full);
    EXPECT_LT(mini, linear);
    EXPECT_LT(mini, 1.1 * full);
  }
}

}  // namespace
}  // namespace kiwami_tests

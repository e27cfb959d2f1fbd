// SPDX-License-Identifier: Apache-2.0
#include "optimizers/rebraiding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <vector>

#include "support/environment.h"
#include "support/random.h"

namespace kiwami {
namespace {

using kiwami_tests::Random;

/// An instance is a row of unit cells along x; a reference is a run of them, halved down to one.
class Rows final : public BraidSource {
 public:
  struct Row {
    Vec3f origin;
    uint32_t cells;
  };

  std::vector<Row> rows;

  BraidReference reference(uint32_t instance, uint32_t first, uint32_t count, bool is_root) const {
    const Vec3f& origin = rows[instance].origin;
    const Vec3f lower{origin.x + static_cast<float>(first), origin.y, origin.z};
    const Vec3f upper{lower.x + static_cast<float>(count), origin.y + 1, origin.z + 1};
    return {{lower, upper},
            {instance, 0, {uint64_t{first} << 32 | count}},
            static_cast<float>(count),
            is_root};
  }

  Array<BraidReference> roots(Memory& memory) const {
    Array<BraidReference> all(memory, rows.size());
    for (uint32_t i = 0; i < rows.size(); ++i) all[i] = reference(i, 0, rows[i].cells, true);
    return all;
  }

  static uint32_t first_of(const BraidReference& from) {
    return static_cast<uint32_t>(from.start.subtree.bits >> 32);
  }
  static uint32_t count_of(const BraidReference& from) {
    return static_cast<uint32_t>(from.start.subtree.bits);
  }

  uint32_t open(const BraidReference& from,
                BraidReference (&children)[kMaxChildren]) const override {
    const uint32_t first = first_of(from), count = count_of(from);
    if (count == 1) return 0;
    const uint32_t half = count / 2;
    children[0] = reference(from.start.instance, first, half, false);
    children[1] = reference(from.start.instance, first + half, count - half, false);
    return 2;
  }
};

class RebraidingTest : public testing::Test {
 protected:
  /// Each row is covered, by runs that do not overlap.
  void expect_complete(const Rows& rows, const Array<BraidReference>& references) {
    std::map<uint32_t, std::vector<std::pair<uint32_t, uint32_t>>> runs;
    for (const BraidReference& reference : references) {
      runs[reference.start.instance].push_back(
          {Rows::first_of(reference), Rows::count_of(reference)});
    }
    ASSERT_EQ(runs.size(), rows.rows.size());
    for (auto& [instance, of_row] : runs) {
      std::sort(of_row.begin(), of_row.end());
      uint32_t next = 0;
      for (const auto& [first, count] : of_row) {
        ASSERT_EQ(first, next);
        next = first + count;
      }
      EXPECT_EQ(next, rows.rows[instance].cells);
    }
  }

  static Rows random_rows(Random& random, uint32_t count, float size) {
    Rows rows;
    for (uint32_t i = 0; i < count; ++i) {
      rows.rows.push_back({{random.unit() * size, random.unit() * size, random.unit() * size},
                           1 + random.below(100)});
    }
    return rows;
  }

  Memory memory_{nullptr, nullptr, nullptr};
};

TEST_F(RebraidingTest, ReferencesCoverAllOnceWithinTheBudget) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(kiwami_tests::seed()));
  Random random(kiwami_tests::seed(), 5);
  for (const double budget : {0.0, 0.1, 0.5, 1.0, 4.0, 30.0}) {
    for (const uint32_t count : {1u, 2u, 3u, 50u, 700u}) {
      const Rows rows = random_rows(random, count, 40.0f);
      RebraidConfig config;
      config.budget = budget;
      const Array<BraidReference> references = rebraid(rows.roots(memory_), rows, config, memory_);
      expect_complete(rows, references);
      EXPECT_LE(references.size(), count + static_cast<size_t>(budget * count + 0.5));
      if (count == 700 && budget == 0.5) {
        EXPECT_GT(references.size(), 1000u);
      }
    }
  }
}

TEST_F(RebraidingTest, WhatOverlapsNothingStaysWhole) {
  Rows rows;
  for (uint32_t i = 0; i < 3; ++i) rows.rows.push_back({{0, 2.0f * static_cast<float>(i), 0}, 64});
  RebraidConfig config;
  config.budget = 8;
  EXPECT_EQ(rebraid(rows.roots(memory_), rows, config, memory_).size(), 3u);
  // Two that do are opened.
  rows.rows[1].origin = {0.5f, 0.5f, 0.5f};
  EXPECT_GT(rebraid(rows.roots(memory_), rows, config, memory_).size(), 3u);
}

TEST_F(RebraidingTest, RootsOnlyOpensNothingTwice) {
  Random random(kiwami_tests::seed(), 6);
  const Rows rows = random_rows(random, 200, 30.0f);
  RebraidConfig config;
  config.budget = 20;
  config.opens_roots_only = true;
  const Array<BraidReference> references = rebraid(rows.roots(memory_), rows, config, memory_);
  expect_complete(rows, references);
  EXPECT_GT(references.size(), 300u);
  for (const BraidReference& reference : references) {
    const uint32_t cells = rows.rows[reference.start.instance].cells;
    EXPECT_GE(Rows::count_of(reference), cells / 2);
  }
}

TEST_F(RebraidingTest, CoincidentInstancesAreDivided) {
  Rows rows;
  for (uint32_t i = 0; i < 100; ++i) rows.rows.push_back({{0, 0, 0}, 1});
  RebraidConfig config;
  config.budget = 2;
  const Array<BraidReference> references = rebraid(rows.roots(memory_), rows, config, memory_);
  expect_complete(rows, references);
  EXPECT_EQ(references.size(), 100u);
}

}  // namespace
}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// The numbers of leaves that roulettes use, and that equal ones see the same ranges.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lights/light_scene.h"
#include "lights/roulette_numbers.h"
#include "support/environment.h"
#include "support/library.h"

namespace kiwami_tests {
namespace {

double uniform_of(const kiwami::LazyNumbers& numbers, uint32_t value, uint32_t below) {
  return numbers.least_bound(value, below);
}
double uniform_of(const kiwami::IndependentNumbers&, double value, uint32_t) {
  return -std::expm1(-value);
}

/// The numbers of all leaves by their places, down the tree as the roulettes go.
template <typename Numbers>
std::vector<double> collect_numbers(const Numbers& numbers, typename Numbers::Value value,
                                    size_t node, uint32_t below) {
  const double least = uniform_of(numbers, value, below);
  EXPECT_LE(numbers.least_bound(value, below), least * (1.0 + 1e-14));
  if (below == 0) {
    for (const double apart : {1e-13, 1e-3}) {
      EXPECT_TRUE(numbers.accepts(value, least * (1.0 + apart)));
      EXPECT_FALSE(numbers.accepts(value, least * (1.0 - apart)));
    }
    EXPECT_TRUE(numbers.accepts(value, 1.0));
    return {least};
  }
  typename Numbers::Value children[2];
  const uint32_t side = numbers.divide(value, node, below, children);
  double admitted = numbers.least_bound(children[1], below - 1);
  EXPECT_TRUE(numbers.settle(children[1], node, below - 1, [&](double bound) {
    EXPECT_LE(admitted, bound);
    admitted = bound;
    return true;
  }));
  EXPECT_LE(admitted, numbers.least_bound(children[1], below - 1));
  std::vector<double> leaves;
  for (const uint32_t child : {0u, 1u}) {
    const std::vector<double> below_child =
        collect_numbers(numbers, children[child ^ side], 2 * node + 1 + child, below - 1);
    leaves.insert(leaves.end(), below_child.begin(), below_child.end());
  }
  EXPECT_DOUBLE_EQ(least, *std::min_element(leaves.begin(), leaves.end()))
      << "the least of a subtree, level " << below << " from below";
  return leaves;
}

/// Marginals are uniform; returns the greatest correlation of two leaves.
template <typename MakeNumbers>
double correlation_of_numbers(const MakeNumbers& make, uint32_t levels) {
  Random random(seed(), 656);
  const size_t count = size_t{1} << levels;
  const auto draws = static_cast<int>(std::max<uint64_t>(4000, ray_budget(20000)));
  std::vector<double> products(count * count, 0.0);
  std::vector<int> histogram(count * 8, 0);
  for (int draw = 0; draw < draws; ++draw) {
    const auto numbers =
        make((static_cast<double>(random.bits()) + static_cast<double>(random.bits()) * 0x1p-32) *
                 0x1p-32,
             levels);
    const std::vector<double> leaves = collect_numbers(numbers, numbers.root(), 0, levels);
    for (size_t i = 0; i < count; ++i) {
      EXPECT_TRUE(leaves[i] >= 0.0 && leaves[i] < 1.0);
      ++histogram[8 * i + static_cast<size_t>(leaves[i] * 8.0)];
      for (size_t j = 0; j < i; ++j) {
        products[count * i + j] += (leaves[i] - 0.5) * (leaves[j] - 0.5);
      }
    }
  }
  const double expected = draws / 8.0;
  double greatest = 0.0;
  for (size_t i = 0; i < count; ++i) {
    double square = 0.0;
    for (size_t k = 0; k < 8; ++k) {
      const double off = histogram[8 * i + k] - expected;
      square += off * off / expected;
    }
    EXPECT_LT(square, 45.0) << "leaf " << i << ", 7 degrees of freedom";
    for (size_t j = 0; j < i; ++j) {
      greatest = std::max(greatest, std::fabs(12.0 * products[count * i + j] / draws));
    }
  }
  return greatest;
}

TEST(RouletteNumbers, ExponentialsAreThoseOfTheLibrary) {
  Random random(seed(), 658);
  EXPECT_EQ(kiwami::exponential_of(0.0), 0.0);
  double greatest = 0.0;
  for (uint64_t i = 0; i < ray_budget(100000); ++i) {
    const double unit = (random.bits() + 0.5) * 0x1p-32;
    const double u = i % 4 == 0   ? unit * std::exp2(-static_cast<double>(random.below(1000)))
                     : i % 4 == 1 ? 1.0 - std::exp2(-53.0 * unit)
                                  : unit;
    const double expected = -std::log1p(-u);
    greatest = std::max(greatest, std::fabs(kiwami::exponential_of(u) - expected) / expected);
  }
  EXPECT_LT(greatest, 1e-15);
}

TEST(RouletteNumbers, AreUniformAndTheLeastOfASubtreeIsKnown) {
  const auto independent = [](double random, uint32_t levels) {
    return kiwami::IndependentNumbers(random, levels);
  };
  const auto lazy = [](double random, uint32_t levels) {
    return kiwami::LazyNumbers(random, levels, false);
  };
  const auto scrambled = [](double random, uint32_t levels) {
    return kiwami::LazyNumbers(random, levels, true);
  };
  for (const uint32_t levels : {0u, 1u, 4u}) {
    // 6 standard deviations of the estimate.
    EXPECT_LT(correlation_of_numbers(independent, levels),
              6.0 / std::sqrt(static_cast<double>(std::max<uint64_t>(4000, ray_budget(20000)))));
    correlation_of_numbers(lazy, levels);
    correlation_of_numbers(scrambled, levels);
  }
}

TEST(LightRoulette, EqualRandomNumbersSeeTheSameRanges) {
  // Two receivers at the same distance of one light agree on it, whatever their normals are.
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  LightScene scene;
  kiwami_light light{};
  light.power = 1.0f;
  light.link_mask = ~uint64_t{0};
  scene.lights = {light};
  const LightTreeHandle tree = make_light_tree(device.get(), scene, 8);
  kiwami_light_query query;
  check(kiwami_light_query_init(&query, sizeof query));
  query.method = KIWAMI_LIGHT_METHOD_CULLING;
  query.max_choices = 2;
  query.reach = 1.0f;
  const kiwami_light_name name{0, KIWAMI_INVALID_ID};
  kiwami_light_receiver receiver{};
  receiver.link_mask = ~uint64_t{0};
  for (const float distance : {0.5f, 2.0f, 4.0f}) {
    receiver.position[0] = distance;
    float p = 0.0f;
    check(kiwami_light_pdf(tree.get(), &receiver, 0, &name, 0, &p, 0, 1, &query));
    EXPECT_NEAR(p, std::min(1.0f, 1.0f / (distance * distance)), 1e-4f);
  }
  Random random(seed(), 657);
  int accepted = 0;
  for (int i = 0; i < 400; ++i) {
    receiver.random = (random.bits() + 0.5) * 0x1p-32;
    kiwami_light_choice choices[3][2];
    const float places[3][3] = {{2, 0, 0}, {0, -2, 0}, {0, 0, 2}};
    for (int k = 0; k < 3; ++k) {
      std::copy_n(places[k], 3, receiver.position);
      for (int axis = 0; axis < 3; ++axis) receiver.normal[axis] = -places[k][axis];
      check(kiwami_light_sample(tree.get(), &receiver, 0, choices[k], 0, 1, &query));
      EXPECT_EQ(choices[k][0].light_id, choices[0][0].light_id);
    }
    accepted += choices[0][0].light_id == 0 ? 1 : 0;
  }
  EXPECT_NEAR(accepted, 100, 50);
}

}  // namespace
}  // namespace kiwami_tests

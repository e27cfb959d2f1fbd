// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <cstring>

#include "math/bounds.h"
#include "math/float4.h"
#include "math/rounding.h"
#include "support/environment.h"
#include "support/random.h"

namespace kiwami_tests {
namespace {

using kiwami::Bounds;

constexpr float kInfinity = INFINITY;

float any_finite_float(Random& random) {
  for (;;) {
    const uint32_t bits = random.bits();
    float value;
    std::memcpy(&value, &bits, sizeof value);
    if (std::abs(value) <= 0x1p60f) return value;
  }
}

TEST(Rounding, NextUpAndDownAreTheNeighbours) {
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed());
  for (int i = 0; i < 100000; ++i) {
    const float value = any_finite_float(random);
    ASSERT_EQ(kiwami::next_up(value), std::nextafter(value, kInfinity)) << value;
    ASSERT_EQ(kiwami::next_down(value), std::nextafter(value, -kInfinity)) << value;
  }
  EXPECT_EQ(kiwami::next_up(0.0f), FLT_TRUE_MIN);
  EXPECT_EQ(kiwami::next_up(-0.0f), FLT_TRUE_MIN);
  EXPECT_EQ(kiwami::next_down(0.0f), -FLT_TRUE_MIN);
  EXPECT_EQ(kiwami::next_up(-FLT_TRUE_MIN), 0.0f);
}

/// The sign of candidate - (a - b), exactly: both differences are taken where they are exact.
int compare_with_difference(float candidate, float a, float b) {
  // candidate + b against a, with the largest magnitude split off by two-sum in long double.
  const long double x = candidate, y = b;
  const long double sum = x + y, back = sum - x;
  const long double error = (x - (sum - back)) + (y - back);
  const long double rest = (sum - static_cast<long double>(a)) + error;
  return rest > 0 ? 1 : rest < 0 ? -1 : 0;
}

void check_directed_difference(float a, float b) {
  const float down = kiwami::subtract_down(a, b), up = kiwami::subtract_up(a, b);
  ASSERT_LE(compare_with_difference(down, a, b), 0) << a << " - " << b;
  ASSERT_GT(compare_with_difference(std::nextafter(down, kInfinity), a, b), 0) << a << " - " << b;
  ASSERT_GE(compare_with_difference(up, a, b), 0) << a << " - " << b;
  ASSERT_LT(compare_with_difference(std::nextafter(up, -kInfinity), a, b), 0) << a << " - " << b;
}

TEST(Rounding, DirectedDifferencesAreTheTightestOnes) {
  Random random(seed());
  for (int i = 0; i < 200000; ++i) {
    // Exponents up to 30 apart: there, long double holds every intermediate result.
    const float a = std::ldexp(random.symmetric(), random.between(-15, 15));
    const float b = std::ldexp(random.symmetric(), random.between(-15, 15));
    check_directed_difference(a, b);
  }
  for (const float a : {0.0f, 1.0f, -1.0f, 1.0f + FLT_EPSILON}) {
    for (const float b : {0.0f, 1.0f, -1.0f, 0x1p-24f, -0x1p-24f, 0x1p-30f, -0x1p-30f}) {
      check_directed_difference(a, b);
    }
  }
}

TEST(Rounding, DirectedDifferencesSeeWhatADoubleCannotHold) {
  for (const float tiny : {0x1p-60f, FLT_MIN, FLT_TRUE_MIN}) {
    for (const float large : {1.0f, 0x1p60f, -3.0f}) {
      EXPECT_EQ(kiwami::subtract_down(large, tiny), std::nextafter(large, -kInfinity));
      EXPECT_EQ(kiwami::subtract_up(large, tiny), large);
      EXPECT_EQ(kiwami::subtract_down(large, -tiny), large);
      EXPECT_EQ(kiwami::subtract_up(large, -tiny), std::nextafter(large, kInfinity));
    }
  }
}

TEST(Rounding, FourDirectedDifferencesAreThoseOfOne) {
  Random random(seed());
  const auto number = [&] {
    const float value = std::ldexp(random.symmetric(), static_cast<int>(random.below(200)) - 149);
    return random.one_in(20) ? 0.0f : random.one_in(20) ? -0.0f : value;
  };
  for (int i = 0; i < 100000; ++i) {
    kiwami::Float4 a{}, b{};
    for (int k = 0; k < 4; ++k) {
      a[k] = number();
      b[k] = random.one_in(10)  ? a[k]
             : random.one_in(2) ? a[k] * (1 + random.symmetric())
                                : number();
    }
    const kiwami::Float4 down = kiwami::subtract_down(a, b), up = kiwami::subtract_up(a, b);
    for (int k = 0; k < 4; ++k) {
      ASSERT_EQ(std::bit_cast<uint32_t>(down[k]),
                std::bit_cast<uint32_t>(kiwami::subtract_down(a[k], b[k])))
          << a[k] << " - " << b[k];
      ASSERT_EQ(std::bit_cast<uint32_t>(up[k]),
                std::bit_cast<uint32_t>(kiwami::subtract_up(a[k], b[k])))
          << a[k] << " - " << b[k];
    }
  }
}

TEST(BoundsMath, EmptyIsTheIdentityOfExtend) {
  Bounds box = Bounds::empty();
  EXPECT_TRUE(box.is_empty());
  EXPECT_EQ(box.half_area(), 0.0f);
  box.extend(kiwami::Vec3f{1, 2, 3});
  EXPECT_FALSE(box.is_empty());
  EXPECT_EQ(box.half_area(), 0.0f);
  box.extend(Bounds::empty());
  EXPECT_EQ(box.lower.x, 1.0f);
  EXPECT_EQ(box.upper.z, 3.0f);
}

TEST(BoundsMath, HalfAreaAndContains) {
  const Bounds box = {{0, 0, 0}, {1, 2, 3}};
  EXPECT_EQ(box.half_area(), 11.0f);
  EXPECT_TRUE(box.contains(box));
  EXPECT_TRUE(box.contains({{0, 1, 1}, {1, 2, 2}}));
  EXPECT_FALSE(box.contains({{0, 1, 1}, {1, 2, 3.5f}}));
  EXPECT_FALSE(box.contains({{-1, 1, 1}, {1, 2, 3}}));
}

TEST(BoundsMath, NanNeverEntersABox) {
  const float nan = NAN;
  EXPECT_EQ(kiwami::min_keep(1.0f, nan), 1.0f);
  EXPECT_EQ(kiwami::max_keep(1.0f, nan), 1.0f);
  Bounds box = {{0, 0, 0}, {1, 1, 1}};
  box.extend(kiwami::Vec3f{nan, 5, nan});
  EXPECT_EQ(box.upper.x, 1.0f);
  EXPECT_EQ(box.upper.y, 5.0f);
}

TEST(BoundsMath, HalfAreaOfTheGreatestBoxIsFinite) {
  const float most = 0x1p60f;
  const Bounds box = {{-most, -most, -most}, {most, most, most}};
  EXPECT_TRUE(std::isfinite(box.half_area()));
}

}  // namespace
}  // namespace kiwami_tests

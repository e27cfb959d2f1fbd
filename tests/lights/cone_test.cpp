// SPDX-License-Identifier: Apache-2.0
// Cones of directions: merging, and their measure.
#include "lights/cone.h"

#include <gtest/gtest.h>

#include <vector>

#include "support/environment.h"
#include "support/random.h"

namespace kiwami_tests {
namespace {

using kiwami::Angle;
using kiwami::Cone;
using kiwami::Vec3d;

constexpr double kPi = 3.14159265358979323846;

Vec3d random_unit(Random& random) {
  for (;;) {
    const Vec3d v{static_cast<double>(random.symmetric()), static_cast<double>(random.symmetric()),
                  static_cast<double>(random.symmetric())};
    const double size = kiwami::length(v);
    if (size > 0.1 && size <= 1.0) return v * (1.0 / size);
  }
}

Angle angle(double radians) { return {std::cos(radians), std::sin(radians)}; }

double spread_of(const Cone& cone) { return std::atan2(cone.spread.sine, cone.spread.cosine); }

double angle_between(Vec3d a, Vec3d b) {
  return 2.0 * std::atan2(kiwami::length(a - b), kiwami::length(a + b));
}

/// How far a direction lies outside of a cone's spread; 0 inside.
double excess(const Cone& cone, Vec3d direction) {
  double off = angle_between(cone.axis, direction);
  if (cone.is_two_sided) off = std::min(off, kPi - off);
  return std::max(0.0, off - spread_of(cone));
}

/// Directions at the rim of a cone's spread, and its axis.
std::vector<Vec3d> rim_of(const Cone& cone) {
  const Vec3d other = std::fabs(cone.axis.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  Vec3d u = kiwami::cross(cone.axis, other);
  u = u * (1.0 / kiwami::length(u));
  const Vec3d v = kiwami::cross(cone.axis, u);
  std::vector<Vec3d> rim{cone.axis};
  for (int i = 0; i < 32; ++i) {
    const double turn = 2.0 * kPi * i / 32.0;
    rim.push_back(cone.axis * cone.spread.cosine +
                  (u * std::cos(turn) + v * std::sin(turn)) * cone.spread.sine);
  }
  return rim;
}

Cone random_cone(Random& random) {
  const double spread = random.one_in(4) ? 0.0 : kPi * std::pow(random.unit(), 3.0);
  const double extent = random.one_in(2) ? 0.5 * kPi : kPi * static_cast<double>(random.unit());
  return {random_unit(random), angle(spread), angle(extent), random.one_in(4), false};
}

TEST(Cone, UnionHoldsBothCones) {
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed(), 600);
  for (uint64_t i = 0; i < ray_budget(20000); ++i) {
    const Cone a = random_cone(random);
    Cone b = random_cone(random);
    if (random.one_in(4)) b.axis = a.axis;
    if (random.one_in(8)) b.axis = a.axis * -1.0;
    const Cone merged = kiwami::merge(a, b);
    EXPECT_NEAR(kiwami::length(merged.axis), 1.0, 1e-12);
    EXPECT_LE(merged.extent.cosine, std::min(a.extent.cosine, b.extent.cosine));
    for (const Cone& part : {a, b}) {
      for (const Vec3d direction : rim_of(part)) {
        ASSERT_LE(excess(merged, direction), 1e-6)
            << "case " << i << " seed " << seed() << " spread " << spread_of(merged);
      }
    }
  }
}

TEST(Cone, UnionIsNotLargerThanNeeded) {
  // Two directions a right angle apart: a cone of 45 degrees around their middle.
  const Cone x{{1, 0, 0}, Angle::zero(), Angle::right(), false, false};
  const Cone y{{0, 1, 0}, Angle::zero(), Angle::right(), false, false};
  const Cone merged = kiwami::merge(x, y);
  EXPECT_NEAR(spread_of(merged), 0.25 * kPi, 1e-9);
  EXPECT_NEAR(angle_between(merged.axis, {std::sqrt(0.5), std::sqrt(0.5), 0}), 0.0, 1e-9);
  // The same direction twice, and nothing at all.
  EXPECT_EQ(kiwami::merge(x, x).spread.cosine, 1.0);
  EXPECT_EQ(kiwami::merge(Cone{}, x).axis.x, 1.0);
  EXPECT_EQ(kiwami::merge(x, Cone{}).axis.x, 1.0);
  EXPECT_TRUE(kiwami::merge(Cone{}, Cone{}).is_empty);
  // Opposite ones are all directions, unless both shine both ways.
  Cone back = x;
  back.axis = {-1, 0, 0};
  EXPECT_EQ(kiwami::merge(x, back).spread.cosine, -1.0);
  Cone both = x;
  both.is_two_sided = back.is_two_sided = true;
  EXPECT_EQ(kiwami::merge(both, back).spread.cosine, 1.0);
}

TEST(Cone, MeasureIsTheIntegralOfTheCosineOverItsDirections) {
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      const double spread = kPi * i / 20.0, extent = kPi * j / 20.0;
      const Cone cone{{0, 0, 1}, angle(spread), angle(extent), false, false};
      const double end = std::min(spread + extent, kPi);
      double expected = 2.0 * kPi * (1.0 - std::cos(spread));
      constexpr int kSteps = 2000;
      for (int k = 0; k < kSteps; ++k) {
        const double t = spread + (end - spread) * (k + 0.5) / kSteps;
        expected += 2.0 * kPi * std::cos(t - spread) * std::sin(t) * (end - spread) / kSteps;
      }
      // Where the extent exceeds a right angle the cosine counts as less than nothing; the library
      // keeps the part beyond the spread from doing so.
      expected = std::max(expected, 2.0 * kPi * (1.0 - std::cos(spread)));
      EXPECT_NEAR(kiwami::orientation_measure(cone), expected, 3e-3) << spread << " " << extent;
    }
  }
}

}  // namespace
}  // namespace kiwami_tests

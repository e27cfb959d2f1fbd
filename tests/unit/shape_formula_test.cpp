// SPDX-License-Identifier: Apache-2.0
// The formulas of spheres, discs and curve segments against searches in extended precision that
// know of each shape only how far a point is from it.
#define KIWAMI_ISA scalar
#include "scalar/simd.h"
// The vocabulary comes first.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "kernels/shape-inl.h"
#include "support/environment.h"
#include "support/random.h"

namespace kiwami_tests {
namespace {

using namespace kiwami::scalar;

using Real = long double;

struct Point {
  Real x, y, z;
};

Real distance(const Point& a, const Point& b) {
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) +
                   (a.z - b.z) * (a.z - b.z));
}

struct Ball {
  float centre[3];
  float radius;
};

struct FloatRay {
  float origin[3], direction[3];

  Point at(Real t) const {
    return {origin[0] + t * direction[0], origin[1] + t * direction[1],
            origin[2] + t * direction[2]};
  }
  Real length() const { return distance(at(0), at(1)); }
  WideRay<double> widened() const { return widen_ray(origin, direction); }
};

Triple<double> triple(const float* a) { return {a[0], a[1], a[2]}; }

Segment<double> segment_of(const Ball& a, const Ball& b) {
  return {{triple(a.centre), triple(b.centre)}, {a.radius, b.radius}};
}

/// How far a point is outside of the segment; negative inside. The function of s is convex.
Real distance_to_segment(const Point& point, const Ball& a, const Ball& b) {
  const auto at = [&](Real s) {
    const Point centre = {a.centre[0] + s * (Real{b.centre[0]} - a.centre[0]),
                          a.centre[1] + s * (Real{b.centre[1]} - a.centre[1]),
                          a.centre[2] + s * (Real{b.centre[2]} - a.centre[2])};
    return distance(point, centre) - (a.radius + s * (Real{b.radius} - a.radius));
  };
  Real low = 0, high = 1;
  for (int i = 0; i < 100; ++i) {
    const Real left = low + (high - low) * 0.4L, right = high - (high - low) * 0.4L;
    (at(left) < at(right) ? high : low) = at(left) < at(right) ? right : left;
  }
  return std::min({at(0), at(1), at((low + high) / 2)});
}

/// The least distance along a ray between two parameters, where it is a convex function.
template <typename Distance>
Real least_along(Real low, Real high, Distance distance_at) {
  for (int i = 0; i < 120; ++i) {
    const Real left = low + (high - low) * 0.4L, right = high - (high - low) * 0.4L;
    (distance_at(left) < distance_at(right) ? high : low) =
        distance_at(left) < distance_at(right) ? right : left;
  }
  return (low + high) / 2;
}

float random_size(Random& random) {
  return std::ldexp(0.5f + random.unit(), random.between(-12, 3));
}

/// A ray from a random point about a centre to a random point about a target of some size.
FloatRay random_ray(Random& random, const float* target, float size, float away) {
  FloatRay ray;
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = target[axis] + away * random.symmetric();
    ray.direction[axis] = target[axis] + 1.1f * size * random.symmetric() - ray.origin[axis];
  }
  if (random.one_in(8)) {
    for (float& component : ray.direction) component *= 0x1p40f;
  }
  if (random.one_in(16)) ray.direction[random.below(3)] = 0.0f;
  return ray;
}

bool is_null(const FloatRay& ray) {
  return ray.direction[0] == 0 && ray.direction[1] == 0 && ray.direction[2] == 0;
}

class ShapeFormula : public testing::Test {
 protected:
  void SetUp() override {
    std::printf("KIWAMI_SEED=%llu\n", static_cast<unsigned long long>(seed()));
  }
};

TEST_F(ShapeFormula, SpheresAreCrossedWhereTheDistanceIsTheRadius) {
  Random random(seed(), 41);
  uint64_t hits = 0;
  const uint64_t budget = ray_budget(40000);
  for (uint64_t i = 0; i < budget; ++i) {
    const Ball ball = {{random.symmetric(), random.symmetric(), random.symmetric()},
                       random_size(random)};
    const FloatRay ray = random_ray(random, ball.centre, ball.radius,
                                    std::ldexp(ball.radius, random.between(-3, 12)));
    if (is_null(ray)) continue;
    const WideRay<double> wide = ray.widened();
    const Passage<double> passage =
        pass_sphere(wide, wide.origin - triple(ball.centre), double{ball.radius});
    const Point centre = {ball.centre[0], ball.centre[1], ball.centre[2]};
    const Point origin = ray.at(0);
    const Real scale = distance(origin, centre) + ball.radius;
    const Real tolerance = 0x1p-48L * scale;
    Real along = 0;
    for (int axis = 0; axis < 3; ++axis) {
      along += (Real{ball.centre[axis]} - ray.origin[axis]) * ray.direction[axis];
    }
    along /= ray.length() * ray.length();
    const Real gap = distance(ray.at(along), centre) - ball.radius;
    if (!(passage.squared_half > 0.0)) {
      EXPECT_GE(gap, -tolerance) << "ray " << i << " misses a sphere that it goes through";
      continue;
    }
    ++hits;
    EXPECT_LE(gap, tolerance) << "ray " << i << " hits a sphere that it passes by";
    const double half = square_root(passage.squared_half);
    for (const double t : {passage.middle - half, passage.middle + half}) {
      EXPECT_LE(std::fabs(distance(ray.at(t), centre) - ball.radius), tolerance) << "ray " << i;
    }
  }
  EXPECT_GT(hits, budget / 4);
}

TEST_F(ShapeFormula, DiscsAreMetInTheirPlaneWithinTheirRadius) {
  Random random(seed(), 42);
  uint64_t hits = 0;
  const uint64_t budget = ray_budget(40000);
  for (uint64_t i = 0; i < budget; ++i) {
    const Ball ball = {{random.symmetric(), random.symmetric(), random.symmetric()},
                       random_size(random)};
    float normal[3];
    const float length = random_size(random);
    for (float& component : normal) component = length * random.symmetric();
    const FloatRay ray = random_ray(random, ball.centre, ball.radius,
                                    std::ldexp(ball.radius, random.between(-3, 12)));
    if (is_null(ray)) continue;
    const WideRay<double> wide = ray.widened();
    const PlaneMeeting<double> meeting =
        meet_plane(wide, wide.origin - triple(ball.centre), triple(normal));
    Real facing = 0, height = 0, size = 0;
    for (int axis = 0; axis < 3; ++axis) {
      facing += Real{normal[axis]} * ray.direction[axis];
      height += Real{normal[axis]} * (Real{ball.centre[axis]} - ray.origin[axis]);
      size += Real{normal[axis]} * normal[axis];
    }
    const Point centre = {ball.centre[0], ball.centre[1], ball.centre[2]};
    const Real sine = std::fabs(facing) / (std::sqrt(size) * ray.length());
    const Real scale = distance(ray.at(0), centre) + ball.radius;
    const Real tolerance = 0x1p-46L * scale / sine;
    const Real gap = distance(ray.at(height / facing), centre) - ball.radius;
    const bool is_hit = meeting.squared_distance < double{ball.radius} * ball.radius;
    hits += is_hit;
    if (is_hit) {
      EXPECT_LE(gap, tolerance) << "ray " << i;
      EXPECT_LE(std::fabs(meeting.t - height / facing) * ray.length(), tolerance) << "ray " << i;
      EXPECT_EQ(meeting.facing > 0.0, facing > 0) << "ray " << i;
    } else {
      EXPECT_FALSE(gap < -tolerance) << "ray " << i;
    }
  }
  EXPECT_GT(hits, budget / 4);
}

/// Two spheres of all proportions: hair, cones with a tip, almost nested, nested, in one point.
void random_segment(Random& random, Ball& a, Ball& b) {
  const float length = random_size(random);
  a.radius = length * std::ldexp(random.unit(), random.between(-12, 1));
  b.radius =
      random.one_in(2) ? a.radius : length * std::ldexp(random.unit(), random.between(-12, 1));
  for (int axis = 0; axis < 3; ++axis) {
    a.centre[axis] = random.symmetric();
    b.centre[axis] = a.centre[axis] + length * random.symmetric();
  }
  if (random.one_in(8)) b.radius = 0.0f;
  if (random.one_in(16)) b = {{a.centre[0], a.centre[1], a.centre[2]}, b.radius};
  if (random.one_in(8)) std::swap(a, b);
}

TEST_F(ShapeFormula, SegmentsAreCrossedWhereTheNearestSphereIs) {
  Random random(seed(), 43);
  uint64_t hits = 0;
  const uint64_t budget = ray_budget(300);
  for (uint64_t i = 0; i < budget; ++i) {
    Ball a, b;
    random_segment(random, a, b);
    float middle[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float s = random.unit();
      middle[axis] = a.centre[axis] + s * (b.centre[axis] - a.centre[axis]);
    }
    const float thickness = std::max(a.radius, b.radius);
    const Real extent =
        distance({a.centre[0], a.centre[1], a.centre[2]}, {b.centre[0], b.centre[1], b.centre[2]}) +
        a.radius + b.radius;
    FloatRay ray = random_ray(random, middle, thickness,
                              static_cast<float>(extent) * std::ldexp(1.0f, random.between(-2, 6)));
    // Along the axis, and nearly so.
    if (random.one_in(8)) {
      for (int axis = 0; axis < 3; ++axis) {
        ray.direction[axis] = b.centre[axis] - a.centre[axis];
        ray.origin[axis] =
            a.centre[axis] - 2.0f * ray.direction[axis] + thickness * random.symmetric();
      }
    }
    if (is_null(ray)) continue;
    const SegmentInterval interval = cross_segment(ray.widened(), segment_of(a, b));
    const Real scale = distance(ray.at(0), {a.centre[0], a.centre[1], a.centre[2]}) + extent;
    const auto at = [&](Real t) { return distance_to_segment(ray.at(t), a, b); };
    const Real reach = 2 * scale / ray.length();
    const Real nearest = least_along(-reach, reach, at);
    // Where the spheres are almost nested the cone is left out: up to 2^-20 of the extent is.
    const Real growth = Real{b.radius} - a.radius;
    const Real length = extent - a.radius - b.radius;
    const bool is_nested = length * length - growth * growth < 0x1p-12L * length * length;
    const Real tolerance = 0x1p-36L * scale + (is_nested ? 0x1p-20L * extent : 0);
    if (interval.is_empty) {
      EXPECT_GE(at(nearest), -tolerance) << "ray " << i << " misses a segment that it goes through";
      continue;
    }
    ++hits;
    EXPECT_LE(at(nearest), tolerance) << "ray " << i << " hits a segment that it passes by";
    EXPECT_LE(interval.entry.t, interval.exit.t);
    for (const SegmentCrossing& crossing : {interval.entry, interval.exit}) {
      // Near a tip the distance is the root of what is computed.
      const Real radius = a.radius + crossing.s * growth;
      const Real at_tip = radius < 0x1p-10L * extent ? 0x1p-24L * extent : 0;
      EXPECT_LE(std::fabs(at(crossing.t)), tolerance + at_tip) << "ray " << i;
      EXPECT_GE(crossing.s, 0.0);
      EXPECT_LE(crossing.s, 1.0);
    }
  }
  EXPECT_GT(hits, budget / 4);
}

TEST_F(ShapeFormula, ConesMeetTheirEndSpheresWithoutAStep) {
  // A ray swept over the seam between the cone and an end sphere: the distance has no jump.
  const Ball a = {{0, 0, 0}, 1.0f}, b = {{4, 0, 0}, 0.25f};
  double previous = 0.0;
  for (int i = 0; i <= 4000; ++i) {
    const FloatRay ray = {{-0.9f + 5.0f * static_cast<float>(i) / 4000, 0, 5}, {0, 0, -1}};
    const SegmentInterval interval = cross_segment(ray.widened(), segment_of(a, b));
    ASSERT_FALSE(interval.is_empty) << i;
    const double step = i == 0 ? 0.0 : std::fabs(interval.entry.t - previous);
    EXPECT_LT(step, 0.004) << i;
    previous = interval.entry.t;
  }
}

TEST_F(ShapeFormula, NothingIsTouchedThatIsOnlyGrazed) {
  const FloatRay ray = {{-4, 1, 0}, {1, 0, 0}};
  const WideRay<double> wide = ray.widened();
  EXPECT_FALSE(pass_sphere(wide, wide.origin, 1.0).squared_half > 0.0);
  EXPECT_TRUE(pass_sphere(wide, wide.origin, 1.0 + 0x1p-23).squared_half > 0.0);
  // In the plane of a disc, and through its rim.
  EXPECT_FALSE(meet_plane(wide, wide.origin, {0, 1, 0}).squared_distance < 4.0);
  EXPECT_FALSE(meet_plane(wide, wide.origin, {1, 0, 0}).squared_distance < 1.0);
  const Ball a = {{0, 0, 0}, 1.0f}, b = {{4, 0, 0}, 1.0f};
  EXPECT_TRUE(cross_segment(wide, segment_of(a, b)).is_empty);
  EXPECT_TRUE(cross_segment(wide, segment_of({{0, 1, 0}, 0.0f}, {{4, 1, 0}, 0.0f})).is_empty);
}

TEST_F(ShapeFormula, FourInLanesAreTheSameToTheBit) {
  Random random(seed(), 44);
  for (uint64_t i = 0; i < ray_budget(20000); ++i) {
    Segment<double> one[4];
    Segment<vdouble4> four;
    float target[3];
    for (int lane = 0; lane < 4; ++lane) {
      Ball a, b;
      random_segment(random, a, b);
      one[lane] = segment_of(a, b);
      std::copy(a.centre, a.centre + 3, target);
      for (int k = 0; k < 2; ++k) {
        four.centre[k].x.lane[lane] = one[lane].centre[k].x;
        four.centre[k].y.lane[lane] = one[lane].centre[k].y;
        four.centre[k].z.lane[lane] = one[lane].centre[k].z;
        four.radius[k].lane[lane] = one[lane].radius[k];
      }
    }
    const FloatRay ray = random_ray(random, target, 1.0f, 2.0f);
    if (is_null(ray)) continue;
    const WideRay<double> wide = ray.widened();
    const WideRay<vdouble4> lanes = spread_ray(wide);
    const Triple<vdouble4> offset = lanes.origin - four.centre[0];
    const Passage<vdouble4> first = pass_sphere(lanes, offset, four.radius[0]);
    const Passage<vdouble4> side = pass_cone(
        frame_cone(lanes, four, offset, first.middle, first.middle), lanes, four.radius[0]);
    for (int lane = 0; lane < 4; ++lane) {
      const Triple<double> from = wide.origin - one[lane].centre[0];
      const Passage<double> alone = pass_sphere(wide, from, one[lane].radius[0]);
      EXPECT_EQ(alone.middle, first.middle.lane[lane]);
      EXPECT_EQ(alone.squared_half, first.squared_half.lane[lane]);
      const Passage<double> cone = pass_cone(
          frame_cone(wide, one[lane], from, alone.middle, alone.middle), wide, one[lane].radius[0]);
      const bool is_number = cone.middle == cone.middle;
      EXPECT_EQ(is_number ? cone.middle : 0.0, is_number ? side.middle.lane[lane] : 0.0);
    }
  }
}

}  // namespace
}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
// Where a ray crosses spheres, discs and round curve segments: the formulas, in double precision.
//
// They are made of + - * / and square roots alone, in the order written, each rounded on its own,
// so every instruction set and both forms here (one shape, T = double; four shapes in lanes, T =
// vdouble4) give the same bits. A dot product is (x x' + y y') + z z'. A distance is rounded to
// float once, at the end.
//
// Spheres: E. Haines, J. Gunther, T. Akenine-Moller, "Precision Improvements for Ray/Sphere
// Intersection", Ray Tracing Gems, 2019. As there, the discriminant comes from the vector between
// the centre and the point of the ray that is nearest to it; both roots are taken from that point,
// since in double precision neither needs the other.
//
// Curve segments are the union of all spheres between two, with centre and radius interpolated
// (rounded cones, as in I. Wald et al., "RTX Beyond Ray Tracing", HPG 2019, and A. Reshetov,
// "Cones and Cylinders for Hair", Ray Tracing Gems II, 2021, treat them). The body is convex, so a
// ray is in it during one interval, which is put together of those of the two end spheres and of
// the crossings of the cone that touches all spheres: least and greatest of all. Nothing has to be
// decided at the seams: both sides hold the same distance there.
#pragma once

#include "wide/shape_source.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

template <typename T>
struct Triple {
  T x, y, z;
};

template <typename T>
inline Triple<T> operator+(const Triple<T>& a, const Triple<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename T>
inline Triple<T> operator-(const Triple<T>& a, const Triple<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename T>
inline Triple<T> operator*(const T& a, const Triple<T>& b) {
  return {a * b.x, a * b.y, a * b.z};
}
template <typename T>
inline T dot(const Triple<T>& a, const Triple<T>& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <typename T>
inline Triple<T> cross(const Triple<T>& a, const Triple<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The same number in each lane.
template <typename T>
inline T spread(double value);
template <>
inline double spread<double>(double value) {
  return value;
}
template <>
inline vdouble4 spread<vdouble4>(double value) {
  return broadcast_double(value);
}
inline double square_root(double value) { return __builtin_sqrt(value); }

/// A ray in double precision, which floats are turned into without rounding.
template <typename T>
struct WideRay {
  Triple<T> origin, direction;
  T squared;  ///< direction * direction
  T inverse;  ///< 1 / squared
};

inline WideRay<double> widen_ray(const float* origin, const float* direction) {
  WideRay<double> ray;
  ray.origin = {origin[0], origin[1], origin[2]};
  ray.direction = {direction[0], direction[1], direction[2]};
  ray.squared = dot(ray.direction, ray.direction);
  ray.inverse = 1.0 / ray.squared;
  return ray;
}

inline WideRay<vdouble4> spread_ray(const WideRay<double>& ray) {
  const auto all = [](const Triple<double>& a) {
    return Triple<vdouble4>{broadcast_double(a.x), broadcast_double(a.y), broadcast_double(a.z)};
  };
  return {all(ray.origin), all(ray.direction), broadcast_double(ray.squared),
          broadcast_double(ray.inverse)};
}

/// Where a line crosses a quadric: at middle - h and middle + h with h * h = squared_half; nowhere
/// unless that is positive.
template <typename T>
struct Passage {
  T middle, squared_half;
};

/// A sphere around the origin of offset, which is the ray's origin seen from the centre.
template <typename T>
inline Passage<T> pass_sphere(const WideRay<T>& ray, const Triple<T>& offset, T radius) {
  const T middle = spread<T>(0.0) - dot(offset, ray.direction) * ray.inverse;
  const Triple<T> nearest = offset + middle * ray.direction;
  return {middle, (radius * radius - dot(nearest, nearest)) * ray.inverse};
}

/// Where a ray meets the plane of a disc, and how far from the centre, squared.
template <typename T>
struct PlaneMeeting {
  T t, facing, squared_distance;
};

template <typename T>
inline PlaneMeeting<T> meet_plane(const WideRay<T>& ray, const Triple<T>& offset,
                                  const Triple<T>& normal) {
  PlaneMeeting<T> meeting;
  meeting.facing = dot(normal, ray.direction);
  meeting.t = spread<T>(0.0) - dot(normal, offset) / meeting.facing;
  const Triple<T> point = offset + meeting.t * ray.direction;
  meeting.squared_distance = dot(point, point);
  return meeting;
}

/// A segment from sphere 0 to sphere 1.
template <typename T>
struct Segment {
  Triple<T> centre[2];
  T radius[2];
};

/// The cone that touches all spheres of a segment, along a ray. With A = c1 - c0, g = r1 - r0, the
/// point p = f + t d seen from c0 is on it where k (p p - r0 r0) = (p A + g r0)^2, k = A A - g g.
/// The sphere that it lies on is then at s = (p A + g r0) / k of the segment. In t this is
/// a t^2 + 2 b t + c = 0; terms of A are gathered in cross products, or a thin segment's thickness
/// would be lost between the squares of its length.
template <typename T>
struct ConeFrame {
  Triple<T> axis, turned;  ///< A, d x A
  T growth;                ///< g
  T squared_length;        ///< A A
  T slope;                 ///< A A - g g
  T leading;               ///< a
  T shift;                 ///< t of the point of the ray nearest to the segment's middle
  Triple<T> start;         ///< that point, seen from c0
};

template <typename T>
inline ConeFrame<T> frame_cone(const WideRay<T>& ray, const Segment<T>& segment,
                               const Triple<T>& offset, T middle0, T middle1) {
  ConeFrame<T> cone;
  cone.axis = segment.centre[1] - segment.centre[0];
  cone.turned = cross(ray.direction, cone.axis);
  cone.growth = segment.radius[1] - segment.radius[0];
  cone.squared_length = dot(cone.axis, cone.axis);
  const T squared_growth = cone.growth * cone.growth;
  cone.slope = cone.squared_length - squared_growth;
  cone.leading = dot(cone.turned, cone.turned) - squared_growth * ray.squared;
  cone.shift = spread<T>(0.5) * (middle0 + middle1);
  cone.start = offset + cone.shift * ray.direction;
  return cone;
}

/// b and c for a ray that begins at a point seen from c0.
template <typename T>
inline T linear_term(const ConeFrame<T>& cone, const WideRay<T>& ray, T radius0,
                     const Triple<T>& point) {
  return dot(cross(point, cone.axis), cone.turned) -
         cone.growth *
             (cone.growth * dot(point, ray.direction) + radius0 * dot(ray.direction, cone.axis));
}
template <typename T>
inline T constant_term(const ConeFrame<T>& cone, T radius0, const Triple<T>& point) {
  const Triple<T> moment = cross(point, cone.axis);
  const T growth = cone.growth;
  return dot(moment, moment) -
         (radius0 * (radius0 * cone.squared_length + (growth + growth) * dot(point, cone.axis)) +
          growth * growth * dot(point, point));
}

/// For rays that are not nearly along the cone's surface: the quadratic once more, from its vertex,
/// where the linear term is gone and the constant one has no cancellation left.
template <typename T>
inline Passage<T> pass_cone(const ConeFrame<T>& cone, const WideRay<T>& ray, T radius0) {
  const T inverse = spread<T>(1.0) / cone.leading;
  const T step = spread<T>(0.0) - linear_term(cone, ray, radius0, cone.start) * inverse;
  const Triple<T> vertex = cone.start + step * ray.direction;
  return {cone.shift + step, spread<T>(0.0) - constant_term(cone, radius0, vertex) * inverse};
}

/// Below this part of (A A - g g) d d, a is too small for pass_cone.
constexpr double kLeastLeading = 0x1p-8;
/// Below this part of A A, A A - g g is too small: one end sphere almost holds the other, and the
/// cone is left out.
constexpr double kLeastSlope = 0x1p-20;
/// How far outside its sphere a crossing of the cone may be computed, in parts of the greatest
/// component of A plus both radii. Boxes are as much wider (core/shapes.cpp), so that whatever is
/// accepted lies in its box. It is a thousand times what rounding does to all but the most extreme
/// cones.
constexpr double kConeTolerance = 0x1p-20;

/// One end of the interval that a ray is in a segment.
struct SegmentCrossing {
  double t;
  double s;  ///< which sphere it lies on, 0 to 1
};

struct SegmentInterval {
  bool is_empty = true;
  SegmentCrossing entry{}, exit{};

  void add(double t, double s) {
    if (is_empty || t < entry.t) entry = {t, s};
    if (is_empty || t > exit.t) exit = {t, s};
    is_empty = false;
  }
  void add(const Passage<double>& passage, double s) {
    if (!(passage.squared_half > 0.0)) return;
    const double half = square_root(passage.squared_half);
    add(passage.middle - half, s);
    add(passage.middle + half, s);
  }
};

inline double greater_of(double a, double b) { return a > b ? a : b; }
inline double magnitude(double a) { return a < 0.0 ? 0.0 - a : a; }

/// Adds a crossing of the cone at t, if it lies between the end spheres, and is not one of the
/// cone's continuation beyond its tip or made of rounding errors alone.
inline void add_cone_crossing(const WideRay<double>& ray, const Segment<double>& segment,
                              const ConeFrame<double>& cone, const Triple<double>& offset, double t,
                              SegmentInterval& interval) {
  const Triple<double> point = offset + t * ray.direction;
  const double s = (dot(point, cone.axis) + cone.growth * segment.radius[0]) / cone.slope;
  if (!(s > 0.0 && s < 1.0)) return;
  const Triple<double> normal = point - s * cone.axis;
  const double extent = greater_of(greater_of(magnitude(cone.axis.x), magnitude(cone.axis.y)),
                                   magnitude(cone.axis.z)) +
                        (segment.radius[0] + segment.radius[1]);
  const double reach = (segment.radius[0] + s * cone.growth) + kConeTolerance * extent;
  if (dot(normal, normal) <= reach * reach) interval.add(t, s);
}

/// For rays nearly along the cone's surface, and others: the quadratic as it is, by the formula
/// that adds no numbers of opposite sign; one of the two crossings may lie at infinity.
inline void cross_cone_steeply(const WideRay<double>& ray, const Segment<double>& segment,
                               const ConeFrame<double>& cone, const Triple<double>& offset,
                               SegmentInterval& interval) {
  const double b = linear_term(cone, ray, segment.radius[0], cone.start);
  const double c = constant_term(cone, segment.radius[0], cone.start);
  const double discriminant = b * b - cone.leading * c;
  if (!(discriminant > 0.0)) return;
  const double root = square_root(discriminant);
  const double sum = b < 0.0 ? b - root : b + root;
  add_cone_crossing(ray, segment, cone, offset, cone.shift - sum / cone.leading, interval);
  add_cone_crossing(ray, segment, cone, offset, cone.shift - c / sum, interval);
}

inline bool has_cone(const ConeFrame<double>& cone) {
  return cone.slope > kLeastSlope * cone.squared_length;
}
inline bool is_steep(const ConeFrame<double>& cone, const WideRay<double>& ray) {
  return !(cone.leading > kLeastLeading * (cone.slope * ray.squared));
}

/// The interval in which a ray is in a segment.
inline SegmentInterval cross_segment(const WideRay<double>& ray, const Segment<double>& segment) {
  SegmentInterval interval;
  const Triple<double> offset = ray.origin - segment.centre[0];
  const Passage<double> first = pass_sphere(ray, offset, segment.radius[0]);
  const Passage<double> second =
      pass_sphere(ray, ray.origin - segment.centre[1], segment.radius[1]);
  interval.add(first, 0.0);
  interval.add(second, 1.0);
  const ConeFrame<double> cone = frame_cone(ray, segment, offset, first.middle, second.middle);
  if (!has_cone(cone)) return interval;
  if (is_steep(cone, ray)) {
    cross_cone_steeply(ray, segment, cone, offset, interval);
    return interval;
  }
  const Passage<double> side = pass_cone(cone, ray, segment.radius[0]);
  if (!(side.squared_half > 0.0)) return interval;
  const double half = square_root(side.squared_half);
  add_cone_crossing(ray, segment, cone, offset, side.middle - half, interval);
  add_cone_crossing(ray, segment, cone, offset, side.middle + half, interval);
  return interval;
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

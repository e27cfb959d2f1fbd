// SPDX-License-Identifier: Apache-2.0
// Cones of directions, for what lights of a group shine to. Angles are kept as cosines and sines:
// no trigonometric function is called, so that trees do not depend on a C library.
#pragma once

#include <algorithm>
#include <cmath>

namespace kiwami {

struct Vec3d {
  double x, y, z;
};
inline Vec3d operator+(Vec3d a, Vec3d b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3d operator-(Vec3d a, Vec3d b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3d operator*(Vec3d a, double s) { return {a.x * s, a.y * s, a.z * s}; }
inline double dot(Vec3d a, Vec3d b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3d cross(Vec3d a, Vec3d b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3d a) { return std::sqrt(dot(a, a)); }

/// An angle of 0 to pi.
struct Angle {
  double cosine, sine;

  static constexpr Angle zero() { return {1.0, 0.0}; }
  static constexpr Angle right() { return {0.0, 1.0}; }
  static constexpr Angle straight() { return {-1.0, 0.0}; }
  static Angle of_cosine(double cosine) {
    return {cosine, std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)))};
  }
  /// Between two directions of length 1: by their sum and difference, which lose no digits.
  static Angle between(Vec3d a, Vec3d b) {
    const double sine = length(a - b), cosine = length(a + b);
    const double scale = 1.0 / (sine * sine + cosine * cosine);
    return {(cosine * cosine - sine * sine) * scale, 2.0 * sine * cosine * scale};
  }

  /// In radians, to 7e-5 of it: Abramowitz & Stegun, "Handbook of Mathematical Functions", 1964,
  /// 4.4.45.
  double radians() const {
    const double x = std::min(1.0, std::fabs(cosine));
    const double acute =
        std::sqrt(1.0 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 + x * -0.0187293)));
    return cosine < 0.0 ? 3.14159265358979 - acute : acute;
  }
};

/// The sum, or pi if that is less.
inline Angle saturated_sum(Angle a, Angle b) {
  if (a.cosine + b.cosine <= 0.0) return Angle::straight();
  return {a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine};
}

/// Directions that a group of lights shines to: its surfaces' normals lie within spread of the
/// axis, and light leaves them within extent of the normal. Merging follows Conty Estevez & Kulla,
/// "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACMCGIT 1(2) (HPG), 2018.
struct Cone {
  Vec3d axis{0.0, 0.0, 1.0};  ///< of length 1
  Angle spread{1.0, 0.0};
  Angle extent{1.0, 0.0};
  bool is_two_sided = false;  ///< shines about the opposite axis, too
  bool is_empty = true;

  static Cone sphere() {
    return {{0.0, 0.0, 1.0}, Angle::straight(), Angle::right(), false, false};
  }
};

namespace cone_detail {

/// The cone around a that just holds b, whose spread is not greater, and whose axis is turn away.
inline Cone turned_towards(const Cone& a, const Cone& b, Angle turn) {
  Cone merged = a;
  merged.spread = Angle::straight();
  // The sum of the three angles, of which the new spread is half. In a full turn it is all.
  const bool first_is_reflex = a.spread.sine * turn.cosine + a.spread.cosine * turn.sine < 0.0;
  const double first_cosine = a.spread.cosine * turn.cosine - a.spread.sine * turn.sine;
  const double first_sine = a.spread.sine * turn.cosine + a.spread.cosine * turn.sine;
  if (first_is_reflex && b.spread.cosine <= first_cosine) return merged;
  const double cosine = first_cosine * b.spread.cosine - first_sine * b.spread.sine;
  const double sine = first_sine * b.spread.cosine + first_cosine * b.spread.sine;
  double half_cosine = std::sqrt(std::max(0.0, (1.0 + cosine) * 0.5));
  double half_sine = std::sqrt(std::max(0.0, (1.0 - cosine) * 0.5));
  if (cosine > 0.0 && sine >= 0.0) half_sine = sine / (2.0 * half_cosine);
  if (sine < 0.0) half_cosine = -half_cosine;
  if (half_cosine <= -1.0) return merged;
  // The axis turns by what the spread grows, in the plane of the two axes.
  const Vec3d across = b.axis - a.axis * dot(a.axis, b.axis);
  const double across_length = length(across);
  if (across_length < 1e-12) return merged;  // opposite: any plane holds both
  const double turn_cosine = half_cosine * a.spread.cosine + half_sine * a.spread.sine;
  const double turn_sine = half_sine * a.spread.cosine - half_cosine * a.spread.sine;
  const Vec3d axis = a.axis * turn_cosine + across * (turn_sine / across_length);
  merged.axis = axis * (1.0 / length(axis));
  merged.spread = {half_cosine, half_sine};
  return merged;
}

}  // namespace cone_detail

/// A cone that holds both. Neither associative nor the least: the order of merging matters.
inline Cone merge(Cone a, Cone b) {
  if (a.is_empty) return b;
  if (b.is_empty) return a;
  if (a.spread.cosine > b.spread.cosine) std::swap(a, b);
  a.is_two_sided = a.is_two_sided || b.is_two_sided;
  a.extent = a.extent.cosine < b.extent.cosine ? a.extent : b.extent;
  if (a.is_two_sided && dot(a.axis, b.axis) < 0.0) b.axis = b.axis * -1.0;
  const Angle turn = Angle::between(a.axis, b.axis);
  const bool holds_b = saturated_sum(turn, b.spread).cosine >= a.spread.cosine - 1e-12;
  return holds_b ? a : cone_detail::turned_towards(a, b, turn);
}

/// M_Omega of Conty Estevez & Kulla 2018: the measure of the directions that a cone shines to.
inline double orientation_measure(const Cone& cone) {
  constexpr double kPi = 3.14159265358979;
  const Angle spread = cone.spread;
  const Angle reach = saturated_sum(spread, cone.extent);
  const double width = std::max(0.0, reach.radians() - spread.radians());
  // cos(spread - 2 reach)
  const double twice_cosine = reach.cosine * reach.cosine - reach.sine * reach.sine;
  const double twice_sine = 2.0 * reach.sine * reach.cosine;
  const double last = spread.cosine * twice_cosine + spread.sine * twice_sine;
  const double rim = 2.0 * width * spread.sine - last + spread.cosine;
  return 2.0 * kPi * (1.0 - spread.cosine) + 0.5 * kPi * std::max(0.0, rim);
}

}  // namespace kiwami

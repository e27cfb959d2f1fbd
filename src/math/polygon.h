// SPDX-License-Identifier: Apache-2.0
// A triangle cut by boxes, in double precision.
#pragma once

#include <cmath>
#include <cstdint>

#include "math/vec3.h"

namespace kiwami {

struct Point3d {
  double at[3];
};

/// The part of a triangle that lies within boxes: convex, with its own box.
class ClippedTriangle {
 public:
  explicit ClippedTriangle(const Vec3f corner[3]) : ClippedTriangle(corner, {0, 0, 0}) {}

  /// With coordinates relative to origin.
  ClippedTriangle(const Vec3f corner[3], const Vec3f& origin) : count_(3) {
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        points_[k].at[axis] = static_cast<double>(corner[k][axis]) - origin[axis];
      }
    }
    update_bounds();
  }

  bool is_empty() const { return count_ == 0; }
  double lower(int axis) const { return lower_[axis]; }
  double upper(int axis) const { return upper_[axis]; }

  /// Whether its own box shares a point with the closed box.
  template <typename Number>
  bool may_overlap(const Number box_lower[3], const Number box_upper[3]) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(lower_[axis] <= box_upper[axis] && box_lower[axis] <= upper_[axis])) return false;
    }
    return true;
  }

  /// Keeps what lies within the closed box: I. E. Sutherland, G. W. Hodgman, "Reentrant Polygon
  /// Clipping", Communications of the ACM 17(1), 1974. Each plane adds one corner at most. Corners
  /// that a plane makes lie on it to the bit, so a next cut by the same plane leaves them.
  void clip(const float box_lower[3], const float box_upper[3]) {
    bool is_cut = false;
    for (int axis = 0; axis < 3 && count_ != 0; ++axis) {
      if (lower_[axis] < box_lower[axis]) is_cut |= cut(axis, box_lower[axis], 1.0);
      if (upper_[axis] > box_upper[axis]) is_cut |= cut(axis, box_upper[axis], -1.0);
    }
    if (is_cut) update_bounds();
  }

  /// Keeps what lies on one side of a plane, in the same way: above it for a sign of 1, below it
  /// for -1.
  void clip(int axis, double plane, double sign) {
    if (cut(axis, plane, sign)) update_bounds();
  }

  double area() const {
    double sum = 0.0;
    for (uint32_t i = 2; i < count_; ++i) sum += area_of(points_[0], points_[i - 1], points_[i]);
    return sum;
  }

 private:
  static constexpr uint32_t kMaxPoints = 9;

  static double area_of(const Point3d& a, const Point3d& b, const Point3d& c) {
    double e[3], f[3];
    for (int axis = 0; axis < 3; ++axis) {
      e[axis] = b.at[axis] - a.at[axis];
      f[axis] = c.at[axis] - a.at[axis];
    }
    const double x = e[1] * f[2] - e[2] * f[1];
    const double y = e[2] * f[0] - e[0] * f[2];
    const double z = e[0] * f[1] - e[1] * f[0];
    return 0.5 * std::sqrt(x * x + y * y + z * z);
  }

  /// Keeps the side where sign * (coordinate - plane) >= 0; returns whether there was another.
  bool cut(int axis, double plane, double sign) {
    Point3d kept[kMaxPoints + 1];
    uint32_t kept_count = 0;
    bool is_cut = false;
    for (uint32_t i = 0; i < count_; ++i) {
      const Point3d& from = points_[i];
      const Point3d& to = points_[i + 1 < count_ ? i + 1 : 0];
      const double from_side = sign * (from.at[axis] - plane);
      const double to_side = sign * (to.at[axis] - plane);
      if (from_side >= 0.0) {
        kept[kept_count++] = from;
      } else {
        is_cut = true;
      }
      if ((from_side > 0.0 && to_side < 0.0) || (from_side < 0.0 && to_side > 0.0)) {
        kept[kept_count++] = crossing(from, to, from_side / (from_side - to_side), axis, plane);
      }
    }
    if (!is_cut) return false;
    count_ = kept_count < 3 ? 0 : kept_count;
    for (uint32_t i = 0; i < count_; ++i) points_[i] = kept[i];
    return true;
  }

  static Point3d crossing(const Point3d& from, const Point3d& to, double t, int axis,
                          double plane) {
    Point3d point;
    for (int k = 0; k < 3; ++k) point.at[k] = from.at[k] + t * (to.at[k] - from.at[k]);
    point.at[axis] = plane;
    return point;
  }

  void update_bounds() {
    for (int axis = 0; axis < 3; ++axis) {
      lower_[axis] = upper_[axis] = points_[0].at[axis];
      for (uint32_t i = 1; i < count_; ++i) {
        lower_[axis] = std::fmin(lower_[axis], points_[i].at[axis]);
        upper_[axis] = std::fmax(upper_[axis], points_[i].at[axis]);
      }
    }
  }

  Point3d points_[kMaxPoints];
  uint32_t count_;
  double lower_[3], upper_[3];
};

}  // namespace kiwami

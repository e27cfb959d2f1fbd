// SPDX-License-Identifier: Apache-2.0
// After J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
// Predicates", Discrete & Computational Geometry 18(3), 1997: a determinant in double precision
// with a bound of its error, and an exact sum where that does not decide. Departs from it in that
// the coordinates are floats: a product of three of them is the sum of two doubles, and no stages
// are needed between the two.
#include "tetrahedra/volume.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace kiwami {
namespace {

/// The error of a determinant of differences, relative to its permanent: (7 + 56 e) e with e =
/// 2^-53, by Shewchuk's derivation, is below this.
constexpr double kSignError = 0x1p-50;
/// A determinant of at least this part of its permanent is right to 2^-24 of itself.
constexpr double kExactEnough = 0x1p-26;

/// A sum of doubles without any error: parts of rising size that do not overlap (Shewchuk's
/// expansion, grown term by term, without its zeros).
class ExactSum {
 public:
  void add(double term) {
    uint32_t kept = 0;
    double rest = term;
    for (uint32_t i = 0; i < count_; ++i) {
      const double sum = rest + parts_[i];
      const double back = sum - rest;
      const double error = (rest - (sum - back)) + (parts_[i] - back);
      if (error != 0.0) parts_[kept++] = error;
      rest = sum;
    }
    if (rest != 0.0) parts_[kept++] = rest;
    count_ = kept;
  }

  /// Rounded; its sign is that of the sum, as the last part is larger than all others together.
  double value() const {
    double sum = 0.0;
    for (uint32_t i = 0; i < count_; ++i) sum += parts_[i];
    return sum;
  }

 private:
  double parts_[48];
  uint32_t count_ = 0;
};

/// a * b * c, exactly: the product of two floats fits into a double, its halves times a third one do
/// so, too.
void add_product(ExactSum& sum, float a, float b, double c) {
  const double product = static_cast<double>(a) * static_cast<double>(b);
  uint64_t bits;
  std::memcpy(&bits, &product, sizeof bits);
  bits &= ~uint64_t{0} << 27;  // 26 of 53 digits
  double high;
  std::memcpy(&high, &bits, sizeof high);
  sum.add((product - high) * c);
  sum.add(high * c);
}

/// sign times the determinant of three points.
void add_determinant(ExactSum& sum, const Vec3f& u, const Vec3f& v, const Vec3f& w, double sign) {
  for (int axis = 0; axis < 3; ++axis) {
    const int next = (axis + 1) % 3, last = (axis + 2) % 3;
    const double along = sign * static_cast<double>(w[axis]);
    add_product(sum, u[next], v[last], along);
    add_product(sum, u[last], v[next], -along);
  }
}

struct Vector {
  double x, y, z;
};

Vector difference(const Vec3f& a, const Vec3f& b) {
  return {static_cast<double>(a.x) - static_cast<double>(b.x),
          static_cast<double>(a.y) - static_cast<double>(b.y),
          static_cast<double>(a.z) - static_cast<double>(b.z)};
}

/// A cross product, and the same of the sizes with sums in place of differences.
struct Cross {
  Vector product, size;

  Cross(const Vector& a, const Vector& b) {
    const double yz = a.y * b.z, zy = a.z * b.y;
    const double zx = a.z * b.x, xz = a.x * b.z;
    const double xy = a.x * b.y, yx = a.y * b.x;
    product = {yz - zy, zx - xz, xy - yx};
    size = {std::fabs(yz) + std::fabs(zy), std::fabs(zx) + std::fabs(xz),
            std::fabs(xy) + std::fabs(yx)};
  }
};

/// A determinant, and what its error is relative to.
struct Volume {
  double value, permanent;

  Volume() = default;
  Volume(const Vector& a, const Cross& of, double sign)
      : value(sign * (a.x * of.product.x + a.y * of.product.y + a.z * of.product.z)),
        permanent(std::fabs(a.x) * of.size.x + std::fabs(a.y) * of.size.y +
                  std::fabs(a.z) * of.size.z) {}

  bool is_known_to(double error) const { return std::fabs(value) > error * permanent; }
};

/// The volumes with each corner in turn replaced by the point.
struct PartVolumes {
  Volume of[4];

  PartVolumes(const Vec3f (&corner)[4], const Vec3f& point) {
    Vector to[4];
    for (int i = 0; i < 4; ++i) to[i] = difference(corner[i], point);
    const Cross last(to[2], to[3]), first(to[0], to[1]);
    of[0] = Volume(to[1], last, 1.0);
    of[1] = Volume(to[0], last, -1.0);
    of[2] = Volume(to[3], first, 1.0);
    of[3] = Volume(to[2], first, -1.0);
  }

  void make_exact(const Vec3f (&corner)[4], const Vec3f& point, int i) {
    Vec3f replaced[4] = {corner[0], corner[1], corner[2], corner[3]};
    replaced[i] = point;
    of[i].value = exact_volume(replaced[0], replaced[1], replaced[2], replaced[3]);
    of[i].permanent = -1.0;  // known, 0 included
  }

  /// Whether two that are known have different signs: then the point is outside.
  bool differ() const {
    bool has_positive = false, has_negative = false;
    for (const Volume& volume : of) {
      if (!volume.is_known_to(kSignError)) continue;
      has_positive = has_positive || volume.value > 0.0;
      has_negative = has_negative || volume.value < 0.0;
    }
    return has_positive && has_negative;
  }
};

}  // namespace

double exact_volume(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  ExactSum sum;
  add_determinant(sum, b, c, d, 1.0);
  add_determinant(sum, a, c, d, -1.0);
  add_determinant(sum, a, b, d, 1.0);
  add_determinant(sum, a, b, c, -1.0);
  return sum.value();
}

double signed_volume(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  const Volume volume(difference(b, a), Cross(difference(c, a), difference(d, a)), 1.0);
  return volume.is_known_to(kSignError) ? volume.value : exact_volume(a, b, c, d);
}

PointPlace place_point(const Vec3f (&corner)[4], const Vec3f& point, float (&weights)[4]) {
  PartVolumes parts(corner, point);
  if (parts.differ()) return PointPlace::kOutside;
  for (int i = 0; i < 4; ++i) {
    if (!parts.of[i].is_known_to(kSignError)) parts.make_exact(corner, point, i);
  }
  if (parts.differ()) return PointPlace::kOutside;
  bool is_inside = true;
  double total = 0.0;
  for (int i = 0; i < 4; ++i) {
    if (!parts.of[i].is_known_to(kExactEnough)) parts.make_exact(corner, point, i);
    is_inside = is_inside && parts.of[i].value != 0.0;
    total += std::fabs(parts.of[i].value);
  }
  for (int i = 0; i < 4; ++i) {
    const double size = std::fabs(parts.of[i].value);
    weights[i] = size > 0.0
                     ? std::max(static_cast<float>(size / total), std::numeric_limits<float>::min())
                     : 0.0f;
  }
  return is_inside ? PointPlace::kInside : PointPlace::kOnBorder;
}

}  // namespace kiwami

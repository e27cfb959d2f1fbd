// SPDX-License-Identifier: Apache-2.0
// Volumes of tetrahedra, whose signs are exact.
#pragma once

#include "math/vec3.h"

namespace kiwami {

/// Six times the signed volume of the tetrahedron (a, b, c, d): above 0 where d lies on the side to
/// which (b - a) x (c - a) points. Exact but for one rounding for each of at most 48 terms that do
/// not cancel; its sign, 0 included, is exact. Coordinates are finite.
double exact_volume(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d);

/// The same, in plain double precision where that is sure of the sign.
double signed_volume(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d);

/// How a point lies with respect to a tetrahedron.
enum class PointPlace { kOutside, kOnBorder, kInside };

/// The place of a point, exactly, with respect to a tetrahedron that has a volume. Unless it is
/// outside, the weights of the corners, each right to 2^-22 of itself.
PointPlace place_point(const Vec3f (&corner)[4], const Vec3f& point, float (&weights)[4]);

}  // namespace kiwami

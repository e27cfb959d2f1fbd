// SPDX-License-Identifier: Apache-2.0
// From a kiwami_ray to what the node and triangle tests need, once per ray.
#pragma once

#include "kernels/kernel_table.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// The margin of the box test, in units of 2^-24 (the rounding error u of a float operation).
///
/// Let M_a = |o_a| + H_a along axis a, in the frame of the stored boxes, and S_a = d_a / d_kz. The
/// accepted t is a convex combination of the vertices' Z' = Sz * (v_kz - o_kz), three roundings.
/// The hit point along axis a, in the same combination, is off by at most 2 u M_a (v_a - o_a, and
/// the last subtraction of the shear) + 4 u S_a M_kz (S_a, its product, v_kz - o_kz, the
/// subtraction)
/// + 3 u S_a M_kz (t itself) + u S_a M_kz (t rounded to float). The slab adds 5 u M_a: the origin
/// moved to the stored frame, the reciprocal, o * r, the margin's subtraction and, where the
/// product and sum are not fused, two roundings of which one scales with H_a alone. Altogether
/// 7 M_a + 8 S_a M_kz; 9 leaves room for the products of errors and the rounding of the margin.
constexpr float kMargin = 9.0f * 0x1p-24f;
/// Below this size errors are absolute (denormal numbers); it is far above 2^-149.
constexpr float kLeastMagnitude = 0x1p-100f;
/// Smaller direction components, relative to the greatest, are raised to this.
constexpr float kLeastDirection = 0x1p-64f;
/// Widens scaled distances that may have become denormal; nothing to any other.
constexpr float kLeastDistance = 0x1p-140f;

/// The scalar part of the set-up. Directions and distances are scaled by the power of two that
/// brings the greatest direction component into [1, 2): so no product below can overflow, and, a
/// power of two being exact, no result changes.
struct ScalarRay {
  float origin[3];
  float direction[3];  ///< scaled
  float tmin, tmax;    ///< as given
  double scale;        ///< scaled distance = distance * scale
  double unscale;      ///< its inverse
  int kx, ky, kz;      ///< kz: axis of the greatest component; kx, ky: so that winding is kept
  float shear_x, shear_y, shear_z;
  uint32_t mask, flags;
};

/// False for a ray that can only miss: NaN, zero or infinite direction, origin out of range. Each
/// comparison is false for NaN.
inline bool is_traceable(const kiwami_ray& ray) {
  const float x = __builtin_fabsf(ray.direction_x), y = __builtin_fabsf(ray.direction_y),
              z = __builtin_fabsf(ray.direction_z);
  const float infinity = __builtin_inff();
  return __builtin_fabsf(ray.origin_x) <= KIWAMI_MAX_COORDINATE &&
         __builtin_fabsf(ray.origin_y) <= KIWAMI_MAX_COORDINATE &&
         __builtin_fabsf(ray.origin_z) <= KIWAMI_MAX_COORDINATE && x < infinity && y < infinity &&
         z < infinity && (x > 0.0f || y > 0.0f || z > 0.0f) && ray.tmin <= ray.tmax;
}

inline double power_of_two(int exponent) {
  const uint64_t bits = static_cast<uint64_t>(1023 + exponent) << 52;
  double value;
  __builtin_memcpy(&value, &bits, sizeof value);
  return value;
}

inline int exponent_of(float value) {
  const double wide = value;  // a denormal float is a normal double
  uint64_t bits;
  __builtin_memcpy(&bits, &wide, sizeof bits);
  return static_cast<int>((bits >> 52) & 0x7ff) - 1023;
}

inline void set_up_scalar(const kiwami_ray& ray, ScalarRay& out) {
  out.origin[0] = ray.origin_x;
  out.origin[1] = ray.origin_y;
  out.origin[2] = ray.origin_z;
  const float direction[3] = {ray.direction_x, ray.direction_y, ray.direction_z};
  const float x = __builtin_fabsf(direction[0]), y = __builtin_fabsf(direction[1]),
              z = __builtin_fabsf(direction[2]);
  const int kz = x >= y ? (x >= z ? 0 : 2) : (y >= z ? 1 : 2);
  const int next = kz == 2 ? 0 : kz + 1, last = kz == 0 ? 2 : kz - 1;
  const bool is_negative = direction[kz] < 0.0f;
  out.kz = kz;
  out.kx = is_negative ? last : next;
  out.ky = is_negative ? next : last;
  const int exponent = exponent_of(direction[kz]);
  out.scale = power_of_two(exponent);
  out.unscale = power_of_two(-exponent);
  for (int axis = 0; axis < 3; ++axis) {
    out.direction[axis] = static_cast<float>(static_cast<double>(direction[axis]) * out.unscale);
  }
  out.shear_x = out.direction[out.kx] / out.direction[kz];
  out.shear_y = out.direction[out.ky] / out.direction[kz];
  out.shear_z = 1.0f / out.direction[kz];
  out.tmin = ray.tmin;
  out.tmax = ray.tmax;
  out.mask = ray.mask;
  out.flags = ray.flags;
}

/// A lower (upper) bound of a scaled distance.
inline float scaled_lower(const ScalarRay& ray, float t) {
  return static_cast<float>(static_cast<double>(t) * ray.scale) - kLeastDistance;
}
inline float scaled_upper(const ScalarRay& ray, float t) {
  return static_cast<float>(static_cast<double>(t) * ray.scale) + kLeastDistance;
}

/// The ray as the node test reads it: near = bound * reciprocal + near_offset per axis.
template <int N>
struct SlabRay {
  vfloat<N> reciprocal[3];
  vfloat<N> near_offset[3];
  vfloat<N> far_offset[3];
  vfloat<N> tmin;
  /// Where in a node the planes lie that the ray meets first (last) along an axis, in bytes.
  size_t near_plane[3];
  size_t far_plane[3];
};

template <int N>
inline void set_up_slabs(const ScalarRay& ray, const TreeView& tree, SlabRay<N>& out) {
  const float centre[3] = {tree.centre.x, tree.centre.y, tree.centre.z};
  const float greatest[3] = {tree.greatest_bound.x, tree.greatest_bound.y, tree.greatest_bound.z};
  const float major_magnitude =
      __builtin_fabsf(ray.origin[ray.kz] - centre[ray.kz]) + greatest[ray.kz] + kLeastMagnitude;
  const float major_direction = __builtin_fabsf(ray.direction[ray.kz]);
  const float least = kLeastDirection * major_direction;
  for (int axis = 0; axis < 3; ++axis) {
    const float origin = ray.origin[axis] - centre[axis];
    const float magnitude = __builtin_fabsf(origin) + greatest[axis] + kLeastMagnitude;
    float direction = ray.direction[axis];
    const float size = __builtin_fabsf(direction);
    const bool is_raised = size < least;
    if (is_raised) direction = __builtin_copysignf(least, direction);
    const float reciprocal = 1.0f / direction;
    const float shear = axis == ray.kz ? 0.0f : size / major_direction;
    float margin = kMargin * (magnitude + shear * major_magnitude) * __builtin_fabsf(reciprocal);
    // A raised component moves the point by at most 2^-64 |d_kz| t <= 2^-64 M_kz.
    if (is_raised) margin += major_magnitude / major_direction;
    const float product = origin * reciprocal;
    out.reciprocal[axis] = broadcast<N>(reciprocal);
    out.near_offset[axis] = broadcast<N>(-product - margin);
    out.far_offset[axis] = broadcast<N>(margin - product);
    const size_t lower = 2 * axis * N * sizeof(float), upper = lower + N * sizeof(float);
    const bool is_backward = __builtin_signbit(direction);
    out.near_plane[axis] = is_backward ? upper : lower;
    out.far_plane[axis] = is_backward ? lower : upper;
  }
  out.tmin = broadcast<N>(scaled_lower(ray, ray.tmin));
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

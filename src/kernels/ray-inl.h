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
/// Widens scaled distances: where a distance is denormal it has been rounded by up to half the
/// least float, where a scaled one is, by as much; any other is left as it is.
constexpr double kLeastDistance = 0x1p-140;
constexpr double kLeastFloat = 0x1p-149;

/// The part of the set-up that no tree has a say in. Directions and distances are scaled by the
/// power of two that brings the greatest direction component into [1, 2): so no product below can
/// overflow, and, a power of two being exact, no result changes.
struct ScalarRay {
  float origin[4];     ///< x, y, z; the fourth lane is not used
  float direction[4];  ///< scaled; the same
  float ratio[4];      ///< direction / greatest direction component
  float tmin, tmax;    ///< as given, but finite: a distance that overflows is no hit
  double scale;        ///< scaled distance = distance * scale
  double unscale;      ///< its inverse
  double slack;        ///< widens scaled distances
  int kx, ky, kz;      ///< kz: axis of the greatest component; kx, ky: so that winding is kept
  float shear_z;       ///< 1 / direction[kz]; ratio[kx] and ratio[ky] are the other two shears
  uint32_t mask, flags;
};

/// The first and second four floats of a ray: origin and tmin, direction and tmax.
inline const float* first_half(const kiwami_ray& ray) {
  return reinterpret_cast<const float*>(&ray);
}
inline const float* second_half(const kiwami_ray& ray) { return first_half(ray) + 4; }

/// False for a ray that can only miss: NaN, zero or infinite direction, origin out of range, no
/// finite distance between tmin and tmax, a mask without bits. Each comparison is false for NaN.
inline bool is_traceable(const kiwami_ray& ray) {
  constexpr uint32_t xyz = 7;
  const vfloat<4> origin = absolute(load<4>(first_half(ray)));
  const vfloat<4> direction = absolute(load<4>(second_half(ray)));
  const bool is_in_range = (less_equal(origin, broadcast<4>(KIWAMI_MAX_COORDINATE)) & xyz) == xyz;
  const bool is_finite = (less_equal(direction, broadcast<4>(__FLT_MAX__)) & xyz) == xyz;
  const bool is_zero = (less_equal(direction, broadcast<4>(0.0f)) & xyz) == xyz;
  return is_in_range && is_finite && !is_zero && ray.tmin <= ray.tmax && ray.tmin <= __FLT_MAX__ &&
         ray.tmax >= -__FLT_MAX__ && ray.mask != 0;
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
  const float x = __builtin_fabsf(ray.direction_x), y = __builtin_fabsf(ray.direction_y),
              z = __builtin_fabsf(ray.direction_z);
  const float greatest_xy = x < y ? y : x;
  const int kz = greatest_xy < z ? 2 : x < y ? 1 : 0;
  const float major = second_half(ray)[kz];
  const int next = kz == 2 ? 0 : kz + 1, last = kz == 0 ? 2 : kz - 1;
  const bool is_negative = major < 0.0f;
  out.kz = kz;
  out.kx = is_negative ? last : next;
  out.ky = is_negative ? next : last;
  const int exponent = exponent_of(major);
  out.scale = power_of_two(exponent);
  out.unscale = power_of_two(-exponent);
  store(out.origin, load<4>(first_half(ray)));
  store_rounded(out.direction, load_widened(second_half(ray)) * broadcast_double(out.unscale));
  const vfloat<4> direction = load<4>(out.direction);
  const vfloat<4> greatest = broadcast<4>(out.direction[kz]);
  store(out.ratio, direction / greatest);
  out.shear_z = 1.0f / out.direction[kz];
  out.slack = kLeastDistance + kLeastFloat * out.scale;
  out.tmin = ray.tmin > -__FLT_MAX__ ? ray.tmin : -__FLT_MAX__;
  out.tmax = ray.tmax < __FLT_MAX__ ? ray.tmax : __FLT_MAX__;
  out.mask = ray.mask;
  out.flags = ray.flags;
}

/// A lower (upper) bound of a scaled distance.
inline float scaled_lower(const ScalarRay& ray, float t) {
  return static_cast<float>(static_cast<double>(t) * ray.scale - ray.slack);
}
inline float scaled_upper(const ScalarRay& ray, float t) {
  return static_cast<float>(static_cast<double>(t) * ray.scale + ray.slack);
}

/// Where in a node the planes lie that a ray meets first and last along each axis, in bytes, for
/// each combination of backward axes.
template <int N>
struct PlaneOffsets {
  size_t near[3], far[3];
};

template <int N>
constexpr PlaneOffsets<N> plane_offsets(uint32_t backward) {
  PlaneOffsets<N> offsets{};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    const uint32_t is_backward = (backward >> axis) & 1u;
    offsets.near[axis] = (2 * axis + is_backward) * N * sizeof(float);
    offsets.far[axis] = (2 * axis + 1 - is_backward) * N * sizeof(float);
  }
  return offsets;
}

template <int N>
constexpr PlaneOffsets<N> kPlaneOffsets[8] = {
    plane_offsets<N>(0), plane_offsets<N>(1), plane_offsets<N>(2), plane_offsets<N>(3),
    plane_offsets<N>(4), plane_offsets<N>(5), plane_offsets<N>(6), plane_offsets<N>(7)};

/// The ray as the node test reads it: near = bound * reciprocal + near_offset per axis.
template <int N>
struct SlabRay {
  uniform4<N> reciprocal;
  uniform4<N> near_offset;
  uniform4<N> far_offset;
  vfloat<N> tmin;
  const PlaneOffsets<N>* planes;
};

/// The axes lie in the lanes. The margin takes S = 1 along the major axis too, where 0 would do.
template <int N>
inline void set_up_slabs(const ScalarRay& ray, const TreeView& tree, SlabRay<N>& out) {
  const vfloat<4> origin =
      load<4>(ray.origin) - load<4>(reinterpret_cast<const float*>(&tree.centre));
  const vfloat<4> magnitude =
      absolute(origin) + (load<4>(reinterpret_cast<const float*>(&tree.greatest_bound)) +
                          broadcast<4>(kLeastMagnitude));
  float magnitudes[4];
  store(magnitudes, magnitude);
  const float major_magnitude = magnitudes[ray.kz];
  const vfloat<4> direction = load<4>(ray.direction);
  const vfloat<4> size = absolute(direction);
  const float major_size = __builtin_fabsf(ray.direction[ray.kz]);
  const vfloat<4> raised = max(size, broadcast<4>(kLeastDirection * major_size));
  const vfloat<4> reciprocal_size = broadcast<4>(1.0f) / raised;
  const vfloat<4> reciprocal = copy_sign(reciprocal_size, direction);
  const vfloat<4> relative =
      broadcast<4>(kMargin) *
      (magnitude + absolute(load<4>(ray.ratio)) * broadcast<4>(major_magnitude)) * reciprocal_size;
  // A raised component moves the point by what was added, times t <= M_kz / |d_kz|.
  const vfloat<4> moved =
      (raised - size) * reciprocal_size * broadcast<4>(major_magnitude / major_size);
  const vfloat<4> margin = relative + moved;
  const vfloat<4> product = origin * reciprocal;
  out.reciprocal = spread<N>(reciprocal);
  out.near_offset = spread<N>(broadcast<4>(0.0f) - product - margin);
  out.far_offset = spread<N>(margin - product);
  out.planes = &kPlaneOffsets<N>[sign_bits(direction) & 7u];
  out.tmin = broadcast<N>(scaled_lower(ray, ray.tmin));
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

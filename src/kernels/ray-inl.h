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
/// Smaller direction components, where the greatest is 1 to 2, are raised to this.
constexpr float kLeastDirection = 0x1p-63f;
/// For what raising adds, relative to it.
constexpr float kRaisedMargin = 16.0f * 0x1p-24f;
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
  float ratio[4];      ///< direction / direction[kz]; those of kx and ky are the shears
  float shear_z;       ///< 1 / direction[kz]
  float tmin, tmax;    ///< as given, but finite: a distance that overflows is no hit
  int kx, ky, kz;      ///< kz: axis of the greatest component; kx, ky: so that winding is kept
  double scale;        ///< scaled distance = distance * scale
  double unscale;      ///< its inverse
  double slack;        ///< widens scaled distances
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

/// The direction with its greatest component brought into [1, 2), and the exponent that it had.
inline vfloat<4> scale_direction(const kiwami_ray& ray, int& exponent) {
  vfloat<4> direction = load<4>(second_half(ray));
  int field = static_cast<int>(first_bits(greatest_of_three(absolute(direction))) >> 23);
  exponent = field - 127;
  if (__builtin_expect(field == 0 || field == 254, 0)) {
    // A factor of 2^-exponent would not be a normal float: a step before leads there.
    direction = direction * broadcast<4>(field == 0 ? 0x1p64f : 0x1p-1f);
    field = static_cast<int>(first_bits(greatest_of_three(absolute(direction))) >> 23);
    exponent = exponent < 0 ? field - 127 - 64 : field - 127 + 1;
  }
  const uint32_t factor_bits = static_cast<uint32_t>(254 - field) << 23;
  float factor;
  __builtin_memcpy(&factor, &factor_bits, sizeof factor);
  return direction * broadcast<4>(factor);
}

inline void set_up_scalar(const kiwami_ray& ray, ScalarRay& out) {
  int exponent;
  const vfloat<4> direction = scale_direction(ray, exponent);
  store(out.direction, direction);
  store(out.origin, load<4>(first_half(ray)));
  const float x = __builtin_fabsf(ray.direction_x), y = __builtin_fabsf(ray.direction_y),
              z = __builtin_fabsf(ray.direction_z);
  const float greatest_xy = x < y ? y : x;
  const int kz = greatest_xy < z ? 2 : x < y ? 1 : 0;
  // Which of the other two comes first is not branched on: backward rays are as likely as others.
  constexpr int others[6][2] = {{1, 2}, {2, 1}, {2, 0}, {0, 2}, {0, 1}, {1, 0}};
  const int is_negative = static_cast<int>(sign_bits(direction) >> kz) & 1;
  out.kz = kz;
  out.kx = others[2 * kz + is_negative][0];
  out.ky = others[2 * kz + is_negative][1];
  const float major = out.direction[kz];
  store(out.ratio, direction / broadcast<4>(major));
  out.shear_z = 1.0f / major;
  out.scale = power_of_two(exponent);
  out.unscale = power_of_two(-exponent);
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
  Uniform4<N> reciprocal;
  Uniform4<N> near_offset;
  Uniform4<N> far_offset;
  float tmin;  ///< a lower bound, scaled
  const PlaneOffsets<N>* planes;
};

/// What SlabRay spreads, with the axes in the lanes.
struct AxisSlabs {
  vfloat<4> reciprocal, near_offset, far_offset;
  uint32_t backward;  ///< bit for each axis along which the ray runs backward
};

/// In the margin, M_kz is taken as the greatest M of all axes, S_a as |d_a| and 1 / |d_kz| as 1:
/// all no less than they are, since |d_kz| lies in [1, 2), and known without looking for kz.
inline void set_up_axes(const ScalarRay& ray, const TreeView& tree, AxisSlabs& out) {
  const vfloat<4> origin =
      load<4>(ray.origin) - load<4>(reinterpret_cast<const float*>(&tree.centre));
  const vfloat<4> direction = load<4>(ray.direction);
  const vfloat<4> size = absolute(direction);
  const vfloat<4> raised = max(size, broadcast<4>(kLeastDirection));
  const vfloat<4> reciprocal_size = broadcast<4>(1.0f) / raised;
  const vfloat<4> magnitude =
      absolute(origin) + (load<4>(reinterpret_cast<const float*>(&tree.greatest_bound)) +
                          broadcast<4>(kLeastMagnitude));
  const vfloat<4> greatest_magnitude = greatest_of_three(magnitude);
  const vfloat<4> rounding = broadcast<4>(kMargin) * (magnitude + size * greatest_magnitude);
  // A raised component moves the point by what was added, times t <= M_kz / |d_kz|. That may be all
  // of t, so its own roundings count as well: four of t, six of the term on its way to the slab's
  // distance and two of the sums there, 12 u in all.
  const vfloat<4> moved = (raised - size) * greatest_magnitude * broadcast<4>(1.0f + kRaisedMargin);
  const vfloat<4> margin = (rounding + moved) * reciprocal_size;
  out.reciprocal = copy_sign(reciprocal_size, direction);
  const vfloat<4> product = origin * out.reciprocal;
  out.near_offset = broadcast<4>(0.0f) - product - margin;
  out.far_offset = margin - product;
  out.backward = sign_bits(direction) & 7u;
}

template <int N>
inline void set_up_slabs(const ScalarRay& ray, const TreeView& tree, SlabRay<N>& out) {
  AxisSlabs slabs;
  set_up_axes(ray, tree, slabs);
  out.reciprocal = spread<N>(slabs.reciprocal);
  out.near_offset = spread<N>(slabs.near_offset);
  out.far_offset = spread<N>(slabs.far_offset);
  out.planes = &kPlaneOffsets<N>[slabs.backward];
  out.tmin = scaled_lower(ray, ray.tmin);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

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
/// Widens scaled distances, by this much before and after scaling: where a distance is denormal it
/// has been rounded by up to half the least float, where a scaled one is, by as much; any above
/// 2^-96 is left as it is. A normal number, since processors are slow with others.
constexpr float kLeastDistance = 0x1p-120f;

/// A ray as traversal reads it. Directions and distances are scaled by the power of two that brings
/// the greatest direction component into [1, 2): so no product can overflow, and, a power of two
/// being exact, no result changes. It is made of rows of four, so that groups of rays can be turned
/// from lanes to rows and back.
struct alignas(64) ReadyRay {
  // For boxes: a plane is met at bound * reciprocal + offset, less or plus the margin.
  float reciprocal[3];  ///< 1 / direction, components near zero raised before
  float nearest;        ///< a lower bound of tmin, scaled
  float near_offset[3];
  float farthest;  ///< an upper bound of tmax, scaled
  float far_offset[3];
  float scale;  ///< scaled distance = distance * scale
  // For triangles, by axes of the ray's own: the last one, z, is that of the greatest component of
  // the direction, and the first two follow so that winding is kept.
  float origin[3];
  float tmin;      ///< as given, but finite: a distance that overflows is no hit
  float shear[2];  ///< direction along x and y for one step along z
  float one;       ///< the same of z
  float tmax;
  uint32_t axis[3];  ///< which axes of the world these are
  float shear_z;     ///< 1 / direction along z
  uint32_t mask, flags;
  uint32_t backward;  ///< bit for each axis of the world along which the ray runs backward
  float slack;        ///< widens scaled distances
};
static_assert(sizeof(ReadyRay) == 128);

/// Writes a row, given by the offset of its first member.
inline void store_row(ReadyRay& ray, size_t offset, vfloat<4> row) {
  store(reinterpret_cast<float*>(reinterpret_cast<unsigned char*>(&ray) + offset), row);
}

/// A caller's ray where it lies: at any address.
using UnalignedRay __attribute__((aligned(1))) = kiwami_ray;

inline const UnalignedRay& ray_of(const RayBatch& batch, size_t i) {
  return *reinterpret_cast<const UnalignedRay*>(batch.rays + i * batch.ray_stride);
}

/// The first and second four floats of a ray: origin and tmin, direction and tmax.
inline vfloat<4> origin_of(const UnalignedRay& ray) { return load_from_bytes<4>(&ray); }
inline vfloat<4> direction_of(const UnalignedRay& ray) {
  return load_from_bytes<4>(reinterpret_cast<const unsigned char*>(&ray) +
                            offsetof(kiwami_ray, direction_x));
}

constexpr uint32_t kAllAxes = 7;

/// A ray's row that ends with tmin (tmax), that made finite. The second operand is what NaN leaves.
inline vfloat<4> with_finite_start(vfloat<4> row) { return max(broadcast<4>(-__FLT_MAX__), row); }
inline vfloat<4> with_finite_end(vfloat<4> row) { return min(broadcast<4>(__FLT_MAX__), row); }

/// False for a ray that can only miss: NaN, zero or infinite direction, origin out of range, no
/// finite distance between tmin and tmax, a mask without bits. Each comparison is false for NaN.
inline bool is_traceable(const UnalignedRay& ray) {
  const vfloat<4> direction = absolute(direction_of(ray));
  const uint32_t in_range =
      less_equal(absolute(origin_of(ray)), broadcast<4>(KIWAMI_MAX_COORDINATE)) &
      less_equal(direction, broadcast<4>(__FLT_MAX__));
  return (in_range & kAllAxes) == kAllAxes && first_bits(greatest_of_three(direction)) != 0 &&
         ray.tmin <= ray.tmax && ray.tmin <= __FLT_MAX__ && ray.tmax >= -__FLT_MAX__ &&
         ray.mask != 0;
}

/// 2^-e for a power of two 2^e, -149 <= e <= 127.
inline double inverse_of(float power_of_two) {
  const double power = power_of_two;
  uint64_t bits;
  __builtin_memcpy(&bits, &power, sizeof bits);
  bits = (uint64_t{2 * 1023} << 52) - bits;
  double inverse;
  __builtin_memcpy(&inverse, &bits, sizeof inverse);
  return inverse;
}

/// A direction with its greatest component brought into [1, 2), what it was divided by, and which
/// components are the greatest.
struct ScaledDirection {
  vfloat<4> value;
  float scale;
  uint32_t greatest;
};

inline ScaledDirection scale_direction(const UnalignedRay& ray) {
  vfloat<4> direction = direction_of(ray);
  vfloat<4> size = absolute(direction);
  vfloat<4> greatest = greatest_of_three(size);
  const uint32_t exponent_field = first_bits(greatest) >> 23;
  float step = 1.0f;
  if (__builtin_expect(exponent_field == 0 || exponent_field == 254, 0)) {
    // The inverse of this power of two would not be a normal float: a step before leads there.
    step = exponent_field == 0 ? 0x1p-64f : 2.0f;
    direction = direction * broadcast<4>(1.0f / step);
    size = absolute(direction);
    greatest = greatest_of_three(size);
  }
  const vfloat<4> power = power_of_two_below(greatest);
  return {direction * inverse_of_power(power), first_lane(power) * step, equal(size, greatest)};
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

/// The ray as the node test reads it, spread over lanes.
template <int N>
struct SlabRay {
  Uniform3<N> reciprocal, near_offset, far_offset;
  float nearest;
  const PlaneOffsets<N>& planes;

  explicit SlabRay(const ReadyRay& ray)
      : reciprocal(ray.reciprocal),
        near_offset(ray.near_offset),
        far_offset(ray.far_offset),
        nearest(ray.nearest),
        planes(kPlaneOffsets<N>[ray.backward]) {}
};

/// A lower (upper) bound of a scaled distance. A power of two scales exactly; what overflows lies
/// beyond all that can be met, since scaled distances of triangles are below 2^62.
inline float scaled_lower(const ReadyRay& ray, float t) { return t * ray.scale - ray.slack; }
inline float scaled_upper(const ReadyRay& ray, float t) { return t * ray.scale + ray.slack; }

/// The axes of a ray: which lanes become its first three, and their numbers.
struct AxisChoice {
  LaneOrder lanes;
  alignas(16) uint32_t axis[4];
};

constexpr AxisChoice axis_choice(uint32_t major, bool is_backward) {
  const uint32_t after = (major + 1) % 3, before = (major + 2) % 3;
  AxisChoice choice{{}, {is_backward ? before : after, is_backward ? after : before, major, 0}};
  const uint32_t lanes[4] = {choice.axis[0], choice.axis[1], major, 3};
  for (uint32_t byte = 0; byte < 16; ++byte) {
    choice.lanes.byte[byte] = static_cast<uint8_t>(4 * lanes[byte / 4] + byte % 4);
  }
  return choice;
}

constexpr AxisChoice kAxisChoices[6] = {axis_choice(0, false), axis_choice(0, true),
                                        axis_choice(1, false), axis_choice(1, true),
                                        axis_choice(2, false), axis_choice(2, true)};

/// The third is the axis of the greatest component, the lowest of equal ones; the other two are in
/// the order that keeps the winding. Nothing is branched on: directions are too mixed to be
/// predicted.
inline const AxisChoice& choose_axes(const ScaledDirection& direction, uint32_t signs) {
  const uint32_t major = static_cast<uint32_t>(__builtin_ctz(direction.greatest));
  return kAxisChoices[2 * major + ((signs >> major) & 1u)];
}

/// By how much the origin is moved along each axis, backward for where a ray enters a slab and
/// forward for where it leaves: the margin times the direction. M_kz is taken as the greatest M of
/// all axes, S_a as |d_a| and 1 / |d_kz| as 1: all no less than they are, since |d_kz| lies in
/// [1, 2), and known without looking for kz.
template <int N>
inline vfloat<N> margin_of(vfloat<N> size, vfloat<N> raised, vfloat<N> magnitude,
                           vfloat<N> greatest_magnitude) {
  const vfloat<N> rounding = broadcast<N>(kMargin) * (magnitude + size * greatest_magnitude);
  // A raised component moves the point by what was added, times t <= M_kz / |d_kz|. That may be all
  // of t, so its own roundings count as well: four of t, six of the term on its way to the slab's
  // distance and two of the sums there, 12 u in all.
  const vfloat<N> moved = (raised - size) * greatest_magnitude * broadcast<N>(1.0f + kRaisedMargin);
  return rounding + moved;
}

/// The rows for boxes, with tmin, tmax and scale in their last lanes.
inline void set_up_slabs(const ScaledDirection& direction, vfloat<4> start, vfloat<4> end,
                         const TreeView& tree, ReadyRay& out) {
  const vfloat<4> size = absolute(direction.value);
  const vfloat<4> raised = max(size, broadcast<4>(kLeastDirection));
  const vfloat<4> reciprocal = copy_sign(broadcast<4>(1.0f) / raised, direction.value);
  const vfloat<4> backward = load<4>(reinterpret_cast<const float*>(&tree.centre)) - start;
  const vfloat<4> magnitude =
      absolute(backward) + (load<4>(reinterpret_cast<const float*>(&tree.greatest_bound)) +
                            broadcast<4>(kLeastMagnitude));
  const vfloat<4> margin = copy_sign(
      margin_of<4>(size, raised, magnitude, greatest_of_three(magnitude)), direction.value);
  const vfloat<4> scale = broadcast<4>(direction.scale);
  const vfloat<4> slack = broadcast<4>(kLeastDistance) + broadcast<4>(kLeastDistance) * scale;
  store_row(out, offsetof(ReadyRay, reciprocal), with_last_of(reciprocal, start * scale - slack));
  store_row(out, offsetof(ReadyRay, near_offset),
            with_last_of((backward - margin) * reciprocal, end * scale + slack));
  store_row(out, offsetof(ReadyRay, far_offset),
            with_last_of((backward + margin) * reciprocal, scale));
  out.slack = first_lane(slack);
}

/// One ray that is_traceable, with the axes in the lanes.
inline void set_up(const UnalignedRay& ray, const TreeView& tree, ReadyRay& out) {
  const ScaledDirection direction = scale_direction(ray);
  const vfloat<4> start = with_finite_start(origin_of(ray));
  const vfloat<4> end = with_finite_end(direction_of(ray));
  set_up_slabs(direction, start, end, tree, out);
  const uint32_t signs = sign_bits(direction.value);
  const AxisChoice& choice = choose_axes(direction, signs);
  const vfloat<4> along = rearrange(direction.value, choice.lanes);
  store_row(out, offsetof(ReadyRay, origin), rearrange(start, choice.lanes));
  store_row(out, offsetof(ReadyRay, shear), with_last_of(along / third_in_all(along), end));
  store_row(out, offsetof(ReadyRay, axis), load<4>(reinterpret_cast<const float*>(choice.axis)));
  out.shear_z = out.reciprocal[choice.axis[2]];
  out.mask = ray.mask;
  out.flags = ray.flags;
  out.backward = signs & kAllAxes;
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// The set-up of N rays at once, a ray a lane: a fifth of the instructions of as many single ones.
#pragma once

#include "kernels/ray-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// N rays in lanes. Every value is made by the operations of the single set-up, in their order: the
/// same to the bit.
template <int N>
struct RayGroup {
  vfloat<N> origin[3], direction[3];  ///< the direction as given, then scaled
  vfloat<N> tmin, tmax;
  uint32_t traceable = 0;  ///< lanes of rays that can be traced
  uint32_t unusual = 0;    ///< those of them whose scale takes a step before: left to set_up
};

template <int N>
inline void read_group(const unsigned char* rays, size_t stride, RayGroup<N>& group) {
  static_assert(offsetof(kiwami_ray, direction_x) == 16);
  vfloat<N> columns[4];
  load_rows(rays, stride, columns);
  for (int axis = 0; axis < 3; ++axis) group.origin[axis] = columns[axis];
  group.tmin = columns[3];
  load_rows(rays + offsetof(kiwami_ray, direction_x), stride, columns);
  for (int axis = 0; axis < 3; ++axis) group.direction[axis] = columns[axis];
  group.tmax = columns[3];
}

template <int N>
inline vfloat<N> greatest_of(const vfloat<N> (&axes)[3]) {
  return max(max(axes[0], axes[1]), axes[2]);
}

/// As is_traceable, but for the mask; and scales the directions.
template <int N>
inline void judge_and_scale(RayGroup<N>& group, vfloat<N>& scale) {
  const vfloat<N> most = broadcast<N>(__FLT_MAX__);
  uint32_t lanes = less_equal(group.tmin, group.tmax) & less_equal(group.tmin, most) &
                   less_equal(broadcast<N>(-__FLT_MAX__), group.tmax);
  vfloat<N> size[3];
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = absolute(group.direction[axis]);
    lanes &= less_equal(size[axis], most) &
             less_equal(absolute(group.origin[axis]), broadcast<N>(KIWAMI_MAX_COORDINATE));
  }
  const vfloat<N> greatest = greatest_of<N>(size);
  group.traceable = lanes & ~less_equal(greatest, broadcast<N>(0.0f));
  scale = power_of_two_below(greatest);
  group.unusual =
      group.traceable & (equal(scale, broadcast<N>(0.0f)) | equal(scale, broadcast<N>(0x1p127f)));
  const vfloat<N> factor = inverse_of_power(scale);
  for (vfloat<N>& component : group.direction) component = component * factor;
}

/// Number k as a float of the same bits, to be moved but not reckoned with.
inline float bits_of(int32_t k) {
  float bits;
  __builtin_memcpy(&bits, &k, sizeof bits);
  return bits;
}

/// Writes the rows for triangles: origin and tmin, shears and tmax, axes and shear_z.
template <int N>
inline void write_triangle_rows(const RayGroup<N>& group, const vfloat<N> (&size)[3],
                                const vfloat<N> (&reciprocal)[3], ReadyRay* const* out) {
  const vfloat<N> greatest = greatest_of<N>(size);
  // Of equal components the lowest axis counts.
  const auto of_major = [&](vfloat<N> x, vfloat<N> y, vfloat<N> z) {
    return select_equal(size[0], greatest, x, select_equal(size[1], greatest, y, z));
  };
  const vfloat<N>(&direction)[3] = group.direction;
  const vfloat<N> major = of_major(direction[0], direction[1], direction[2]);
  struct Row {
    vfloat<N> column[4];
  };
  // Values by axes of the world as values by each ray's own axes.
  const auto by_own_axes = [&](const vfloat<N>(&axes)[3], vfloat<N> last) {
    const vfloat<N> after = of_major(axes[1], axes[2], axes[0]);
    const vfloat<N> before = of_major(axes[2], axes[0], axes[1]);
    return Row{{select_negative(major, before, after), select_negative(major, after, before),
                of_major(axes[0], axes[1], axes[2]), last}};
  };
  store_rows(by_own_axes(group.origin, group.tmin).column, out, offsetof(ReadyRay, origin));
  Row shears = by_own_axes(direction, group.tmax);
  for (int axis = 0; axis < 3; ++axis) shears.column[axis] = shears.column[axis] / major;
  store_rows(shears.column, out, offsetof(ReadyRay, shear));
  const vfloat<N> numbers[3] = {broadcast<N>(bits_of(0)), broadcast<N>(bits_of(1)),
                                broadcast<N>(bits_of(2))};
  const vfloat<N> shear_z = of_major(reciprocal[0], reciprocal[1], reciprocal[2]);
  store_rows(by_own_axes(numbers, shear_z).column, out, offsetof(ReadyRay, axis));
}

/// Writes all rows of N rays; the lanes that are not traceable receive garbage.
template <int N>
inline void write_rows(RayGroup<N>& group, vfloat<N> scale, const TreeView& tree,
                       ReadyRay* const* out) {
  vfloat<N> size[3], raised[3], reciprocal[3], backward[3], magnitude[3];
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = absolute(group.direction[axis]);
    raised[axis] = max(size[axis], broadcast<N>(kLeastDirection));
    reciprocal[axis] = copy_sign(broadcast<N>(1.0f) / raised[axis], group.direction[axis]);
    backward[axis] = broadcast<N>(tree.centre[axis]) - group.origin[axis];
    magnitude[axis] =
        absolute(backward[axis]) + broadcast<N>(tree.greatest_bound[axis] + kLeastMagnitude);
  }
  const vfloat<N> greatest_magnitude = greatest_of<N>(magnitude);
  group.tmin = max(group.tmin, broadcast<N>(-__FLT_MAX__));
  group.tmax = min(group.tmax, broadcast<N>(__FLT_MAX__));
  const vfloat<N> slack = broadcast<N>(kLeastDistance) + broadcast<N>(kLeastDistance) * scale;
  vfloat<N> near_row[4], far_row[4];
  for (int axis = 0; axis < 3; ++axis) {
    const vfloat<N> margin =
        copy_sign(margin_of<N>(size[axis], raised[axis], magnitude[axis], greatest_magnitude),
                  group.direction[axis]);
    near_row[axis] = (backward[axis] - margin) * reciprocal[axis];
    far_row[axis] = (backward[axis] + margin) * reciprocal[axis];
  }
  near_row[3] = group.tmax * scale + slack;
  far_row[3] = scale;
  const vfloat<N> reciprocal_row[4] = {reciprocal[0], reciprocal[1], reciprocal[2],
                                       group.tmin * scale - slack};
  store_rows(reciprocal_row, out, offsetof(ReadyRay, reciprocal));
  store_rows(near_row, out, offsetof(ReadyRay, near_offset));
  store_rows(far_row, out, offsetof(ReadyRay, far_offset));
  write_triangle_rows<N>(group, size, reciprocal, out);
}

/// Writes the N rays of a group, the first of which is that of number first, to their places.
template <int N>
inline void write_group(const RayBatch& batch, size_t first, const TreeView& tree,
                        RayGroup<N>& group, vfloat<N> scale, const uint8_t* backward,
                        ReadyRay* const* places) {
  write_rows<N>(group, scale, tree, places);
  for (int lane = 0; lane < N; ++lane) {
    const UnalignedRay& ray = ray_of(batch, first + static_cast<size_t>(lane));
    ReadyRay& ready = *places[lane];
    ready.mask = ray.mask;
    ready.flags = ray.flags;
    ready.backward = backward[lane];
    ready.slack = kLeastDistance + kLeastDistance * ready.scale;
  }
  for (uint32_t lanes = group.unusual; lanes; lanes &= lanes - 1) {
    const int lane = __builtin_ctz(lanes);
    set_up(ray_of(batch, first + static_cast<size_t>(lane)), tree, *places[lane]);
  }
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// What the children of a node of a light tree can contribute to a receiver at most: the
// conservative geometric term of Conty Estevez & Kulla, "Importance Sampling of Many Lights with
// Adaptive Tree Splitting", PACMCGIT 1(2) (HPG), 2018, for N children at once.
//
// Departures: angles are subtracted by their cosines and sines, so that no trigonometric function
// is needed and every ISA computes the same bits (no fused operations, roots and divisions are
// exact); distances are clamped to the radius of the child's sphere; the cosine at the receiver is
// bounded by the box, too, which also says when all of a child lies below the receiver's tangent
// plane (Yuksel, "Stochastic Lightcuts", HPG 2019, calls it a dead branch); a segment counts the
// integral of the inverse square of the distance.
//
// Of a glossy receiver, a bound of its lobe takes the place of the cosine there (Y. Liu, K. Xu,
// L.-Q. Yan, "Adaptive BRDF-Oriented Multiple Importance Sampling of Many Lights", CGF 38(4)
// (EGSR), 2019). Departs from it in the lobe, which is that of the roulettes: around the mirror
// direction, not the half vector, and nowhere 0, so that nothing that contributes is left out.
#pragma once

#include "lights/light_node.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// A receiver in the coordinates of a tree.
struct LightPoint {
  float position[3];
  float normal[3];   ///< of length 1
  float segment[3];  ///< to the other end
  float slack;       ///< by how much the position may be off
  bool has_normal;
  bool has_segment;
  bool takes_both_sides;
  bool is_lightcut;  ///< children are compared as stochastic lightcuts do
  bool has_lobe;
  float lobe_axis[3];       ///< of length 1
  float lobe_eccentricity;  ///< e of the ellipsoid of its polar radius
  float lobe_least;         ///< 1 - e
  uint64_t link_mask;
};

constexpr float kLeastImportance = 1.17549435e-38f;  // the least normal float
/// What a child that shines past the receiver by less than rounding may seem to emit.
constexpr float kLeastEmission = 1e-3f;
/// By how much cosines may be wrong: of a point's directions, whose sines come from cross products,
/// and of a segment's, whose sines come from cosines.
constexpr float kPointCosineSlack = 1e-5f;
constexpr float kSegmentCosineSlack = 1e-3f;
/// Rounding of a sum of three products, relative to the sum of their sizes.
constexpr float kSumSlack = 1e-6f;

#define KIWAMI_LIGHT_INLINE __attribute__((always_inline)) inline

template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> dot(const vfloat<N> (&a)[3], const vfloat<N> (&b)[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> sine_of(vfloat<N> cosine) {
  const vfloat<N> one = broadcast<N>(1.0f);
  return square_root(max((one - cosine) * (one + cosine), broadcast<N>(0.0f)));
}

/// An angle of 0 to pi in each lane.
template <int N>
struct Angles {
  vfloat<N> cosine, sine;
};

/// The cosine of a - b, or 1 where b is the greater.
template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> cosine_of_difference(const Angles<N>& a, const Angles<N>& b) {
  return select_negative(a.cosine - b.cosine, a.cosine * b.cosine + a.sine * b.sine,
                         broadcast<N>(1.0f));
}

/// a - b, or 0 where b is the greater.
template <int N>
KIWAMI_LIGHT_INLINE Angles<N> difference_of(const Angles<N>& a, const Angles<N>& b) {
  return {cosine_of_difference(a, b),
          select_negative(a.cosine - b.cosine, a.sine * b.cosine - a.cosine * b.sine,
                          broadcast<N>(0.0f))};
}

/// How the sphere around a child is seen.
template <int N>
struct Sight {
  vfloat<N> distance;        ///< of the middle, not 0
  vfloat<N> is_outside;      ///< negative where the receiver is outside of the sphere
  vfloat<N> clamped_square;  ///< of the distance, at least that of the radius
  Angles<N> half_angle;      ///< that the sphere takes up; where the receiver is outside
};

template <int N>
KIWAMI_LIGHT_INLINE Sight<N> sight_of(const LightNode<N>& node, const LightPoint& point,
                                      vfloat<N> square, float least_square) {
  const vfloat<N> least = broadcast<N>(least_square);
  const vfloat<N> radius = load<N>(node.radius) + broadcast<N>(point.slack);
  const vfloat<N> reach = max(radius * radius, least);
  Sight<N> sight;
  square = max(square, least);
  sight.distance = square_root(square);
  sight.is_outside = reach - square;
  sight.clamped_square = max(square, reach);
  sight.half_angle.sine = radius / sight.distance;
  sight.half_angle.cosine = sine_of(sight.half_angle.sine);
  return sight;
}

/// The least cosine that no direction of the sphere's points exceeds, from that of its middle.
template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> cosine_by_sphere(const Angles<N>& middle, const Sight<N>& sight) {
  const vfloat<N> seen = cosine_of_difference(middle, sight.half_angle);
  return select_negative(sight.is_outside, seen, broadcast<N>(1.0f));
}

/// The boxes of the children as a receiver sees them.
template <int N>
struct BoxSight {
  vfloat<N> offset[3];  ///< from the receiver to the middles
  vfloat<N> half_extent[3];
  vfloat<N> nearest, farthest;  ///< distances, not 0

  KIWAMI_LIGHT_INLINE BoxSight(const LightNode<N>& node, const LightPoint& point,
                               float least_square) {
    vfloat<N> gap_square = broadcast<N>(0.0f), far_square = broadcast<N>(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      offset[axis] = load<N>(node.centre[axis]) - broadcast<N>(point.position[axis]);
      half_extent[axis] = load<N>(node.half_extent[axis]);
      const vfloat<N> away = absolute(offset[axis]);
      const vfloat<N> gap = max(away - half_extent[axis], broadcast<N>(0.0f));
      const vfloat<N> far = away + half_extent[axis];
      gap_square = gap_square + gap * gap;
      far_square = far_square + far * far;
    }
    nearest = square_root(max(gap_square, broadcast<N>(least_square)));
    farthest = square_root(max(far_square, broadcast<N>(least_square)));
  }

  /// By how much a child rises along a direction (away from the receiver's plane), at most: middle
  /// is that of its middle.
  KIWAMI_LIGHT_INLINE vfloat<N> top(const vfloat<N> (&direction)[3], vfloat<N> middle,
                                    float slack) const {
    vfloat<N> rise = broadcast<N>(0.0f), size = broadcast<N>(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      rise = rise + absolute(direction[axis]) * half_extent[axis];
      size = size + absolute(direction[axis]) * absolute(offset[axis]);
    }
    return middle + rise + (size + rise) * broadcast<N>(kSumSlack) + broadcast<N>(slack);
  }

  /// No point of a box whose top is this has a greater cosine.
  KIWAMI_LIGHT_INLINE vfloat<N> cosine(vfloat<N> top) const {
    return select_negative(top, top / farthest, min(top / nearest, broadcast<N>(1.0f)));
  }
};

/// The share of a child's energy that may leave it, and negative for none: from a bound of the
/// cosine between the receiver and the nearest normal of the child's spread.
template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> emission_of(const LightNode<N>& node, vfloat<N> cosine, float slack) {
  const vfloat<N> margin = cosine - load<N>(node.cos_extent) + broadcast<N>(slack);
  return select_negative(margin, broadcast<N>(-1.0f), max(cosine, broadcast<N>(kLeastEmission)));
}

template <int N>
KIWAMI_LIGHT_INLINE Angles<N> spread_of(const LightNode<N>& node) {
  return {load<N>(node.cos_spread), load<N>(node.sin_spread)};
}

/// Of a child that shines about the opposite axis, too, the size.
template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> sided(const LightNode<N>& node, vfloat<N> cosine) {
  return select_negative(load<N>(node.side), absolute(cosine), cosine);
}

template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> emission_to_point(const LightNode<N>& node, const LightPoint& point,
                                                const BoxSight<N>& box, const Sight<N>& sight) {
  const vfloat<N> axis[3] = {load<N>(node.axis[0]), load<N>(node.axis[1]), load<N>(node.axis[2])};
  const vfloat<N>(&offset)[3] = box.offset;
  const vfloat<N> across[3] = {axis[1] * offset[2] - axis[2] * offset[1],
                               axis[2] * offset[0] - axis[0] * offset[2],
                               axis[0] * offset[1] - axis[1] * offset[0]};
  const vfloat<N> height = sided(node, broadcast<N>(0.0f) - dot(axis, offset));
  const Angles<N> middle{height / sight.distance,
                         square_root(dot(across, across)) / sight.distance};
  const Angles<N> spread = spread_of(node);
  const vfloat<N> by_sphere = cosine_by_sphere(difference_of(middle, spread), sight);
  const vfloat<N> box_cosine = box.cosine(box.top(axis, height, point.slack));
  const vfloat<N> by_box = cosine_of_difference(Angles<N>{box_cosine, sine_of(box_cosine)}, spread);
  return emission_of(node, min(by_sphere, by_box), kPointCosineSlack);
}

/// A bound of the cosine between the receiver's normal and all of a child, and negative where all
/// of it lies below the tangent plane.
template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> cosine_at_receiver(const LightPoint& point, const BoxSight<N>& box,
                                                 const Sight<N>& sight) {
  const vfloat<N> zero = broadcast<N>(0.0f), one = broadcast<N>(1.0f);
  const vfloat<N> normal[3] = {broadcast<N>(point.normal[0]), broadcast<N>(point.normal[1]),
                               broadcast<N>(point.normal[2])};
  vfloat<N> height = dot(normal, box.offset);
  if (point.takes_both_sides) height = absolute(height);
  const vfloat<N> top = box.top(normal, height, point.slack);
  const vfloat<N> of_middle = max(min(height / sight.distance, one), broadcast<N>(-1.0f));
  const vfloat<N> by_sphere = cosine_by_sphere(Angles<N>{of_middle, sine_of(of_middle)}, sight);
  return select_negative(top, broadcast<N>(-1.0f), max(min(by_sphere, box.cosine(top)), zero));
}

/// The lobe of a glossy receiver in a direction whose cosine with its axis is this, relative to its
/// peak: the square of an ellipsoid's polar radius. Between 0 and 1, and rising.
template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> lobe_at(const LightPoint& point, vfloat<N> cosine) {
  const vfloat<N> least = broadcast<N>(point.lobe_least);
  const vfloat<N> away = max(broadcast<N>(1.0f) - cosine, broadcast<N>(0.0f));
  const vfloat<N> radius = least / (least + broadcast<N>(point.lobe_eccentricity) * away);
  return radius * radius;
}

/// A bound of the receiver's lobe over all of a child.
template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> lobe_of_child(const LightPoint& point, const BoxSight<N>& box,
                                            const Sight<N>& sight) {
  const vfloat<N> one = broadcast<N>(1.0f);
  const vfloat<N> axis[3] = {broadcast<N>(point.lobe_axis[0]), broadcast<N>(point.lobe_axis[1]),
                             broadcast<N>(point.lobe_axis[2])};
  const vfloat<N> height = dot(axis, box.offset);
  const vfloat<N> by_box = box.cosine(box.top(axis, height, point.slack));
  const vfloat<N> of_middle = max(min(height / sight.distance, one), broadcast<N>(-1.0f));
  const vfloat<N> by_sphere = cosine_by_sphere(Angles<N>{of_middle, sine_of(of_middle)}, sight);
  return lobe_at(point, min(by_sphere, by_box));
}

/// The factor of the receiver: its lobe, or the cosine; negative where all of the child lies below
/// the tangent plane.
template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> reflection_of(const LightPoint& point, vfloat<N> cosine,
                                            const BoxSight<N>& box, const Sight<N>& sight) {
  if (!point.has_lobe) return cosine;
  return select_negative(cosine, cosine, lobe_of_child(point, box, sight));
}

/// Nothing where a factor is negative or there is no energy, else not 0.
template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> positive_where_alive(vfloat<N> importance, vfloat<N> energy,
                                                   vfloat<N> emission, vfloat<N> cosine) {
  const vfloat<N> zero = broadcast<N>(0.0f);
  const vfloat<N> least = min(energy, broadcast<N>(kLeastImportance));
  return select_negative(emission, zero, select_negative(cosine, zero, max(importance, least)));
}

template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> importance_at_point(const LightNode<N>& node, const LightPoint& point,
                                                  float least_square) {
  const BoxSight<N> box(node, point, least_square);
  const Sight<N> sight = sight_of(node, point, dot(box.offset, box.offset), least_square);
  const vfloat<N> emission = emission_to_point(node, point, box, sight);
  vfloat<N> cosine = broadcast<N>(1.0f);
  if (point.has_normal) cosine = cosine_at_receiver(point, box, sight);
  const vfloat<N> reflection = reflection_of(point, cosine, box, sight);
  const vfloat<N> energy = load<N>(node.energy);
  const vfloat<N> importance = energy / sight.clamped_square * emission * reflection;
  return positive_where_alive(importance, energy, emission, reflection);
}

/// What stochastic lightcuts compare children by: energy times a bound of the cosines, over the
/// squared distances of the nearest and of the farthest point of the box (C. Yuksel, "Stochastic
/// Lightcuts", HPG 2019). The bound at the receiver is the paper's: the greatest height of the box
/// over the receiver's plane, seen at the least tangential distance; it is 0 just for what lies
/// below the plane. The bound at the lights is that of importance_at_point.
template <int N>
KIWAMI_LIGHT_INLINE void lightcut_terms(const LightNode<N>& node, const LightPoint& point,
                                        float least_square, vfloat<N>& near, vfloat<N>& far) {
  const vfloat<N> zero = broadcast<N>(0.0f);
  const BoxSight<N> box(node, point, least_square);
  const Sight<N> sight = sight_of(node, point, dot(box.offset, box.offset), least_square);
  const vfloat<N> emission = emission_to_point(node, point, box, sight);
  vfloat<N> cosine = broadcast<N>(1.0f);
  if (point.has_normal) {
    vfloat<N> normal[3], gap[3];
    for (int axis = 0; axis < 3; ++axis) {
      normal[axis] = broadcast<N>(point.normal[axis]);
      gap[axis] = copy_sign(max(absolute(box.offset[axis]) - box.half_extent[axis], zero),
                            box.offset[axis]);
    }
    vfloat<N> height = dot(normal, box.offset);
    if (point.takes_both_sides) height = absolute(height);
    const vfloat<N> top = box.top(normal, height, point.slack);
    const vfloat<N> rise = dot(normal, gap);
    const vfloat<N> tangential = max(dot(gap, gap) - rise * rise, zero);
    const vfloat<N> reach = square_root(max(tangential + top * top, broadcast<N>(least_square)));
    cosine = select_negative(top, broadcast<N>(-1.0f), max(top / reach, zero));
  }
  const vfloat<N> reflection = reflection_of(point, cosine, box, sight);
  const vfloat<N> energy = load<N>(node.energy);
  const vfloat<N> bound = energy * emission * reflection;
  near = positive_where_alive(bound / box.nearest / box.nearest, energy, emission, reflection);
  far = positive_where_alive(bound / box.farthest / box.farthest, energy, emission, reflection);
}

/// Of all points of a segment: the greatest cosine between the children's axes and the direction
/// from their middles to it. start: from the segment's first point to the middles. The cosine has
/// no minimum or maximum inside but one, whose place is that of the root of a linear function.
template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> greatest_cosine(const LightNode<N>& node, const vfloat<N> (&start)[3],
                                              const vfloat<N> (&along)[3], float least_square) {
  const vfloat<N> zero = broadcast<N>(0.0f), one = broadcast<N>(1.0f);
  const vfloat<N> axis[3] = {load<N>(node.axis[0]), load<N>(node.axis[1]), load<N>(node.axis[2])};
  const vfloat<N> least = broadcast<N>(least_square);
  const vfloat<N> height = zero - dot(axis, start), slope = dot(axis, along);
  const vfloat<N> square = dot(start, start), mixed = zero - dot(start, along);
  const vfloat<N> length_square = dot(along, along);
  const auto cosine_at = [&](vfloat<N> s) __attribute__((always_inline)) {
    const vfloat<N> to[3] = {start[0] - s * along[0], start[1] - s * along[1],
                             start[2] - s * along[2]};
    return sided(node, (height + slope * s) / square_root(max(dot(to, to), least)));
  };
  // Scaled by the distance, whose square times a product could overflow. No root, no place: 0 / 0
  // becomes an end, since min gives its second operand.
  const vfloat<N> distance = square_root(max(square, least));
  const vfloat<N> reach = square_root(max(length_square, least));
  const vfloat<N> unit_height = height / distance, unit_slope = slope / reach;
  const vfloat<N> turn = mixed / distance / reach;
  const vfloat<N> top = (unit_slope - unit_height * turn) * distance;
  const vfloat<N> bottom = (unit_height - unit_slope * turn) * reach;
  const vfloat<N> place = max(min(top / bottom, one), zero);
  return max(max(cosine_at(zero), cosine_at(one)), cosine_at(place));
}

template <int N>
KIWAMI_LIGHT_INLINE vfloat<N> importance_along_segment(const LightNode<N>& node,
                                                       const LightPoint& point,
                                                       float least_square) {
  const vfloat<N> zero = broadcast<N>(0.0f), one = broadcast<N>(1.0f);
  vfloat<N> start[3], end[3], along[3];
  for (int i = 0; i < 3; ++i) {
    along[i] = broadcast<N>(point.segment[i]);
    start[i] = load<N>(node.centre[i]) - broadcast<N>(point.position[i]);
    end[i] = start[i] - along[i];
  }
  const vfloat<N> place =
      max(min(dot(start, along) / max(dot(along, along), broadcast<N>(least_square)), one), zero);
  const vfloat<N> nearest[3] = {start[0] - place * along[0], start[1] - place * along[1],
                                start[2] - place * along[2]};
  const Sight<N> sight = sight_of(node, point, dot(nearest, nearest), least_square);
  const vfloat<N> cosine = greatest_cosine(node, start, along, least_square);
  const vfloat<N> bounded = max(min(cosine, one), broadcast<N>(-1.0f));
  const Angles<N> beyond_spread =
      difference_of(Angles<N>{bounded, sine_of(bounded)}, spread_of(node));
  const vfloat<N> emission =
      emission_of(node, cosine_by_sphere(beyond_spread, sight), kSegmentCosineSlack);
  // The integral of 1 / (distance^2 + radius^2): the angle between the ends, as seen from a point
  // that lies a radius off in a fourth dimension, over the sine's product. The angle over its sine
  // is taken from the cosine h of half of it, as (pi / 2 - (pi / 2 - 1) h) / h, 5 % off at most.
  const vfloat<N> radius = load<N>(node.radius);
  const vfloat<N> off = max(radius * radius, broadcast<N>(least_square));
  const vfloat<N> first = square_root(dot(start, start) + off);
  const vfloat<N> last = square_root(dot(end, end) + off);
  const vfloat<N> cosine_between = (dot(start, end) + off) / first / last;
  const vfloat<N> half_cosine =
      max(square_root(max((one + cosine_between) * broadcast<N>(0.5f), zero)), broadcast<N>(1e-3f));
  const vfloat<N> angle_over_sine =
      (broadcast<N>(1.5707963f) - broadcast<N>(0.5707963f) * half_cosine) / half_cosine;
  const vfloat<N> energy = load<N>(node.energy);
  const vfloat<N> importance = energy / first / last * angle_over_sine * emission;
  return positive_where_alive(importance, energy, emission, one);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

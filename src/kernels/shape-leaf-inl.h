// SPDX-License-Identifier: Apache-2.0
// One ray against the shapes of a leaf block: four at a time where the ray misses most, one by one
// where it may not.
#pragma once

#include "kernels/ray-inl.h"
#include "kernels/shape-inl.h"
#include "wide/wide_bvh.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// A shape, and which number it has in its geometry.
struct ShapePlace {
  const ShapeView* view;
  uint32_t primitive;
};

inline ShapePlace place_of(const ShapeSource& source, uint32_t id) {
  uint32_t low = 0, high = source.view_count;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    (source.views[middle].first_id <= id ? low : high) = middle;
  }
  const ShapeView& view = source.views[low];
  return {&view, id - view.first_id};
}

/// A point with its radius, and a normal, as they lie in the caller's memory.
struct RawPoint {
  float x, y, z, radius;
};
struct RawNormal {
  float x, y, z;
};

inline RawPoint point_at(const ShapeView& view, size_t index) {
  RawPoint point;
  __builtin_memcpy(&point, view.points + index * view.point_stride, sizeof point);
  return point;
}
inline RawNormal normal_at(const ShapeView& view, size_t index) {
  RawNormal normal;
  __builtin_memcpy(&normal, view.normals + index * view.normal_stride, sizeof normal);
  return normal;
}
inline size_t first_point_of(const ShapePlace& segment) {
  if (!segment.view->indices) return segment.primitive;
  uint32_t index;
  __builtin_memcpy(&index, segment.view->indices + segment.primitive * segment.view->index_stride,
                   sizeof index);
  return index;
}

inline Triple<double> centre_of(const RawPoint& point) { return {point.x, point.y, point.z}; }
inline Triple<double> triple_of(const RawNormal& normal) { return {normal.x, normal.y, normal.z}; }
inline Segment<double> segment_of(const RawPoint& a, const RawPoint& b) {
  return {{centre_of(a), centre_of(b)}, {a.radius, b.radius}};
}

/// Points of up to N shapes, in rows of N lanes.
template <int N>
struct PointRows {
  const float* rows;

  float x(int lane) const { return rows[lane]; }
  float y(int lane) const { return rows[N + lane]; }
  float z(int lane) const { return rows[2 * N + lane]; }
  float radius(int lane) const { return rows[3 * N + lane]; }
  RawPoint operator[](int lane) const { return {x(lane), y(lane), z(lane), radius(lane)}; }

  Triple<vdouble4> centres(int first) const {
    return {load_widened(rows + first), load_widened(rows + N + first),
            load_widened(rows + 2 * N + first)};
  }
  vdouble4 radii(int first) const { return load_widened(rows + 3 * N + first); }
  vfloat<N> row(int i) const { return load<N>(rows + i * N); }
};

/// The shapes of a leaf block: where they stand as a block of their own, or gathered from the
/// buffers. Lanes that are not asked for hold others, or zeros.
template <int N>
struct ShapeRows {
  float room[kMostShapeRows][N];

  void set(int lane, int first_row, const RawPoint& point) {
    room[first_row][lane] = point.x;
    room[first_row + 1][lane] = point.y;
    room[first_row + 2][lane] = point.z;
    room[first_row + 3][lane] = point.radius;
  }

  /// Gathered: lanes that are not asked for repeat one that is.
  void gather(const ShapeSource& source, const IndexBlock<N>& block, uint32_t lanes) {
    for (int lane = 0; lane < N; ++lane) {
      const bool is_own = ((lanes >> lane) & 1u) != 0;
      const ShapePlace place = place_of(source, block.id[is_own ? lane : __builtin_ctz(lanes)]);
      if (source.kind == ShapeKind::kCurve) {
        const size_t index = first_point_of(place);
        set(lane, 0, point_at(*place.view, index));
        set(lane, 4, point_at(*place.view, index + 1));
        continue;
      }
      set(lane, 0, point_at(*place.view, place.primitive));
      if (source.kind != ShapeKind::kDisc) continue;
      const RawNormal normal = normal_at(*place.view, place.primitive);
      room[4][lane] = normal.x;
      room[5][lane] = normal.y;
      room[6][lane] = normal.z;
    }
  }

  const float* of(const ShapeSource& source, const TreeView& tree, const IndexBlock<N>& block,
                  uint32_t lanes) {
    if (!source.blocks) {
      gather(source, block, lanes);
      return room[0];
    }
    const auto* const at = reinterpret_cast<const unsigned char*>(block.id);
    const uint64_t begin = static_cast<uint64_t>(at - tree.memory) - source.leaf_begin;
    // A leaf block has one row, of ids.
    return source.blocks + begin / sizeof(uint32_t) * shape_rows(source.kind);
  }
};

/// Which of four numbers, first on, are positive.
inline uint32_t positive_lanes(vdouble4 a, int first) {
  return greater(a, broadcast_double(0.0)) << first;
}

/// One crossing of a ray and a shape.
struct ShapeCrossing {
  float t;
  bool is_entry;   ///< for discs: seen from the side that the normal points to
  double exact_t;  ///< before it was rounded
  double s;        ///< of a curve segment: where along it
  ShapePlace shape;
};

/// The next greater float.
inline float next_float(float value) {
  int32_t bits;
  __builtin_memcpy(&bits, &value, sizeof bits);
  bits = value == 0.0f ? 1 : bits < 0 ? bits - 1 : bits + 1;
  __builtin_memcpy(&value, &bits, sizeof value);
  return value;
}

/// Hands the crossings that the ray may meet to accept, by masks, sides and distance.
template <typename Accept>
struct ShapeSieve {
  const ReadyRay& ray;
  const WideRay<double>& wide;
  Accept& accept;

  bool is_masked(const ShapePlace& shape) const { return (shape.view->mask & ray.mask) == 0; }

  /// Returns true where accept ends it all.
  bool pass(const ShapeCrossing& crossing) const {
    if (!(ray.tmin <= crossing.t && crossing.t <= ray.tmax)) return false;
    const uint32_t side =
        crossing.is_entry ? KIWAMI_RAY_CULL_FRONT_FACES : KIWAMI_RAY_CULL_BACK_FACES;
    return (ray.flags & side) == 0 && accept(crossing);
  }

  /// An interval whose ends round to the same float keeps its length of one float: a ray that
  /// enters leaves, and two crossings are told apart by their distance.
  bool pass(const SegmentInterval& interval, const ShapePlace& shape) const {
    const float entry = static_cast<float>(interval.entry.t);
    float exit = static_cast<float>(interval.exit.t);
    if (exit == entry) exit = next_float(exit);
    return pass({entry, true, interval.entry.t, interval.entry.s, shape}) ||
           pass({exit, false, interval.exit.t, interval.exit.s, shape});
  }
};

template <int N, typename Sieve>
inline bool visit_spheres(const ShapeSource& source, const float* rows, const IndexBlock<N>& block,
                          uint32_t lanes, const Sieve& sieve) {
  const PointRows<N> points{rows};
  const WideRay<vdouble4> ray = spread_ray(sieve.wide);
  double middle[N], squared_half[N];
  uint32_t met = 0;
  for (int first = 0; first < N; first += 4) {
    if (((lanes >> first) & 0xFu) == 0) continue;
    const Passage<vdouble4> passage =
        pass_sphere(ray, ray.origin - points.centres(first), points.radii(first));
    store(middle + first, passage.middle);
    store(squared_half + first, passage.squared_half);
    met |= positive_lanes(passage.squared_half, first);
  }
  for (met &= lanes; met; met &= met - 1) {
    const int lane = __builtin_ctz(met);
    const ShapePlace place = place_of(source, block.id[lane]);
    if (sieve.is_masked(place)) continue;
    SegmentInterval interval;
    interval.add({middle[lane], squared_half[lane]}, 0.0);
    if (sieve.pass(interval, place)) return true;
  }
  return false;
}

template <int N, typename Sieve>
inline bool visit_discs(const ShapeSource& source, const float* rows, const IndexBlock<N>& block,
                        uint32_t lanes, const Sieve& sieve) {
  const PointRows<N> points{rows};
  const float* const normals = rows + 4 * N;
  const WideRay<vdouble4> ray = spread_ray(sieve.wide);
  double t[N], facing[N];
  uint32_t met = 0;
  for (int first = 0; first < N; first += 4) {
    if (((lanes >> first) & 0xFu) == 0) continue;
    const Triple<vdouble4> normal = {load_widened(normals + first),
                                     load_widened(normals + N + first),
                                     load_widened(normals + 2 * N + first)};
    const PlaneMeeting<vdouble4> meeting =
        meet_plane(ray, ray.origin - points.centres(first), normal);
    const vdouble4 radius = points.radii(first);
    store(t + first, meeting.t);
    store(facing + first, meeting.facing);
    met |= greater(radius * radius, meeting.squared_distance) << first;
  }
  for (met &= lanes; met; met &= met - 1) {
    const int lane = __builtin_ctz(met);
    const ShapePlace place = place_of(source, block.id[lane]);
    if (sieve.is_masked(place)) continue;
    const ShapeCrossing crossing = {static_cast<float>(t[lane]), facing[lane] < 0.0, t[lane], 0.0,
                                    place};
    if (sieve.pass(crossing)) return true;
  }
  return false;
}

/// A ray as the tests of shapes read it.
struct ShapeRay {
  WideRay<double> wide;
  float origin[3], unit[3];  ///< and the direction of length 1, for curve segments
};

/// Which segments' capsules, as wide as their greater radius, the ray may meet. Most rays miss most
/// of a leaf, which single precision tells in all lanes at once; the others are looked at in double.
///
/// The ends are projected along the ray, and the nearest point of the line between them is compared
/// with the radius. With u = 2^-24 and f an end seen from the origin, the unit direction and the
/// projection are off by less than 16 u |f|, the place of the nearest point by 4 u |f|, and the point
/// by 3 u |f|, less than half of kCapsuleMargin. The other half is more than what a crossing of the
/// cone may lie outside (kConeTolerance). Lanes that overflow are kept, and so are tiny ones.
template <int N>
inline uint32_t near_lanes(const ShapeRay& ray, const PointRows<N> (&points)[2]) {
  constexpr float kCapsuleMargin = 0x1p-18f, kLeastReach = 0x1p-60f, kGreatestSize = 0x1p+60f;
  static_assert(kCapsuleMargin >= 2 * kConeTolerance);
  const auto product = [](const vfloat<N>(&a)[3], const vfloat<N>(&b)[3]) {
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
  };
  const vfloat<N> along[3] = {broadcast<N>(ray.unit[0]), broadcast<N>(ray.unit[1]),
                              broadcast<N>(ray.unit[2])};
  const vfloat<N> radius[2] = {points[0].row(3), points[1].row(3)};
  vfloat<N> size = radius[0] + radius[1];
  vfloat<N> end[2][3];
  for (int k = 0; k < 2; ++k) {
    vfloat<N> offset[3];
    for (int axis = 0; axis < 3; ++axis) {
      offset[axis] = points[k].row(axis) - broadcast<N>(ray.origin[axis]);
      size = size + absolute(offset[axis]);
    }
    const vfloat<N> distance = product(offset, along);
    for (int axis = 0; axis < 3; ++axis) end[k][axis] = offset[axis] - distance * along[axis];
  }
  const vfloat<N> line[3] = {end[1][0] - end[0][0], end[1][1] - end[0][1], end[1][2] - end[0][2]};
  const vfloat<N> zero = broadcast<N>(0.0f);
  const vfloat<N> place =
      min(max((zero - product(end[0], line)) / product(line, line), zero), broadcast<N>(1.0f));
  const vfloat<N> nearest[3] = {end[0][0] + place * line[0], end[0][1] + place * line[1],
                                end[0][2] + place * line[2]};
  const vfloat<N> reach =
      max(radius[0], radius[1]) + (broadcast<N>(kCapsuleMargin) * size + broadcast<N>(kLeastReach));
  const uint32_t missed = less_equal(reach * reach, product(nearest, nearest)) &
                          less_equal(size, broadcast<N>(kGreatestSize));
  return ~missed;
}

template <int N, typename Sieve>
inline bool visit_curves(const ShapeSource& source, const float* rows, const IndexBlock<N>& block,
                         const ShapeRay& ray, uint32_t lanes, const Sieve& sieve) {
  const PointRows<N> points[2] = {{rows}, {rows + 4 * N}};
  lanes &= near_lanes(ray, points);
  for (; lanes; lanes &= lanes - 1) {
    const int lane = __builtin_ctz(lanes);
    const ShapePlace place = place_of(source, block.id[lane]);
    if (sieve.is_masked(place)) continue;
    const SegmentInterval interval =
        cross_segment(sieve.wide, segment_of(points[0][lane], points[1][lane]));
    if (!interval.is_empty && sieve.pass(interval, place)) return true;
  }
  return false;
}

inline WideRay<double> widen_ray(const UnalignedRay& ray) {
  const float origin[3] = {ray.origin_x, ray.origin_y, ray.origin_z};
  const float direction[3] = {ray.direction_x, ray.direction_y, ray.direction_z};
  return widen_ray(origin, direction);
}

inline ShapeRay shape_ray(const UnalignedRay& given, ShapeKind kind) {
  ShapeRay ray;
  ray.wide = widen_ray(given);
  if (kind != ShapeKind::kCurve) return ray;
  ray.origin[0] = given.origin_x;
  ray.origin[1] = given.origin_y;
  ray.origin[2] = given.origin_z;
  const double inverse = 1.0 / square_root(ray.wide.squared);
  ray.unit[0] = static_cast<float>(ray.wide.direction.x * inverse);
  ray.unit[1] = static_cast<float>(ray.wide.direction.y * inverse);
  ray.unit[2] = static_cast<float>(ray.wide.direction.z * inverse);
  return ray;
}

/// Calls accept(crossing) for each crossing of the shapes of a leaf of a tree that the ray meets,
/// until accept returns true; then returns true.
template <int N, typename Accept>
inline bool visit_shapes(const ShapeSource& source, const TreeView& tree, ChildReference leaf,
                         const ReadyRay& ready, const ShapeRay& ray, Accept accept) {
  const ShapeSieve<Accept> sieve{ready, ray.wide, accept};
  const IndexBlock<N>& block = index_leaf_at<N>(tree.memory, leaf);
  const uint32_t lanes = leaf.mask();
  ShapeRows<N> gathered;
  const float* const rows = gathered.of(source, tree, block, lanes);
  if (source.kind == ShapeKind::kSphere) return visit_spheres(source, rows, block, lanes, sieve);
  if (source.kind == ShapeKind::kDisc) return visit_discs(source, rows, block, lanes, sieve);
  return visit_curves(source, rows, block, ray, lanes, sieve);
}

/// Fills in what a hit says of the shape: u, v and the normal, each rounded once.
inline void describe_crossing(const ShapeSource& source, const WideRay<double>& ray,
                              const ShapeCrossing& crossing, kiwami_hit& hit) {
  const ShapeView& view = *crossing.shape.view;
  const size_t index =
      source.kind == ShapeKind::kCurve ? first_point_of(crossing.shape) : crossing.shape.primitive;
  const RawPoint point = point_at(view, index);
  Triple<double> normal = (ray.origin - centre_of(point)) + crossing.exact_t * ray.direction;
  hit.u = hit.v = 0.0f;
  if (source.kind == ShapeKind::kDisc) {
    const double radius = point.radius;
    hit.u = static_cast<float>(dot(normal, normal) / (radius * radius));
    normal = triple_of(normal_at(view, index));
  } else if (source.kind == ShapeKind::kCurve) {
    hit.u = static_cast<float>(crossing.s);
    normal = normal - crossing.s * (centre_of(point_at(view, index + 1)) - centre_of(point));
  }
  hit.normal_x = static_cast<float>(normal.x);
  hit.normal_y = static_cast<float>(normal.y);
  hit.normal_z = static_cast<float>(normal.z);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

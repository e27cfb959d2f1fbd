// SPDX-License-Identifier: Apache-2.0
#include "measure/double_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "measure/ray_sets.h"

namespace kiwami::tools {
namespace {

constexpr double kRelativeTolerance = 1e-5;

double largest(Vec3d v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Three vertices, seen from the ray: z along the ray's major axis, in units of t; x and y across.
struct Sheared {
  Vec3d corner[3];
  double position_slack;  ///< how far single precision may move x and y
  double major;           ///< the direction's largest component
};

int major_axis(Vec3d v) {
  const double x = std::abs(v.x);
  const double y = std::abs(v.y);
  const double z = std::abs(v.z);
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

Sheared shear(const SceneFile& scene, const kiwami_ray& ray, const kiwami_hit& hit) {
  const Vec3d origin{ray.origin_x, ray.origin_y, ray.origin_z};
  const Vec3d direction{ray.direction_x, ray.direction_y, ray.direction_z};
  const int kz = major_axis(direction);
  const int kx = (kz + 1) % 3;
  const int ky = (kz + 2) % 3;
  const Mesh& mesh = scene.meshes[hit.geometry_id];
  Sheared result{};
  result.major = direction[kz];
  double size = largest(origin);
  for (size_t i = 0; i < 3; ++i) {
    const uint32_t index = mesh.indices[size_t{hit.primitive_id} * 3 + i];
    const float* v = &mesh.vertices[size_t{index} * 3];
    const Vec3d vertex{v[0], v[1], v[2]};
    const Vec3d p = vertex - origin;
    size = std::max(size, largest(vertex));
    const double z = p[kz] / result.major;
    result.corner[i] = {p[kx] - direction[kx] * z, p[ky] - direction[ky] * z, z};
  }
  // Translation, slope, product and difference round once each, relative to at most four times the
  // greatest coordinate: the slopes are at most 1.
  result.position_slack = 16.0 * 0x1p-24 * size;
  return result;
}

/// Twice the signed area of the triangle that the origin makes with an edge.
double edge_function(Vec3d a, Vec3d b) { return a.x * b.y - a.y * b.x; }

/// The distance of the origin from the segment.
double segment_distance(Vec3d a, Vec3d b) {
  const double x = b.x - a.x;
  const double y = b.y - a.y;
  const double square = x * x + y * y;
  const double t = square > 0.0 ? std::clamp(-(a.x * x + a.y * y) / square, 0.0, 1.0) : 0.0;
  return std::hypot(a.x + t * x, a.y + t * y);
}

/// How far t moves when the hit point moves across by the slack: much on grazing triangles.
double slack_of_distance(const Sheared& s, double determinant, double t) {
  const double relative = kRelativeTolerance * std::abs(t) + s.position_slack / std::abs(s.major);
  if (determinant == 0.0) return std::numeric_limits<double>::infinity();
  const Vec3d e1 = s.corner[1] - s.corner[0];
  const Vec3d e2 = s.corner[2] - s.corner[0];
  const double slope_x = (e1.z * e2.y - e2.z * e1.y) / determinant;
  const double slope_y = (e2.z * e1.x - e1.z * e2.x) / determinant;
  return relative + s.position_slack * (std::abs(slope_x) + std::abs(slope_y));
}

bool within(double a, double b, double slack) { return std::abs(a - b) <= slack; }

bool near_ray_end(const kiwami_ray& ray, const DoubleHit& hit) {
  return within(hit.t, ray.tmin, hit.distance_slack) || within(hit.t, ray.tmax, hit.distance_slack);
}

Agreement judge_same_primitive(const SceneFile& scene, const kiwami_ray& ray, const kiwami_hit& own,
                               const kiwami_hit& reference) {
  const double difference = std::abs(double{own.t} - double{reference.t});
  if (difference <= kRelativeTolerance * std::abs(double{reference.t})) {
    return Agreement::kSamePrimitive;
  }
  const DoubleHit exact = judge_triangle(scene, ray, own);
  if (exact.parallel) return Agreement::kOnEdge;
  if (std::abs(own.t - exact.t) <= std::abs(reference.t - exact.t)) {
    return Agreement::kReferenceDistanceOff;
  }
  return within(own.t, exact.t, exact.distance_slack) ? Agreement::kOwnDistanceOff
                                                      : Agreement::kWrong;
}

/// We have a hit, and the reference has none before or beside it.
Agreement judge_own_hit(const SceneFile& scene, const kiwami_ray& ray, const kiwami_hit& own) {
  const DoubleHit exact = judge_triangle(scene, ray, own);
  if (exact.passage == Passage::kOutside) return Agreement::kWrong;
  if (exact.parallel || exact.passage == Passage::kOnEdge) return Agreement::kOnEdge;
  if (!within(own.t, exact.t, exact.distance_slack)) return Agreement::kWrong;
  return near_ray_end(ray, exact) ? Agreement::kAtRayEnd : Agreement::kReferenceMissed;
}

/// The reference has a hit, and we have none before or beside it.
Agreement judge_reference_hit(const SceneFile& scene, const kiwami_ray& ray, const kiwami_hit& own,
                              const kiwami_hit& reference) {
  const DoubleHit exact = judge_triangle(scene, ray, reference);
  if (exact.passage == Passage::kOutside) return Agreement::kReferenceFalseHit;
  if (exact.parallel || exact.passage == Passage::kOnEdge) return Agreement::kOnEdge;
  if (near_ray_end(ray, exact)) return Agreement::kAtRayEnd;
  if (exact.t < ray.tmin || exact.t > ray.tmax) return Agreement::kReferenceFalseHit;
  if (is_hit(own)) {
    const DoubleHit own_exact = judge_triangle(scene, ray, own);
    const double slack = exact.distance_slack + own_exact.distance_slack;
    if (own_exact.passage != Passage::kOutside && own_exact.t <= exact.t + slack) {
      return within(own_exact.t, exact.t, slack) ? Agreement::kSameDistance
                                                 : Agreement::kReferenceFalseHit;
    }
  }
  return Agreement::kWrong;
}

}  // namespace

const char* agreement_name(Agreement agreement) {
  switch (agreement) {
    case Agreement::kBothMiss:
      return "both miss";
    case Agreement::kSamePrimitive:
      return "same primitive";
    case Agreement::kSameDistance:
      return "other primitive at the same distance";
    case Agreement::kReferenceDistanceOff:
      return "same primitive, Embree's t is farther from double";
    case Agreement::kOwnDistanceOff:
      return "same primitive, Kiwami's t is farther from double";
    case Agreement::kOnEdge:
      return "on an edge within rounding";
    case Agreement::kAtRayEnd:
      return "at the ray's end within rounding";
    case Agreement::kReferenceMissed:
      return "Embree missed a hit that double finds";
    case Agreement::kReferenceFalseHit:
      return "Embree has a hit that double denies";
    case Agreement::kWrong:
      return "Kiwami is wrong by double";
  }
  return "";
}

DoubleHit judge_triangle(const SceneFile& scene, const kiwami_ray& ray, const kiwami_hit& hit) {
  const Sheared s = shear(scene, ray, hit);
  const double u = edge_function(s.corner[1], s.corner[2]);
  const double v = edge_function(s.corner[2], s.corner[0]);
  const double w = edge_function(s.corner[0], s.corner[1]);
  const double determinant = u + v + w;
  DoubleHit result{};
  result.parallel = determinant == 0.0;
  if (!result.parallel) {
    result.t = (u * s.corner[0].z + v * s.corner[1].z + w * s.corner[2].z) / determinant;
  }
  result.distance_slack = slack_of_distance(s, determinant, result.t);
  const double nearest = std::min({segment_distance(s.corner[0], s.corner[1]),
                                   segment_distance(s.corner[1], s.corner[2]),
                                   segment_distance(s.corner[2], s.corner[0])});
  const bool same_side = (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
  result.passage = nearest <= s.position_slack ? Passage::kOnEdge
                   : same_side                 ? Passage::kInside
                                               : Passage::kOutside;
  return result;
}

Agreement compare_hits(const SceneFile& scene, const kiwami_ray& ray, const kiwami_hit& own,
                       const kiwami_hit& reference) {
  if (!is_hit(own) && !is_hit(reference)) return Agreement::kBothMiss;
  if (!is_hit(reference)) return judge_own_hit(scene, ray, own);
  if (!is_hit(own)) return judge_reference_hit(scene, ray, own, reference);
  if (own.geometry_id == reference.geometry_id && own.primitive_id == reference.primitive_id) {
    return judge_same_primitive(scene, ray, own, reference);
  }
  const double difference = std::abs(double{own.t} - double{reference.t});
  if (difference <= kRelativeTolerance * std::abs(double{reference.t})) {
    return Agreement::kSameDistance;
  }
  return own.t < reference.t ? judge_own_hit(scene, ray, own)
                             : judge_reference_hit(scene, ray, own, reference);
}

}  // namespace kiwami::tools

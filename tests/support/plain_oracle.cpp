// SPDX-License-Identifier: Apache-2.0
#include "support/plain_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kiwami_tests {
namespace {

struct Flat {
  float x, y, z;
};

bool is_coordinate(float value) { return std::fabs(value) <= KIWAMI_MAX_COORDINATE; }
bool is_in_range(Point p) { return is_coordinate(p.x) && is_coordinate(p.y) && is_coordinate(p.z); }

int sign_of(double value) { return (value > 0.0) - (value < 0.0); }

/// The sign of p x q; where it is zero, at the query point moved by (epsilon, epsilon^2), unless
/// zero itself is wanted.
int edge_sign(Flat p, Flat q, EdgeRule rule) {
  const float single = p.x * q.y - p.y * q.x;
  if (single != 0.0f) return single > 0.0f ? 1 : -1;
  const double exact = static_cast<double>(p.x) * static_cast<double>(q.y) -
                       static_cast<double>(p.y) * static_cast<double>(q.x);
  if (exact != 0.0 || rule == EdgeRule::kInclusive) return sign_of(exact);
  if (p.y != q.y) return p.y > q.y ? 1 : -1;
  return sign_of(static_cast<double>(q.x) - static_cast<double>(p.x));
}

double edge_value(Flat p, Flat q) {
  return static_cast<double>(p.x) * static_cast<double>(q.y) -
         static_cast<double>(p.y) * static_cast<double>(q.x);
}

bool is_ray(const kiwami_ray& ray) {
  const float d[3] = {ray.direction_x, ray.direction_y, ray.direction_z};
  bool is_zero = true;
  for (const float component : d) {
    if (!std::isfinite(component)) return false;
    if (component != 0.0f) is_zero = false;
  }
  return !is_zero && is_in_range({ray.origin_x, ray.origin_y, ray.origin_z}) &&
         ray.tmin <= ray.tmax;
}

}  // namespace

/// The coordinate system in which the ray is the z axis.
struct PlainOracle::Frame {
  Point origin;
  int kx, ky, kz;
  float shear_x, shear_y, shear_z;
  double scale;  ///< what the direction was multiplied by

  explicit Frame(const kiwami_ray& ray) : origin{ray.origin_x, ray.origin_y, ray.origin_z} {
    const Point given{ray.direction_x, ray.direction_y, ray.direction_z};
    kz = 0;
    for (int axis = 1; axis < 3; ++axis) {
      if (std::fabs(given[axis]) > std::fabs(given[kz])) kz = axis;
    }
    kx = (kz + 1) % 3;
    ky = (kx + 1) % 3;
    if (given[kz] < 0.0f) std::swap(kx, ky);
    const int exponent = std::ilogb(given[kz]);
    scale = std::ldexp(1.0, -exponent);
    Point direction;
    for (int axis = 0; axis < 3; ++axis) direction[axis] = std::ldexp(given[axis], -exponent);
    shear_x = direction[kx] / direction[kz];
    shear_y = direction[ky] / direction[kz];
    shear_z = 1.0f / direction[kz];
  }

  Flat place(Point vertex) const {
    const Point moved = vertex - origin;
    return {moved[kx] - shear_x * moved[kz], moved[ky] - shear_y * moved[kz], shear_z * moved[kz]};
  }
};

struct PlainOracle::Crossing {
  float t, u, v;
};

PlainOracle::PlainOracle(const Scene& scene, EdgeRule rule) : rule_(rule) {
  for (uint32_t geometry = 0; geometry < scene.meshes.size(); ++geometry) {
    const Mesh& mesh = scene.meshes[geometry];
    for (uint32_t primitive = 0; primitive < mesh.triangles.size(); ++primitive) {
      const auto corner = mesh.corners(primitive);
      if (!is_in_range(corner[0]) || !is_in_range(corner[1]) || !is_in_range(corner[2])) continue;
      triangles_.push_back({corner[0], corner[1], corner[2], primitive, geometry, mesh.mask});
    }
  }
}

bool PlainOracle::crosses(const Frame& frame, const kiwami_ray& ray, const Triangle& triangle,
                          Crossing& crossing) const {
  const Flat a = frame.place(triangle.a), b = frame.place(triangle.b), c = frame.place(triangle.c);
  const int sign_u = edge_sign(c, b, rule_);
  const int sign_v = edge_sign(a, c, rule_);
  if (sign_u * sign_v < 0) return false;
  const int sign_w = edge_sign(b, a, rule_);
  const bool has_positive = sign_u > 0 || sign_v > 0 || sign_w > 0;
  const bool has_negative = sign_u < 0 || sign_v < 0 || sign_w < 0;
  if (has_positive == has_negative) return false;
  if (rule_ == EdgeRule::kOwned && (sign_u == 0 || sign_v == 0 || sign_w == 0)) return false;

  const double u = edge_value(c, b), v = edge_value(a, c), w = edge_value(b, a);
  const double sum = (u + v) + w;
  const double scaled_t = ((u * a.z + v * b.z) + w * c.z) / sum;
  crossing.t = static_cast<float>(scaled_t * frame.scale);
  crossing.u = static_cast<float>(v / sum);
  crossing.v = static_cast<float>(w / sum);
  if (!std::isfinite(crossing.t)) return false;
  if (!(ray.tmin <= crossing.t && crossing.t <= ray.tmax)) return false;
  if (has_positive && (ray.flags & KIWAMI_RAY_CULL_FRONT_FACES)) return false;
  if (has_negative && (ray.flags & KIWAMI_RAY_CULL_BACK_FACES)) return false;
  return true;
}

template <typename Visit>
void PlainOracle::for_each_crossing(const kiwami_ray& ray, Visit visit) const {
  if (!is_ray(ray)) return;
  const Frame frame(ray);
  for (const Triangle& triangle : triangles_) {
    Crossing crossing;
    if ((triangle.mask & ray.mask) == 0 || !crosses(frame, ray, triangle, crossing)) continue;
    if (visit(triangle, crossing)) return;
  }
}

kiwami_hit missing_hit() {
  kiwami_hit hit{};
  hit.t = std::numeric_limits<float>::infinity();
  hit.primitive_id = hit.geometry_id = hit.instance_id = KIWAMI_INVALID_ID;
  return hit;
}

kiwami_hit PlainOracle::hit_of(const Triangle& triangle, const Crossing& crossing) {
  const Point first = triangle.b - triangle.a, second = triangle.c - triangle.a;
  return {crossing.t,
          crossing.u,
          crossing.v,
          first.y * second.z - first.z * second.y,
          first.z * second.x - first.x * second.z,
          first.x * second.y - first.y * second.x,
          triangle.primitive_id,
          triangle.geometry_id,
          KIWAMI_INVALID_ID};
}

kiwami_hit PlainOracle::closest_hit(const kiwami_ray& ray) const {
  // Triangles come by rising (geometry, primitive): of equal distances the first is the least.
  const Triangle* closest = nullptr;
  Crossing best{};
  for_each_crossing(ray, [&](const Triangle& triangle, const Crossing& crossing) {
    if (!closest || crossing.t < best.t) {
      closest = &triangle;
      best = crossing;
    }
    return false;
  });
  return closest ? hit_of(*closest, best) : missing_hit();
}

std::vector<kiwami_hit> PlainOracle::hits(const kiwami_ray& ray) const {
  std::vector<kiwami_hit> found;
  for_each_crossing(ray, [&](const Triangle& triangle, const Crossing& crossing) {
    found.push_back(hit_of(triangle, crossing));
    return false;
  });
  // Triangles come by rising (geometry, primitive): of equal distances their order stays.
  std::stable_sort(found.begin(), found.end(),
                   [](const kiwami_hit& a, const kiwami_hit& b) { return a.t < b.t; });
  return found;
}

bool PlainOracle::any_hit(const kiwami_ray& ray) const {
  bool is_hit = false;
  for_each_crossing(ray, [&](const Triangle&, const Crossing&) { return is_hit = true; });
  return is_hit;
}

uint32_t PlainOracle::all_hits(const kiwami_ray& ray) const {
  uint32_t count = 0;
  for_each_crossing(ray, [&](const Triangle&, const Crossing&) {
    ++count;
    return false;
  });
  return count;
}

}  // namespace kiwami_tests

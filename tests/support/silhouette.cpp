// SPDX-License-Identifier: Apache-2.0
#include "support/silhouette.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace kiwami_tests {
namespace {

int major_axis(const double* d) {
  int major = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (std::fabs(d[axis]) > std::fabs(d[major])) major = axis;
  }
  return major;
}

template <typename Flat>
double area(const Flat& p, const Flat& q) {
  return p.x * q.y - p.y * q.x;
}

/// From the origin to the segment from p to q.
template <typename Flat>
double distance_to_segment(const Flat& p, const Flat& q) {
  const double ex = q.x - p.x, ey = q.y - p.y;
  const double square = ex * ex + ey * ey;
  const double along = square > 0.0 ? -(p.x * ex + p.y * ey) / square : 0.0;
  const double s = std::clamp(along, 0.0, 1.0);
  return std::hypot(p.x + s * ex, p.y + s * ey);
}

}  // namespace

SilhouetteJudge::SilhouetteJudge(const Mesh& mesh) : mesh_(mesh) {
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> owner;
  for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      owner[{mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3]}] = i;
    }
  }
  for (const auto& [edge, left] : owner) {
    if (edge.first < edge.second) {
      edges_.push_back({edge.first, edge.second, left, owner.at({edge.second, edge.first})});
    }
  }
  for (const Point& p : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      greatest_[axis] = std::max(greatest_[axis], std::fabs(p[axis]));
    }
  }
}

/// Vertices in the plane across the ray's major axis, the ray at the origin; z is t.
std::vector<SilhouetteJudge::Flat> SilhouetteJudge::projected(const kiwami_ray& ray) const {
  const double o[3] = {ray.origin_x, ray.origin_y, ray.origin_z};
  const double d[3] = {ray.direction_x, ray.direction_y, ray.direction_z};
  const int major = major_axis(d);
  const int first = (major + 1) % 3, second = (major + 2) % 3;
  std::vector<Flat> flat;
  flat.reserve(mesh_.vertices.size());
  for (const Point& p : mesh_.vertices) {
    const double t = (static_cast<double>(p[major]) - o[major]) / d[major];
    flat.push_back({static_cast<double>(p[first]) - o[first] - t * d[first],
                    static_cast<double>(p[second]) - o[second] - t * d[second], t});
  }
  return flat;
}

SilhouetteJudge::Verdict SilhouetteJudge::judge(const kiwami_ray& ray) const {
  const std::vector<Flat> flat = projected(ray);
  Verdict verdict{false, std::numeric_limits<double>::infinity(), 0.0};
  std::vector<bool> is_positive(mesh_.triangles.size());
  for (size_t i = 0; i < mesh_.triangles.size(); ++i) {
    const auto& index = mesh_.triangles[i];
    const Flat &a = flat[index[0]], &b = flat[index[1]], &c = flat[index[2]];
    const double u = area(c, b), v = area(a, c), w = area(b, a), sum = u + v + w;
    is_positive[i] = sum > 0.0;
    if (!((u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0))) continue;
    const double t = (u * a.z + v * b.z + w * c.z) / sum;
    if (ray.tmin <= t && t <= ray.tmax) verdict.is_hit = true;
  }
  for (const Edge& edge : edges_) {
    if (is_positive[edge.left] == is_positive[edge.right]) continue;
    verdict.distance =
        std::min(verdict.distance, distance_to_segment(flat[edge.from], flat[edge.to]));
  }
  verdict.margin = margin_of(ray);
  return verdict;
}

/// The margin of the box test along an axis a is 9 u (M_a + S_a M_kz); over the two axes across.
double SilhouetteJudge::margin_of(const kiwami_ray& ray) const {
  const double o[3] = {ray.origin_x, ray.origin_y, ray.origin_z};
  const double d[3] = {ray.direction_x, ray.direction_y, ray.direction_z};
  const int major = major_axis(d);
  double magnitude[3], square = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    magnitude[axis] = std::fabs(o[axis]) + static_cast<double>(greatest_[axis]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == major) continue;
    const double margin =
        9.0 * 0x1p-24 * (magnitude[axis] + std::fabs(d[axis] / d[major]) * magnitude[major]);
    square += margin * margin;
  }
  return std::sqrt(square);
}

}  // namespace kiwami_tests

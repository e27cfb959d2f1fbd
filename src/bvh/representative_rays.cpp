// SPDX-License-Identifier: Apache-2.0
#include "bvh/representative_rays.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace kiwami {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Of the scene's diagonal: as far from the surface rays begin, and the reach of the short ones.
constexpr double kLift = 1e-4, kReach = 0.25;

struct Vec3d {
  double x, y, z;
};

Vec3d operator-(Vec3d a, Vec3d b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec3d operator+(Vec3d a, Vec3d b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec3d operator*(double s, Vec3d a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vec3d a, Vec3d b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
double length(Vec3d a) { return std::sqrt(dot(a, a)); }
Vec3d cross(Vec3d a, Vec3d b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec3d widen(Vec3f a) { return {a.x, a.y, a.z}; }
Vec3f narrow(Vec3d a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

/// SplitMix64: G. L. Steele, D. Lea, C. H. Flood, "Fast Splittable Pseudorandom Number Generators",
/// OOPSLA 2014.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}

  /// 0 <= result < 1.
  double unit() {
    state_ += 0x9E3779B97F4A7C15u;
    uint64_t bits = state_;
    bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
    bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
    return static_cast<double>((bits ^ (bits >> 31)) >> 11) * 0x1p-53;
  }

  /// Evenly over the unit sphere, without functions that differ between mathematical libraries.
  Vec3d direction() {
    while (true) {
      const Vec3d point = {2.0 * unit() - 1.0, 2.0 * unit() - 1.0, 2.0 * unit() - 1.0};
      const double distance = length(point);
      if (0.01 < distance && distance <= 1.0) return (1.0 / distance) * point;
    }
  }

 private:
  uint64_t state_;
};

/// A triangle, and twice its area by its normal.
struct Patch {
  Vec3d corner[3];
  Vec3d normal;
};

/// Calls visit(patch) for each triangle that has an area and can be hit.
template <typename Visit>
void for_each_patch(const TriangleSource& source, Visit&& visit) {
  for (uint32_t m = 0; m < source.mesh_count; ++m) {
    const TriangleMeshView& mesh = source.meshes[m];
    for (uint32_t i = 0; i < mesh.triangle_count; ++i) {
      Vec3f corner[3];
      mesh.corners_of(i, corner);
      if (!can_be_hit(corner)) continue;
      Patch patch = {{widen(corner[0]), widen(corner[1]), widen(corner[2])}, {}};
      patch.normal = cross(patch.corner[1] - patch.corner[0], patch.corner[2] - patch.corner[0]);
      if (length(patch.normal) > 0.0) visit(patch);
    }
  }
}

/// False for a ray that can only miss, by the rules of kiwami/trace.h.
bool can_hit(const kiwami_ray& ray) {
  bool is_zero = true;
  for (const float component : {ray.direction_x, ray.direction_y, ray.direction_z}) {
    if (!std::isfinite(component)) return false;
    is_zero = is_zero && component == 0.0f;
  }
  for (const float component : {ray.origin_x, ray.origin_y, ray.origin_z}) {
    // Written so that NaN is out of range.
    if (!(std::fabs(component) <= KIWAMI_MAX_COORDINATE)) return false;
  }
  return !is_zero && ray.tmin <= ray.tmax && ray.mask != 0;
}

/// Makes rays that start on surfaces, of one kind after the other.
class RaySampler {
 public:
  explicit RaySampler(const Bounds& box)
      : lower_(widen(box.lower)), extent_(widen(box.upper) - lower_), diagonal_(length(extent_)) {}

  RepresentativeRay sample(const Patch& patch) {
    const Vec3d point = point_of(patch);
    const Vec3d normal = (1.0 / length(patch.normal)) * patch.normal;
    if (++number_ % 3 == 0) return towards_light(point, normal);
    const Vec3d side = (random_.unit() < 0.5 ? -1.0 : 1.0) * normal;
    // A point of the sphere around the normal's tip: distributed by the cosine.
    const Vec3d direction = side + random_.direction();
    const double reach = number_ % 3 == 1 ? kInfinity : kReach * diagonal_;
    return {narrow(lifted(point, side)), 0.0f,
            narrow((1.0 / std::max(length(direction), 1e-6)) * direction),
            static_cast<float>(reach)};
  }

 private:
  /// Evenly distributed over the triangle.
  Vec3d point_of(const Patch& patch) {
    double u = random_.unit(), v = random_.unit();
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    return patch.corner[0] + u * (patch.corner[1] - patch.corner[0]) +
           v * (patch.corner[2] - patch.corner[0]);
  }

  Vec3d lifted(Vec3d point, Vec3d normal) const { return point + kLift * diagonal_ * normal; }

  RepresentativeRay towards_light(Vec3d point, Vec3d normal) {
    const double x = random_.unit(), y = random_.unit(), z = random_.unit();
    const Vec3d light = lower_ + Vec3d{x * extent_.x, y * extent_.y, z * extent_.z};
    const double side = dot(light - point, normal) < 0.0 ? -1.0 : 1.0;
    const Vec3d origin = lifted(point, side * normal);
    return {narrow(origin), 0.0f, narrow(light - origin), 1.0f};
  }

  Vec3d lower_, extent_;
  double diagonal_;
  uint32_t number_ = 0;
  Random random_{1};
};

}  // namespace

Array<RepresentativeRay> copy_representative_rays(const kiwami_ray* rays, size_t stride,
                                                  size_t count, Memory& memory) {
  const size_t step = stride != 0 ? stride : sizeof(kiwami_ray);
  Array<RepresentativeRay> copied(memory, count);
  size_t made = 0;
  for (size_t i = 0; i < count; ++i) {
    kiwami_ray ray;
    std::memcpy(&ray, reinterpret_cast<const unsigned char*>(rays) + i * step, sizeof ray);
    if (!can_hit(ray)) continue;
    copied[made++] = {{ray.origin_x, ray.origin_y, ray.origin_z},
                      ray.tmin,
                      {ray.direction_x, ray.direction_y, ray.direction_z},
                      ray.tmax};
  }
  copied.shrink(made);
  return copied;
}

Array<RepresentativeRay> sample_rays(const TriangleSource& source, size_t count, Memory& memory) {
  Array<RepresentativeRay> rays(memory, count);
  double area = 0.0;
  Bounds box = Bounds::empty();
  for_each_patch(source, [&](const Patch& patch) {
    area += length(patch.normal);
    for (const Vec3d& corner : patch.corner) box.extend(narrow(corner));
  });
  // Systematic sampling: points at equal steps of the area from the first triangle to the last.
  size_t made = 0;
  double passed = 0.0;
  RaySampler sampler(box);
  for_each_patch(source, [&](const Patch& patch) {
    passed += length(patch.normal);
    while (made < count &&
           (static_cast<double>(made) + 0.5) * area <= passed * static_cast<double>(count)) {
      rays[made++] = sampler.sample(patch);
    }
  });
  rays.shrink(made);
  return rays;
}

double StatisticalRay::enter(const Bounds& box, double farthest) const {
  double near = tmin_, far = farthest;
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.lower[axis] - box_origin_[axis]) * inverse_[axis];
    const double b = (box.upper[axis] - box_origin_[axis]) * inverse_[axis];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far ? near : kInfinity;
}

/// T. Möller, B. Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997.
double StatisticalRay::meet(const Vec3f corner[3]) const {
  const Vec3d direction = {direction_[0], direction_[1], direction_[2]};
  const Vec3d a = widen(corner[0]), ab = widen(corner[1]) - a, ac = widen(corner[2]) - a;
  const Vec3d from_a = Vec3d{origin_[0], origin_[1], origin_[2]} - a;
  const Vec3d p = cross(direction, ac), q = cross(from_a, ab);
  const double determinant = dot(ab, p);
  const double u = dot(from_a, p) / determinant, v = dot(direction, q) / determinant;
  const double t = dot(ac, q) / determinant;
  // Written so that NaN, of a determinant of 0, is a miss.
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && tmin_ <= t && t <= tmax_ ? t : kInfinity;
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "support/shape_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kiwami_tests {
namespace {

/// Three doubles, as the documentation writes them.
struct Vector {
  double x, y, z;
};

Vector minus(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
/// a + s b.
Vector along(Vector a, double s, Vector b) { return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z}; }
double product(Vector a, Vector b) {
  const double x = a.x * b.x, y = a.y * b.y, z = a.z * b.z;
  return (x + y) + z;
}
Vector crossed(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct Line {
  Vector o, d;
  double dd, inverse;
};

struct Event {
  double t, s;
};

Vector centre_of(const std::array<float, 4>& point) { return {point[0], point[1], point[2]}; }

bool is_ball(const std::array<float, 4>& point) {
  for (const float number : point) {
    if (!(std::fabs(number) <= KIWAMI_MAX_COORDINATE)) return false;
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (double{std::fabs(point[axis])} + double{point[3]} > double{KIWAMI_MAX_COORDINATE})
      return false;
  }
  return !(point[3] < 0.0f);
}

double middle_of_ball(const Line& line, Vector f) {
  return 0.0 - product(f, line.d) * line.inverse;
}

void add_ball(const Line& line, Vector f, double radius, double s, std::vector<Event>& events) {
  const double m = middle_of_ball(line, f);
  const Vector l = along(f, m, line.d);
  const double h2 = (radius * radius - product(l, l)) * line.inverse;
  if (!(h2 > 0.0)) return;
  events.push_back({m - std::sqrt(h2), s});
  events.push_back({m + std::sqrt(h2), s});
}

/// The cone of the segment, by the names of the documentation.
void add_cone(const Line& line, const std::array<float, 4>& first,
              const std::array<float, 4>& second, std::vector<Event>& events) {
  const double r0 = first[3], g = double{second[3]} - r0;
  const Vector f = minus(line.o, centre_of(first));
  const Vector a = minus(centre_of(second), centre_of(first));
  const Vector e = crossed(line.d, a);
  const double aa = product(a, a), k = aa - g * g;
  if (!(k > 0x1p-20 * aa)) return;
  const double alpha = product(e, e) - g * g * line.dd;
  const double shift =
      0.5 * (middle_of_ball(line, f) + middle_of_ball(line, minus(line.o, centre_of(second))));
  const Vector w = along(f, shift, line.d);
  const double beta =
      product(crossed(w, a), e) - g * (g * product(w, line.d) + r0 * product(line.d, a));
  const auto gamma = [&](Vector p) {
    const Vector c = crossed(p, a);
    return product(c, c) - (r0 * (r0 * aa + (g + g) * product(p, a)) + g * g * product(p, p));
  };
  const auto add = [&](double t) {
    const Vector p = along(f, t, line.d);
    const double s = (product(p, a) + g * r0) / k;
    if (!(s > 0.0 && s < 1.0)) return;
    const Vector n = along(p, -s, a);
    const double extent =
        std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)}) + (r0 + double{second[3]});
    const double reach = (r0 + s * g) + 0x1p-20 * extent;
    if (product(n, n) <= reach * reach) events.push_back({t, s});
  };
  if (alpha > 0x1p-8 * (k * line.dd)) {
    const double step = 0.0 - beta * (1.0 / alpha);
    const double h2 = 0.0 - gamma(along(w, step, line.d)) * (1.0 / alpha);
    if (!(h2 > 0.0)) return;
    add((shift + step) - std::sqrt(h2));
    add((shift + step) + std::sqrt(h2));
  } else {
    const double c = gamma(w);
    const double discriminant = beta * beta - alpha * c;
    if (!(discriminant > 0.0)) return;
    const double q = beta < 0.0 ? beta - std::sqrt(discriminant) : beta + std::sqrt(discriminant);
    add(shift - q / alpha);
    add(shift - c / q);
  }
}

kiwami_hit hit_at(float t, double u, Vector normal, uint32_t primitive, uint32_t geometry) {
  kiwami_hit hit{};
  hit.t = t;
  hit.u = static_cast<float>(u);
  hit.normal_x = static_cast<float>(normal.x);
  hit.normal_y = static_cast<float>(normal.y);
  hit.normal_z = static_cast<float>(normal.z);
  hit.primitive_id = primitive;
  hit.geometry_id = geometry;
  hit.instance_id = KIWAMI_INVALID_ID;
  return hit;
}

bool is_of_interest(const kiwami_ray& ray, float t, bool is_front) {
  const uint32_t culled = is_front ? KIWAMI_RAY_CULL_FRONT_FACES : KIWAMI_RAY_CULL_BACK_FACES;
  return ray.tmin <= t && t <= ray.tmax && std::isfinite(t) && (ray.flags & culled) == 0;
}

bool is_ray(const kiwami_ray& ray) {
  for (const float origin : {ray.origin_x, ray.origin_y, ray.origin_z}) {
    if (!(std::fabs(origin) <= KIWAMI_MAX_COORDINATE)) return false;
  }
  for (const float direction : {ray.direction_x, ray.direction_y, ray.direction_z}) {
    if (!std::isfinite(direction)) return false;
  }
  const bool is_zero = ray.direction_x == 0 && ray.direction_y == 0 && ray.direction_z == 0;
  return !is_zero && ray.tmin <= ray.tmax && ray.mask != 0;
}

/// The entry and the exit of a body.
void add_interval(const std::vector<Event>& events, const Line& line, const kiwami_ray& ray,
                  const std::array<float, 4>& first, Vector axis, bool is_curve, uint32_t primitive,
                  uint32_t geometry, std::vector<kiwami_hit>& hits) {
  if (events.empty()) return;
  Event entry = events[0], exit = events[0];
  for (const Event& event : events) {
    if (event.t < entry.t) entry = event;
    if (event.t > exit.t) exit = event;
  }
  const float t0 = static_cast<float>(entry.t);
  float t1 = static_cast<float>(exit.t);
  if (t1 == t0) t1 = std::nextafter(t1, std::numeric_limits<float>::infinity());
  const auto add = [&](float t, const Event& event, bool is_front) {
    if (!is_of_interest(ray, t, is_front)) return;
    const Vector p = along(minus(line.o, centre_of(first)), event.t, line.d);
    const Vector normal = is_curve ? along(p, -event.s, axis) : p;
    hits.push_back(hit_at(t, is_curve ? event.s : 0.0, normal, primitive, geometry));
  };
  add(t0, entry, true);
  add(t1, exit, false);
}

void add_disc(const ShapeSet& set, uint32_t primitive, uint32_t geometry, const Line& line,
              const kiwami_ray& ray, std::vector<kiwami_hit>& hits) {
  const auto& point = set.points[primitive];
  const Point given = set.normals[primitive];
  const Vector n = {given.x, given.y, given.z};
  const Vector f = minus(line.o, centre_of(point));
  const double facing = product(n, line.d);
  const double t = 0.0 - product(n, f) / facing;
  const Vector p = along(f, t, line.d);
  const double rr = double{point[3]} * double{point[3]};
  if (!(product(p, p) < rr)) return;
  if (!is_of_interest(ray, static_cast<float>(t), facing < 0.0)) return;
  hits.push_back(hit_at(static_cast<float>(t), product(p, p) / rr, n, primitive, geometry));
}

void add_shape(const ShapeSet& set, uint32_t primitive, uint32_t geometry, const Line& line,
               const kiwami_ray& ray, std::vector<kiwami_hit>& hits) {
  const uint32_t index = set.type == ShapeType::kCurves ? set.indices[primitive] : primitive;
  const auto& point = set.points[index];
  if (!is_ball(point)) return;
  if (set.type == ShapeType::kDiscs) {
    const Point n = set.normals[primitive];
    const double length = product({n.x, n.y, n.z}, {n.x, n.y, n.z});
    if (length > 0.0 && std::isfinite(length)) add_disc(set, primitive, geometry, line, ray, hits);
    return;
  }
  std::vector<Event> events;
  add_ball(line, minus(line.o, centre_of(point)), point[3], 0.0, events);
  Vector axis{};
  if (set.type == ShapeType::kCurves) {
    const auto& next = set.points[index + 1];
    if (!is_ball(next)) return;
    axis = minus(centre_of(next), centre_of(point));
    add_ball(line, minus(line.o, centre_of(next)), next[3], 1.0, events);
    add_cone(line, point, next, events);
  }
  add_interval(events, line, ray, point, axis, set.type == ShapeType::kCurves, primitive, geometry,
               hits);
}

}  // namespace

std::vector<kiwami_hit> shape_hits(const std::vector<ShapeSet>& sets, uint32_t first_geometry_id,
                                   const kiwami_ray& ray) {
  std::vector<kiwami_hit> hits;
  if (!is_ray(ray)) return hits;
  Line line;
  line.o = {ray.origin_x, ray.origin_y, ray.origin_z};
  line.d = {ray.direction_x, ray.direction_y, ray.direction_z};
  line.dd = product(line.d, line.d);
  line.inverse = 1.0 / line.dd;
  for (uint32_t i = 0; i < sets.size(); ++i) {
    if ((sets[i].mask & ray.mask) == 0) continue;
    for (uint32_t primitive = 0; primitive < sets[i].count(); ++primitive) {
      add_shape(sets[i], primitive, first_geometry_id + i, line, ray, hits);
    }
  }
  std::sort(hits.begin(), hits.end(), [](const kiwami_hit& a, const kiwami_hit& b) {
    if (a.t != b.t) return a.t < b.t;
    if (a.geometry_id != b.geometry_id) return a.geometry_id < b.geometry_id;
    return a.primitive_id < b.primitive_id;
  });
  return hits;
}

ShapeSet random_shapes(ShapeType type, uint32_t number, uint32_t count, Random& random) {
  ShapeSet set;
  set.type = type;
  const float scale = number % 4 == 3 ? random.power_of_two(-40, 40) : 1.0f;
  const float offset = number % 3 == 2 ? 1000.0f * scale : 0.0f;
  const float size = number % 2 == 1 ? 0.3f : 0.02f;
  const auto coordinate = [&] { return offset + scale * random.symmetric(); };
  const auto radius = [&] {
    if (random.one_in(24)) return 0.0f;
    return scale * size * (random.one_in(4) ? random.power_of_two(-10, 1) : random.unit());
  };
  for (uint32_t i = 0; i < count; ++i) {
    std::array<float, 4> point = {coordinate(), coordinate(), coordinate(), radius()};
    if (!set.points.empty() && random.one_in(8)) point = set.points[random.below(i)];
    if (type == ShapeType::kCurves && !set.points.empty() && !random.one_in(5)) {
      for (int axis = 0; axis < 3; ++axis) {
        point[axis] = set.points[i - 1][axis] + scale * size * 2 * random.symmetric();
      }
    }
    if (random.one_in(64)) point[random.below(4)] = std::numeric_limits<float>::quiet_NaN();
    if (random.one_in(64)) point[3] = -point[3];
    if (random.one_in(64)) point[random.below(3)] = std::numeric_limits<float>::infinity();
    if (number % 8 == 6 && random.one_in(8)) point[3] *= 1e4f;
    set.points.push_back(point);
    if (type == ShapeType::kDiscs) {
      const float length = random.one_in(4) ? random.power_of_two(-60, 60) : 1.0f;
      Point normal = {length * random.symmetric(), length * random.symmetric(),
                      length * random.symmetric()};
      if (random.one_in(8)) normal = {0, 0, length};
      if (random.one_in(32)) normal = {0, 0, 0};
      set.normals.push_back(normal);
    }
    if (type == ShapeType::kCurves && i + 1 < count) {
      set.indices.push_back(random.one_in(8) ? random.below(count - 1) : i);
    }
  }
  if (number % 5 == 4) set.mask = 1u << random.below(4);
  return set;
}

Scene targets_of(const std::vector<ShapeSet>& sets) {
  Scene scene;
  scene.name = "targets";
  Mesh mesh;
  for (const ShapeSet& set : sets) {
    for (const auto& point : set.points) {
      if (!is_ball(point)) continue;
      const Point centre = {point[0], point[1], point[2]};
      const float r = point[3];
      mesh.add(centre, centre + Point{r, 0, 0}, centre + Point{0, -r, 0});
      mesh.add(centre + Point{0, 0, r}, centre + Point{0.6f * r, 0.8f * r, 0}, centre);
    }
  }
  scene.meshes.push_back(mesh);
  return scene;
}

}  // namespace kiwami_tests

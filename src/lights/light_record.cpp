// SPDX-License-Identifier: Apache-2.0
#include "lights/light_record.h"

#include <limits>

#include "core/error.h"

namespace kiwami {
namespace {

constexpr double kPi = 3.14159265358979323846;

bool is_coordinate(float value) { return std::fabs(value) <= KIWAMI_MAX_COORDINATE; }

Vec3f point_of(const float (&values)[3]) { return {values[0], values[1], values[2]}; }
Vec3f point_of(const kiwami_light& light, int i) {
  return {light.points[3 * i], light.points[3 * i + 1], light.points[3 * i + 2]};
}
Vec3d widened(Vec3f a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}
Vec3f narrowed(Vec3d a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

[[noreturn]] void reject(size_t index, const char* field, float value, const char* expected) {
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "lights[%zu].%s is %g, expected %s", index, field,
              static_cast<double>(value), expected);
}

int point_count_of(uint32_t type) {
  switch (type) {
    case KIWAMI_LIGHT_TRIANGLE:
      return 3;
    case KIWAMI_LIGHT_QUAD:
      return 4;
    case KIWAMI_LIGHT_DISTANT:
    case KIWAMI_LIGHT_ENVIRONMENT:
      return 0;
    default:
      return 1;
  }
}

bool has_direction(uint32_t type) {
  return type == KIWAMI_LIGHT_SPOT || type == KIWAMI_LIGHT_DISC || type == KIWAMI_LIGHT_DISTANT;
}
bool has_radius(uint32_t type) { return type == KIWAMI_LIGHT_SPHERE || type == KIWAMI_LIGHT_DISC; }
bool has_sides(uint32_t type) {
  return type == KIWAMI_LIGHT_TRIANGLE || type == KIWAMI_LIGHT_QUAD || type == KIWAMI_LIGHT_DISC;
}

void check_shape(const kiwami_light& light, size_t index) {
  for (int i = 0; i < point_count_of(light.type); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!is_coordinate(light.points[3 * i + axis])) {
        throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                    "lights[%zu].points[%d] is %g, expected at most 2^60 in size", index,
                    3 * i + axis, static_cast<double>(light.points[3 * i + axis]));
      }
    }
  }
  if (has_radius(light.type) && !(light.radius > 0.0f && is_coordinate(light.radius))) {
    reject(index, "radius", light.radius, "more than 0 and at most 2^60");
  }
  if (has_direction(light.type)) {
    const double size = length(widened(point_of(light.direction)));
    if (!(size > 0.0 && size <= static_cast<double>(std::numeric_limits<float>::max()))) {
      reject(index, "direction, whose length", static_cast<float>(size), "finite and above 0");
    }
  }
}

void check_cosines(const kiwami_light& light, size_t index) {
  const bool is_spot = light.type == KIWAMI_LIGHT_SPOT;
  if (!is_spot && light.type != KIWAMI_LIGHT_DISTANT) return;
  if (!(light.cos_outer >= -1.0f && light.cos_outer <= 1.0f)) {
    reject(index, "cos_outer", light.cos_outer, "-1 to 1");
  }
  if (is_spot && !(light.cos_inner >= light.cos_outer && light.cos_inner <= 1.0f)) {
    reject(index, "cos_inner", light.cos_inner, "cos_outer to 1");
  }
}

void check(const kiwami_light& light, size_t index) {
  if (light.type > KIWAMI_LIGHT_ENVIRONMENT) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "lights[%zu].type is %u, expected one of KIWAMI_LIGHT_*", index, light.type);
  }
  const uint32_t known = has_sides(light.type) ? uint32_t{KIWAMI_LIGHT_TWO_SIDED} : 0u;
  if (light.flags & ~known) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "lights[%zu].flags is 0x%x, expected %s", index,
                light.flags, known ? "0 or KIWAMI_LIGHT_TWO_SIDED" : "0 for a light of its type");
  }
  if (!(light.power >= 0.0f && light.power <= std::numeric_limits<float>::max())) {
    reject(index, "power", light.power, "0 or more, finite");
  }
  check_shape(light, index);
  check_cosines(light, index);
}

Vec3d normalised(Vec3d a) {
  // In two steps, so that the square of no float's length is 0.
  const double greatest = std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)});
  const Vec3d scaled = a * (1.0 / greatest);
  return scaled * (1.0 / length(scaled));
}

/// Twice the area times the normal, in double precision.
Vec3d area_normal(Vec3f a, Vec3f b, Vec3f c) {
  return cross(widened(b) - widened(a), widened(c) - widened(a));
}

Cone flat_cone(Vec3d normal, bool is_two_sided) {
  return {normalised(normal), Angle::zero(), Angle::right(), is_two_sided, false};
}

void set_surface(LightRecord& record, const Cone& cone) {
  record.set_cone(cone);
  // The peak of a Lambertian emitter.
  record.intensity_per_power = static_cast<float>(cone.is_two_sided ? 0.5 / kPi : 1.0 / kPi);
}

void set_quad(LightRecord& record, const kiwami_light& light, size_t index) {
  Cone cone;
  double area = 0.0;
  const bool is_two_sided = (light.flags & KIWAMI_LIGHT_TWO_SIDED) != 0;
  for (int half = 0; half < point_count_of(light.type) - 2; ++half) {
    const Vec3f corners[3] = {point_of(light, 0), point_of(light, 1 + half),
                              point_of(light, 2 + half)};
    const Vec3d normal = area_normal(corners[0], corners[1], corners[2]);
    for (const Vec3f corner : corners) record.box.extend(corner);
    const double size = length(normal);
    area += size;
    if (size > 0.0) cone = merge(cone, flat_cone(normal, is_two_sided));
  }
  if (!(area > 0.0)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "lights[%zu].points span no area, expected a triangle or a quad with one", index);
  }
  set_surface(record, cone);
}

/// A coordinate to a float above (below) it.
float rounded_up(double value) {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) < value
             ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
             : nearest;
}
float rounded_down(double value) { return -rounded_up(-value); }

void extend_around(Bounds& box, Vec3f centre, Vec3d reach) {
  const Vec3d middle = widened(centre);
  box.extend(Vec3f{rounded_down(middle.x - reach.x), rounded_down(middle.y - reach.y),
                   rounded_down(middle.z - reach.z)});
  box.extend(Vec3f{rounded_up(middle.x + reach.x), rounded_up(middle.y + reach.y),
                   rounded_up(middle.z + reach.z)});
}

void set_disc(LightRecord& record, const kiwami_light& light) {
  const Vec3d normal = normalised(widened(point_of(light.direction)));
  const double radius = static_cast<double>(light.radius);
  const auto reach = [&](double n) { return radius * std::sqrt(std::max(0.0, 1.0 - n * n)); };
  extend_around(record.box, point_of(light, 0),
                {reach(normal.x), reach(normal.y), reach(normal.z)});
  set_surface(record, flat_cone(normal, (light.flags & KIWAMI_LIGHT_TWO_SIDED) != 0));
}

void set_spot(LightRecord& record, const kiwami_light& light) {
  record.box.extend(point_of(light, 0));
  const double outer = static_cast<double>(light.cos_outer);
  record.set_cone({normalised(widened(point_of(light.direction))), Angle::of_cosine(outer),
                   Angle::zero(), false, false});
  // As if it shone fully up to the middle of its rim.
  const double middle = 0.5 * (outer + static_cast<double>(light.cos_inner));
  record.intensity_per_power = static_cast<float>(0.5 / (kPi * std::max(1e-4, 1.0 - middle)));
}

void set_all_around(LightRecord& record) {
  record.set_cone(Cone::sphere());
  record.intensity_per_power = static_cast<float>(0.25 / kPi);
}

void set_distant(LightRecord& record, const kiwami_light& light) {
  record.intensity_per_power = 1.0f;
  if (light.type == KIWAMI_LIGHT_ENVIRONMENT) {
    record.kind = LightKind::kEnvironment;
    record.set_cone(Cone::sphere());
    return;
  }
  record.kind = LightKind::kDistant;
  const Angle spread = Angle::of_cosine(static_cast<double>(light.cos_outer));
  const Vec3d towards = normalised(widened(point_of(light.direction))) * -1.0;
  record.set_cone({towards, spread, Angle::zero(), false, false});
}

LightRecord empty_record(float power, uint64_t link_mask) {
  LightRecord record{};
  record.box = Bounds::empty();
  record.kind = LightKind::kLocal;
  record.power = power;
  record.link_mask = link_mask;
  return record;
}

}  // namespace

void LightRecord::set_cone(const Cone& cone) {
  axis = narrowed(cone.axis);
  cos_spread = static_cast<float>(cone.spread.cosine);
  sin_spread = static_cast<float>(cone.spread.sine);
  cos_extent = static_cast<float>(cone.extent.cosine);
  is_two_sided = cone.is_two_sided ? 1 : 0;
}

LightRecord record_of(const kiwami_light& light, size_t index) {
  check(light, index);
  LightRecord record = empty_record(light.power, light.link_mask);
  switch (light.type) {
    case KIWAMI_LIGHT_POINT:
      record.box.extend(point_of(light, 0));
      set_all_around(record);
      break;
    case KIWAMI_LIGHT_SPOT:
      set_spot(record, light);
      break;
    case KIWAMI_LIGHT_TRIANGLE:
    case KIWAMI_LIGHT_QUAD:
      set_quad(record, light, index);
      break;
    case KIWAMI_LIGHT_SPHERE: {
      const double radius = static_cast<double>(light.radius);
      extend_around(record.box, point_of(light, 0), {radius, radius, radius});
      set_all_around(record);
      break;
    }
    case KIWAMI_LIGHT_DISC:
      set_disc(record, light);
      break;
    default:
      set_distant(record, light);
  }
  return record;
}

LightRecord record_of_triangle(const Vec3f (&corners)[3], float radiance, bool is_two_sided,
                               uint64_t link_mask) {
  LightRecord record = empty_record(0.0f, link_mask);
  for (const Vec3f corner : corners) {
    if (!is_coordinate(corner.x) || !is_coordinate(corner.y) || !is_coordinate(corner.z)) {
      record.kind = LightKind::kUnusable;
      record.box = Bounds::empty();
      return record;
    }
    record.box.extend(corner);
  }
  const Vec3d normal = area_normal(corners[0], corners[1], corners[2]);
  const double area = 0.5 * length(normal);
  if (!(area > 0.0)) {
    set_all_around(record);
    return record;
  }
  set_surface(record, flat_cone(normal, is_two_sided));
  const double power = kPi * area * static_cast<double>(radiance) * (is_two_sided ? 2.0 : 1.0);
  record.power =
      static_cast<float>(std::min(power, static_cast<double>(std::numeric_limits<float>::max())));
  return record;
}

LightRecord transformed(const LightRecord& light, const float (&local_to_world)[12],
                        float power_scale, uint64_t link_mask) {
  LightRecord result = light;
  result.link_mask = light.link_mask & link_mask;
  const double power = static_cast<double>(light.power) * static_cast<double>(power_scale);
  result.power =
      static_cast<float>(std::min(power, static_cast<double>(std::numeric_limits<float>::max())));
  Vec3d rows[3];
  const Vec3d middle = (widened(light.box.lower) + widened(light.box.upper)) * 0.5;
  const Vec3d half = (widened(light.box.upper) - widened(light.box.lower)) * 0.5;
  result.box = Bounds::empty();
  Vec3f lower{}, upper{};
  for (int row = 0; row < 3; ++row) {
    const float* m = local_to_world + 4 * row;
    rows[row] = widened({m[0], m[1], m[2]});
    const Vec3d size{std::fabs(rows[row].x), std::fabs(rows[row].y), std::fabs(rows[row].z)};
    const double centre = dot(rows[row], middle) + static_cast<double>(m[3]);
    // The receivers are transformed in float: what that loses is added here.
    const double slack =
        4e-7 * (std::fabs(centre) + dot(size, half) + std::fabs(static_cast<double>(m[3])));
    lower[row] = rounded_down(centre - dot(size, half) - slack);
    upper[row] = rounded_up(centre + dot(size, half) + slack);
  }
  result.box.extend(lower);
  result.box.extend(upper);
  // Of a similarity, the rows are as long as each other, and orthogonal.
  const double square = dot(rows[0], rows[0]);
  double deviation = 0.0;
  for (int i = 0; i < 3; ++i) {
    deviation = std::max(deviation, std::fabs(dot(rows[i], rows[i]) - square));
    deviation = std::max(deviation, std::fabs(dot(rows[i], rows[(i + 1) % 3])));
  }
  Cone cone = light.cone();
  if (deviation > 1e-5 * square) {
    cone = Cone::sphere();
  } else {
    const Vec3d axis = cone.axis;
    cone.axis = normalised({dot(rows[0], axis), dot(rows[1], axis), dot(rows[2], axis)});
    // By what the transform may bend angles.
    cone.spread = saturated_sum(cone.spread, Angle::of_cosine(1.0 - 1e-6));
  }
  result.set_cone(cone);
  return result;
}

}  // namespace kiwami

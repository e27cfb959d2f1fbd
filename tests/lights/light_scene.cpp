// SPDX-License-Identifier: Apache-2.0
#include "lights/light_scene.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "support/library.h"

namespace kiwami_tests {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Vector {
  double x, y, z;
};
Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator*(Vector a, double s) { return {a.x * s, a.y * s, a.z * s}; }
double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(Vector a) { return std::sqrt(dot(a, a)); }
Vector unit(Vector a) { return a * (1.0 / length(a)); }
Vector vector_of(const float (&a)[3]) {
  return {static_cast<double>(a[0]), static_cast<double>(a[1]), static_cast<double>(a[2])};
}

Vector random_unit(Random& random) {
  for (;;) {
    const Vector v{static_cast<double>(random.symmetric()), static_cast<double>(random.symmetric()),
                   static_cast<double>(random.symmetric())};
    const double size = length(v);
    if (size > 0.1 && size <= 1.0) return v * (1.0 / size);
  }
}

void put(Vector v, float (&to)[3]) {
  to[0] = static_cast<float>(v.x);
  to[1] = static_cast<float>(v.y);
  to[2] = static_cast<float>(v.z);
}

void put_point(Vector v, kiwami_light& light, int i) {
  float point[3];
  put(v, point);
  std::copy_n(point, 3, light.points + 3 * i);
}
Vector point_of(const kiwami_light& light, int i) {
  const float* point = light.points + 3 * i;
  return {static_cast<double>(point[0]), static_cast<double>(point[1]),
          static_cast<double>(point[2])};
}

kiwami_light random_light(Vector centre, double size, Random& random) {
  kiwami_light light{};
  light.type = random.below(6);
  const Vector u = random_unit(random) * size;
  const Vector v = random_unit(random) * size;
  put_point(centre, light, 0);
  put_point(centre + u, light, 1);
  put_point(centre + u + v, light, 2);
  put_point(centre + v, light, 3);
  put(random_unit(random) * 3.0, light.direction);
  light.radius = static_cast<float>(0.5 * size);
  light.cos_outer = random.one_in(4) ? 0.99f : random.symmetric() * 0.9f;
  light.cos_inner = light.cos_outer + (1.0f - light.cos_outer) * random.unit();
  const bool has_sides = light.type == KIWAMI_LIGHT_TRIANGLE || light.type == KIWAMI_LIGHT_QUAD ||
                         light.type == KIWAMI_LIGHT_DISC;
  if (has_sides && random.one_in(3)) light.flags = KIWAMI_LIGHT_TWO_SIDED;
  light.power = random.one_in(12) ? 0.0f : std::exp2(6.0f * random.symmetric());
  light.link_mask = ~uint64_t{0};
  return light;
}

std::vector<kiwami_light> random_cluster_lights(uint32_t count, Random& random) {
  std::vector<kiwami_light> lights;
  Vector centre{0.0, 0.0, 0.0};
  double spread = 1.0;
  for (uint32_t i = 0; i < count; ++i) {
    if (i % 16 == 0) {
      centre = random_unit(random) * 4.0;
      spread = std::exp2(-4.0 * static_cast<double>(random.unit()));
    }
    const double size = spread * std::exp2(-3.0 * static_cast<double>(random.unit()));
    lights.push_back(random_light(centre + random_unit(random) * spread, size, random));
    lights.back().user_id = 1000 + i;
  }
  return lights;
}

kiwami_light random_distant(Random& random) {
  kiwami_light light{};
  light.type = random.one_in(3) ? KIWAMI_LIGHT_ENVIRONMENT : KIWAMI_LIGHT_DISTANT;
  put(random_unit(random), light.direction);
  light.cos_outer = random.one_in(2) ? 1.0f : 0.9f;
  light.power = random.unit() + 0.1f;
  light.link_mask = ~uint64_t{0};
  return light;
}

/// A turn, a scale and a shift; now and then a shear or a mirror, too.
void random_transform(float (&rows)[12], Random& random) {
  const Vector a = random_unit(random);
  Vector b = unit(cross(a, random_unit(random)));
  Vector c = cross(a, b);
  if (random.one_in(3)) c = c * -1.0;
  if (random.one_in(3)) b = b * 2.5 + a * 0.4;
  const double scale = std::exp2(2.0 * static_cast<double>(random.symmetric()));
  const Vector shift = random_unit(random) * 3.0;
  const double entries[3][4] = {{a.x, b.x, c.x, shift.x / scale},
                                {a.y, b.y, c.y, shift.y / scale},
                                {a.z, b.z, c.z, shift.z / scale}};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      rows[4 * row + column] = static_cast<float>(entries[row][column] * scale);
    }
  }
}

constexpr float kIdentity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/// A point of a light with the normal there, in its own space; no normal for points.
struct Emitter {
  Vector position;
  Vector normal;
  bool has_normal;
};

std::vector<Emitter> emitters_of(const kiwami_light& light, Vector seen_from) {
  const Vector first = point_of(light, 0);
  std::vector<Emitter> emitters;
  switch (light.type) {
    case KIWAMI_LIGHT_POINT:
    case KIWAMI_LIGHT_SPOT:
      return {{first, {}, false}};
    case KIWAMI_LIGHT_SPHERE: {
      const double radius = static_cast<double>(light.radius);
      const Vector towards = seen_from - first;
      for (const Vector axis : {towards, Vector{1, 0, 0}, Vector{-1, 0, 0}, Vector{0, 1, 0},
                                Vector{0, -1, 0}, Vector{0, 0, 1}, Vector{0, 0, -1}}) {
        if (!(length(axis) > 0.0)) continue;
        emitters.push_back({first + unit(axis) * radius, unit(axis), true});
      }
      return emitters;
    }
    case KIWAMI_LIGHT_DISC: {
      const Vector normal = unit(vector_of(light.direction));
      const Vector other = std::fabs(normal.x) < 0.5 ? Vector{1, 0, 0} : Vector{0, 1, 0};
      const Vector u = unit(cross(normal, other)) * (0.999 * static_cast<double>(light.radius));
      const Vector v = cross(normal, u);
      for (const Vector off : {Vector{0, 0, 0}, u, v, u * -1.0, v * -1.0}) {
        emitters.push_back({first + off, normal, true});
      }
      return emitters;
    }
    default: {
      const int halves = light.type == KIWAMI_LIGHT_QUAD ? 2 : 1;
      for (int half = 0; half < halves; ++half) {
        const Vector corners[3] = {first, point_of(light, 1 + half), point_of(light, 2 + half)};
        const Vector across = cross(corners[1] - corners[0], corners[2] - corners[0]);
        if (!(length(across) > 0.0)) continue;
        const Vector middle = (corners[0] + corners[1] + corners[2]) * (1.0 / 3.0);
        emitters.push_back({middle, unit(across), true});
        for (const Vector corner : corners) {
          emitters.push_back({corner + (middle - corner) * 1e-3, unit(across), true});
        }
      }
      return emitters;
    }
  }
}

/// The intensity of a light's point into a direction of its own space.
double intensity(const kiwami_light& light, const Emitter& from, Vector direction) {
  if (light.type == KIWAMI_LIGHT_POINT) return 0.25 / kPi;
  const Vector towards = unit(direction);
  if (light.type == KIWAMI_LIGHT_SPOT) {
    const double cosine = dot(towards, unit(vector_of(light.direction)));
    const double outer = static_cast<double>(light.cos_outer);
    const double inner = static_cast<double>(light.cos_inner);
    if (cosine <= outer) return 0.0;
    return cosine >= inner ? 0.5 : 0.5 * (cosine - outer) / (inner - outer);
  }
  const double cosine = dot(towards, from.normal) / kPi;
  return (light.flags & KIWAMI_LIGHT_TWO_SIDED) ? 0.5 * std::fabs(cosine) : std::max(cosine, 0.0);
}

Vector to_world(const float (&m)[12], Vector p, double shift) {
  const auto row = [&](int i) {
    return static_cast<double>(m[4 * i]) * p.x + static_cast<double>(m[4 * i + 1]) * p.y +
           static_cast<double>(m[4 * i + 2]) * p.z + static_cast<double>(m[4 * i + 3]) * shift;
  };
  return {row(0), row(1), row(2)};
}

/// Undoes the linear part by Cramer's rule.
Vector to_local_direction(const float (&m)[12], Vector d) {
  const auto column = [&](int j) {
    return Vector{static_cast<double>(m[j]), static_cast<double>(m[4 + j]),
                  static_cast<double>(m[8 + j])};
  };
  const Vector a = column(0), b = column(1), c = column(2);
  const double determinant = dot(a, cross(b, c));
  return {dot(d, cross(b, c)) / determinant, dot(a, cross(d, c)) / determinant,
          dot(a, cross(b, d)) / determinant};
}

double cosine_at(const kiwami_light_receiver& receiver, Vector towards, bool has_normal) {
  if (!has_normal) return 1.0;
  const double cosine = dot(unit(vector_of(receiver.normal)), towards);
  return (receiver.flags & KIWAMI_RECEIVER_BOTH_SIDES) ? std::fabs(cosine) : std::max(cosine, 0.0);
}

double contribution_to_point(const SeenLight& seen, const kiwami_light_receiver& receiver,
                             Vector position, bool has_normal) {
  const kiwami_light& light = seen.light;
  if (light.type == KIWAMI_LIGHT_ENVIRONMENT) return seen.power;
  if (light.type == KIWAMI_LIGHT_DISTANT) {
    return seen.power * cosine_at(receiver, unit(vector_of(light.direction)) * -1.0, has_normal);
  }
  const Vector origin = to_world(seen.local_to_world, {0, 0, 0}, 1.0);
  const Vector local = to_local_direction(seen.local_to_world, position - origin);
  const std::vector<Emitter> emitters = emitters_of(light, local);
  double sum = 0.0;
  for (const Emitter& emitter : emitters) {
    const Vector at = to_world(seen.local_to_world, emitter.position, 1.0);
    const double distance = length(at - position);
    if (!(distance > 1e-5)) continue;
    const double strength = intensity(light, emitter, local - emitter.position);
    sum += strength * cosine_at(receiver, unit(at - position), has_normal) / (distance * distance);
  }
  return seen.power * sum / static_cast<double>(emitters.size());
}

}  // namespace

std::vector<SeenLight> LightScene::seen() const {
  std::vector<SeenLight> all;
  for (uint32_t i = 0; i < lights.size(); ++i) {
    SeenLight seen{{i, KIWAMI_INVALID_ID},
                   lights[i],
                   {},
                   lights[i].link_mask,
                   static_cast<double>(lights[i].power)};
    std::memcpy(seen.local_to_world, kIdentity, sizeof kIdentity);
    all.push_back(seen);
  }
  for (uint32_t g = 0; g < groups.size(); ++g) {
    const Group& group = groups[g];
    for (uint32_t i = 0; i < group.lights.size(); ++i) {
      const kiwami_light& light = group.lights[i];
      SeenLight seen{
          {i, g},
          light,
          {},
          light.link_mask & group.instance.link_mask,
          static_cast<double>(light.power) * static_cast<double>(group.instance.power_scale)};
      std::memcpy(seen.local_to_world, group.instance.local_to_world, sizeof seen.local_to_world);
      all.push_back(seen);
    }
  }
  return all;
}

LightScene random_light_scene(const LightSceneOptions& options, Random& random) {
  LightScene scene;
  scene.lights = random_cluster_lights(options.light_count, random);
  for (uint32_t i = 0; i < options.distant_count; ++i) {
    scene.lights.insert(scene.lights.begin() + random.below(options.light_count + 1),
                        random_distant(random));
  }
  for (uint32_t i = 0; i < options.group_count; ++i) {
    LightScene::Group group{};
    group.lights = random_cluster_lights(options.lights_per_group, random);
    check(kiwami_light_instance_desc_init(&group.instance, sizeof group.instance));
    random_transform(group.instance.local_to_world, random);
    group.instance.power_scale = 0.25f + random.unit();
    scene.groups.push_back(group);
  }
  if (options.has_link_masks) {
    const auto some_bits = [&] { return uint64_t{1} << random.below(6) | uint64_t{1} << 40; };
    const auto none_or_some = [&] {
      return random.one_in(16) ? 0 : some_bits() & ~(random.one_in(2) ? uint64_t{1} << 40 : 0);
    };
    for (kiwami_light& light : scene.lights) light.link_mask = none_or_some();
    for (LightScene::Group& group : scene.groups) {
      group.instance.link_mask = random.one_in(2) ? ~uint64_t{0} : some_bits();
      for (kiwami_light& light : group.lights) light.link_mask = none_or_some();
    }
  }
  return scene;
}

LightTreeHandle make_light_tree(kiwami_device* device, const LightScene& scene, uint32_t width,
                                uint32_t builder) {
  kiwami_light_tree_desc desc;
  check(kiwami_light_tree_desc_init(&desc, sizeof desc));
  desc.width = width;
  desc.builder = builder;
  desc.flags = KIWAMI_LIGHT_TREE_WITH_ROULETTE;
  const auto create = [&](const std::vector<kiwami_light>& lights) {
    kiwami_light_tree* tree = nullptr;
    check(kiwami_light_tree_create(device, &desc, &tree));
    LightTreeHandle handle(tree);
    check(kiwami_light_tree_add_lights(tree, lights.data(), 0, lights.size(), nullptr));
    return handle;
  };
  LightTreeHandle tree = create(scene.lights);
  for (const LightScene::Group& group : scene.groups) {
    const LightTreeHandle inner = create(group.lights);
    check(kiwami_light_tree_commit(inner.get()));
    kiwami_light_instance_desc instance = group.instance;
    instance.tree = inner.get();
    check(kiwami_light_tree_add_instance(tree.get(), &instance, nullptr));
  }
  check(kiwami_light_tree_commit(tree.get()));
  return tree;
}

kiwami_light_receiver random_receiver(const LightScene& scene, Random& random) {
  kiwami_light_receiver receiver{};
  receiver.link_mask = ~uint64_t{0};
  Vector position = random_unit(random) * (5.0 * static_cast<double>(random.unit()));
  Vector normal = random_unit(random) * 2.0;
  const uint32_t kind = random.below(8);
  if (kind < 3 && !scene.lights.empty()) {
    const auto count = static_cast<uint32_t>(scene.lights.size());
    const kiwami_light& light = scene.lights[random.below(count)];
    const Vector p0 = point_of(light, 0), p1 = point_of(light, 1);
    position = kind == 0 ? p0 : p0 + (p1 - p0) * static_cast<double>(random.unit());
    // On the light and facing as it does, on its plane, or anyhow.
    if (kind == 1) normal = cross(p1 - p0, point_of(light, 2) - p0);
  } else if (kind == 3) {
    position = random_unit(random) * std::exp2(3.0 + 20.0 * static_cast<double>(random.unit()));
  }
  put(position, receiver.position);
  if (!random.one_in(5)) put(normal, receiver.normal);
  if (random.one_in(5)) receiver.flags = KIWAMI_RECEIVER_BOTH_SIDES;
  if (random.one_in(5)) {
    put(random_unit(random) * (8.0 * static_cast<double>(random.unit())), receiver.segment);
  }
  receiver.random = static_cast<double>(random.bits()) * 0x1p-32;
  return receiver;
}

double contribution(const SeenLight& seen, const kiwami_light_receiver& receiver) {
  if ((seen.link_mask & receiver.link_mask) == 0) return 0.0;
  const Vector start = vector_of(receiver.position), along = vector_of(receiver.segment);
  if (length(along) > 0.0) {
    double sum = 0.0;
    constexpr int kSteps = 8;
    for (int i = 0; i <= kSteps; ++i) {
      sum += contribution_to_point(seen, receiver,
                                   start + along * (static_cast<double>(i) / kSteps), false);
    }
    return sum / (kSteps + 1);
  }
  return contribution_to_point(seen, receiver, start, length(vector_of(receiver.normal)) > 0.0);
}

}  // namespace kiwami_tests

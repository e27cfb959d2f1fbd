// SPDX-License-Identifier: Apache-2.0
#include "measure/bench_rays.h"

#include <array>
#include <cmath>
#include <limits>

namespace kiwami::tools {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr uint64_t kSeed = 1;
constexpr float kOcclusionReach = 0.2f;  // of the diagonal

using Surfaces = std::vector<Surface>;

Vec3 random_point(const Box& box, Random& random) {
  const float x = random.uniform(box.low.x, box.high.x);
  const float y = random.uniform(box.low.y, box.high.y);
  const float z = random.uniform(box.low.z, box.high.z);
  return {x, y, z};
}

Surfaces first_surfaces(const Tracer& tracer, const std::vector<kiwami_ray>& rays) {
  std::vector<kiwami_hit> hits(rays.size());
  tracer.closest_hits(rays, hits);
  Surfaces surfaces;
  for (size_t i = 0; i < rays.size(); ++i) {
    if (is_hit(hits[i])) surfaces.push_back(surface_of(rays[i], hits[i]));
  }
  return surfaces;
}

std::vector<kiwami_ray> scattered(const Surfaces& surfaces, size_t count, float reach,
                                  uint64_t stream) {
  Random random(kSeed, stream);
  std::vector<kiwami_ray> rays;
  rays.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const Surface& surface = surfaces[i % surfaces.size()];
    rays.push_back(make_ray(surface.point, cosine_direction(surface.normal, random), 0.0f, reach));
  }
  return rays;
}

void shuffle(std::vector<kiwami_ray>& rays) {
  Random random(kSeed, 13);
  for (size_t i = rays.size(); i > 1; --i) {
    std::swap(rays[i - 1], rays[random.below(static_cast<uint32_t>(i))]);
  }
}

std::vector<kiwami_ray> towards_lights(const Surfaces& surfaces, const Box& box, size_t count) {
  Random random(kSeed, 14);
  std::array<Vec3, 16> lights;
  for (Vec3& light : lights) light = random_point(box, random);
  std::vector<kiwami_ray> rays;
  rays.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const Vec3 origin = surfaces[i % surfaces.size()].point;
    const Vec3 direction = lights[random.below(lights.size())] - origin;
    // A direction of its full length: the light is at t = 1.
    rays.push_back(make_ray(origin, direction, 0.0f, 1.0f));
  }
  return rays;
}

std::vector<kiwami_ray> anywhere(const Box& box, size_t count) {
  Random random(kSeed, 15);
  std::vector<kiwami_ray> rays;
  rays.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const Vec3 origin = random_point(box, random);
    rays.push_back(make_ray(origin, uniform_direction(random), 0.0f, kInfinity));
  }
  return rays;
}

}  // namespace

const std::vector<std::string>& bench_ray_names() {
  static const std::vector<std::string> kNames = {"primary", "bounce", "bounce_shuffled",
                                                  "ao",      "shadow", "random"};
  return kNames;
}

std::vector<BenchRays> make_bench_rays(const Tracer& tracer, const View& view, const Box& box,
                                       const std::vector<std::string>& names, size_t count) {
  const auto side = static_cast<uint32_t>(std::sqrt(static_cast<double>(count)));
  const RaySet primary = primary_rays(Camera(view, side, side));
  const Surfaces surfaces = first_surfaces(tracer, primary.rays);
  std::vector<BenchRays> sets;
  for (const std::string& name : names) {
    if (surfaces.empty() && name != "primary" && name != "random") {
      throw SceneError("the camera sees nothing from which '" + name + "' rays could start");
    }
    RaySet set{name, {}};
    if (name == "primary") set.rays = primary.rays;
    if (name.starts_with("bounce")) set.rays = scattered(surfaces, count, kInfinity, 11);
    if (name == "bounce_shuffled") shuffle(set.rays);
    if (name == "ao") set.rays = scattered(surfaces, count, kOcclusionReach * box.diagonal(), 12);
    if (name == "shadow") set.rays = towards_lights(surfaces, box, count);
    if (name == "random") set.rays = anywhere(box, count);
    sets.push_back({std::move(set), name == "ao" || name == "shadow"});
  }
  return sets;
}

}  // namespace kiwami::tools

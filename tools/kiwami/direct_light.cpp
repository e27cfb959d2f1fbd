// SPDX-License-Identifier: Apache-2.0
#include "kiwami/direct_light.h"

#include <algorithm>
#include <cmath>

#include "measure/contest.h"
#include "measure/ray_sets.h"

namespace kiwami::tools {
namespace {

constexpr float kAlbedoOverPi = 0.7f / 3.14159265f;
constexpr float kMiddleGrey = 0.3f;

/// A point of a triangle, uniformly, from two random numbers: R. Osada, T. Funkhouser, B. Chazelle,
/// D. Dobkin, "Shape Distributions", TOG 21(4), 2002.
Vec3 point_on(const EmissiveTriangle& triangle, float first, float second) {
  const float root = std::sqrt(first);
  return triangle.corner + triangle.u * (root * (1.0f - second)) + triangle.v * (root * second);
}

}  // namespace

DirectLight::DirectLight(const Device& device, const SceneFile& file, double share,
                         const LightMethodName& method, uint32_t width, double roughness)
    : triangles_(choose_emissive(file, share)),
      method_(method),
      set_(device, triangles_, width, method.is_roulette()),
      roughness_(static_cast<float>(roughness)) {}

float DirectLight::radiance_of(const kiwami_hit& hit) const {
  const auto place = std::lower_bound(
      triangles_.begin(), triangles_.end(), hit,
      [](const EmissiveTriangle& triangle, const kiwami_hit& sought) {
        return triangle.mesh != sought.geometry_id ? triangle.mesh < sought.geometry_id
                                                   : triangle.number < sought.primitive_id;
      });
  const bool shines = place != triangles_.end() && place->mesh == hit.geometry_id &&
                      place->number == hit.primitive_id;
  return shines ? place->radiance : 0.0f;
}

void DirectLight::choose_targets(std::span<const kiwami_light_receiver> receivers,
                                 std::span<const GlossySurface> surfaces,
                                 std::span<const size_t> sources, SampleBatch& batch,
                                 std::vector<kiwami_ray>& rays, std::vector<size_t>& targets,
                                 std::vector<float>& amounts) const {
  std::vector<kiwami_light_choice> choices(receivers.size() * method_.max_choices);
  std::vector<kiwami_light_lobe> lobes;
  for (const GlossySurface& surface : surfaces) lobes.push_back(surface.lobe());
  std::vector<kiwami_light_pixel> pixels;
  for (const size_t source : sources) pixels.push_back(batch.pixels[source]);
  set_.sample(method_, receivers, {lobes, pixels}, choices);
  for (size_t i = 0; i < receivers.size(); ++i) {
    const Vec3 at{receivers[i].position[0], receivers[i].position[1], receivers[i].position[2]};
    const Vec3 normal{receivers[i].normal[0], receivers[i].normal[1], receivers[i].normal[2]};
    for (uint32_t k = 0; k < method_.max_choices; ++k) {
      const kiwami_light_choice& choice = choices[i * method_.max_choices + k];
      if (choice.light_id == KIWAMI_INVALID_ID) break;
      const EmissiveTriangle& light = triangles_[choice.light_id];
      const Vec3 target =
          point_on(light, static_cast<float>(choice.random), batch.randoms[sources[i]].uniform());
      const float sent = surfaces.empty()
                             ? kAlbedoOverPi * light.arriving(target, at, normal)
                             : light.sent(target, at) * surfaces[i].reflected(target - at);
      const float amount = light.area * sent / choice.probability;
      if (!(amount > 0.0f)) continue;
      // Short of the light, which would be in its own way.
      rays.push_back(make_ray(at, target - at, 0.0f, 0.999f));
      targets.push_back(sources[i]);
      amounts.push_back(amount);
    }
  }
}

void DirectLight::shade(Tracing& tracing, SampleBatch& batch) const {
  std::vector<kiwami_hit> hits(batch.rays.size());
  tracing.closest_hits(batch.rays, hits);
  std::vector<kiwami_light_receiver> receivers;
  std::vector<GlossySurface> surfaces;
  std::vector<size_t> sources;
  for (size_t i = 0; i < hits.size(); ++i) {
    batch.colors[i] = Vec3{0, 0, 0};
    if (!is_hit(hits[i])) continue;
    const float own = exposure_ * radiance_of(hits[i]);
    batch.colors[i] = Vec3{own, own, own};
    const Surface surface = surface_of(batch.rays[i], hits[i]);
    Random& random = batch.randoms[i];
    const double number = (static_cast<double>(random.next()) + random.uniform()) * 0x1p-32;
    receivers.push_back(receiver_at(surface.point, surface.normal, number));
    if (roughness_ > 0.0f) {
      const Vec3 way{batch.rays[i].direction_x, batch.rays[i].direction_y,
                     batch.rays[i].direction_z};
      surfaces.push_back({surface.normal, way * (-1.0f / length(way)), roughness_});
    }
    sources.push_back(i);
  }
  std::vector<kiwami_ray> rays;
  std::vector<size_t> targets;
  std::vector<float> amounts;
  choose_targets(receivers, surfaces, sources, batch, rays, targets, amounts);
  std::vector<uint8_t> occluded(rays.size());
  tracing.any_hits(rays, occluded);
  for (size_t k = 0; k < rays.size(); ++k) {
    if (occluded[k] == 0) {
      const float amount = exposure_ * amounts[k];
      batch.colors[targets[k]] = batch.colors[targets[k]] + Vec3{amount, amount, amount};
    }
  }
}

void DirectLight::expose(Tracing& tracing, const Camera& camera) {
  SampleBatch batch(size_t{camera.width()} * camera.height());
  batch.rays = primary_rays(camera).rays;
  for (size_t i = 0; i < batch.randoms.size(); ++i) batch.randoms[i] = Random(i, 95);
  std::vector<double> sums(batch.rays.size(), 0.0);
  const uint32_t samples = std::max(1u, 16 / method_.max_choices);
  for (uint32_t sample = 0; sample < samples; ++sample) {
    for (size_t i = 0; i < batch.pixels.size(); ++i) {
      const auto pixel = static_cast<uint32_t>(i);
      batch.pixels[i] = {pixel % camera.width(), pixel / camera.width(), sample};
    }
    shade(tracing, batch);
    for (size_t i = 0; i < sums.size(); ++i) {
      sums[i] += static_cast<double>(batch.colors[i].x) / samples;
    }
  }
  std::erase_if(sums, [](double sum) { return !(sum > 0.0); });
  if (!sums.empty()) exposure_ = kMiddleGrey / static_cast<float>(median(sums));
}

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#include "kiwami/path_tracer.h"

#include <algorithm>
#include <limits>

#include "kiwami/parallel_ranges.h"
#include "measure/ray_sets.h"

namespace kiwami::tools {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Vec3 kSunRadiance = {2.4f, 2.2f,
                               1.9f};  // already divided by pi and times its solid angle
constexpr Vec3 kZenith = {0.20f, 0.32f, 0.58f};
constexpr Vec3 kHorizon = {0.55f, 0.60f, 0.66f};

Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// A sky above, light ground below, and where the sun stands.
struct Sky {
  Vec3 up;
  Vec3 sun;

  explicit Sky(Vec3 upwards) : up(normalize(upwards)) {
    const Vec3 aside = normalize(cross(up, up.x * up.x > 0.5f ? Vec3{0, 1, 0} : Vec3{1, 0, 0}));
    sun = normalize(up * 0.8f + aside * 0.45f + cross(aside, up) * -0.5f);
  }

  Vec3 radiance(Vec3 direction) const {
    const float height = dot(direction, up);
    if (height < 0.0f) return kHorizon * 0.5f;
    return kHorizon + (kZenith - kHorizon) * height;
  }
};

/// Meshes are told apart by pale colours of their own.
Vec3 albedo_of(uint32_t geometry_id) {
  Random random(geometry_id, 77);
  const float red = random.uniform(0.58f, 0.74f);
  const float green = random.uniform(0.58f, 0.74f);
  const float blue = random.uniform(0.58f, 0.74f);
  return {red, green, blue};
}

/// Paths of a batch, from one bounce to the next.
class Wavefront {
 public:
  Wavefront(Tracing& tracing, const RenderSettings& settings, SampleBatch& batch)
      : tracing_(tracing),
        settings_(settings),
        batch_(batch),
        sky_(settings.up),
        rays_(batch.rays),
        throughput_(batch.rays.size(), Vec3{1, 1, 1}) {
    for (size_t i = 0; i < rays_.size(); ++i) active_.push_back(i);
    std::fill(batch.colors.begin(), batch.colors.end(), Vec3{0, 0, 0});
  }

  void run() {
    for (uint32_t bounce = 0; bounce <= settings_.bounces && !active_.empty(); ++bounce) {
      hits_.resize(rays_.size());
      tracing_.closest_hits(rays_, hits_);
      collect_sky();
      if (bounce == settings_.bounces) return;
      scatter();
      collect_sun();
    }
  }

 private:
  /// Paths that leave the scene end in the sky; the others are moved together.
  void collect_sky() {
    size_t kept = 0;
    for (size_t k = 0; k < active_.size(); ++k) {
      const size_t i = active_[k];
      if (!is_hit(hits_[k])) {
        const kiwami_ray& ray = rays_[k];
        const Vec3 direction{ray.direction_x, ray.direction_y, ray.direction_z};
        batch_.colors[i] = batch_.colors[i] + times(throughput_[i], sky_.radiance(direction));
        continue;
      }
      active_[kept] = i;
      rays_[kept] = rays_[k];
      hits_[kept] = hits_[k];
      ++kept;
    }
    active_.resize(kept);
    rays_.resize(kept);
    hits_.resize(kept);
  }

  /// Each hit gets a shadow ray to the sun and the next ray of its path.
  void scatter() {
    shadow_rays_.resize(active_.size());
    sun_cosines_.resize(active_.size());
    parallel_ranges(settings_.threads, active_.size(), [&](size_t first, size_t last) {
      for (size_t k = first; k < last; ++k) {
        const size_t i = active_[k];
        const Surface surface = surface_of(rays_[k], hits_[k]);
        throughput_[i] = times(throughput_[i], albedo_of(hits_[k].geometry_id));
        sun_cosines_[k] = dot(surface.normal, sky_.sun);
        // A ray whose tmin is beyond its tmax is a miss: no light would come from behind anyway.
        const float tmax = sun_cosines_[k] > 0.0f ? kInfinity : -1.0f;
        shadow_rays_[k] = make_ray(surface.point, sky_.sun, 0.0f, tmax, rays_[k].time);
        const Vec3 direction = cosine_direction(surface.normal, batch_.randoms[i]);
        rays_[k] = make_ray(surface.point, direction, 0.0f, kInfinity, rays_[k].time);
      }
    });
  }

  void collect_sun() {
    occluded_.resize(shadow_rays_.size());
    tracing_.any_hits(shadow_rays_, occluded_);
    for (size_t k = 0; k < active_.size(); ++k) {
      if (occluded_[k] != 0 || !(sun_cosines_[k] > 0.0f)) continue;
      const size_t i = active_[k];
      batch_.colors[i] = batch_.colors[i] + times(throughput_[i], kSunRadiance) * sun_cosines_[k];
    }
  }

  Tracing& tracing_;
  const RenderSettings& settings_;
  SampleBatch& batch_;
  Sky sky_;
  std::vector<size_t> active_;  ///< the sample that ray k belongs to
  std::vector<kiwami_ray> rays_;
  std::vector<kiwami_hit> hits_;
  std::vector<kiwami_ray> shadow_rays_;
  std::vector<float> sun_cosines_;
  std::vector<uint8_t> occluded_;
  std::vector<Vec3> throughput_;  ///< by sample
};

}  // namespace

void trace_paths(Tracing& tracing, const RenderSettings& settings, SampleBatch& batch) {
  Wavefront(tracing, settings, batch).run();
}

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#include "kiwami/renderer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "kiwami/direct_light.h"
#include "kiwami/parallel_ranges.h"
#include "kiwami/path_tracer.h"
#include "measure/ray_sets.h"

namespace kiwami::tools {
namespace {

constexpr size_t kBatchPixels = size_t{1} << 16;
constexpr Vec3 kBackground = {0.82f, 0.88f, 0.95f};

/// Spreads the bits of its argument, so that neighbouring pixels get unrelated random numbers
/// (SplitMix64: G. L. Steele, D. Lea, C. H. Flood, "Fast Splittable Pseudorandom Number
/// Generators", OOPSLA 2014).
uint64_t mix(uint64_t x) {
  x += 0x9E3779B97F4A7C15u;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

/// The camera rays of sample `sample` of the pixels from `first_pixel` on.
void start_samples(const Camera& camera, size_t first_pixel, uint32_t sample,
                   const RenderSettings& settings, SampleBatch& batch) {
  const float open = settings.shutter_open, width = settings.shutter_close - open;
  parallel_ranges(settings.threads, batch.rays.size(), [&](size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      const size_t pixel = first_pixel + i;
      Random random(mix(uint64_t{pixel} << 32 | sample));
      const float x = static_cast<float>(pixel % camera.width()) + random.uniform();
      const float y = static_cast<float>(pixel / camera.width()) + random.uniform();
      batch.rays[i] = camera.ray(x, y);
      batch.rays[i].time = width > 0.0f ? open + width * random.uniform() : open;
      batch.randoms[i] = random;
      batch.pixels[i] = {static_cast<uint32_t>(pixel % camera.width()),
                         static_cast<uint32_t>(pixel / camera.width()), sample};
    }
  });
}

void shade_normals(Tracing& tracing, size_t threads, SampleBatch& batch) {
  std::vector<kiwami_hit> hits(batch.rays.size());
  tracing.closest_hits(batch.rays, hits);
  parallel_ranges(threads, hits.size(), [&](size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      const Vec3 normal = is_hit(hits[i]) ? surface_of(batch.rays[i], hits[i]).normal : Vec3{};
      batch.colors[i] = is_hit(hits[i]) ? normal * 0.5f + Vec3{0.5f, 0.5f, 0.5f} : kBackground;
    }
  });
}

void shade_occlusion(Tracing& tracing, const RenderSettings& settings, SampleBatch& batch) {
  const size_t count = batch.rays.size();
  std::vector<kiwami_hit> hits(count);
  tracing.closest_hits(batch.rays, hits);
  std::vector<size_t> sources;
  for (size_t i = 0; i < count; ++i) {
    batch.colors[i] = kBackground;
    if (is_hit(hits[i])) sources.push_back(i);
  }
  std::vector<kiwami_ray> rays(sources.size());
  parallel_ranges(settings.threads, sources.size(), [&](size_t first, size_t last) {
    for (size_t k = first; k < last; ++k) {
      const size_t i = sources[k];
      const Surface surface = surface_of(batch.rays[i], hits[i]);
      rays[k] = make_ray(surface.point, cosine_direction(surface.normal, batch.randoms[i]), 0.0f,
                         settings.occlusion_radius, batch.rays[i].time);
    }
  });
  std::vector<uint8_t> occluded(rays.size());
  tracing.any_hits(rays, occluded);
  for (size_t k = 0; k < sources.size(); ++k) {
    batch.colors[sources[k]] = occluded[k] != 0 ? Vec3{0, 0, 0} : Vec3{1, 1, 1};
  }
}

void shade(Tracing& tracing, const RenderSettings& settings, SampleBatch& batch) {
  switch (settings.mode) {
    case RenderMode::kNormals:
      return shade_normals(tracing, settings.threads, batch);
    case RenderMode::kAmbientOcclusion:
      return shade_occlusion(tracing, settings, batch);
    case RenderMode::kPath:
      return trace_paths(tracing, settings, batch);
    case RenderMode::kDirectLight:
      return settings.direct_light->shade(tracing, batch);
  }
}

/// A byte for a display. The square root stands for the display's curve: unlike a power it is the
/// same to the bit in every mathematical library.
uint8_t to_byte(float linear) {
  // Written so that NaN becomes 0.
  const float clamped = linear > 0.0f ? std::min(linear, 1.0f) : 0.0f;
  return static_cast<uint8_t>(std::sqrt(clamped) * 255.0f + 0.5f);
}

/// Compresses light of any strength into 0 to 1; 2 becomes white (E. Reinhard, M. Stark, P.
/// Shirley, J. Ferwerda, "Photographic Tone Reproduction for Digital Images", SIGGRAPH 2002,
/// equation 4).
float compress(float linear) { return linear * (1.0f + linear * 0.25f) / (1.0f + linear); }

void write_pixels(const std::vector<Vec3>& sums, const RenderSettings& settings, uint8_t* bytes) {
  const float scale = 1.0f / static_cast<float>(settings.samples_per_pixel);
  const bool is_light =
      settings.mode == RenderMode::kPath || settings.mode == RenderMode::kDirectLight;
  for (const Vec3& sum : sums) {
    for (int channel = 0; channel < 3; ++channel) {
      const float linear = sum[channel] * scale;
      *bytes++ = to_byte(is_light ? compress(linear) : linear);
    }
  }
}

}  // namespace

void Tracing::closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) {
  const auto start = std::chrono::steady_clock::now();
  scene_.closest_hits(rays, hits);
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ray_count_ += rays.size();
}

void Tracing::any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) {
  const auto start = std::chrono::steady_clock::now();
  scene_.any_hits(rays, occluded);
  seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  ray_count_ += rays.size();
}

Image render(Tracing& tracing, const Camera& camera, const RenderSettings& settings,
             const RenderProgress& progress) {
  const size_t pixel_count = size_t{camera.width()} * camera.height();
  Image image{camera.width(), camera.height(), std::vector<uint8_t>(pixel_count * 3)};
  uint64_t samples_done = 0;
  for (size_t first = 0; first < pixel_count; first += kBatchPixels) {
    SampleBatch batch(std::min(kBatchPixels, pixel_count - first));
    const size_t count = batch.rays.size();
    std::vector<Vec3> sums(count, Vec3{0, 0, 0});
    for (uint32_t sample = 0; sample < settings.samples_per_pixel; ++sample) {
      start_samples(camera, first, sample, settings, batch);
      shade(tracing, settings, batch);
      for (size_t i = 0; i < count; ++i) sums[i] = sums[i] + batch.colors[i];
      samples_done += count;
      progress(samples_done, tracing.ray_count());
    }
    write_pixels(sums, settings, &image.pixels[first * 3]);
  }
  return image;
}

}  // namespace kiwami::tools

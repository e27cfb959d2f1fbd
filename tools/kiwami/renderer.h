// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "kiwami/image.h"
#include "measure/camera.h"
#include "measure/library.h"
#include "scene/random.h"

namespace kiwami::tools {

enum class RenderMode { kNormals, kAmbientOcclusion, kPath, kDirectLight };

class DirectLight;

struct RenderSettings {
  RenderMode mode = RenderMode::kPath;
  uint32_t samples_per_pixel = 16;
  uint32_t bounces = 4;                             ///< of a path, at least 1
  float occlusion_radius = 1.0f;                    ///< how far ambient occlusion looks
  Vec3 up = {0, 1, 0};                              ///< where the sky is
  const DirectLight* direct_light = nullptr;        ///< of that mode
  uint32_t threads = 1;                             ///< for shading; the scene's device has its own
  float shutter_open = 0.0f, shutter_close = 0.0f;  ///< times of samples; equal: one time
};

/// One sample of each pixel of a batch.
struct SampleBatch {
  std::vector<kiwami_ray> rays;
  std::vector<Random> randoms;
  std::vector<Vec3> colors;
  std::vector<kiwami_light_pixel> pixels;  ///< of which picture's samples they are

  explicit SampleBatch(size_t size)
      : rays(size), randoms(size, Random(0)), colors(size, Vec3{0, 0, 0}), pixels(size) {}
};

/// Traces batches and counts what that took.
class Tracing {
 public:
  explicit Tracing(const BuiltScene& scene) : scene_(scene) {}

  void closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits);
  void any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded);

  uint64_t ray_count() const { return ray_count_; }
  double seconds() const { return seconds_; }

 private:
  const BuiltScene& scene_;
  uint64_t ray_count_ = 0;
  double seconds_ = 0.0;
};

/// Called with the samples done, of all pixels, and the rays traced.
using RenderProgress = std::function<void(uint64_t samples, uint64_t rays)>;

/// Renders a picture. Random numbers depend on the pixel and the sample alone, and a pixel's
/// samples are added in order: the picture is the same on every ISA, node width and thread count.
Image render(Tracing& tracing, const Camera& camera, const RenderSettings& settings,
             const RenderProgress& progress);

}  // namespace kiwami::tools

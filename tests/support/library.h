// SPDX-License-Identifier: Apache-2.0
// The public C API behind RAII: errors become exceptions.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kiwami/kiwami.h"
#include "support/mesh.h"

namespace kiwami_tests {

struct Release {
  void operator()(kiwami_device* device) const { kiwami_device_release(device); }
  void operator()(kiwami_geometry* geometry) const { kiwami_geometry_release(geometry); }
  void operator()(kiwami_scene* scene) const { kiwami_scene_release(scene); }
};
using DeviceHandle = std::unique_ptr<kiwami_device, Release>;
using SceneHandle = std::unique_ptr<kiwami_scene, Release>;

/// Throws std::runtime_error with the library's own sentence unless result is KIWAMI_OK.
void check(kiwami_result result);

/// thread_count 0: one per processor.
DeviceHandle make_device(uint32_t isa, uint32_t thread_count);

kiwami_device_info info_of(const kiwami_device* device);
kiwami_scene_info info_of(const kiwami_scene* scene);

/// The ISAs that can run here, scalar first.
std::vector<uint32_t> available_isas();

struct BuildOptions {
  uint32_t width = 0;  ///< 0: the device's default
  bool merges_leaves = true;
  uint32_t max_leaf_size = 0;  ///< 0: one full leaf block
  bool validates = false;      ///< after each stage
  /// More of KIWAMI_PARAMETER_*, with their values.
  std::vector<std::pair<uint32_t, double>> parameters = {};
  /// KIWAMI_OPTIMIZER_* in place of those of the quality.
  std::optional<std::vector<uint32_t>> optimizers = {};
  std::vector<kiwami_ray> representative_rays = {};  ///< none: sampled ones
};

/// Mesh i of the scene becomes geometry i.
SceneHandle make_scene(kiwami_device* device, const Scene& scene, const BuildOptions& options);

std::vector<kiwami_hit> closest_hits(const kiwami_scene* scene,
                                     const std::vector<kiwami_ray>& rays);
/// By the call whose fields lie apart.
std::vector<kiwami_hit> closest_hits_by_fields(const kiwami_scene* scene,
                                               const std::vector<kiwami_ray>& rays);
std::vector<uint8_t> any_hits(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays);
std::vector<uint8_t> any_hits_by_fields(const kiwami_scene* scene,
                                        const std::vector<kiwami_ray>& rays);

}  // namespace kiwami_tests

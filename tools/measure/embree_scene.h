// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <embree3/rtcore.h>
#include <kiwami/kiwami.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// What an Embree scene is asked for.
struct EmbreeSettings {
  std::string config;  ///< the device's, such as "threads=1,isa=avx2"
  bool robust = false;
  RTCBuildQuality quality = RTC_BUILD_QUALITY_MEDIUM;
  bool has_filters = false;  ///< of intersection contexts
};

/// The configuration of a device with the instructions of one of KIWAMI_ISA_* and so many threads.
std::string embree_config(uint32_t isa, uint32_t threads);

/// Owns an Embree device and a committed scene whose geometry i is mesh i of the file; or, of a
/// file with instances, its instance i over a scene of its mesh.
class EmbreeScene {
 public:
  EmbreeScene(const SceneFile& file, const EmbreeSettings& settings);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  RTCScene get() const { return scene_; }
  double build_seconds() const { return build_seconds_; }
  /// What Embree holds for the scene, its copies of the buffers aside.
  uint64_t bytes() const;

 private:
  void build(const SceneFile& file, const EmbreeSettings& settings);
  RTCScene make_scene(const EmbreeSettings& settings);
  void attach(RTCScene scene, const Mesh& mesh, RTCBuildQuality quality);
  void attach(const Instance& instance, const float* moved_transform);
  void commit(RTCScene scene);
  void release();

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::vector<RTCScene> shown_;  ///< the scenes of instances
  std::atomic<int64_t> bytes_{0};
  double build_seconds_ = 0.0;
};

/// With Embree's mask of all ones: it is asked about geometry alone.
inline RTCRay to_embree(const kiwami_ray& ray) {
  return {ray.origin_x,
          ray.origin_y,
          ray.origin_z,
          ray.tmin,
          ray.direction_x,
          ray.direction_y,
          ray.direction_z,
          ray.time,
          ray.tmax,
          ~0u,
          0,
          0};
}

}  // namespace kiwami::tools

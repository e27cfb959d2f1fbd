// SPDX-License-Identifier: Apache-2.0
#include "measure/embree_scene.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <new>
#include <stdexcept>

namespace kiwami::tools {
namespace {

bool count_bytes(void* user, ssize_t bytes, bool) {
  static_cast<std::atomic<int64_t>*>(user)->fetch_add(bytes);
  return true;
}

void fill_buffer(RTCGeometry geometry, RTCBufferType type, unsigned slot, RTCFormat format,
                 const void* data, size_t element_bytes, size_t count) {
  if (count == 0) return;
  // Embree pads its own buffers, which its loads beyond the last vertex need.
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, slot, format, element_bytes, count);
  if (buffer == nullptr) throw std::bad_alloc();
  std::memcpy(buffer, data, element_bytes * count);
}

}  // namespace

std::string embree_config(uint32_t isa, uint32_t threads) {
  std::string config = "threads=" + std::to_string(threads);
  if (isa == KIWAMI_ISA_SCALAR) config += ",isa=sse2";
  if (isa == KIWAMI_ISA_SSE) config += ",isa=sse4.2";
  if (isa == KIWAMI_ISA_AVX2) config += ",isa=avx2";
  // Embree keeps to 256 bits by itself unless it is told that the clock may fall.
  if (isa == KIWAMI_ISA_AVX512) config += ",isa=avx512,frequency_level=simd512";
  return config;
}

EmbreeScene::EmbreeScene(const SceneFile& file, const EmbreeSettings& settings) {
  device_ = rtcNewDevice(settings.config.c_str());
  if (device_ == nullptr) {
    throw std::runtime_error("Embree cannot make a device of '" + settings.config + "'");
  }
  try {
    build(file, settings);
  } catch (...) {
    release();
    throw;
  }
}

void EmbreeScene::build(const SceneFile& file, const EmbreeSettings& settings) {
  scene_ = make_scene(settings);
  if (file.instances.empty()) {
    for (const Mesh& mesh : file.meshes) attach(scene_, mesh, settings.quality);
  } else {
    for (const Mesh& mesh : file.meshes) {
      shown_.push_back(make_scene(settings));
      attach(shown_.back(), mesh, settings.quality);
      commit(shown_.back());
    }
    for (size_t i = 0; i < file.instances.size(); ++i) {
      attach(file.instances[i],
             file.moved_transforms.empty() ? nullptr : file.moved_transforms[i].data());
    }
  }
  commit(scene_);
}

RTCScene EmbreeScene::make_scene(const EmbreeSettings& settings) {
  RTCScene scene = rtcNewScene(device_);
  rtcSetSceneBuildQuality(scene, settings.quality);
  const int flags = (settings.robust ? RTC_SCENE_FLAG_ROBUST : 0) |
                    (settings.has_filters ? RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION : 0);
  if (flags != 0) rtcSetSceneFlags(scene, static_cast<RTCSceneFlags>(flags));
  return scene;
}

EmbreeScene::~EmbreeScene() { release(); }

uint64_t EmbreeScene::bytes() const {
  return static_cast<uint64_t>(std::max<int64_t>(0, bytes_.load()));
}

void EmbreeScene::attach(RTCScene scene, const Mesh& mesh, RTCBuildQuality quality) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  // A scene of low quality takes the builder of each geometry from its own quality.
  rtcSetGeometryBuildQuality(geometry, quality);
  if (!mesh.moved.empty()) rtcSetGeometryTimeStepCount(geometry, 2);
  fill_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(), 12,
              mesh.vertex_count());
  fill_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, 1, RTC_FORMAT_FLOAT3, mesh.moved.data(), 12,
              mesh.moved.size() / 3);
  fill_buffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.indices.data(), 12,
              mesh.triangle_count());
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

void EmbreeScene::attach(const Instance& instance, const float* moved_transform) {
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, shown_[instance.mesh]);
  if (moved_transform != nullptr) rtcSetGeometryTimeStepCount(geometry, 2);
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, instance.transform.data());
  if (moved_transform != nullptr) {
    rtcSetGeometryTransform(geometry, 1, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, moved_transform);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
}

void EmbreeScene::commit(RTCScene scene) {
  rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
  const auto start = std::chrono::steady_clock::now();
  rtcCommitScene(scene);
  build_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  rtcSetDeviceMemoryMonitorFunction(device_, nullptr, nullptr);
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) {
    throw std::runtime_error("Embree cannot build the scene");
  }
}

void EmbreeScene::release() {
  rtcReleaseScene(scene_);
  for (RTCScene scene : shown_) rtcReleaseScene(scene);
  rtcReleaseDevice(device_);
}

}  // namespace kiwami::tools

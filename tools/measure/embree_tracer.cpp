// SPDX-License-Identifier: Apache-2.0
#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>

#include "measure/tracer.h"

namespace kiwami::tools {
namespace {

bool count_bytes(void* user, ssize_t bytes, bool) {
  static_cast<std::atomic<int64_t>*>(user)->fetch_add(bytes);
  return true;
}

void fill_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, const void* data,
                 size_t element_bytes, size_t count) {
  if (count == 0) return;
  // Embree pads its own buffers, which its loads beyond the last vertex need.
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, element_bytes, count);
  if (buffer == nullptr) throw std::bad_alloc();
  std::memcpy(buffer, data, element_bytes * count);
}

class Embree3Tracer final : public EmbreeTracer {
 public:
  Embree3Tracer(const SceneFile& file, bool robust) {
    device_ = rtcNewDevice("threads=1");
    if (device_ == nullptr) throw std::runtime_error("Embree cannot make a device");
    scene_ = rtcNewScene(device_);
    if (robust) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    for (const Mesh& mesh : file.meshes) attach(mesh);
    rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
    const auto start = std::chrono::steady_clock::now();
    rtcCommitScene(scene_);
    build_seconds_ =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) {
      throw std::runtime_error("Embree cannot build the scene");
    }
  }
  ~Embree3Tracer() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  double build_seconds() const override { return build_seconds_; }
  uint64_t bytes() const override {
    return static_cast<uint64_t>(std::max<int64_t>(0, bytes_.load()));
  }

  void closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < rays.size(); ++i) hits[i] = closest_hit(context, rays[i]);
  }

 private:
  void attach(const Mesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    fill_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, mesh.vertices.data(), 12,
                mesh.vertex_count());
    fill_buffer(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, mesh.indices.data(), 12,
                mesh.triangle_count());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
  }

  kiwami_hit closest_hit(RTCIntersectContext& context, const kiwami_ray& ray) const {
    RTCRayHit query;
    query.ray = {ray.origin_x,
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
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.primID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
      return {std::numeric_limits<float>::infinity(),
              0,
              0,
              0,
              0,
              0,
              KIWAMI_INVALID_ID,
              KIWAMI_INVALID_ID,
              KIWAMI_INVALID_ID};
    }
    return {query.ray.tfar, query.hit.u,      query.hit.v,      query.hit.Ng_x,   query.hit.Ng_y,
            query.hit.Ng_z, query.hit.primID, query.hit.geomID, KIWAMI_INVALID_ID};
  }

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::atomic<int64_t> bytes_{0};
  double build_seconds_ = 0.0;
};

}  // namespace

std::unique_ptr<EmbreeTracer> EmbreeTracer::create(const SceneFile& file, bool robust) {
  return std::make_unique<Embree3Tracer>(file, robust);
}

const char* embree_version() { return RTC_VERSION_STRING; }

}  // namespace kiwami::tools

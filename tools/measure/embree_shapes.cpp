// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <new>
#include <stdexcept>

#include "measure/embree_scene.h"
#include "measure/shape_scene.h"

namespace kiwami::tools {
namespace {

RTCGeometryType type_of(CloudKind kind) {
  switch (kind) {
    case CloudKind::kSpheres:
      return RTC_GEOMETRY_TYPE_SPHERE_POINT;
    case CloudKind::kDiscs:
      return RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT;
    case CloudKind::kCurves:
      break;
  }
  return RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE;
}

void fill_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, const void* data,
                 size_t element_bytes, size_t count) {
  if (count == 0) return;
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, element_bytes, count);
  if (buffer == nullptr) throw std::bad_alloc();
  std::memcpy(buffer, data, element_bytes * count);
}

class Embree3Shapes final : public EmbreeShapes {
 public:
  Embree3Shapes(const ShapeCloud& cloud, uint32_t isa)
      : device_(rtcNewDevice(embree_config(isa, 1).c_str())), scene_(rtcNewScene(device_)) {
    RTCGeometry geometry = rtcNewGeometry(device_, type_of(cloud.kind));
    fill_buffer(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, cloud.points.data(), 16,
                cloud.points.size() / 4);
    if (cloud.kind == CloudKind::kDiscs) {
      fill_buffer(geometry, RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, cloud.normals.data(), 12,
                  cloud.count());
    }
    if (cloud.kind == CloudKind::kCurves) {
      fill_buffer(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT, cloud.indices.data(), 4,
                  cloud.count());
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) {
      release();
      throw std::runtime_error("Embree cannot build the scene of shapes");
    }
  }
  ~Embree3Shapes() override { release(); }

  void closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < rays.size(); ++i) {
      RTCRayHit query;
      query.ray = to_embree(rays[i]);
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene_, &context, &query);
      const bool is_hit = query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
      hits[i] = {is_hit ? query.ray.tfar : __builtin_inff(),
                 query.hit.u,
                 query.hit.v,
                 query.hit.Ng_x,
                 query.hit.Ng_y,
                 query.hit.Ng_z,
                 is_hit ? query.hit.primID : KIWAMI_INVALID_ID,
                 query.hit.geomID,
                 KIWAMI_INVALID_ID};
    }
  }

  void any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < rays.size(); ++i) {
      RTCRay ray = to_embree(rays[i]);
      rtcOccluded1(scene_, &context, &ray);
      occluded[i] = ray.tfar < 0.0f ? 1 : 0;
    }
  }

 private:
  void release() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

std::unique_ptr<EmbreeShapes> EmbreeShapes::create(const ShapeCloud& cloud, uint32_t isa) {
  return std::make_unique<Embree3Shapes>(cloud, isa);
}

}  // namespace kiwami::tools

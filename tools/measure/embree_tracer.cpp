// SPDX-License-Identifier: Apache-2.0
#include "measure/tracer.h"

#include <limits>

#include "measure/embree_scene.h"

namespace kiwami::tools {
namespace {

class Embree3Tracer final : public EmbreeTracer {
 public:
  Embree3Tracer(const SceneFile& file, bool robust) : scene_(file, {"threads=1", robust}) {}

  double build_seconds() const override { return scene_.build_seconds(); }
  uint64_t bytes() const override { return scene_.bytes(); }

  void closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < rays.size(); ++i) hits[i] = closest_hit(context, rays[i]);
  }

 private:
  kiwami_hit closest_hit(RTCIntersectContext& context, const kiwami_ray& ray) const {
    RTCRayHit query;
    query.ray = to_embree(ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.primID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_.get(), &context, &query);
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
    return {query.ray.tfar, query.hit.u,      query.hit.v,      query.hit.Ng_x,     query.hit.Ng_y,
            query.hit.Ng_z, query.hit.primID, query.hit.geomID, query.hit.instID[0]};
  }

  EmbreeScene scene_;
};

}  // namespace

std::unique_ptr<EmbreeTracer> EmbreeTracer::create(const SceneFile& file, bool robust) {
  return std::make_unique<Embree3Tracer>(file, robust);
}

const char* embree_version() { return RTC_VERSION_STRING; }

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#include "measure/embree_contender.h"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <vector>

#include "measure/embree_scene.h"
#include "measure/parallel_blocks.h"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace kiwami::tools {
namespace {

constexpr size_t kRaysPerBlock = 4096;

/// Embree's manual asks for denormals to be flushed in each thread that traces.
class FlushedDenormals {
 public:
#if defined(__SSE__)
  FlushedDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }
  ~FlushedDenormals() { _mm_setcsr(saved_); }
#else
  FlushedDenormals() {}
  ~FlushedDenormals() {}
#endif
  FlushedDenormals(const FlushedDenormals&) = delete;
  FlushedDenormals& operator=(const FlushedDenormals&) = delete;

#if defined(__SSE__)
 private:
  unsigned saved_;
#endif
};

RTCIntersectContext make_context(bool coherent) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

/// Fills lane `lane` of a packet of rays.
template <typename Packet>
void set_lane(Packet& packet, size_t lane, const kiwami_ray& ray) {
  packet.org_x[lane] = ray.origin_x;
  packet.org_y[lane] = ray.origin_y;
  packet.org_z[lane] = ray.origin_z;
  packet.tnear[lane] = ray.tmin;
  packet.dir_x[lane] = ray.direction_x;
  packet.dir_y[lane] = ray.direction_y;
  packet.dir_z[lane] = ray.direction_z;
  packet.time[lane] = ray.time;
  packet.tfar[lane] = ray.tmax;
  packet.mask[lane] = ~0u;
  packet.id[lane] = 0;
  packet.flags[lane] = 0;
}

float closest_distance(float tfar, unsigned geometry) {
  return geometry == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<float>::infinity() : tfar;
}

/// Embree answers an any-hit query by tfar = -inf.
float any_distance(float tfar) {
  return tfar < 0.0f ? 0.0f : std::numeric_limits<float>::infinity();
}

/// One ray a call, or a stream of them; Query is RTCRayHit, or RTCRay for any hit.
template <typename Query>
class ArrayRun final : public PeerRun {
 public:
  ArrayRun(RTCScene scene, std::span<const kiwami_ray> rays, bool stream, bool coherent)
      : scene_(scene), rays_(rays), stream_(stream), coherent_(coherent), queries_(rays.size()) {}

  void reset() override {
    for (size_t i = 0; i < rays_.size(); ++i) {
      if constexpr (kClosest) {
        queries_[i].ray = to_embree(rays_[i]);
        queries_[i].hit.geomID = RTC_INVALID_GEOMETRY_ID;
        queries_[i].hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      } else {
        queries_[i] = to_embree(rays_[i]);
      }
    }
  }

  void trace(uint32_t threads) override {
    parallel_blocks(threads, queries_.size(), kRaysPerBlock, [this](size_t first, size_t last) {
      const FlushedDenormals flushed;
      if (stream_) {
        trace_stream(first, last);
      } else {
        trace_singly(first, last);
      }
    });
  }

  float distance(size_t i) const override {
    if constexpr (kClosest) {
      return closest_distance(queries_[i].ray.tfar, queries_[i].hit.geomID);
    } else {
      return any_distance(queries_[i].tfar);
    }
  }

 private:
  static constexpr bool kClosest = std::is_same_v<Query, RTCRayHit>;

  void trace_singly(size_t first, size_t last) {
    RTCIntersectContext context = make_context(coherent_);
    for (size_t i = first; i < last; ++i) {
      if constexpr (kClosest) {
        rtcIntersect1(scene_, &context, &queries_[i]);
      } else {
        rtcOccluded1(scene_, &context, &queries_[i]);
      }
    }
  }

  void trace_stream(size_t first, size_t last) {
    RTCIntersectContext context = make_context(coherent_);
    const auto count = static_cast<unsigned>(last - first);
    if constexpr (kClosest) {
      rtcIntersect1M(scene_, &context, &queries_[first], count, sizeof(Query));
    } else {
      rtcOccluded1M(scene_, &context, &queries_[first], count, sizeof(Query));
    }
  }

  RTCScene scene_;
  std::span<const kiwami_ray> rays_;
  bool stream_;
  bool coherent_;
  std::vector<Query> queries_;
};

/// Packets of Lanes rays; Query is RTCRayHit8 or 16, or RTCRay8 or 16 for any hit.
template <size_t Lanes, typename Query>
class PacketRun final : public PeerRun {
 public:
  PacketRun(RTCScene scene, std::span<const kiwami_ray> rays, bool coherent)
      : scene_(scene),
        rays_(rays),
        coherent_(coherent),
        packets_((rays.size() + Lanes - 1) / Lanes) {}

  void reset() override {
    for (size_t i = 0; i < rays_.size(); ++i) {
      Query& packet = packets_[i / Lanes];
      if constexpr (kClosest) {
        set_lane(packet.ray, i % Lanes, rays_[i]);
        packet.hit.geomID[i % Lanes] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][i % Lanes] = RTC_INVALID_GEOMETRY_ID;
      } else {
        set_lane(packet, i % Lanes, rays_[i]);
      }
    }
  }

  void trace(uint32_t threads) override {
    parallel_blocks(threads, packets_.size(), kRaysPerBlock / Lanes,
                    [this](size_t first, size_t last) {
                      const FlushedDenormals flushed;
                      trace_packets(first, last);
                    });
  }

  float distance(size_t i) const override {
    const Query& packet = packets_[i / Lanes];
    if constexpr (kClosest) {
      return closest_distance(packet.ray.tfar[i % Lanes], packet.hit.geomID[i % Lanes]);
    } else {
      return any_distance(packet.tfar[i % Lanes]);
    }
  }

 private:
  static constexpr bool kClosest =
      std::is_same_v<Query, RTCRayHit8> || std::is_same_v<Query, RTCRayHit16>;

  void trace_packets(size_t first, size_t last) {
    RTCIntersectContext context = make_context(coherent_);
    alignas(64) int valid[Lanes];
    for (size_t i = first; i < last; ++i) {
      const size_t used = std::min(Lanes, rays_.size() - i * Lanes);
      for (size_t lane = 0; lane < Lanes; ++lane) valid[lane] = lane < used ? -1 : 0;
      if constexpr (Lanes == 8 && kClosest) {
        rtcIntersect8(valid, scene_, &context, &packets_[i]);
      } else if constexpr (Lanes == 8) {
        rtcOccluded8(valid, scene_, &context, &packets_[i]);
      } else if constexpr (kClosest) {
        rtcIntersect16(valid, scene_, &context, &packets_[i]);
      } else {
        rtcOccluded16(valid, scene_, &context, &packets_[i]);
      }
    }
  }

  RTCScene scene_;
  std::span<const kiwami_ray> rays_;
  bool coherent_;
  std::vector<Query> packets_;
};

bool is_coherent(EmbreeEntrance entrance) {
  return entrance == EmbreeEntrance::kPacket8Coherent ||
         entrance == EmbreeEntrance::kPacket16Coherent ||
         entrance == EmbreeEntrance::kStreamCoherent;
}

RTCBuildQuality build_quality(EmbreeQuality quality) {
  switch (quality) {
    case EmbreeQuality::kLow:
      return RTC_BUILD_QUALITY_LOW;
    case EmbreeQuality::kDefault:
      return RTC_BUILD_QUALITY_MEDIUM;
    case EmbreeQuality::kHigh:
      break;
  }
  return RTC_BUILD_QUALITY_HIGH;
}

class Embree3Contender final : public EmbreeContender {
 public:
  Embree3Contender(const SceneFile& file, const EmbreeOptions& options)
      : scene_(file, {embree_config(options.isa, options.build_threads), options.robust,
                      build_quality(options.quality)}) {}

  double build_seconds() const override { return scene_.build_seconds(); }
  uint64_t bytes() const override { return scene_.bytes(); }

  std::vector<PeerEntrance> entrances(std::span<const kiwami_ray> rays, bool any_hit,
                                      bool singly) const override {
    std::vector<PeerEntrance> all;
    for (const EmbreeEntrance entrance : kEmbreeEntrances) {
      if (singly && entrance != EmbreeEntrance::kSingle) continue;
      all.push_back({entrance_name(entrance, any_hit),
                     [this, rays, any_hit, entrance] { return prepare(rays, any_hit, entrance); }});
    }
    return all;
  }

  std::unique_ptr<PeerRun> prepare(std::span<const kiwami_ray> rays, bool any_hit,
                                   EmbreeEntrance entrance) const override {
    return any_hit ? make_run<RTCRay, RTCRay8, RTCRay16>(rays, entrance)
                   : make_run<RTCRayHit, RTCRayHit8, RTCRayHit16>(rays, entrance);
  }

 private:
  template <typename One, typename Eight, typename Sixteen>
  std::unique_ptr<PeerRun> make_run(std::span<const kiwami_ray> rays,
                                    EmbreeEntrance entrance) const {
    const bool coherent = is_coherent(entrance);
    switch (entrance) {
      case EmbreeEntrance::kPacket8:
      case EmbreeEntrance::kPacket8Coherent:
        return std::make_unique<PacketRun<8, Eight>>(scene_.get(), rays, coherent);
      case EmbreeEntrance::kPacket16:
      case EmbreeEntrance::kPacket16Coherent:
        return std::make_unique<PacketRun<16, Sixteen>>(scene_.get(), rays, coherent);
      case EmbreeEntrance::kStream:
      case EmbreeEntrance::kStreamCoherent:
        return std::make_unique<ArrayRun<One>>(scene_.get(), rays, true, coherent);
      case EmbreeEntrance::kSingle:
        break;
    }
    return std::make_unique<ArrayRun<One>>(scene_.get(), rays, false, false);
  }

  EmbreeScene scene_;
};

}  // namespace

std::string entrance_name(EmbreeEntrance entrance, bool any_hit) {
  std::string name = any_hit ? "rtcOccluded" : "rtcIntersect";
  switch (entrance) {
    case EmbreeEntrance::kPacket8:
    case EmbreeEntrance::kPacket8Coherent:
      name += "8";
      break;
    case EmbreeEntrance::kPacket16:
    case EmbreeEntrance::kPacket16Coherent:
      name += "16";
      break;
    case EmbreeEntrance::kStream:
    case EmbreeEntrance::kStreamCoherent:
      name += "1M";
      break;
    case EmbreeEntrance::kSingle:
      name += "1";
      break;
  }
  return is_coherent(entrance) ? name + " coherent" : name;
}

std::unique_ptr<EmbreeContender> EmbreeContender::create(const SceneFile& file,
                                                         const EmbreeOptions& options) {
  return std::make_unique<Embree3Contender>(file, options);
}

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#include "measure/embree_queries.h"

#include <algorithm>
#include <limits>

#include "measure/embree_scene.h"

namespace kiwami::tools {
namespace {

/// What a filter function is told by the context that it is called with.
struct Collection {
  RTCIntersectContext context;
  uint32_t limit;  ///< 0: none
  std::vector<kiwami_hit>* hits;
  size_t first;  ///< where the ray's begin
};

bool is_nearer(const kiwami_hit& a, const kiwami_hit& b) { return a.t < b.t; }

/// Takes every hit into the collection and rejects it, so that Embree goes on. When the collection
/// is full, the hit is accepted, with the distance of the farthest in it as the ray's new end:
/// Embree reads the end again after a filter.
void collect(const RTCFilterFunctionNArguments* arguments) {
  auto& collection = *reinterpret_cast<Collection*>(arguments->context);
  auto& ray = *reinterpret_cast<RTCRay*>(arguments->ray);
  const auto& found = *reinterpret_cast<const RTCHit*>(arguments->hit);
  const kiwami_hit hit = {ray.tfar,   found.u,      found.v,      found.Ng_x,       found.Ng_y,
                          found.Ng_z, found.primID, found.geomID, KIWAMI_INVALID_ID};
  std::vector<kiwami_hit>& hits = *collection.hits;
  arguments->valid[0] = 0;
  if (collection.limit == 0) {
    hits.push_back(hit);
    return;
  }
  const auto begin = hits.begin() + static_cast<ptrdiff_t>(collection.first);
  const bool was_full = hits.size() - collection.first == collection.limit;
  if (!was_full || is_nearer(hit, hits.back())) {
    const auto place = std::upper_bound(begin, hits.end(), hit, is_nearer);
    if (was_full) {
      std::move_backward(place, hits.end() - 1, hits.end());
      *place = hit;
    } else {
      hits.insert(place, hit);
    }
  }
  if (hits.size() - collection.first == collection.limit) {
    ray.tfar = hits.back().t;
    arguments->valid[0] = -1;
  }
}

/// The same for a filter that judges hits.
struct Judgement {
  RTCIntersectContext context;
  AcceptsHit accepts;
  const void* user;
};

void judge(const RTCFilterFunctionNArguments* arguments) {
  const auto& judgement = *reinterpret_cast<const Judgement*>(arguments->context);
  const auto& hit = *reinterpret_cast<const RTCHit*>(arguments->hit);
  if (!judgement.accepts(hit.geomID, hit.primID, hit.u, hit.v, judgement.user)) {
    arguments->valid[0] = 0;
  }
}

class Embree3Queries final : public EmbreeQueries {
 public:
  Embree3Queries(const SceneFile& file, uint32_t isa)
      : scene_(file, {embree_config(isa, 1), false, RTC_BUILD_QUALITY_MEDIUM, true}) {}

  void multi_hits(std::span<const kiwami_ray> rays, uint32_t max_hits,
                  HitLists& lists) const override {
    Collection collection;
    rtcInitIntersectContext(&collection.context);
    collection.context.filter = collect;
    collection.limit = max_hits;
    collection.hits = &lists.hits;
    lists.hits.clear();
    lists.offsets.assign(1, 0);
    for (const kiwami_ray& ray : rays) {
      collection.first = lists.hits.size();
      RTCRayHit query;
      query.ray = to_embree(ray);
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene_.get(), &collection.context, &query);
      if (max_hits == 0) {
        std::sort(lists.hits.begin() + static_cast<ptrdiff_t>(collection.first), lists.hits.end(),
                  is_nearer);
      }
      lists.offsets.push_back(lists.hits.size());
    }
  }

  void filtered_hits(std::span<const kiwami_ray> rays, AcceptsHit accepts, const void* user,
                     std::span<float> distances) const override {
    Judgement judgement;
    rtcInitIntersectContext(&judgement.context);
    judgement.context.filter = judge;
    judgement.accepts = accepts;
    judgement.user = user;
    for (size_t i = 0; i < rays.size(); ++i) {
      RTCRayHit query;
      query.ray = to_embree(rays[i]);
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene_.get(), &judgement.context, &query);
      distances[i] = query.hit.geomID == RTC_INVALID_GEOMETRY_ID
                         ? std::numeric_limits<float>::infinity()
                         : query.ray.tfar;
    }
  }

 private:
  EmbreeScene scene_;
};

}  // namespace

std::unique_ptr<EmbreeQueries> EmbreeQueries::create(const SceneFile& file, uint32_t isa) {
  return std::make_unique<Embree3Queries>(file, isa);
}

}  // namespace kiwami::tools

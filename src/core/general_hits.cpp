// SPDX-License-Identifier: Apache-2.0
#include "core/general_hits.h"

#include <algorithm>
#include <cstring>

namespace kiwami {
namespace {

/// Hits that are listed at once. With a filter, which may reject any of them, or where all are
/// wanted, the ray is traced on from the last.
constexpr uint32_t kListLength = 32;

enum class Verdict { kReject, kAccept, kStop };

Verdict ask_filter(const QueryOptions& options, const GeneralHit& hit) {
  if (!options.filter || hit.is_asked == 0) return Verdict::kAccept;
  kiwami_filter_candidate candidate{};
  candidate.struct_size = sizeof candidate;
  candidate.depth = hit.path.depth;
  candidate.ray = options.first_ray;
  candidate.hit = hit.hit;
  for (uint32_t i = 0; i < KIWAMI_MAX_INSTANCE_DEPTH; ++i) {
    candidate.instance_path[i] = i < hit.path.depth ? hit.path.number[i] : KIWAMI_INVALID_ID;
  }
  switch (options.filter(options.filter_user, &candidate)) {
    case KIWAMI_FILTER_REJECT:
      return Verdict::kReject;
    case KIWAMI_FILTER_ACCEPT:
      return Verdict::kAccept;
    case KIWAMI_FILTER_ACCEPT_AND_STOP:
      return Verdict::kStop;
    default:
      options.report_failed_callback();
      return Verdict::kStop;
  }
}

}  // namespace

uint32_t GeneralHits::trace(const CommittedScene& scene, const RayBatch& ray,
                            const QueryOptions& options, uint32_t max_hits, bool keeps) {
  GeneralHit listed[kListLength];
  HitKey keys[kListLength];
  GeneralHit last;
  const GeneralHit* after = nullptr;
  for (uint32_t found = 0;;) {
    const bool takes_all = options.filter || max_hits == 0;
    const uint32_t limit = takes_all ? kListLength : std::min(kListLength, max_hits - found);
    const uint32_t count = scene.kernels().general.nearest_hits(scene.view(), ray, options,
                                                                {listed, keys, limit, after});
    for (uint32_t k = 0; k < count; ++k) {
      const GeneralHit& hit = listed[keys[k].slot];
      const Verdict verdict = ask_filter(options, hit);
      if (verdict == Verdict::kReject) continue;
      if (keeps) add(scene.memory(), hit);
      if (++found == max_hits || verdict == Verdict::kStop) return found;
    }
    if (count < limit) return found;
    last = listed[keys[count - 1].slot];
    after = &last;
  }
}

void GeneralHits::add(Memory& memory, const GeneralHit& hit) {
  if (count_ == paths_.size()) {
    const size_t size = std::max<size_t>(64, 2 * count_);
    Array<kiwami_hit> hits(memory, size);
    Array<InstancePath> paths(memory, size);
    if (count_ != 0) {
      std::memcpy(hits.data(), hits_.data(), count_ * sizeof(kiwami_hit));
      std::memcpy(paths.data(), paths_.data(), count_ * sizeof(InstancePath));
    }
    hits_ = std::move(hits);
    paths_ = std::move(paths);
  }
  hits_[count_] = hit.hit;
  paths_[count_++] = hit.path;
}

}  // namespace kiwami

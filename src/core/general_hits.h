// SPDX-License-Identifier: Apache-2.0
// The hits of single rays, in scenes and for queries of all kinds.
#pragma once

#include "core/committed_scene.h"
#include "core/memory.h"
#include "kernels/kernel_table.h"

namespace kiwami {

/// Hits of one ray after the other, with the paths to them.
class GeneralHits {
 public:
  /// Forgets all hits.
  void clear() { count_ = 0; }

  /// Finds a ray's nearest max_hits (0: all) hits that the filter accepts, which is asked from
  /// front to back and about no more. Returns their number; adds them where they are to be kept.
  /// The rays of the batch are one.
  uint32_t trace(const CommittedScene& scene, const RayBatch& ray, const QueryOptions& options,
                 uint32_t max_hits, bool keeps);

  const kiwami_hit* hits() const { return hits_.data(); }
  const InstancePath* paths() const { return paths_.data(); }

 private:
  void add(Memory& memory, const GeneralHit& hit);

  Array<kiwami_hit> hits_;
  Array<InstancePath> paths_;
  size_t count_ = 0;
};

}  // namespace kiwami

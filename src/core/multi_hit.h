// SPDX-License-Identifier: Apache-2.0
// Several hits of each ray of a batch, one ray's after the other's.
#pragma once

#include "core/trace.h"

namespace kiwami {

/// What a multi-hit call asks for, and where the numbers go.
struct MultiHitRequest {
  uint32_t max_hits;      ///< of a ray, the nearest; 0: all
  uint64_t hit_capacity;  ///< hits beyond are counted, not written
  uint64_t* offsets;      ///< where each ray's hits begin, and where the last one's end
  TraceRequest trace;
};

/// Writes hits to an array of structs. Returns how many there are, whatever the capacity. Throws
/// Error(OUT_OF_MEMORY or CALLBACK) and what Parallel throws.
uint64_t trace_multi_hit(const CommittedScene& scene, const RayBatch& rays, kiwami_hit* hits,
                         const MultiHitRequest& request);

/// The same for rays and hits whose fields lie apart.
uint64_t trace_multi_hit(const CommittedScene& scene, const kiwami_ray_fields& rays, size_t count,
                         const kiwami_hit_fields& hits, const MultiHitRequest& request);

}  // namespace kiwami

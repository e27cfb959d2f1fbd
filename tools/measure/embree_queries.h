// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Hits of several rays, one ray's after the other's.
struct HitLists {
  std::vector<uint64_t> offsets;  ///< where each ray's begin, and where the last one's end
  std::vector<kiwami_hit> hits;
};

/// Whether a hit on a triangle counts.
using AcceptsHit = bool (*)(uint32_t geometry_id, uint32_t primitive_id, float u, float v,
                            const void* user);

/// What Embree does by filter functions, on one thread, one ray a call.
class EmbreeQueries {
 public:
  virtual ~EmbreeQueries() = default;
  /// Nothing when the tools were built without Embree. `isa` is one of KIWAMI_ISA_*.
  static std::unique_ptr<EmbreeQueries> create(const SceneFile& file, uint32_t isa);

  /// The nearest max_hits of each ray (0: all), by a filter that collects and, once it has as many,
  /// draws the ray's end nearer.
  virtual void multi_hits(std::span<const kiwami_ray> rays, uint32_t max_hits,
                          HitLists& lists) const = 0;
  /// The nearest hits that count.
  virtual void filtered_hits(std::span<const kiwami_ray> rays, AcceptsHit accepts, const void* user,
                             std::span<float> distances) const = 0;
};

}  // namespace kiwami::tools

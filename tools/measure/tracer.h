// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>
#include <memory>
#include <span>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Anything that finds closest hits, so that libraries can be measured with the same code.
class Tracer {
 public:
  virtual ~Tracer() = default;
  /// As many hits as rays.
  virtual void closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const = 0;
};

/// Embree on one thread, one ray a call.
class EmbreeTracer : public Tracer {
 public:
  /// Nothing when the tools were built without Embree. `robust` sets its robust scene flag. Ray
  /// masks and flags are not obeyed.
  static std::unique_ptr<EmbreeTracer> create(const SceneFile& file, bool robust);

  virtual double build_seconds() const = 0;
  /// What Embree allocated for the scene, its copies of the buffers aside.
  virtual uint64_t bytes() const = 0;
};

/// "3.13.5", or "" without Embree.
const char* embree_version();

}  // namespace kiwami::tools

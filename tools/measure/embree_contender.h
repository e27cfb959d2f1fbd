// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Embree's ways to trace many rays.
enum class EmbreeEntrance {
  kSingle,
  kPacket8,
  kPacket8Coherent,
  kPacket16,
  kPacket16Coherent,
  kStream,
  kStreamCoherent,
};
constexpr EmbreeEntrance kEmbreeEntrances[] = {
    EmbreeEntrance::kSingle,           EmbreeEntrance::kPacket8,
    EmbreeEntrance::kPacket8Coherent,  EmbreeEntrance::kPacket16,
    EmbreeEntrance::kPacket16Coherent, EmbreeEntrance::kStream,
    EmbreeEntrance::kStreamCoherent};

/// "rtcIntersect8 coherent".
std::string entrance_name(EmbreeEntrance entrance, bool any_hit);

/// Rays in the layout that an entrance asks for: the answers go where the rays are, so that nothing
/// is converted while it is timed.
class EmbreeRun {
 public:
  virtual ~EmbreeRun() = default;
  /// Undoes the answers.
  virtual void reset() = 0;
  /// Traces all rays, blocks of them on as many threads as given.
  virtual void trace(uint32_t threads) = 0;
  /// The distance of ray i's hit, infinite for a miss; of any hit 0 or infinite.
  virtual float distance(size_t i) const = 0;
};

/// A scene in Embree.
class EmbreeContender {
 public:
  virtual ~EmbreeContender() = default;

  /// Nothing when the tools were built without Embree. `isa`, one of KIWAMI_ISA_*, limits the
  /// instructions that Embree uses to those that the kernels of that ISA use.
  static std::unique_ptr<EmbreeContender> create(const SceneFile& file, uint32_t isa,
                                                 uint32_t build_threads, bool robust);

  virtual double build_seconds() const = 0;
  virtual uint64_t bytes() const = 0;
  /// The rays must outlive the run.
  virtual std::unique_ptr<EmbreeRun> prepare(std::span<const kiwami_ray> rays, bool any_hit,
                                             EmbreeEntrance entrance) const = 0;
};

}  // namespace kiwami::tools

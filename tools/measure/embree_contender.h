// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "measure/peer.h"
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

/// A scene in Embree.
class EmbreeContender : public PeerScene {
 public:
  /// Nothing when the tools were built without Embree. `isa`, one of KIWAMI_ISA_*, limits the
  /// instructions that Embree uses to those that the kernels of that ISA use.
  static std::unique_ptr<EmbreeContender> create(const SceneFile& file, uint32_t isa,
                                                 uint32_t build_threads, bool robust);

  /// The rays must outlive the run.
  virtual std::unique_ptr<PeerRun> prepare(std::span<const kiwami_ray> rays, bool any_hit,
                                           EmbreeEntrance entrance) const = 0;
};

}  // namespace kiwami::tools

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

/// Embree's qualities of a build: low is along a Morton curve, high with spatial splits.
enum class EmbreeQuality { kLow, kDefault, kHigh };

/// What Embree is asked for.
struct EmbreeOptions {
  uint32_t isa = KIWAMI_ISA_AUTO;  ///< limits its instructions to those that our kernels use
  uint32_t build_threads = 1;
  bool robust = false;  ///< its robust scene flag
  EmbreeQuality quality = EmbreeQuality::kDefault;
};

/// "rtcIntersect8 coherent".
std::string entrance_name(EmbreeEntrance entrance, bool any_hit);

/// A scene in Embree.
class EmbreeContender : public PeerScene {
 public:
  /// Nothing when the tools were built without Embree.
  static std::unique_ptr<EmbreeContender> create(const SceneFile& file,
                                                 const EmbreeOptions& options);

  /// The rays must outlive the run.
  virtual std::unique_ptr<PeerRun> prepare(std::span<const kiwami_ray> rays, bool any_hit,
                                           EmbreeEntrance entrance) const = 0;
};

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace kiwami::tools {

/// Rays in the layout that an entrance of a peer asks for: the answers go where the rays are, so
/// that nothing is converted while it is timed.
class PeerRun {
 public:
  virtual ~PeerRun() = default;
  /// Undoes the answers.
  virtual void reset() = 0;
  /// Traces all rays, blocks of them on as many threads as given.
  virtual void trace(uint32_t threads) = 0;
  /// The distance of ray i's hit, infinite for a miss; of any hit 0 or infinite.
  virtual float distance(size_t i) const = 0;
};

/// One of a peer's ways to trace many rays.
struct PeerEntrance {
  std::string name;
  std::function<std::unique_ptr<PeerRun>()> prepare;
};

/// A scene in another library, which ours is measured against.
class PeerScene {
 public:
  virtual ~PeerScene() = default;
  virtual double build_seconds() const = 0;
  virtual uint64_t bytes() const = 0;
  /// The entrances for these rays; `singly`: those alone that take one ray a call. The rays must
  /// outlive the runs.
  virtual std::vector<PeerEntrance> entrances(std::span<const kiwami_ray> rays, bool any_hit,
                                              bool singly) const = 0;
};

}  // namespace kiwami::tools

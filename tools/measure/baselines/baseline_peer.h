// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "measure/baselines/structure.h"
#include "measure/peer.h"
#include "scene/scene_file.h"

namespace kiwami::tools {

/// Rays through a structure, which must outlive the run, as they must.
std::unique_ptr<PeerRun> make_run(const Structure& structure, std::span<const kiwami_ray> rays,
                                  bool any_hit);

/// A binary hierarchy without vector instructions as a peer, built on one thread.
std::unique_ptr<PeerScene> make_binary_peer(const SceneFile& file);

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "measure/peer.h"
#include "scene/scene_file.h"

namespace kiwami::tools {

/// A binary hierarchy without vector instructions as a peer, built on one thread.
std::unique_ptr<PeerScene> make_binary_peer(const SceneFile& file);

}  // namespace kiwami::tools

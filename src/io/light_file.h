// SPDX-License-Identifier: Apache-2.0
// Committed sets of lights as files: the lights, and the shape of the tree over them, in which a
// load writes it anew.
#pragma once

#include "kiwami/io.h"
#include "lights/light_tree.h"

namespace kiwami {

/// Saves what was committed, with the trees that instances show; returns the file's size. Throws
/// Error.
uint64_t save_lights(const LightTree& tree, const CommittedLights& committed,
                     const kiwami_save_desc& desc);

/// A committed set. Throws Error.
LightTree* load_lights(Device& device, const kiwami_load_desc& desc);

}  // namespace kiwami

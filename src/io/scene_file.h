// SPDX-License-Identifier: Apache-2.0
// Committed scenes as files.
#pragma once

#include "core/scene.h"
#include "kiwami/io.h"

namespace kiwami {

/// Saves what was committed, with the scenes that it shows, what is attached or disabled since, and
/// the parameters of the next commit; returns the file's size. Throws Error.
uint64_t save_scene(const Scene& scene, const CommittedScene& committed,
                    const kiwami_save_desc& desc);

/// A committed scene. Throws Error.
Scene* load_scene(Device& device, const kiwami_load_desc& desc);

/// What the beginning of a file says. Throws Error.
kiwami_file_info describe_file(Device& device, const kiwami_load_desc& desc);

}  // namespace kiwami

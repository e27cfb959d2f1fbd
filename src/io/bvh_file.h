// SPDX-License-Identifier: Apache-2.0
// Trees of kiwami_bvh_build as files.
#pragma once

#include "core/bvh.h"
#include "kiwami/io.h"

namespace kiwami {

/// Returns the file's size. Throws Error.
uint64_t save_bvh(const Bvh& bvh, const kiwami_save_desc& desc);

/// Throws Error.
Bvh* load_bvh(Device& device, const kiwami_load_desc& desc);

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lights/light_tree.h"

namespace kiwami {

/// Runs a kernel over a batch, in blocks on the device's threads if it is large.
void run_light_kernel(const Parallel& parallel, const LightTreeView& tree, LightKernel kernel,
                      const LightBatch& batch, bool on_calling_thread);

}  // namespace kiwami

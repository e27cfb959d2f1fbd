// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/committed_scene.h"
#include "kiwami/bvh.h"

namespace kiwami {

/// Traces rays, each alone, by a counting kernel, and adds up. Rays lie ray_stride bytes apart, the
/// counts of each ray each_stride bytes; each may be null. struct_size of the result is 0.
kiwami_visits count_visits(const CommittedScene& scene, const kiwami_ray* rays, size_t ray_stride,
                           size_t count, bool any_hit, kiwami_ray_visits* each, size_t each_stride);

}  // namespace kiwami

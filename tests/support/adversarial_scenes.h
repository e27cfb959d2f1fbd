// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "support/mesh.h"

namespace kiwami_tests {

/// A small scene of the kind that breaks ray tracers: slivers, coplanar, duplicated, huge and tiny,
/// NaN, none, one or two triangles, all identical, degenerate, out of range, denormal. The kind
/// goes round with the index, so that any 20 consecutive ones hold each.
Scene adversarial_scene(uint32_t index, uint64_t seed);

}  // namespace kiwami_tests

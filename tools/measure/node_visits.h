// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>
#include <span>
#include <vector>

#include "measure/tracer.h"

namespace kiwami::tools {

/// How many of the rays pass through each node's box before or at their closest hit: the nodes that
/// any traversal has to visit, in whatever order. `tracer` answers for the tree's triangles.
std::vector<uint64_t> node_visits(std::span<const kiwami_bvh_node> nodes, const Tracer& tracer,
                                  std::span<const kiwami_ray> rays);

}  // namespace kiwami::tools

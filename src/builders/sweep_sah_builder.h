// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/sah_config.h"
#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Top-down construction by the surface area heuristic over every position along every axis:
/// I. Wald, S. Boulos, P. Shirley, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume
/// Hierarchies", TOG 26(1), 2007. Primitives are sorted once along each axis; a split marks the
/// sides of the primitives and divides the three orders by stable partitions, so they stay sorted
/// (the orders of I. Wald, V. Havran, "On building fast kd-Trees for Ray Tracing, and on doing that
/// in O(N log N)", IRT 2006). Departs from both in counting full leaf blocks instead of primitives.
class SweepSahBuilder {
 public:
  using Config = SahConfig;

  /// The same tree for any number of threads. Takes 57 bytes a primitive, and the nodes.
  static BinaryBvh build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                         const Parallel& parallel);
};

}  // namespace kiwami

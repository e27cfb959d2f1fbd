// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Mini trees under one top tree: P. Ganestam, R. Barringer, M. Doggett, T. Akenine-Moeller,
/// "Bonsai: Rapid Bounding Volume Hierarchy Generation using Mini Trees", JCGT 4(3), 2015. Small
/// groups of primitives get a tree by sweeping, each in a task; the upper nodes of large ones are
/// pruned, since their groups were cut blindly; and a sweep over what is left makes the top tree.
/// Departs from it in that groups are cells of a Morton curve in place of halves of their own box.
class MiniTreeBuilder {
 public:
  struct Config {
    uint32_t group_size = 512;  ///< primitives of a mini tree at most, 1 or more
    /// Roots of mini trees with more of the scene's surface area than this part are pruned.
    float prune_area = 0.01f;
  };

  /// One primitive a leaf. The same tree for any number of threads.
  static BinaryBvh build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                         const Parallel& parallel);
};

}  // namespace kiwami

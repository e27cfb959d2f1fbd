// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Sort-tile-recursive packing of an R-tree: S. Leutenegger, M. Lopez, J. Edgington, "STR: A Simple
/// and Efficient Algorithm for R-Tree Packing", ICDE 1997. Centres are sorted along x and cut into
/// slabs, these along y into runs, these along z; each page of so many neighbours becomes a node,
/// and the nodes are packed in the same way. Departs from it in that a page is a balanced subtree
/// of two children a node, which the pipeline contracts again.
class StrBuilder {
 public:
  struct Config {
    uint32_t page_size = 8;  ///< children of a page, 2 to 16
  };

  /// One primitive a leaf. The same tree for any number of threads.
  static BinaryBvh build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                         const Parallel& parallel);
};

}  // namespace kiwami

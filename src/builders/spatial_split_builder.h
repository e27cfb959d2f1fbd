// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/sah_config.h"
#include "bvh/binary_bvh.h"
#include "bvh/triangle_source.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Top-down construction that may also divide space: M. Stich, H. Friedrich, A. Dietrich, "Spatial
/// Splits in Bounding Volume Hierarchies", HPG 2009; cf. S. Popov, I. Georgiev, R. Dimov,
/// P. Slusallek, "Object Partitioning Considered Harmful: Space Subdivision for BVHs", HPG 2009.
/// Where the boxes of the best object split overlap, a plane is tried that cuts triangles in two
/// references, each with the box of its own part. A reference goes to one side whole where that is
/// cheaper ("reference unsplitting").
///
/// Departs from the papers in a budget of references that is never passed: each node owns a range
/// of memory with room for what it may add, and leaves each child a share of the rest. So subtrees
/// need nothing of each other, the tree does not depend on the number of threads, and the memory is
/// known beforehand. Departs also in counting full leaf blocks, as all builders here do.
class SpatialSplitBuilder {
 public:
  struct Config : SahConfig {
    /// Bins per axis, 2 to 32; of space twice as many, at most 32.
    uint32_t bin_count = 16;
    /// References beyond one a triangle, as a part of the number of triangles.
    double split_budget = 0.3;
    /// Space is divided only where the boxes of an object split overlap by more than this part of
    /// the root's area.
    double split_alpha = 1e-5;
  };

  /// The primitives are boxes around triangles of the source. The same tree for any number of
  /// threads. Takes 32 bytes a primitive and reference of the budget, and the nodes.
  static BinaryBvh build(Array<BuildPrimitive> primitives, const TriangleSource& source,
                         const Config& config, Memory& memory, const Parallel& parallel);
};

}  // namespace kiwami

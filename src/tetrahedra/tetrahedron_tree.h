// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/float4.h"
#include "parallel/parallel.h"
#include "tetrahedra/tetrahedron_source.h"

namespace kiwami {

/// A tree of four children a node over the boxes of tetrahedra, which is asked for the boxes that
/// hold a point: by binned SAH, contracted by area, one tetrahedron a leaf.
class TetrahedronTree {
 public:
  TetrahedronTree() = default;
  TetrahedronTree(const TetrahedronSource& source, Memory& memory, const Parallel& parallel);

  uint64_t bytes() const { return nodes_.bytes(); }

  /// Calls visit(id) for the tetrahedra whose box holds a point, its border included, in an order
  /// that depends on the tree alone, until it returns false.
  template <typename Visit>
  void visit_boxes_at(const Vec3f& point, Visit&& visit) const;

 private:
  static constexpr uint32_t kLeafBit = 0x80000000u;

  struct Node {
    Float4 lower[3], upper[3];  ///< of the children; a box of nothing where there is none
    uint32_t child[4];          ///< a node, or kLeafBit and a tetrahedron
  };

  Array<Node> nodes_;  ///< 0 is the root
};

template <typename Visit>
void TetrahedronTree::visit_boxes_at(const Vec3f& point, Visit&& visit) const {
  if (nodes_.empty()) return;
  // Each step down pushes at most four and pops one.
  uint32_t stack[3 * 72 + 2];
  uint32_t size = 0;
  stack[size++] = 0;
  Float4 at[3];
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = Float4{point[axis], point[axis], point[axis], point[axis]};
  }
  while (size != 0) {
    const Node& node = nodes_[stack[--size]];
    Int4 holds = {-1, -1, -1, -1};
    for (int axis = 0; axis < 3; ++axis) {
      holds &= (node.lower[axis] <= at[axis]) & (at[axis] <= node.upper[axis]);
    }
    for (int slot = 0; slot < 4; ++slot) {
      if (holds[slot] == 0) continue;
      if ((node.child[slot] & kLeafBit) == 0) {
        stack[size++] = node.child[slot];
      } else if (!visit(node.child[slot] & ~kLeafBit)) {
        return;
      }
    }
  }
}

}  // namespace kiwami

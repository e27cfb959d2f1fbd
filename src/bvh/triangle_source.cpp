// SPDX-License-Identifier: Apache-2.0
#include "bvh/triangle_source.h"

#include "core/error.h"

namespace kiwami {

void TriangleMeshView::checked_indices_of(uint32_t primitive, uint32_t index[3]) const {
  indices_of(primitive, index);
  for (uint32_t k = 0; k < 3; ++k) {
    if (index[k] < vertex_count) continue;
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "index %u of triangle %u of geometry %u is %u, expected less than its vertex "
                "count, which is %zu",
                k, primitive, geometry_id, index[k], vertex_count);
  }
}

void TriangleMeshView::checked_corners_of(uint32_t primitive, Vec3f corner[3]) const {
  uint32_t index[3];
  checked_indices_of(primitive, index);
  read_vertices(index, corner);
}

}  // namespace kiwami

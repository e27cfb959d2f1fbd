// SPDX-License-Identifier: Apache-2.0
#include "bvh/triangle_source.h"

#include "core/error.h"

namespace kiwami {

void TriangleMeshView::refuse_index(uint32_t corner, uint32_t primitive, uint32_t index) const {
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
              "index %u of triangle %u of geometry %u is %u, expected less than its vertex "
              "count, which is %zu",
              corner, primitive, geometry_id, index, vertex_count);
}

}  // namespace kiwami

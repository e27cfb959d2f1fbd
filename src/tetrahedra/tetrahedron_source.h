// SPDX-License-Identifier: Apache-2.0
// The tetrahedra of a mesh as those that locate points see them.
#pragma once

#include <cstdint>

#include "core/memory.h"
#include "math/bounds.h"

namespace kiwami {

struct Tetrahedron {
  uint32_t vertex[4];
};

/// Packed copies of the caller's buffers, with what is known of each tetrahedron.
struct TetrahedronSource {
  Array<Vec3f> vertices;
  Array<Tetrahedron> tetrahedra;
  /// 1: it contains points, 0: it is left out.
  Array<uint8_t> has_volume;
  uint64_t skipped_count = 0, inverted_count = 0;

  void corners_of(uint32_t id, Vec3f (&corner)[4]) const {
    for (int i = 0; i < 4; ++i) corner[i] = vertices[tetrahedra[id].vertex[i]];
  }

  Bounds bounds_of(uint32_t id) const {
    Bounds bounds = Bounds::empty();
    for (const uint32_t vertex : tetrahedra[id].vertex) bounds.extend(vertices[vertex]);
    return bounds;
  }
};

}  // namespace kiwami

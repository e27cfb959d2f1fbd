// SPDX-License-Identifier: Apache-2.0
#include "core/motion_blocks.h"

#include <algorithm>
#include <cstring>

#include "core/leaf_rows.h"

namespace kiwami {
namespace {

/// Nine numbers of the first step, then those of the second.
void read_rows(const MovingMeshView& mesh, uint32_t primitive, float (&rows)[kMotionBlockRows]) {
  uint32_t index[3] = {3 * primitive, 3 * primitive + 1, 3 * primitive + 2};
  if (mesh.indices) {
    std::memcpy(index, mesh.indices + primitive * mesh.index_stride, sizeof index);
  }
  for (uint32_t step = 0; step < 2; ++step) {
    for (uint32_t k = 0; k < 3; ++k) {
      std::memcpy(rows + 9 * step + 3 * k,
                  mesh.vertices + step * mesh.step_stride + index[k] * mesh.vertex_stride,
                  3 * sizeof(float));
    }
  }
}

}  // namespace

const MovingMeshView& mesh_of(const MotionPart& part, uint32_t id) {
  return *(std::upper_bound(
               part.meshes, part.meshes + part.mesh_count, id,
               [](uint32_t value, const MovingMeshView& mesh) { return value < mesh.first_id; }) -
           1);
}

bool may_have_blocks(const MotionPart& part) {
  return std::all_of(part.meshes, part.meshes + part.mesh_count,
                     [](const MovingMeshView& mesh) { return mesh.time.segment_count == 1; });
}

Array<float> make_motion_blocks(const MotionPart& part, const WideTree& tree, Memory& memory,
                                const Parallel& parallel) {
  const MovingMeshView& last = part.meshes[part.mesh_count - 1];
  const auto id_count = static_cast<uint32_t>(last.first_id + last.triangle_count);
  return make_leaf_rows<kMotionBlockRows>(tree, kMotionBlockRows, id_count, memory, parallel,
                                          [&](uint32_t id, float(&rows)[kMotionBlockRows]) {
                                            const MovingMeshView& mesh = mesh_of(part, id);
                                            read_rows(mesh, id - mesh.first_id, rows);
                                          });
}

}  // namespace kiwami

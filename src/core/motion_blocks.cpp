// SPDX-License-Identifier: Apache-2.0
#include "core/motion_blocks.h"

#include <algorithm>
#include <cstring>

namespace kiwami {
namespace {

constexpr size_t kBlocksAtOnce = 1024;

const MovingMeshView& mesh_of(const MotionPart& part, uint32_t id) {
  return *(std::upper_bound(
               part.meshes, part.meshes + part.mesh_count, id,
               [](uint32_t value, const MovingMeshView& mesh) { return value < mesh.first_id; }) -
           1);
}

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

bool may_have_blocks(const MotionPart& part) {
  return std::all_of(part.meshes, part.meshes + part.mesh_count,
                     [](const MovingMeshView& mesh) { return mesh.time.segment_count == 1; });
}

Array<float> make_motion_blocks(const MotionPart& part, const WideTree& tree, Memory& memory,
                                const Parallel& parallel) {
  const size_t width = tree.leaf_width;
  const MovingMeshView& last = part.meshes[part.mesh_count - 1];
  const uint32_t id_count = last.first_id + static_cast<uint32_t>(last.triangle_count);
  Array<float> blocks(memory, tree.leaf_block_count * kMotionBlockRows * width);
  parallel.for_blocks(tree.leaf_block_count, kBlocksAtOnce, [&](size_t begin, size_t end) {
    for (size_t number = begin; number < end; ++number) {
      const uint32_t* ids = tree.leaf_ids(number);
      float* block = blocks.data() + number * kMotionBlockRows * width;
      for (size_t lane = 0; lane < width; ++lane) {
        float rows[kMotionBlockRows] = {};
        // Of a file, lanes that no node refers to may have any id.
        if (ids[lane] < id_count) {
          const MovingMeshView& mesh = mesh_of(part, ids[lane]);
          read_rows(mesh, ids[lane] - mesh.first_id, rows);
        }
        for (size_t row = 0; row < kMotionBlockRows; ++row) block[row * width + lane] = rows[row];
      }
    }
  });
  return blocks;
}

}  // namespace kiwami

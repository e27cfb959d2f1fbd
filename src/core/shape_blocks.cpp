// SPDX-License-Identifier: Apache-2.0
#include "core/shape_blocks.h"

#include <algorithm>
#include <cstring>

namespace kiwami {
namespace {

constexpr size_t kBlocksAtOnce = 1024;

const ShapeView& view_of(const ShapeSource& source, uint32_t id) {
  return *(std::upper_bound(
               source.views, source.views + source.view_count, id,
               [](uint32_t value, const ShapeView& view) { return value < view.first_id; }) -
           1);
}

/// The rows of one shape.
void read_rows(const ShapeSource& source, uint32_t id, float (&rows)[kMostShapeRows]) {
  const ShapeView& view = view_of(source, id);
  size_t first = id - view.first_id;
  if (source.kind == ShapeKind::kDisc) {
    std::memcpy(rows + 4, view.normals + first * view.normal_stride, 3 * sizeof(float));
  }
  if (view.indices) {
    uint32_t index;
    std::memcpy(&index, view.indices + first * view.index_stride, sizeof index);
    first = index;
  }
  std::memcpy(rows, view.points + first * view.point_stride, 4 * sizeof(float));
  if (source.kind == ShapeKind::kCurve) {
    std::memcpy(rows + 4, view.points + (first + 1) * view.point_stride, 4 * sizeof(float));
  }
}

}  // namespace

Array<float> make_shape_blocks(const ShapeSource& source, const WideTree& tree, Memory& memory,
                               const Parallel& parallel) {
  const size_t width = tree.leaf_width, row_count = shape_rows(source.kind);
  const ShapeView& last = source.views[source.view_count - 1];
  const uint32_t id_count = last.first_id + static_cast<uint32_t>(last.count);
  Array<float> blocks(memory, tree.leaf_block_count * row_count * width);
  parallel.for_blocks(tree.leaf_block_count, kBlocksAtOnce, [&](size_t begin, size_t end) {
    for (size_t number = begin; number < end; ++number) {
      const uint32_t* ids = tree.leaf_ids(number);
      float* block = blocks.data() + number * row_count * width;
      for (size_t lane = 0; lane < width; ++lane) {
        float rows[kMostShapeRows] = {};
        // Of a file, lanes that no node refers to may have any id.
        if (ids[lane] < id_count) read_rows(source, ids[lane], rows);
        for (size_t row = 0; row < row_count; ++row) block[row * width + lane] = rows[row];
      }
    }
  });
  return blocks;
}

}  // namespace kiwami

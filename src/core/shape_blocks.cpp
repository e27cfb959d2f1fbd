// SPDX-License-Identifier: Apache-2.0
#include "core/shape_blocks.h"

#include <algorithm>
#include <cstring>

#include "core/leaf_rows.h"

namespace kiwami {
namespace {

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
  const ShapeView& last = source.views[source.view_count - 1];
  return make_leaf_rows<kMostShapeRows>(
      tree, shape_rows(source.kind), last.first_id + last.count, memory, parallel,
      [&](uint32_t id, float(&rows)[kMostShapeRows]) { read_rows(source, id, rows); });
}

}  // namespace kiwami

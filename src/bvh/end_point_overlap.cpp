// SPDX-License-Identifier: Apache-2.0
#include "bvh/end_point_overlap.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "math/polygon.h"

namespace kiwami {
namespace {

/// Entries of primitive_ids that one task follows.
constexpr size_t kBlockSize = 1024;

/// The whole surface in the units of the sums.
constexpr double kWhole = 4611686018427387904.0;  // 2^62

/// Where each triangle stands among the primitives of a tree.
class Positions {
 public:
  Positions(const Array<uint32_t>& primitive_ids, Memory& memory)
      : first_(memory, size_t{highest(primitive_ids)} + 2), at_(memory, primitive_ids.size()) {
    first_.fill_zero();
    for (const uint32_t id : primitive_ids) ++first_[id + 1];
    for (size_t id = 1; id < first_.size(); ++id) first_[id] += first_[id - 1];
    // Filled from behind, which moves each first_[id + 1] down to where it began.
    for (size_t i = primitive_ids.size(); i-- > 0;) {
      at_[--first_[primitive_ids[i] + 1]] = static_cast<uint32_t>(i);
    }
  }

  /// Rising.
  std::span<const uint32_t> of(uint32_t id) const {
    const size_t begin = first_[size_t{id} + 1];
    const size_t end = size_t{id} + 2 < first_.size() ? first_[size_t{id} + 2] : at_.size();
    return {at_.data() + begin, end - begin};
  }

 private:
  static uint32_t highest(const Array<uint32_t>& ids) {
    return ids.empty() ? 0 : *std::max_element(ids.begin(), ids.end());
  }

  Array<uint32_t> first_;  ///< by id + 1
  Array<uint32_t> at_;
};

/// One triangle on its way down the tree.
class Descent {
 public:
  Descent(std::span<const kiwami_bvh_node> nodes, std::span<const uint32_t> positions,
          double surface_area, Array<uint64_t>& foreign)
      : nodes_(nodes), positions_(positions), surface_area_(surface_area), foreign_(foreign) {}

  /// piece is what of the triangle may lie in the children of a node.
  void visit_children(const kiwami_bvh_node& node, const ClippedTriangle& piece) {
    for (uint32_t i = 0; i < node.child_count; ++i) {
      const uint32_t index = node.first_child + i;
      const kiwami_bvh_node& child = nodes_[index];
      if (!piece.may_overlap(child.lower, child.upper)) continue;
      if (is_home(child)) {
        visit_children(child, piece);
      } else {
        visit_foreign(index, piece);
      }
    }
  }

 private:
  bool is_home(const kiwami_bvh_node& node) const {
    return std::any_of(positions_.begin(), positions_.end(), [&](uint32_t position) {
      return position - node.first_primitive < node.primitive_count;
    });
  }

  void visit_foreign(uint32_t index, ClippedTriangle piece) {
    const kiwami_bvh_node& node = nodes_[index];
    piece.clip(node.lower, node.upper);
    const double area = piece.area();
    if (!(area > 0.0)) return;
    const auto share = static_cast<uint64_t>(std::llround(area / surface_area_ * kWhole));
    std::atomic_ref(foreign_[index]).fetch_add(share, std::memory_order_relaxed);
    visit_children(node, piece);
  }

  std::span<const kiwami_bvh_node> nodes_;
  std::span<const uint32_t> positions_;
  double surface_area_;
  Array<uint64_t>& foreign_;
};

ClippedTriangle triangle_of(uint32_t id, const TriangleSource& source) {
  Vec3f corner[3];
  source.corners_of(id, corner);
  return ClippedTriangle(corner);
}

/// In the order of the positions, whatever the threads.
double sum_surface(const Array<uint32_t>& primitive_ids, const Positions& positions,
                   const TriangleSource& source, Memory& memory, const Parallel& parallel) {
  Array<double> sums(memory, (primitive_ids.size() + kBlockSize - 1) / kBlockSize);
  parallel.for_blocks(primitive_ids.size(), kBlockSize, [&](size_t begin, size_t end) {
    double sum = 0.0;
    for (size_t i = begin; i < end; ++i) {
      const uint32_t id = primitive_ids[i];
      if (positions.of(id)[0] == i) sum += triangle_of(id, source).area();
    }
    sums[begin / kBlockSize] = sum;
  });
  double sum = 0.0;
  for (const double of_block : sums) sum += of_block;
  return sum;
}

}  // namespace

EndPointOverlap measure_end_point_overlap(std::span<const kiwami_bvh_node> nodes,
                                          const Array<uint32_t>& primitive_ids,
                                          const TriangleSource& source, Memory& memory,
                                          const Parallel& parallel) {
  EndPointOverlap overlap{Array<double>(memory, nodes.size()), 0.0};
  overlap.foreign_area.fill_zero();
  const Positions positions(primitive_ids, memory);
  overlap.surface_area = sum_surface(primitive_ids, positions, source, memory, parallel);
  if (!(overlap.surface_area > 0.0)) return overlap;

  Array<uint64_t> foreign(memory, nodes.size());
  foreign.fill_zero();
  parallel.for_blocks(primitive_ids.size(), kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const uint32_t id = primitive_ids[i];
      const std::span<const uint32_t> of_triangle = positions.of(id);
      if (of_triangle[0] != i) continue;
      Descent(nodes, of_triangle, overlap.surface_area, foreign)
          .visit_children(nodes[0], triangle_of(id, source));
    }
  });
  for (size_t i = 0; i < nodes.size(); ++i) {
    overlap.foreign_area[i] = static_cast<double>(foreign[i]) / kWhole;
  }
  return overlap;
}

}  // namespace kiwami

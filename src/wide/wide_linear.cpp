// SPDX-License-Identifier: Apache-2.0
#include "wide/wide_linear.h"

#include <algorithm>
#include <span>

#include "builders/morton_order.h"
#include "builders/sah_bins.h"
#include "core/error.h"
#include "wide/part_arrays.h"

namespace kiwami {
namespace {

constexpr uint32_t kMaxWidth = 16;

/// Boxes that are read while a cache line is under way; most leaves follow each other.
constexpr uint32_t kLookahead = 16;

/// Consecutive primitives along the curve whose codes have the same leading bits.
struct Cell {
  uint32_t begin, end;

  uint32_t size() const { return end - begin; }
};

// No path is too long for the traversal. A node halves width - 1 cells, none smaller than a child that
// it leaves whole: so the codes of the child agree in at least log2(width) leading bits more than
// those of the node. Cells of equal codes come last and have half as many primitives each time.
static_assert(63 / 2 + 32 <= kMaxWideDepth);

class LinearBuild {
 public:
  LinearBuild(Array<BuildPrimitive> primitives, const WideLinearConfig& config, Memory& memory,
              const Parallel& parallel)
      : config_(config),
        memory_(memory),
        parallel_(parallel),
        primitives_(std::move(primitives)),
        order_(sort_morton_codes(primitives_, memory, parallel, CurveCode::kExtended).sorted),
        primitive_ids_(memory, primitives_.size()),
        parts_(memory, parallel) {}

  WideDraft run() {
    const Cell all = {0, static_cast<uint32_t>(primitives_.size())};
    const Array<Cell> cells = part_cells(all);
    const uint32_t first_part = parts_.start_level(cells.size());
    Array<WideCluster> roots(memory_, cells.size());
    parallel_.for_each(cells.size(), [&](size_t i) {
      const uint32_t size = cells[i].size();
      PartArrays arrays(size, 2 * size, size, memory_);
      arrays.start(primitive_ids_.data() + cells[i].begin);
      roots[i] = write_part(cells[i], first_part + static_cast<uint32_t>(i), arrays);
      parts_.set(roots[i].part, arrays.take(memory_));
    });
    parts_.end_level(std::move(roots));
    if (cells.size() > 1) write_top(all, cells);
    primitives_ = Array<BuildPrimitive>();
    order_ = Array<CodedIndex>();
    return parts_.join(std::move(primitive_ids_));
  }

 private:
  static bool is_before(const Cell& a, const Cell& b) { return a.begin < b.begin; }
  bool is_leaf(const Cell& cell) const { return cell.size() <= config_.leaf_width; }
  bool is_part(const Cell& cell) const { return cell.size() <= config_.part_size || is_leaf(cell); }

  /// As large as the cell: what its codes differ in; 0: it is a leaf.
  uint64_t extent_of(const Cell& cell) const {
    if (is_leaf(cell)) return 0;
    return 1 + (order_[cell.begin].code ^ order_[cell.end - 1].code);
  }

  /// Divides a cell among the slots of a node; returns how many are used.
  uint32_t divide(const Cell& whole, Cell* cells) const {
    uint64_t extents[kMaxWidth];
    uint32_t count = 1;
    cells[0] = whole;
    extents[0] = extent_of(whole);
    while (count < config_.width) {
      uint32_t largest = 0;
      for (uint32_t i = 1; i < count; ++i) {
        const bool is_larger = extents[i] != extents[largest]
                                   ? extents[i] > extents[largest]
                                   : cells[i].size() > cells[largest].size();
        if (is_larger) largest = i;
      }
      if (extents[largest] == 0) break;
      const Cell cell = cells[largest];
      const uint32_t middle = middle_of_cell(order_, cell.begin, cell.end);
      cells[largest] = {cell.begin, middle};
      cells[count] = {middle, cell.end};
      extents[largest] = extent_of(cells[largest]);
      extents[count] = extent_of(cells[count]);
      ++count;
    }
    return count;
  }

  /// The cells that parts are made of, from left to right.
  Array<Cell> part_cells(const Cell& all) const {
    GrowingArray<Cell> found(memory_);
    collect_part_cells(all, found);
    Array<Cell> cells = found.take();
    std::sort(cells.begin(), cells.end(), is_before);
    return cells;
  }

  void collect_part_cells(const Cell& cell, GrowingArray<Cell>& cells) const {
    if (is_part(cell)) {
      cells.push_back(cell);
      return;
    }
    Cell children[kMaxWidth];
    const uint32_t count = divide(cell, children);
    for (uint32_t i = 0; i < count; ++i) collect_part_cells(children[i], cells);
  }

  WideCluster write_part(const Cell& cell, uint32_t part, PartArrays& arrays) const {
    WideCluster root = {Bounds::empty(), 0.0f, 0, part, 0};
    if (is_leaf(cell)) {
      root.child = write_leaf(cell, arrays, root.box);
    } else {
      root.child = arrays.add_node();
      root.height = expand(cell, root.child, {}, arrays, root.box);
    }
    return root;
  }

  /// The nodes above all parts: few, so one thread writes them.
  void write_top(const Cell& all, const Array<Cell>& cells) {
    const uint32_t part = parts_.start_level(1);
    const uint32_t most = static_cast<uint32_t>(cells.size());
    PartArrays arrays(most, 2 * most, 0, memory_);
    arrays.start(nullptr);
    Array<WideCluster> root(memory_, 1);
    root[0] = {Bounds::empty(), 0.0f, arrays.add_node(), part, 0};
    root[0].height = expand(all, root[0].child, {cells.data(), cells.size()}, arrays, root[0].box);
    parts_.set(part, arrays.take(memory_));
    parts_.end_level(std::move(root));
  }

  /// Writes a node and all below it, down to the cells that are parts, if there are any; returns
  /// the height, and the box in box.
  uint32_t expand(const Cell& cell, uint32_t node, std::span<const Cell> parts, PartArrays& arrays,
                  Bounds& box) const {
    Cell cells[kMaxWidth];
    const uint32_t count = divide(cell, cells);
    const uint32_t first = arrays.add_slots(node, count);
    uint32_t height = 0;
    for (uint32_t i = 0; i < count; ++i) {
      Bounds of_child = Bounds::empty();
      uint32_t child;
      if (!parts.empty() && is_part(cells[i])) {
        const auto at = std::lower_bound(parts.begin(), parts.end(), cells[i], is_before);
        const uint32_t part = static_cast<uint32_t>(at - parts.begin());
        of_child = parts_.clusters()[part].box;
        height = std::max(height, parts_.clusters()[part].height);
        child = kClusterFlag | part;
      } else {
        child = is_leaf(cells[i]) ? write_leaf(cells[i], arrays, of_child) : arrays.add_node();
      }
      arrays.set_slot(first + i, of_child, child);
    }
    box = Bounds::empty();
    for (uint32_t i = 0; i < count; ++i) {
      const uint32_t child = arrays.child(first + i);
      if ((child & (kLeafFlag | kClusterFlag)) == 0) {
        Bounds of_child;
        height = std::max(height, expand(cells[i], child, parts, arrays, of_child));
        arrays.set_box(first + i, of_child);
      }
      box.extend(arrays.box(first + i));
    }
    arrays.add_node_area(box.half_area());
    return height + 1;
  }

  uint32_t write_leaf(const Cell& cell, PartArrays& arrays, Bounds& box) const {
    uint32_t* ids = arrays.ids();
    VectorBounds bounds = VectorBounds::empty();
    for (uint32_t i = cell.begin; i < cell.end; ++i) {
      if (i + kLookahead < order_.size()) {
        __builtin_prefetch(&primitives_[order_[i + kLookahead].index]);
      }
      const BuildPrimitive& primitive = primitives_[order_[i].index];
      bounds.extend(VectorBounds::of(primitive));
      *ids++ = primitive.id;
    }
    box = bounds.bounds();
    return arrays.add_leaf(ids, box.half_area());
  }

  const WideLinearConfig& config_;
  Memory& memory_;
  const Parallel& parallel_;
  Array<BuildPrimitive> primitives_;
  Array<CodedIndex> order_;
  Array<uint32_t> primitive_ids_;
  WideParts parts_;
};

}  // namespace

WideDraft build_wide_linear(Array<BuildPrimitive> primitives, const WideLinearConfig& config,
                            Memory& memory, const Parallel& parallel) {
  if (config.width != 4 && config.width != 8 && config.width != 16) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "width is %u, expected 4, 8 or 16", config.width);
  }
  if (primitives.empty()) return {};
  return LinearBuild(std::move(primitives), config, memory, parallel).run();
}

}  // namespace kiwami

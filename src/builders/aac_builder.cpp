// SPDX-License-Identifier: Apache-2.0
#include "builders/aac_builder.h"

#include <cmath>

#include "builders/cluster_matrix.h"
#include "bvh/tree_edit.h"

namespace kiwami {
namespace {

/// Cells of at most so many primitives are one task each.
constexpr uint32_t kTaskSize = 4096;
/// No cell hands on more clusters, so that a matrix stays within 256 MiB however large the scene.
constexpr uint32_t kMostClusters = 4096;

/// The clusters of a cell stand from its begin on.
class CellClustering {
 public:
  CellClustering(const Array<uint64_t>& codes, Array<Cluster>& clusters,
                 const AacBuilder::Config& config, BinaryBvh& bvh, Memory& memory,
                 const Parallel& parallel)
      : codes_(codes),
        clusters_(clusters),
        config_(config),
        bvh_(bvh),
        memory_(memory),
        parallel_(parallel),
        cells_(memory),
        levels_(memory) {}

  void run() {
    halve_large_cells();
    parallel_.for_each(cells_.size(), [this](size_t i) {
      Cell& cell = cells_[i];
      if (cell.first_half != 0) return;
      ClusterMatrix matrix(memory_);
      cell.cluster_count = build(cell.begin, cell.end, matrix);
    });
    for (size_t level = levels_.size() - 1; level-- > 0;) {
      const uint32_t first = levels_[level];
      parallel_.for_each(levels_[level + 1] - first, [&](size_t i) { unite(cells_[first + i]); });
    }
    ClusterMatrix(memory_).combine(clusters_.data(), cells_[0].cluster_count, 1, bvh_);
    bvh_.nodes[0] = clusters_[0].node();
  }

 private:
  struct Cell {
    uint32_t begin, end;
    uint32_t first_half;  ///< the other one follows; 0: a task of its own
    uint32_t cluster_count;
  };

  /// Level by level; what is small enough is left to the tasks.
  void halve_large_cells() {
    cells_.push_back({0, static_cast<uint32_t>(clusters_.size()), 0, 0});
    levels_.push_back(0);
    for (uint32_t i = 0; i < cells_.size(); ++i) {
      if (i == levels_.back()) levels_.push_back(static_cast<uint32_t>(cells_.size()));
      const Cell cell = cells_[i];
      if (cell.end - cell.begin <= kTaskSize) continue;
      const uint32_t middle = middle_of_cell(codes_, cell.begin, cell.end);
      cells_[i].first_half = static_cast<uint32_t>(cells_.size());
      cells_.push_back({cell.begin, middle, 0, 0});
      cells_.push_back({middle, cell.end, 0, 0});
    }
  }

  /// What the paper calls f.
  uint32_t clusters_of(uint32_t size) const {
    const double wanted = 0.5 * std::pow(config_.cell_size, 0.5 + config_.epsilon) *
                          std::pow(size, 0.5 - config_.epsilon);
    return static_cast<uint32_t>(std::clamp(std::round(wanted), 1.0, double{kMostClusters}));
  }

  /// Returns how many clusters are left. No deeper than a code has bits and then halves.
  uint32_t build(uint32_t begin, uint32_t end, ClusterMatrix& matrix) {
    if (end - begin < config_.cell_size) {
      return matrix.combine(&clusters_[begin], end - begin, clusters_of(config_.cell_size), bvh_);
    }
    const uint32_t middle = middle_of_cell(codes_, begin, end);
    const uint32_t left = build(begin, middle, matrix);
    const uint32_t right = build(middle, end, matrix);
    return combine_halves(begin, left, middle, right, clusters_of(end - begin), matrix);
  }

  void unite(Cell& cell) {
    if (cell.first_half == 0) return;
    const Cell &left = cells_[cell.first_half], &right = cells_[cell.first_half + 1];
    ClusterMatrix matrix(memory_);
    cell.cluster_count =
        combine_halves(left.begin, left.cluster_count, right.begin, right.cluster_count,
                       clusters_of(cell.end - cell.begin), matrix);
  }

  uint32_t combine_halves(uint32_t begin, uint32_t left_count, uint32_t middle,
                          uint32_t right_count, uint32_t target, ClusterMatrix& matrix) {
    Cluster* first = &clusters_[begin];
    std::copy_n(&clusters_[middle], right_count, first + left_count);
    return matrix.combine(first, left_count + right_count, target, bvh_);
  }

  const Array<uint64_t>& codes_;
  Array<Cluster>& clusters_;
  const AacBuilder::Config& config_;
  BinaryBvh& bvh_;
  Memory& memory_;
  const Parallel& parallel_;
  GrowingArray<Cell> cells_;
  GrowingArray<uint32_t> levels_;  ///< where each level of cells begins, and their end
};

}  // namespace

BinaryBvh AacBuilder::build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                            const Parallel& parallel) {
  if (primitives.empty()) return {};
  BinaryBvh bvh;
  {
    MortonOrder order =
        sort_by_morton_code(std::move(primitives), memory, parallel, config.curve_code);
    Array<Cluster> clusters;
    bvh = separate(std::move(order.primitives), clusters, memory);
    CellClustering(order.codes, clusters, config, bvh, memory, parallel).run();
  }
  relabel_depth_first(bvh, memory);
  limit_depth(bvh, memory);
  return bvh;
}

}  // namespace kiwami

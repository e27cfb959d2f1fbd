// SPDX-License-Identifier: Apache-2.0
#include "optimizers/treelet_restructuring.h"

#include <bit>
#include <limits>

namespace kiwami {
namespace {

constexpr uint32_t kMaxOptimalLeaves = 8;

/// The least cost of each subset of a treelet's leaves, and how it is divided.
class SubsetTable {
 public:
  SubsetTable(const TreeletCluster* leaves, uint32_t count, const ClusterCosts& costs) {
    bounds_[0] = Bounds::empty();
    primitive_counts_[0] = 0;
    // A subset's own subsets are lesser numbers.
    for (uint32_t subset = 1; subset < 1u << count; ++subset) {
      const uint32_t rest = subset & (subset - 1);
      const TreeletCluster& leaf = leaves[std::countr_zero(subset)];
      bounds_[subset] = bounds_[rest];
      bounds_[subset].extend(leaf.bounds);
      primitive_counts_[subset] = primitive_counts_[rest] + leaf.primitive_count;
      costs_[subset] = rest == 0 ? leaf.cost
                                 : costs.of(bounds_[subset].half_area(), primitive_counts_[subset],
                                            divide(subset));
    }
  }

  double cost(uint32_t subset) const { return costs_[subset]; }
  uint32_t part(uint32_t subset) const { return parts_[subset]; }

 private:
  /// The least cost of two parts.
  double divide(uint32_t subset) {
    // All parts that lack the lowest leaf, so that each division is tried once.
    const uint32_t movable = subset & (subset - 1);
    double least = std::numeric_limits<double>::infinity();
    for (uint32_t part = movable; part != 0; part = (part - 1) & movable) {
      const double cost = costs_[part] + costs_[subset ^ part];
      if (cost >= least) continue;
      least = cost;
      parts_[subset] = static_cast<uint8_t>(part);
    }
    return least;
  }

  Bounds bounds_[1u << kMaxOptimalLeaves];
  double costs_[1u << kMaxOptimalLeaves];
  uint32_t primitive_counts_[1u << kMaxOptimalLeaves];
  uint8_t parts_[1u << kMaxOptimalLeaves];
};

class OptimalShaper {
 public:
  explicit OptimalShaper(const TreeletConfig& config) : costs_(config) {}

  bool shape(const TreeletCluster* leaves, uint32_t count, double cost, Join* joins) const {
    const SubsetTable table(leaves, count, costs_);
    const uint32_t all = (1u << count) - 1;
    // What rounding alone could gain is left alone.
    if (!(table.cost(all) < cost * (1.0 - 1e-9))) return false;
    uint32_t made = 0;
    emit(table, all, count, joins, made);
    return true;
  }

 private:
  /// Writes the joins of a subset; returns its cluster.
  static uint32_t emit(const SubsetTable& table, uint32_t subset, uint32_t count, Join* joins,
                       uint32_t& made) {
    if (std::has_single_bit(subset)) return static_cast<uint32_t>(std::countr_zero(subset));
    const uint32_t part = table.part(subset);
    const uint32_t left = emit(table, subset ^ part, count, joins, made);
    const uint32_t right = emit(table, part, count, joins, made);
    joins[made] = {left, right};
    return count + made++;
  }

  ClusterCosts costs_;
};

}  // namespace

void optimize_by_treelets(BinaryBvh& bvh, const TreeletConfig& config, Memory& memory,
                          const Parallel& parallel) {
  if (bvh.nodes.empty()) return;
  {
    const OptimalShaper shaper(config);
    TreeletPass(bvh, config, shaper, memory).run(parallel);
  }
  relabel_depth_first(bvh, memory);
  limit_depth(bvh, memory);
}

}  // namespace kiwami

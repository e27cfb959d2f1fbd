// SPDX-License-Identifier: Apache-2.0
#include "measure/tree_summary.h"

#include <algorithm>
#include <numeric>

namespace kiwami::tools {
namespace {

class Summary {
 public:
  Summary(std::span<const kiwami_bvh_node> nodes, const NodeFigures& figures, size_t most_rows)
      : nodes_(nodes), figures_(figures) {
    sum_subtrees();
    choose(most_rows);
  }

  std::vector<SummaryRow> make() {
    rows_.push_back(row_of(0, -1));
    // Rows are added while they are walked: those of a node's children follow it.
    for (size_t row = 0; row < rows_.size(); ++row) {
      if (rows_[row].kind == RowKind::kInner) add_children(row);
    }
    return std::move(rows_);
  }

 private:
  /// Children come after their parents, so one pass from the end adds everything up.
  void sum_subtrees() {
    subtree_cost_.resize(nodes_.size());
    for (size_t i = 0; i < nodes_.size(); ++i) subtree_cost_[i] = figures_.measures[i].sah;
    subtree_nodes_.assign(nodes_.size(), 1);
    for (size_t i = nodes_.size(); i-- > 1;) {
      subtree_cost_[nodes_[i].parent] += subtree_cost_[i];
      subtree_nodes_[nodes_[i].parent] += subtree_nodes_[i];
    }
  }

  /// A subtree costs no more than one that holds it, and among equals the upper one comes first: so
  /// the parent of a chosen node is chosen, too. Each of them brings at most one row for the rest
  /// of its children.
  void choose(size_t most_rows) {
    chosen_.assign(nodes_.size(), nodes_.size() <= most_rows ? 1 : 0);
    if (nodes_.size() <= most_rows) return;
    const size_t count = std::max<size_t>(most_rows / 2, 1);
    std::vector<uint32_t> order(nodes_.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto costs_more = [this](uint32_t a, uint32_t b) {
      return subtree_cost_[a] != subtree_cost_[b] ? subtree_cost_[a] > subtree_cost_[b] : a < b;
    };
    std::nth_element(order.begin(), order.begin() + static_cast<ptrdiff_t>(count - 1), order.end(),
                     costs_more);
    for (size_t i = 0; i < count; ++i) chosen_[order[i]] = 1;
    // A single row that has no child of its own shows the whole tree.
    if (most_rows == 1) chosen_[0] = 0;
  }

  SummaryRow row_of(uint32_t number, int32_t parent) const {
    const kiwami_bvh_node& node = nodes_[number];
    SummaryRow row{};
    row.kind = node.child_count == 0  ? RowKind::kLeaf
               : chosen_[number] != 0 ? RowKind::kInner
                                      : RowKind::kFolded;
    row.parent = parent;
    row.node = number;
    row.depth = node.depth;
    row.member_count = 1;
    std::copy_n(node.lower, 3, row.lower);
    std::copy_n(node.upper, 3, row.upper);
    row.area = figures_.measures[number].area;
    row.cost = figures_.measures[number].sah;
    row.subtree_cost = subtree_cost_[number];
    row.subtree_node_count = subtree_nodes_[number];
    row.primitive_count = node.primitive_count;
    row.overlap = figures_.measures[number].epo;
    row.visits = figures_.visits.empty() ? 0 : figures_.visits[number];
    return row;
  }

  void add_children(size_t parent_row) {
    const kiwami_bvh_node& parent = nodes_[rows_[parent_row].node];
    const auto parent_number = static_cast<int32_t>(parent_row);
    std::vector<uint32_t> rest;
    for (uint32_t i = 0; i < parent.child_count; ++i) {
      const uint32_t child = parent.first_child + i;
      if (chosen_[child] != 0) {
        rows_.push_back(row_of(child, parent_number));
      } else {
        rest.push_back(child);
      }
    }
    if (rest.empty()) return;
    SummaryRow group = row_of(rest[0], parent_number);
    for (size_t i = 1; i < rest.size(); ++i) join(group, row_of(rest[i], parent_number));
    rows_.push_back(group);
  }

  static void join(SummaryRow& group, const SummaryRow& other) {
    group.kind = RowKind::kGroup;
    ++group.member_count;
    for (int axis = 0; axis < 3; ++axis) {
      group.lower[axis] = std::min(group.lower[axis], other.lower[axis]);
      group.upper[axis] = std::max(group.upper[axis], other.upper[axis]);
    }
    group.area += other.area;
    group.cost += other.cost;
    group.subtree_cost += other.subtree_cost;
    group.subtree_node_count += other.subtree_node_count;
    group.primitive_count += other.primitive_count;
    group.overlap += other.overlap;
    group.visits += other.visits;
  }

  std::span<const kiwami_bvh_node> nodes_;
  const NodeFigures& figures_;
  std::vector<double> subtree_cost_;
  std::vector<uint64_t> subtree_nodes_;
  std::vector<uint8_t> chosen_;
  std::vector<SummaryRow> rows_;
};

}  // namespace

std::vector<SummaryRow> summarize(std::span<const kiwami_bvh_node> nodes,
                                  const NodeFigures& figures, size_t most_rows) {
  if (nodes.empty()) return {};
  return Summary(nodes, figures, most_rows).make();
}

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#include "lights/radix_tree_forest.h"

#include <algorithm>
#include <bit>

namespace kiwami {
namespace {

constexpr size_t kCellsOfTask = 16384;

}  // namespace

RadixTreeForest::RadixTreeForest(const Array<double>& weights, Memory& memory,
                                 const Parallel& parallel)
    : bounds_(memory, weights.size()),
      children_(memory, weights.size() - 1),
      cells_(memory, weights.size()) {
  double total = 0.0;
  for (size_t i = 0; i < weights.size(); ++i) {
    bounds_[i] = total;
    total += weights[i];
  }
  // A quotient of rising sums rises: rounding keeps the order.
  for (double& bound : bounds_) bound /= total;
  Array<uint32_t> stack(memory, children_.size());
  parallel.for_blocks(cells_.size(), kCellsOfTask, [&](size_t begin, size_t end) {
    auto node = first_node_of(static_cast<uint32_t>(begin));
    for (auto cell = static_cast<uint32_t>(begin); cell < end; ++cell) {
      const uint32_t next = first_node_of(cell + 1);
      plant(cell, node, next, stack.data() + node);
      node = next;
    }
  });
}

/// Of a bound or a random number below 1. It rises with the value.
uint32_t RadixTreeForest::cell_of(double value) const {
  const auto last = static_cast<uint32_t>(cells_.size() - 1);
  return std::min(static_cast<uint32_t>(value * static_cast<double>(cells_.size())), last);
}

/// The first of the nodes whose keys lie in the cell or behind it. Keys of 1 lie behind all.
uint32_t RadixTreeForest::first_node_of(uint32_t cell) const {
  const double* const keys = bounds_.begin() + 1;
  const double* const place = std::partition_point(
      keys, bounds_.end(), [&](double key) { return key < 1.0 && cell_of(key) < cell; });
  return static_cast<uint32_t>(place - keys);
}

/// The bits in which the keys around a node differ. The first interval of a cell may begin before.
uint64_t RadixTreeForest::difference(uint32_t node, uint32_t cell) const {
  const double left_end = static_cast<double>(cell) / static_cast<double>(cells_.size());
  return std::bit_cast<uint64_t>(std::max(bounds_[node], left_end)) ^
         std::bit_cast<uint64_t>(bounds_[node + 1]);
}

/// Whether a node stands above one that follows it: where a higher bit differs. Equal keys, of
/// numbers without weight, are told apart by their places.
bool RadixTreeForest::is_above(uint32_t node, uint32_t other, uint32_t cell) const {
  const int zeros = std::countl_zero(difference(node, cell));
  const int other_zeros = std::countl_zero(difference(other, cell));
  if (zeros != other_zeros) return zeros < other_zeros;
  return (node ^ (node + 1)) >= (other ^ (other + 1));
}

/// Builds the tree over the nodes of a cell. The stack, of as many places, holds the nodes on the
/// way from the root to the last one.
void RadixTreeForest::plant(uint32_t cell, uint32_t begin, uint32_t end, uint32_t* stack) {
  uint32_t height = 0;
  for (uint32_t node = begin; node < end; ++node) {
    int32_t below = ~static_cast<int32_t>(node);
    while (height > 0 && !is_above(stack[height - 1], node, cell)) {
      below = static_cast<int32_t>(stack[--height]);
    }
    children_[node] = {below, ~static_cast<int32_t>(node + 1)};
    if (height > 0) children_[stack[height - 1]].right = static_cast<int32_t>(node);
    stack[height++] = node;
  }
  cells_[cell] = static_cast<int32_t>(height > 0 ? stack[0] : ~begin);
}

Draw RadixTreeForest::draw(double random) const {
  int32_t place = cells_[cell_of(random)];
  while (place >= 0) {
    const Node& node = children_[static_cast<uint32_t>(place)];
    place = random < bounds_[static_cast<uint32_t>(place) + 1] ? node.left : node.right;
  }
  const auto index = static_cast<uint32_t>(~place);
  const double lower = bounds_[index];
  return {index, std::min((random - lower) / (upper_bound(index) - lower), Draw::kGreatestRandom)};
}

double RadixTreeForest::probability(uint32_t index) const {
  return upper_bound(index) - bounds_[index];
}

/// Those of random numbers from low to high, which come to this place at this depth. No deeper than
/// a key has bits and a place, too.
void RadixTreeForest::add_steps(int32_t place, double low, double high, uint32_t depth,
                                Steps& steps) const {
  if (!(low < high)) return;
  if (place < 0) {
    steps.most = std::max(steps.most, depth);
    return;
  }
  steps.mean += high - low;
  const Node& node = children_[static_cast<uint32_t>(place)];
  const double key = bounds_[static_cast<uint32_t>(place) + 1];
  add_steps(node.left, low, std::min(key, high), depth + 1, steps);
  add_steps(node.right, std::max(key, low), high, depth + 1, steps);
}

RadixTreeForest::Steps RadixTreeForest::steps() const {
  Steps all{0.0, 0};
  const auto count = static_cast<double>(cells_.size());
  for (size_t cell = 0; cell < cells_.size(); ++cell) {
    const auto left = static_cast<double>(cell);
    add_steps(cells_[cell], left / count, (left + 1.0) / count, 0, all);
  }
  return all;
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "lights/saoh_builder.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace kiwami {
namespace {

/// Groups from this depth on are halved by number.
constexpr uint32_t kBalancedDepth = 48;
/// Octants of directed lights, then all others.
constexpr uint32_t kOctantGroups = 9;
/// Subtrees of at most as many lights are built by one task.
constexpr uint32_t kTaskSize = 4096;
/// Centres that are nearer to each other are not told apart.
constexpr float kLeastExtent = 1e-30f;

struct Bin {
  Bounds box = Bounds::empty();
  Cone cone;
  double power = 0.0;
  uint32_t count = 0;

  void add(const LightRecord& light) {
    box.extend(light.box);
    if (light.power > 0.0f) cone = merge(cone, light.cone());
    power += static_cast<double>(light.power);
    ++count;
  }
  void add(const Bin& other) {
    if (other.count == 0) return;
    box.extend(other.box);
    cone = merge(cone, other.cone);
    power += other.power;
    count += other.count;
  }
};

/// A subtree to build: leaf numbers first .. first + count become the nodes from node on.
struct Task {
  uint32_t first, count;
  uint32_t node;
  uint32_t depth;
  uint32_t first_group, last_group;  ///< the groups that it holds, both included
};

struct Split {
  double cost = std::numeric_limits<double>::infinity();
  int axis = -1;
  uint32_t last_left_bin = 0;
};

float centre_of(const Bounds& box, int axis) {
  return 0.5f * box.lower[axis] + 0.5f * box.upper[axis];
}

uint32_t group_of(const LightRecord& light) {
  if (light.is_two_sided || light.cos_spread < 0.0f) return kOctantGroups - 1;
  return (light.axis.x < 0.0f ? 1u : 0u) | (light.axis.y < 0.0f ? 2u : 0u) |
         (light.axis.z < 0.0f ? 4u : 0u);
}

/// Maps centres along one axis to bins.
struct BinMap {
  int axis;
  float lower, scale;
  uint32_t bin_count;

  uint32_t operator()(const LightRecord& light) const {
    const float position = (centre_of(light.box, axis) - lower) * scale;
    return std::min(static_cast<uint32_t>(std::max(position, 0.0f)), bin_count - 1);
  }
};

class Build {
 public:
  Build(const LightLeaves& leaves, Array<uint32_t>& numbers, const SaohBuilder::Config& config,
        Memory& memory)
      : leaves_(leaves),
        numbers_(numbers),
        scratch_(memory, numbers.size()),
        links_(memory, 2 * numbers.size() - 1),
        config_(config),
        area_measure_(bounds_of({0, static_cast<uint32_t>(numbers.size()), 0, 0, 0, 0})) {}

  LightLinks run(Memory& memory, const Parallel& parallel) {
    const auto count = static_cast<uint32_t>(numbers_.size());
    const Task root{0, count, 0, 0, 0, config_.sorts_by_octant ? kOctantGroups - 1 : 0};
    GrowingArray<Task> pending(memory), tasks(memory);
    pending.push_back(root);
    while (!pending.empty()) {
      const Task task = pending.back();
      pending.pop_back();
      if (task.count <= kTaskSize) {
        tasks.push_back(task);
      } else {
        split(task, [&](const Task& child) { pending.push_back(child); });
      }
    }
    parallel.for_each(tasks.size(), [&](size_t i) { build_subtree(tasks[i]); });
    return std::move(links_);
  }

 private:
  void build_subtree(const Task& root) {
    // Each level leaves one task behind.
    Task stack[kMaxLightDepth + kOctantGroups];
    size_t size = 0;
    stack[size++] = root;
    while (size != 0) {
      const Task task = stack[--size];
      split(task, [&](const Task& child) { stack[size++] = child; });
    }
  }

  /// Makes the node of a task, and emits the tasks of its children.
  template <typename Emit>
  void split(const Task& task, Emit&& emit) {
    if (task.count == 1) {
      links_[task.node] = kLightLeafBit | numbers_[task.first];
      return;
    }
    Task left = task, right = task;
    const uint32_t left_count =
        task.first_group < task.last_group ? part_groups(task, left, right) : part_by_cost(task);
    if (left_count == 0 || left_count == task.count) {
      // All are of one half of the groups: the same node again.
      emit(left_count == 0 ? right : left);
      return;
    }
    left.count = left_count;
    left.node = task.node + 1;
    right.first = task.first + left_count;
    right.count = task.count - left_count;
    right.node = task.node + 2 * left_count;
    left.depth = right.depth = task.depth + 1;
    links_[task.node] = right.node;
    emit(right);
    emit(left);
  }

  uint32_t part_groups(const Task& task, Task& left, Task& right) {
    // The ninth group first, then halves of the octants.
    const uint32_t last_left = task.last_group == kOctantGroups - 1
                                   ? kOctantGroups - 2
                                   : (task.first_group + task.last_group) / 2;
    left.last_group = last_left;
    right.first_group = last_left + 1;
    return partition(task, [&](const LightRecord& light) { return group_of(light) <= last_left; });
  }

  /// Never all or none.
  uint32_t part_by_cost(const Task& task) {
    const uint32_t half = task.count / 2;
    if (task.depth >= kBalancedDepth) return half;
    Bounds centres = Bounds::empty();
    for (uint32_t i = 0; i < task.count; ++i) {
      const Bounds& box = light(task, i).box;
      centres.extend(Vec3f{centre_of(box, 0), centre_of(box, 1), centre_of(box, 2)});
    }
    const Split best = find_split(task, centres);
    if (best.axis < 0) return half;
    const BinMap map = map_of(centres, best.axis);
    const uint32_t left_count =
        partition(task, [&](const LightRecord& light) { return map(light) <= best.last_left_bin; });
    return left_count == 0 || left_count == task.count ? half : left_count;
  }

  Split find_split(const Task& task, const Bounds& centres) const {
    const Vec3f extent = bounds_of(task).upper - bounds_of(task).lower;
    const float longest = std::max({extent.x, extent.y, extent.z});
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(centres.upper[axis] - centres.lower[axis] > kLeastExtent)) continue;
      const BinMap map = map_of(centres, axis);
      Bin bins[SaohBuilder::kMaxBinCount];
      for (uint32_t i = 0; i < task.count; ++i) bins[map(light(task, i))].add(light(task, i));
      // Thin boxes are worth less (K_r of the paper).
      const double regulariser = static_cast<double>(longest) / static_cast<double>(extent[axis]);
      consider(bins, axis, regulariser, best);
    }
    return best;
  }

  /// Compares the planes between the bins of one axis.
  void consider(const Bin* bins, int axis, double regulariser, Split& best) const {
    double right_cost[SaohBuilder::kMaxBinCount];
    uint32_t right_count[SaohBuilder::kMaxBinCount];
    Bin right;
    for (uint32_t i = config_.bin_count; i-- > 1;) {
      right.add(bins[i]);
      right_cost[i] = cost_of(right);
      right_count[i] = right.count;
    }
    Bin left;
    for (uint32_t i = 0; i + 1 < config_.bin_count; ++i) {
      left.add(bins[i]);
      if (left.count == 0 || right_count[i + 1] == 0) continue;
      const double cost = regulariser * (cost_of(left) + right_cost[i + 1]);
      if (cost < best.cost) best = {cost, axis, i};
    }
  }

  double cost_of(const Bin& bin) const {
    if (bin.count == 0) return 0.0;
    const double cost = bin.power * area_measure_(bin.box);
    return config_.sorts_by_octant ? cost : cost * orientation_measure(bin.cone);
  }

  /// Keeps the order on both sides.
  template <typename IsLeft>
  uint32_t partition(const Task& task, IsLeft&& is_left) {
    uint32_t left_count = 0, right_count = 0;
    uint32_t* numbers = numbers_.data() + task.first;
    uint32_t* others = scratch_.data() + task.first;
    for (uint32_t i = 0; i < task.count; ++i) {
      const uint32_t number = numbers[i];
      if (is_left(leaves_[number])) {
        numbers[left_count++] = number;
      } else {
        others[right_count++] = number;
      }
    }
    std::memcpy(numbers + left_count, others, right_count * sizeof(uint32_t));
    return left_count;
  }

  BinMap map_of(const Bounds& centres, int axis) const {
    const float extent = centres.upper[axis] - centres.lower[axis];
    return {axis, centres.lower[axis], static_cast<float>(config_.bin_count) / extent,
            config_.bin_count};
  }

  Bounds bounds_of(const Task& task) const {
    Bounds box = Bounds::empty();
    for (uint32_t i = 0; i < task.count; ++i) box.extend(light(task, i).box);
    return box;
  }

  const LightRecord& light(const Task& task, uint32_t i) const {
    return leaves_[numbers_[task.first + i]];
  }

  const LightLeaves& leaves_;
  Array<uint32_t>& numbers_;
  Array<uint32_t> scratch_;
  LightLinks links_;
  const SaohBuilder::Config& config_;
  AreaMeasure area_measure_;
};

}  // namespace

LightLinks SaohBuilder::build(const LightLeaves& leaves, Array<uint32_t>& leaf_numbers,
                              const Config& config, Memory& memory, const Parallel& parallel) {
  return Build(leaves, leaf_numbers, config, memory).run(memory, parallel);
}

}  // namespace kiwami

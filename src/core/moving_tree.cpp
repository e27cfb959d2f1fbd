// SPDX-License-Identifier: Apache-2.0
#include "core/moving_tree.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/saved_scene.h"
#include "kiwami/moving_mesh.h"
#include "math/rounding.h"

namespace kiwami {
namespace {

/// Bounds of a slot that nothing is in during a segment: they stay finite at any time between.
constexpr float kUnused = 0x1p100f;
constexpr uint32_t kMaxSegments = KIWAMI_MAX_TIME_STEPS - 1;
/// Segments are halved up to so many, and once: a second time takes twice as long as the first and
/// gains little.
constexpr uint32_t kMostHalves = 16;
/// Segments are halved where the boxes get smaller than this part of what they were, on average
/// over time; where they may, those in the middle get smaller by twice as much.
constexpr double kWorthwhile = 0.9, kPromising = 0.85;
/// Segments that are looked at for that.
constexpr uint32_t kSampledSegments = 4;

/// A box at a part of the way through its segment; empty for an unused slot.
template <int N>
Bounds box_at(const MotionBounds<N>& node, uint32_t slot, float fraction) {
  Bounds box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = [&](int side) {
      return (1.0f - fraction) * node.bounds[0][axis][side][slot] +
             fraction * node.bounds[1][axis][side][slot];
    };
    box.lower[axis] = at(0);
    box.upper[axis] = at(1);
  }
  return box;
}

/// Walks a tree from its leaves up, for one segment of time.
template <int N>
class BoundsFiller {
 public:
  BoundsFiller(const WideTree& tree, const MovingSource& source, const TimeSteps& steps,
               uint32_t segment, MotionBounds<N>* bounds)
      : tree_(tree), source_(source), steps_(steps), segment_(segment), bounds_(bounds) {}

  /// What is below a reference; writes the bounds of all nodes below.
  LinearBounds fill(ChildReference reference) {
    LinearBounds below;
    if (reference.is_leaf()) {
      const uint32_t* ids = tree_.leaf_ids(tree_.number_of(reference));
      for (uint32_t lane = 0; lane < N; ++lane) {
        if (((reference.mask() >> lane) & 1u) != 0)
          below.extend(source_.during(ids[lane], steps_, segment_));
      }
      return below;
    }
    const WideNode<N>& node = tree_.nodes<N>()[tree_.number_of(reference)];
    for (uint32_t slot = 0; slot < N; ++slot) {
      if (((reference.mask() >> slot) & 1u) == 0) continue;
      below.extend(fill_slot(reference, slot, node.child[slot]));
    }
    return below;
  }

  /// The same of one slot of a node.
  LinearBounds fill_slot(ChildReference node, uint32_t slot, ChildReference child) {
    const LinearBounds below = fill(child);
    MotionBounds<N>& target = bounds_[tree_.number_of(node)];
    write(target.bounds[0], slot, below.start);
    write(target.bounds[1], slot, below.end);
    return below;
  }

  static void clear(MotionBounds<N>& bounds) {
    for (auto& at_time : bounds.bounds) {
      for (auto& axis : at_time) {
        std::fill_n(axis[0], N, kUnused);
        std::fill_n(axis[1], N, -kUnused);
      }
    }
  }

 private:
  void write(float (&bounds)[3][2][N], uint32_t slot, const Bounds& box) const {
    if (box.is_empty()) return;
    for (int axis = 0; axis < 3; ++axis) {
      const float centre = tree_.view.centre[axis];
      bounds[axis][0][slot] = subtract_down(box.lower[axis], centre);
      bounds[axis][1][slot] = subtract_up(box.upper[axis], centre);
    }
  }

  const WideTree& tree_;
  const MovingSource& source_;
  const TimeSteps& steps_;
  uint32_t segment_;
  MotionBounds<N>* bounds_;
};

/// Walks a tree from its leaves up in the middle of a segment, and adds the areas of its boxes there:
/// as they are, and as they would be if the segment were divided.
template <int N>
class MiddleAreas {
 public:
  MiddleAreas(const WideTree& tree, const MovingSource& source, const TimeSteps& steps,
              uint32_t segment, const MotionBounds<N>* bounds)
      : tree_(tree),
        source_(source),
        time_(static_cast<float>(steps.begin + (double{steps.end} - steps.begin) *
                                                   ((segment + 0.5) / steps.segment_count))),
        bounds_(bounds) {}

  Bounds add_slot(ChildReference node, uint32_t slot, ChildReference child) {
    const Bounds below = add(child);
    if (below.is_empty()) return below;
    divided += double{below.half_area()};
    undivided += double{box_at<N>(bounds_[tree_.number_of(node)], slot, 0.5f).half_area()};
    return below;
  }

  double undivided = 0.0, divided = 0.0;

 private:
  Bounds add(ChildReference reference) {
    Bounds below = Bounds::empty();
    for (uint32_t i = 0; i < N; ++i) {
      if (((reference.mask() >> i) & 1u) == 0) continue;
      const uint64_t number = tree_.number_of(reference);
      below.extend(reference.is_leaf() ? source_.at(tree_.leaf_ids(number)[i], time_)
                                       : add_slot(reference, i, tree_.nodes<N>()[number].child[i]));
    }
    return below;
  }

  const WideTree& tree_;
  const MovingSource& source_;
  float time_;
  const MotionBounds<N>* bounds_;
};

/// Walks a tree from its leaves up, at one time.
template <int N>
class BoundsChecker {
 public:
  BoundsChecker(const WideTree& tree, const MovingBoxes& boxes, const MovingSource& source,
                float time)
      : tree_(tree), boxes_(boxes), source_(source), time_(time) {
    if (!place_in_time(boxes.time, time, place_)) {
      throw Error(KIWAMI_ERROR_VALIDATION, "time %g lies outside of that of a moving tree",
                  double{time});
    }
  }

  /// The box of all primitives below at the time. Throws where a box does not hold those below it.
  Bounds check(ChildReference reference) const {
    Bounds below = Bounds::empty();
    for (uint32_t i = 0; i < N; ++i) {
      if (((reference.mask() >> i) & 1u) == 0) continue;
      below.extend(reference.is_leaf()
                       ? source_.at(tree_.leaf_ids(tree_.number_of(reference))[i], time_)
                       : check_slot(reference, i));
    }
    return below;
  }

 private:
  Bounds check_slot(ChildReference node, uint32_t slot) const {
    const uint64_t number = tree_.number_of(node);
    const Bounds below = check(tree_.nodes<N>()[number].child[slot]);
    if (below.is_empty()) return below;
    const auto* const bounds = reinterpret_cast<const MotionBounds<N>*>(boxes_.bounds);
    const Bounds box =
        box_at<N>(bounds[place_.segment * boxes_.node_count + number], slot, place_.fraction);
    for (int axis = 0; axis < 3; ++axis) {
      const float centre = tree_.view.centre[axis];
      if (box.lower[axis] <= subtract_down(below.lower[axis], centre) &&
          subtract_up(below.upper[axis], centre) <= box.upper[axis]) {
        continue;
      }
      throw Error(KIWAMI_ERROR_VALIDATION,
                  "slot %u of node %llu does not hold what is below it at the time %g", slot,
                  static_cast<unsigned long long>(number), double{time_});
    }
    return below;
  }

  const WideTree& tree_;
  const MovingBoxes& boxes_;
  const MovingSource& source_;
  float time_;
  TimePlace place_{};
};

}  // namespace

TimeSteps common_steps(const TimeSteps* steps, size_t count) {
  TimeSteps common = steps[0];
  for (size_t i = 1; i < count; ++i) {
    common.begin = std::min(common.begin, steps[i].begin);
    common.end = std::max(common.end, steps[i].end);
  }
  double most = 1.0;
  for (size_t i = 0; i < count; ++i) {
    const double part =
        (double{steps[i].end} - steps[i].begin) / (double{common.end} - common.begin);
    most = std::max(most, steps[i].segment_count / part);
  }
  common.segment_count = static_cast<uint32_t>(std::min(std::ceil(most), double{kMaxSegments}));
  return common;
}

void MovingTree::build(Array<BuildPrimitive> boxes, const Bounds& extent, const TimeSteps& time,
                       const MovingSource& source, const PartPlan& plan) {
  tree_ = build_part_tree(std::move(boxes), plan);
  tree_.bounds = extent;
  time_ = time;
  if (plan.width == 4) bound<4>(source, plan);
  if (plan.width == 8) bound<8>(source, plan);
  if (plan.width == 16) bound<16>(source, plan);
}

template <int N>
void MovingTree::bound(const MovingSource& source, const PartPlan& plan) {
  Memory& memory = plan.memory;
  const Parallel& parallel = plan.parallel;
  fill<N>(source, memory, parallel);
  if (plan.parameters.whole(KIWAMI_PARAMETER_DIVIDE_TIME) == 0) return;
  if (2 * time_.segment_count > kMostHalves) return;
  if (!is_promising<N>(source, memory, parallel)) return;
  const double area = mean_area<N>(memory, parallel);
  Array<unsigned char> before = std::move(bounds_);
  time_.segment_count *= 2;
  fill<N>(source, memory, parallel);
  if (mean_area<N>(memory, parallel) <= kWorthwhile * area) return;
  bounds_ = std::move(before);
  time_.segment_count /= 2;
}

/// Whether divided segments may be worthwhile, which costs less to find out than to divide them.
template <int N>
bool MovingTree::is_promising(const MovingSource& source, Memory& memory,
                              const Parallel& parallel) const {
  const WideTree& tree = tree_.tree;
  const ChildReference root = tree.view.root;
  if (root.mask() == 0 || root.is_leaf()) return false;
  struct Areas {
    double undivided, divided;
  };
  const uint32_t samples = std::min(kSampledSegments, time_.segment_count);
  Array<Areas> areas(memory, size_t{N} * samples);
  const auto* const bounds = reinterpret_cast<const MotionBounds<N>*>(bounds_.data());
  const WideNode<N>& node = tree.nodes<N>()[tree.number_of(root)];
  parallel.for_each(areas.size(), [&](size_t task) {
    const auto slot = static_cast<uint32_t>(task % N);
    const uint32_t segment = static_cast<uint32_t>(task / N) * time_.segment_count / samples;
    MiddleAreas<N> sum(tree, source, time_, segment, bounds + segment * tree.node_count);
    if (((root.mask() >> slot) & 1u) != 0) sum.add_slot(root, slot, node.child[slot]);
    areas[task] = {sum.undivided, sum.divided};
  });
  Areas all{0.0, 0.0};
  for (const Areas& some : areas) {
    all.undivided += some.undivided;
    all.divided += some.divided;
  }
  return all.divided < kPromising * all.undivided;
}

/// The sum of the areas of all boxes, on average over time.
template <int N>
double MovingTree::mean_area(Memory& memory, const Parallel& parallel) const {
  const uint64_t node_count = tree_.tree.node_count;
  const auto* const bounds = reinterpret_cast<const MotionBounds<N>*>(bounds_.data());
  Array<double> sums(memory, time_.segment_count);
  parallel.for_each(time_.segment_count, [&](size_t segment) {
    double sum = 0.0;
    for (uint64_t node = 0; node < node_count; ++node) {
      for (uint32_t slot = 0; slot < N; ++slot) {
        for (const float f : {1.0f / 6.0f, 0.5f, 5.0f / 6.0f}) {
          sum += double{box_at<N>(bounds[segment * node_count + node], slot, f).half_area()};
        }
      }
    }
    sums[segment] = sum;
  });
  double all = 0.0;
  for (const double sum : sums) all += sum;
  return all / time_.segment_count;
}

void MovingTree::restore(const SavedTree& saved, const TimeSteps& time,
                         std::span<const unsigned char> bounds) {
  const size_t node_bytes = size_t{saved.width} * (sizeof(MotionBounds<4>) / 4);
  // No product overflows: there are as many bytes of nodes in the file.
  const uint64_t undivided = time.segment_count * saved.node_count * node_bytes;
  const uint64_t division = undivided == 0 ? 1 : bounds.size() / undivided;
  if (bounds.size() != division * undivided || division == 0 ||
      division * time.segment_count > kMaxSegments) {
    throw Error(KIWAMI_ERROR_INVALID_FILE,
                "the moving boxes have %zu bytes, expected %llu for %u segments of %llu nodes, or "
                "a multiple for at most %u segments",
                bounds.size(), static_cast<unsigned long long>(undivided), time.segment_count,
                static_cast<unsigned long long>(saved.node_count), kMaxSegments);
  }
  tree_ = saved.part();
  time_ = time;
  time_.segment_count *= static_cast<uint32_t>(division);
  bounds_ = Array<unsigned char>::borrow(const_cast<unsigned char*>(bounds.data()), bounds.size());
}

template <int N>
void MovingTree::fill(const MovingSource& source, Memory& memory, const Parallel& parallel) {
  WideTree& tree = tree_.tree;
  const uint64_t node_count = tree.node_count;
  bounds_ =
      Array<unsigned char>(memory, time_.segment_count * node_count * sizeof(MotionBounds<N>));
  auto* const bounds = reinterpret_cast<MotionBounds<N>*>(bounds_.data());
  const ChildReference root = tree.view.root;
  if (root.mask() == 0) return;
  // Also of a leaf at the root. All boxes are in that of all times, which padding widens by a part
  // of the same numbers.
  for (int axis = 0; axis < 3; ++axis) {
    const double centre = tree.view.centre[axis];
    const double lower = tree_.bounds.lower[axis], upper = tree_.bounds.upper[axis];
    const double reach = std::max(std::fabs(lower - centre), std::fabs(upper - centre));
    const double greatest = std::max(std::fabs(lower), std::fabs(upper));
    tree.view.greatest_bound[axis] = round_up(reach + 0x1p-18 * (greatest + (upper - lower)));
  }
  if (root.is_leaf()) return;
  parallel.for_blocks(time_.segment_count * node_count, 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) BoundsFiller<N>::clear(bounds[i]);
  });
  const WideNode<N>& node = tree.nodes<N>()[tree.number_of(root)];
  // One task a child of the root and a segment.
  parallel.for_each(size_t{N} * time_.segment_count, [&](size_t task) {
    const auto slot = static_cast<uint32_t>(task % N), segment = static_cast<uint32_t>(task / N);
    if (((root.mask() >> slot) & 1u) == 0) return;
    BoundsFiller<N>(tree, source, time_, segment, bounds + segment * node_count)
        .fill_slot(root, slot, node.child[slot]);
  });
}

template <int N>
void MovingTree::check(const MovingSource& source, const Parallel& parallel) const {
  const ChildReference root = tree_.tree.view.root;
  if (root.mask() == 0 || root.is_leaf()) return;
  // The steps, and between them.
  constexpr float parts[] = {0.0f, 0.3f, 0.5f, 0.9f};
  const TimeSteps& time = time_;
  const MovingBoxes moving = boxes();
  parallel.for_each(size_t{4} * time.segment_count, [&](size_t i) {
    const size_t segment = i / 4;
    const float place = static_cast<float>(segment) + parts[i % 4];
    const float at =
        time.begin + (time.end - time.begin) * (place / static_cast<float>(time.segment_count));
    BoundsChecker<N>(tree_.tree, moving, source, std::min(at, time.end)).check(root);
  });
  BoundsChecker<N>(tree_.tree, moving, source, time.end).check(root);
}

void MovingTree::validate(const Array<BuildPrimitive>& boxes, const MovingSource& source,
                          Memory& memory, const Parallel& parallel) const {
  verify_wide_tree(tree_.tree, {boxes.data(), boxes.size()}, memory);
  if (tree_.tree.width == 4) check<4>(source, parallel);
  if (tree_.tree.width == 8) check<8>(source, parallel);
  if (tree_.tree.width == 16) check<16>(source, parallel);
}

}  // namespace kiwami

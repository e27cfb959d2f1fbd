// SPDX-License-Identifier: Apache-2.0
#include "core/moving_instances.h"

#include <algorithm>
#include <atomic>

#include "core/collect_boxes.h"
#include "core/committed_scene.h"
#include "core/saved_scene.h"
#include "math/rounding.h"

namespace kiwami {
namespace {

/// Instances that one task looks at.
constexpr size_t kBlockSize = 1024;

Affine map_at(const MovingArray& array, const float* steps, double fraction) {
  float rows[12];
  if (fraction == 0.0) {
    matrix_of_step(steps, array.format, rows);
  } else {
    matrix_between(steps, array.format, static_cast<float>(fraction), rows);
  }
  return map_of(rows);
}

}  // namespace

/// Where the instances are. Everything of one is found by its place among those that move.
class MovingInstances::Source final : public MovingSource {
 public:
  Source(const MovingInstances& moving, CommittedScene* const* scenes, Memory& memory,
         const Parallel& parallel)
      : moving_(moving), scenes_(scenes), places_(memory, moving.array_count_) {
    size_t count = 0;
    for (uint32_t i = 0; i < moving.array_count_; ++i) {
      places_[i] = count;
      count += moving.arrays_[i].count;
    }
    entries_ = Array<Entry>(memory, count);
    for (uint32_t i = 0; i < moving.array_count_; ++i) {
      const MovingArray& array = moving.arrays_[i];
      parallel.for_blocks(array.count, kBlockSize, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
          entries_[places_[i] + k] = measure(array, array.first + static_cast<uint32_t>(k));
        }
      });
    }
  }

  /// What all show at any time, and the errors of hits there.
  Bounds bounds() const {
    Bounds bounds = Bounds::empty();
    for (const Entry& entry : entries_) bounds.extend(entry.bounds);
    return bounds;
  }
  HitError error() const {
    HitError error;
    for (const Entry& entry : entries_) error.extend(entry.error);
    return error;
  }

  /// Whether all of an array are at all times, whatever they show.
  bool is_regular(uint32_t array) const {
    const Entry* const first = entries_.data() + places_[array];
    return std::all_of(first, first + moving_.arrays_[array].count,
                       [](const Entry& entry) { return entry.is_regular; });
  }

  /// The mean boxes of those that show something, and the box of all boxes.
  Array<BuildPrimitive> boxes(Memory& memory, Bounds& extent) const {
    Array<BuildPrimitive> boxes(memory, entries_.size());
    size_t used = 0, place = 0;
    extent = Bounds::empty();
    for (uint32_t i = 0; i < moving_.array_count_; ++i) {
      const MovingArray& array = moving_.arrays_[i];
      for (uint32_t k = 0; k < array.count; ++k) {
        const Entry& entry = entries_[place++];
        if (entry.bounds.is_empty()) continue;
        const uint32_t number = array.first + k;
        const Bounds mean = mean_box(array, number, scene_of(number).bounds());
        boxes[used++] = {mean.lower, number, mean.upper, 0};
        extent.extend(widened(entry.bounds, margin_of(entry) + slack_of(array, entry)));
      }
    }
    boxes.shrink(used);
    return boxes;
  }

  LinearBounds during(uint32_t number, const TimeSteps& steps, uint32_t segment) const override {
    LinearBounds bounds;
    const MovingArray& array = array_of_number(number);
    const Entry& entry = entry_of(array, number);
    if (entry.bounds.is_empty()) return bounds;
    const Bounds inner = scene_of(number).bounds();
    if (const uint32_t division = division_of(array.time, steps)) {
      const uint32_t own = segment / division, part = segment % division;
      // A part of an arc bows as the square of its length.
      double margin = margin_of(entry) + bow(array, number, own, inner) / (division * division);
      if (division != 1) margin += slack_of(array, entry);
      bounds.start =
          image_at(array, number, own, static_cast<double>(part) / division, inner, margin);
      bounds.end = image_at(array, number, own, (part + 1.0) / division, inner, margin);
    } else {
      bounds.start = bounds.end = swept_box(array, number, steps, segment, inner, margin_of(entry));
      if (bounds.start.is_empty()) return bounds;
    }
    pad(bounds.start, moving_.tree_.tree().bounds);
    pad(bounds.end, moving_.tree_.tree().bounds);
    return bounds;
  }

  Bounds at(uint32_t number, float time) const override {
    const MovingArray& array = array_of_number(number);
    const CommittedScene& scene = scene_of(number);
    float rows[12], inverse[4][3];
    if (scene.bounds().is_empty() || !matrix_at(array, number, time, rows) ||
        !invert_for_rays(rows, inverse)) {
      return Bounds::empty();
    }
    return image_of(inverse_of(map_of(inverse)), scene.bounds(), 0.0);
  }

 private:
  struct Entry {
    Bounds bounds;  ///< at all times; empty: it shows nothing
    HitError error;
    double rounding, reach;  ///< see MotionLimits
    bool is_regular;
  };

  const MovingArray& array_of_number(uint32_t number) const {
    return array_of(moving_.arrays_.data(), moving_.array_count_, number);
  }
  const Entry& entry_of(const MovingArray& array, uint32_t number) const {
    const size_t i = static_cast<size_t>(&array - moving_.arrays_.data());
    return entries_[places_[i] + (number - array.first)];
  }
  const CommittedScene& scene_of(uint32_t number) const {
    return *scenes_[moving_.data_.instances.instances[number].prototype];
  }

  Entry measure(const MovingArray& array, uint32_t number) const {
    Entry entry{Bounds::empty(), {}, 0.0, 0.0, false};
    const CommittedScene& scene = scene_of(number);
    const Bounds inner = scene.bounds();
    const MotionLimits limits =
        MotionLimits::of(steps_of(array, number, 0), array.time.segment_count, array.format);
    entry.is_regular = limits.is_regular;
    if (inner.is_empty()) return entry;
    entry.rounding = limits.rounding(inner);
    entry.reach = limits.reach(inner);
    for (uint32_t segment = 0; segment < array.time.segment_count; ++segment) {
      const double margin = entry.rounding + bow(array, number, segment, inner);
      entry.bounds.extend(image_at(array, number, segment, 0.0, inner, margin));
      entry.bounds.extend(image_at(array, number, segment, 1.0, inner, margin));
    }
    entry.error = limits.error_through(scene.hit_error(), entry.bounds);
    return entry;
  }

  /// What boxes from the matrices of steps lack, but for the bow.
  double margin_of(const Entry& entry) const {
    return entry.rounding + entry.error.margin(double{moving_.far_origin_});
  }

  /// What a place may be off by where segments are divided.
  static double slack_of(const MovingArray& array, const Entry& entry) {
    return place_rounding(array.time) * 2.0 * entry.reach;
  }

  static double bow(const MovingArray& array, uint32_t number, uint32_t segment,
                    const Bounds& inner) {
    return bow_of(steps_of(array, number, segment), array.format, inner);
  }

  static Bounds image_at(const MovingArray& array, uint32_t number, uint32_t segment,
                         double fraction, const Bounds& inner, double margin) {
    // An end is that of the step, whatever the segment makes of it.
    const bool is_end = fraction == 1.0;
    const float* const steps = steps_of(array, number, segment + (is_end ? 1 : 0));
    return image_of(map_at(array, steps, is_end ? 0.0 : fraction), inner, margin);
  }

  /// As far as boxes go: see image_of.
  static Bounds widened(const Bounds& box, double margin) {
    constexpr Affine same = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};
    return image_of(same, box, margin);
  }

  static Bounds mean_box(const MovingArray& array, uint32_t number, const Bounds& inner) {
    double lower[3] = {}, upper[3] = {};
    const uint32_t step_count = array.time.segment_count + 1;
    for (uint32_t step = 0; step < step_count; ++step) {
      const Bounds box = image_of(map_at(array, steps_of(array, number, step), 0.0), inner, 0.0);
      for (int axis = 0; axis < 3; ++axis) {
        lower[axis] += double{box.lower[axis]};
        upper[axis] += double{box.upper[axis]};
      }
    }
    Bounds mean;
    for (int axis = 0; axis < 3; ++axis) {
      mean.lower[axis] = static_cast<float>(lower[axis] / step_count);
      mean.upper[axis] = static_cast<float>(upper[axis] / step_count);
    }
    return mean;
  }

  /// Where it is at any time of a segment of steps that have nothing to do with its own.
  static Bounds swept_box(const MovingArray& array, uint32_t number, const TimeSteps& steps,
                          uint32_t segment, const Bounds& inner, double margin) {
    Bounds box = Bounds::empty();
    PlaceRange range;
    if (!places_during(array.time, steps, segment, range)) return box;
    const uint32_t last_segment = array.time.segment_count - 1;
    const auto first = std::min(static_cast<uint32_t>(range.first), last_segment);
    const auto last = std::min(static_cast<uint32_t>(range.last), last_segment);
    for (uint32_t own = first; own <= last; ++own) {
      const double wider = margin + bow(array, number, own, inner);
      const double begin = std::max(range.first - own, 0.0), end = std::min(range.last - own, 1.0);
      box.extend(image_at(array, number, own, begin, inner, wider));
      box.extend(image_at(array, number, own, end, inner, wider));
    }
    return box;
  }

  const MovingInstances& moving_;
  CommittedScene* const* scenes_;
  Array<size_t> places_;  ///< of the first instance of each array
  Array<Entry> entries_;
};

void MovingInstances::reserve(Memory& memory, size_t array_count, size_t step_floats) {
  arrays_ = Array<MovingArray>(memory, array_count);
  steps_ = Array<float>(memory, step_floats);
  regular_ = Array<uint32_t>(memory, array_count);
  regular_.fill_zero();
}

bool MovingInstances::add(const Instances& instances, uint32_t first, const Parallel& parallel) {
  const size_t floats = step_floats_of(instances), per_instance = floats / instances.count();
  float* const steps = steps_.data() + used_floats_;
  std::atomic<bool> is_faulty{false};
  parallel.for_blocks(instances.count(), kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (instances.read_steps(static_cast<uint32_t>(i), steps + i * per_instance)) continue;
      is_faulty.store(true, std::memory_order_relaxed);
      return;
    }
  });
  place(instances, first);
  return !is_faulty.load();
}

void MovingInstances::place(const Instances& instances, uint32_t first) {
  MovingArray& array = arrays_[array_count_];
  array.steps = steps_.data() + used_floats_;
  array.time = instances.time();
  array.format = instances.format();
  array.first = first;
  array.count = instances.count();
  array.is_regular = regular_[array_count_++];
  used_floats_ += step_floats_of(instances);
}

TimeSteps MovingInstances::show(const InstancePart& all, Memory& memory) {
  data_.instances = all;
  data_.instances.starts = nullptr;
  data_.arrays = arrays_.data();
  data_.array_count = array_count_;
  Array<TimeSteps> times(memory, array_count_);
  for (uint32_t i = 0; i < array_count_; ++i) times[i] = arrays_[i].time;
  return common_steps(times.data(), times.size());
}

void MovingInstances::build(const InstancePart& all, CommittedScene* const* scenes,
                            const PartPlan& plan) {
  if (array_count_ == 0) return;
  const TimeSteps time = show(all, plan.memory);
  const Source source(*this, scenes, plan.memory, plan.parallel);
  for (uint32_t i = 0; i < array_count_; ++i) {
    arrays_[i].is_regular = regular_[i] = source.is_regular(i) ? 1 : 0;
  }
  bounds_ = source.bounds();
  error_ = source.error();
  if (bounds_.is_empty()) return;
  far_origin_ = static_cast<float>(2.0 * greatest_coordinate(bounds_));
  Bounds extent;
  Array<BuildPrimitive> boxes = source.boxes(plan.memory, extent);
  tree_.build(std::move(boxes), extent, time, source, plan);
  data_.boxes = tree_.boxes();
  if (plan.parameters.whole(KIWAMI_PARAMETER_VALIDATE_BUILD) != 0) {
    validate(scenes, plan.memory, plan.parallel);
  }
}

void MovingInstances::borrow(const SavedMovingInstances& saved, Memory& memory) {
  arrays_ = Array<MovingArray>(memory, saved.regular.size());
  steps_ = Array<float>::borrow(const_cast<float*>(saved.steps.data()), saved.steps.size());
  regular_ =
      Array<uint32_t>::borrow(const_cast<uint32_t*>(saved.regular.data()), saved.regular.size());
}

void MovingInstances::restore(const InstancePart& all, const SavedMovingInstances& saved,
                              const SavedTree* tree, Memory& memory) {
  uint64_t count = 0;
  for (const MovingArray& array : arrays()) count += array.count;
  // There is no tree either where they show nothing.
  if (tree) check_saved_part("instances that move", count, tree);
  if (array_count_ == 0) return;
  const TimeSteps time = show(all, memory);
  bounds_ = saved.bounds;
  error_ = saved.error;
  far_origin_ = saved.far_origin;
  if (!tree) return;
  tree_.restore(*tree, time, saved.boxes);
  data_.boxes = tree_.boxes();
}

SavedMovingInstances MovingInstances::saved() const {
  return {{steps_.data(), steps_.size()},
          {regular_.data(), regular_.size()},
          tree_.bounds(),
          bounds_,
          error_,
          far_origin_};
}

ScenePart MovingInstances::part() const {
  return {PartKind::kMovingInstances, tree_.tree().tree.view, &data_, far_origin_,
          far_origin_margin_of(error_)};
}

void MovingInstances::validate(CommittedScene* const* scenes, Memory& memory,
                               const Parallel& parallel) const {
  if (!can_be_hit()) return;
  const Source source(*this, scenes, memory, parallel);
  Bounds extent;
  tree_.validate(source.boxes(memory, extent), source, memory, parallel);
}

}  // namespace kiwami

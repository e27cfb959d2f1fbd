// SPDX-License-Identifier: Apache-2.0
#include "io/part_checks.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/instance_bounds.h"
#include "core/instances.h"

namespace kiwami::file {
namespace {

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
}

/// Elements that one task looks at.
constexpr size_t kBlockSize = 4096;

/// The index of the first element that is not as it should be; count where all are.
template <typename IsRight>
size_t first_wrong(size_t count, const Parallel& parallel, IsRight&& is_right) {
  std::atomic<size_t> wrong{count};
  parallel.for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (is_right(i)) continue;
      size_t lowest = wrong.load(std::memory_order_relaxed);
      while (i < lowest && !wrong.compare_exchange_weak(lowest, i)) {
      }
      return;
    }
  });
  return wrong.load();
}

/// False for NaN.
bool is_error(double value) { return value >= 0.0 && value <= 0x1p480; }

void check_numbers(const Bounds& bounds, const HitError& error, float far_origin) {
  constexpr float most = 2.0f * KIWAMI_MAX_COORDINATE;
  for (int axis = 0; axis < 3 && !bounds.is_empty(); ++axis) {
    // False where one is NaN.
    if (-most <= bounds.lower[axis] && bounds.lower[axis] <= bounds.upper[axis] &&
        bounds.upper[axis] <= most) {
      continue;
    }
    fail("the instances reach from %g to %g on axis %d, expected finite numbers",
         static_cast<double>(bounds.lower[axis]), static_cast<double>(bounds.upper[axis]), axis);
  }
  if (is_error(double{far_origin}) && is_error(error.per_origin) && is_error(error.fixed)) return;
  fail("the errors of instances are %g, %g and %g, expected 0 to 2^480", double{far_origin},
       error.per_origin, error.fixed);
}

/// The greatest square of an angle between unit quaternions, (pi / 2)^2, with its rounding.
constexpr float kMaxSquaredAngle = 2.5f;

bool is_step(const float* step, TransformFormat format) {
  float rows[12], inverse[4][3];
  matrix_of_step(step, format, rows);
  if (!invert_for_rays(rows, inverse)) return false;
  return format == TransformFormat::kMatrix ||
         (step[kSquaredAngle] >= 0.0f && step[kSquaredAngle] <= kMaxSquaredAngle);
}

/// Whether an array has such an instance, and rays can be carried by its matrix and by what the
/// commit made of it: in general just that.
bool is_resting(const InstanceArray& array, size_t instance, const InstanceRecord& record) {
  if (array.indices && array.indices[instance] >= array.scene_count) return false;
  float rows[12], inverse[4][3];
  std::memcpy(rows, array.matrices + instance * sizeof rows, sizeof rows);
  if (!invert_for_rays(rows, inverse)) return false;
  return std::memcmp(inverse, record.column, sizeof inverse) == 0 ||
         is_usable(transform_of(record.column));
}

void check_array(const InstanceArray& array, std::span<const InstanceRecord> records,
                 std::span<const uint32_t> shown, const Parallel& parallel) {
  // Where there are too few or too many records, all of them are refused later.
  const auto first = std::min<size_t>(static_cast<size_t>(array.numbers.first), records.size());
  records = records.subspan(first);
  records = records.first(std::min<size_t>(records.size(), array.numbers.count));
  const size_t wrong = first_wrong(records.size(), parallel, [&](size_t i) {
    return records[i].prototype < shown.size() &&
           (!array.matrices || is_resting(array, i, records[i]));
  });
  if (wrong == records.size()) return;
  fail(
      "instance %zu shows scene %u of %zu by a transform that is singular or not finite, or none "
      "of them",
      first + wrong, records[wrong].prototype, shown.size());
}

}  // namespace

void check_instances(const SavedInstances& instances, const InstanceContents& contents,
                     const SavedForest& forest, const Parallel& parallel) {
  check_numbers(instances.bounds, instances.error, instances.far_origin);
  check_numbers(instances.moving.bounds, instances.moving.error, instances.moving.far_origin);
  const auto& records = instances.records;
  const auto& shown = contents.shown;
  for (const InstanceArray& array : contents.arrays) check_array(array, records, shown, parallel);
  const auto& starts = instances.starts;
  const size_t wrong = first_wrong(starts.size(), parallel, [&](size_t i) {
    const InstanceStart& start = starts[i];
    if (start.instance >= records.size() || !contains(contents.resting, start.instance)) {
      return false;
    }
    if (start.tree == InstanceStart::kAllTrees) return true;
    return forest.owns(shown[records[start.instance].prototype], start.tree, start.subtree);
  });
  if (wrong != starts.size()) {
    fail("start %zu is of instance %u and tree %u, expected a place in a tree that it shows", wrong,
         starts[wrong].instance, starts[wrong].tree);
  }
}

void check_instance_steps(std::span<const float> steps, TransformFormat format, uint32_t step_count,
                          bool is_regular, const Parallel& parallel) {
  const size_t size = step_size_of(format), count = steps.size() / size;
  size_t wrong = first_wrong(count, parallel,
                             [&](size_t i) { return is_step(steps.data() + i * size, format); });
  if (wrong != count) {
    fail(
        "step %zu of an array of instances is singular or not finite, expected one that rays can "
        "be carried by",
        wrong);
  }
  if (!is_regular) return;
  const size_t instance_count = count / step_count;
  wrong = first_wrong(instance_count, parallel, [&](size_t i) {
    return MotionLimits::of(steps.data() + i * step_count * size, step_count - 1, format)
        .is_regular;
  });
  if (wrong == instance_count) return;
  fail(
      "instance %zu of an array that moves is near singular between its steps, expected none as "
      "the array is said to be regular",
      wrong);
}

void check_moving_boxes(std::span<const float> bounds, const Parallel& parallel) {
  const size_t wrong = first_wrong(bounds.size(), parallel, [&](size_t i) {
    // Those of unused slots are the greatest. False where one is NaN.
    return std::fabs(bounds[i]) <= 0x1p100f;
  });
  if (wrong == bounds.size()) return;
  fail("number %zu of the moving boxes is %g, expected at most 2^100", wrong,
       static_cast<double>(bounds[wrong]));
}

}  // namespace kiwami::file

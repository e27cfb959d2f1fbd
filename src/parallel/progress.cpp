// SPDX-License-Identifier: Apache-2.0
#include "parallel/progress.h"

#include <algorithm>

#include "core/error.h"

namespace kiwami {
namespace {

/// Within a stage the caller is told not more often than this.
constexpr std::chrono::milliseconds kInterval{1};

}  // namespace

void Progress::throw_if_cancelled() const {
  if (!is_cancelled_.load(std::memory_order_relaxed)) return;
  throw Error(KIWAMI_ERROR_CANCELLED,
              "the progress function asked to cancel, expected 0 for going on");
}

void Progress::tell(double fraction) {
  if (is_cancelled_.load(std::memory_order_relaxed)) return;
  told_ = fraction;
  if (function_(user_, fraction) != 0) is_cancelled_.store(true, std::memory_order_relaxed);
  next_time_ = Clock::now() + kInterval;
}

void Progress::begin_stage(double end, size_t expected_tasks) {
  throw_if_cancelled();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stage_begin_ = stage_end_;
    stage_end_ = std::max(stage_end_, end);
    expected_tasks_ = expected_tasks + 1;
    task_count_.store(0, std::memory_order_relaxed);
    tell(stage_begin_);
  }
  throw_if_cancelled();
}

void Progress::begin_task() {
  throw_if_cancelled();
  const size_t count = task_count_.fetch_add(1, std::memory_order_relaxed) + 1;
  {
    // Whoever comes while the caller is being told goes on.
    const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock() || Clock::now() < next_time_) return;
    // Counts do not come in their order.
    const double part = static_cast<double>(count) / static_cast<double>(count + expected_tasks_);
    const double fraction = stage_begin_ + (stage_end_ - stage_begin_) * part;
    if (fraction < told_) return;
    tell(fraction);
  }
  throw_if_cancelled();
}

void Progress::finish() {
  stage_end_ = 1.0;
  begin_stage(1.0, 0);
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// How far a commit is: what the caller is told, and may stop.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>

#include "kiwami/scene.h"

namespace kiwami {

/// Counts the tasks of a commit and makes a fraction of them, which never falls. A stage's part of
/// the whole is known, the number of its tasks is not: half of the stage is over when there have
/// been as many as expected, two thirds after twice as many, and so on.
class Progress {
 public:
  Progress(kiwami_progress function, void* user) : function_(function), user_(user) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// The stages before are over: a stage begins that ends at this fraction. Throws
  /// Error(CANCELLED).
  void begin_stage(double end, size_t expected_tasks);

  /// A task begins, on any thread. Throws Error(CANCELLED) where the caller has said so.
  void begin_task();

  /// All is done. Throws Error(CANCELLED).
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  void tell(double fraction);
  void throw_if_cancelled() const;

  kiwami_progress function_;
  void* user_;
  std::atomic<bool> is_cancelled_{false};
  std::atomic<size_t> task_count_{0};  ///< of this stage
  std::mutex mutex_;                   ///< of what follows; held while the caller is told
  double stage_begin_ = 0.0, stage_end_ = 0.0, told_ = 0.0;
  size_t expected_tasks_ = 1;
  Clock::time_point next_time_{};
};

}  // namespace kiwami

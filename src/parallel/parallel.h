// SPDX-License-Identifier: Apache-2.0
// Parallel loops over oneTBB, over the caller's own runner, or on the calling thread.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

#include "kiwami/device.h"

namespace kiwami {

class Progress;

/// Runs loops for one device. No algorithm may let its result depend on how the indices are spread
/// over threads: the loops hand out indices, never thread numbers.
class Parallel {
 public:
  /// runner == nullptr: the library's own tasks with thread_count threads (0: one per processor).
  Parallel(unsigned thread_count, kiwami_parallel_runner runner, void* runner_user,
           unsigned runner_width);
  /// The same threads, for loops that report each of their tasks to progress, which may end them.
  Parallel(const Parallel& other, Progress& progress);
  /// For a part of what other does: its tasks are told to the same progress, but not its stages.
  /// For loops within loops, on the thread that calls.
  static Parallel part_of(const Parallel& other, bool on_one_thread);
  ~Parallel();
  Parallel(const Parallel&) = delete;
  Parallel(Parallel&&) = default;
  Parallel& operator=(const Parallel&) = delete;

  /// How many indices run at once, at least 1.
  unsigned width() const { return width_; }

  /// To progress, if there is one: what follows is a stage that ends at this fraction of the whole,
  /// of about so many tasks; and that all is done.
  void begin_stage(double end, size_t expected_tasks) const;
  void finish() const;
  /// For long work on one thread: throws Error(CANCELLED) where the caller has asked for that.
  void check_cancelled() const;

  /// Calls body(index) for each index below count. The first exception of a body is thrown again
  /// here, after all running bodies have ended; Error(CALLBACK) when the runner failed.
  /// The floating-point state is the default one inside each body.
  template <typename Body>
  void for_each(size_t count, Body&& body) const {
    using Callable = std::remove_reference_t<Body>;
    run(
        count, [](void* data, size_t index) { (*static_cast<Callable*>(data))(index); },
        const_cast<void*>(static_cast<const void*>(&body)));
  }

  /// Calls body(begin, end) for consecutive blocks of block_size indices (the last may be shorter).
  template <typename Body>
  void for_blocks(size_t count, size_t block_size, Body&& body) const {
    const size_t blocks = (count + block_size - 1) / block_size;
    for_each(blocks, [&](size_t block) {
      const size_t begin = block * block_size;
      const size_t end = begin + block_size < count ? begin + block_size : count;
      body(begin, end);
    });
  }

 private:
  Parallel() = default;
  void run(size_t count, kiwami_parallel_task task, void* data) const;

  void run_unwatched(size_t count, kiwami_parallel_task task, void* data) const;

  struct Arena;
  std::shared_ptr<Arena> arena_;
  Progress* progress_ = nullptr;
  bool is_part_ = false;
  kiwami_parallel_runner runner_ = nullptr;
  void* runner_user_ = nullptr;
  unsigned width_ = 1;
};

}  // namespace kiwami

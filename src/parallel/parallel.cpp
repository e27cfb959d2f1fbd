// SPDX-License-Identifier: Apache-2.0
#include "parallel/parallel.h"

#include <atomic>
#include <exception>
#include <thread>

#include "core/error.h"
#include "math/float_environment.h"
#include "parallel/progress.h"

#if defined(KIWAMI_TASKING_TBB)
#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>
#endif

namespace kiwami {

#if defined(KIWAMI_TASKING_TBB)
struct Parallel::Arena {
  explicit Arena(unsigned width) : tasks(static_cast<int>(width)) {}
  tbb::task_arena tasks;
};
#else
struct Parallel::Arena {};
#endif

namespace {

/// How many indices run at once in a device's loops.
unsigned width_of(unsigned thread_count, kiwami_parallel_runner runner, unsigned runner_width) {
  if (runner) {
    if (runner_width != 0) return runner_width;
    // Unknown: at least two, or a machine with one processor would never call the runner.
    const unsigned processors = std::thread::hardware_concurrency();
    return processors > 2 ? processors : 2;
  }
#if defined(KIWAMI_TASKING_TBB)
  // oneTBB never has more threads than processors, and prints a warning when asked for more.
  const int concurrency = tbb::info::default_concurrency();
  const unsigned processors = concurrency > 1 ? static_cast<unsigned>(concurrency) : 1;
  return thread_count != 0 && thread_count < processors ? thread_count : processors;
#else
  static_cast<void>(thread_count);
  return 1;
#endif
}

void run_here(size_t count, kiwami_parallel_task task, void* data) {
  const DefaultFloatEnvironment environment;
  for (size_t index = 0; index < count; ++index) task(data, index);
}

/// One loop on the caller's runner. Its threads are not ours: no exception may reach them.
class RunnerLoop {
 public:
  RunnerLoop(kiwami_parallel_task task, void* data) : task_(task), data_(data) {}

  void run(kiwami_parallel_runner runner, void* user, size_t count) {
    const int32_t status = runner(user, count, &RunnerLoop::call, this);
    if (exception_) std::rethrow_exception(exception_);
    if (status != 0) {
      throw Error(KIWAMI_ERROR_CALLBACK, "runner returned %d, expected 0",
                  static_cast<int>(status));
    }
    const size_t calls = calls_.load(std::memory_order_acquire);
    if (calls != count) {
      throw Error(KIWAMI_ERROR_CALLBACK, "runner made %zu calls of its task, expected %zu", calls,
                  count);
    }
  }

 private:
  static void call(void* loop, size_t index) { static_cast<RunnerLoop*>(loop)->call(index); }

  void call(size_t index) {
    if (!has_failed_.load(std::memory_order_relaxed)) {
      const DefaultFloatEnvironment environment;
      try {
        task_(data_, index);
      } catch (...) {
        if (!has_failed_.exchange(true)) exception_ = std::current_exception();
      }
    }
    calls_.fetch_add(1, std::memory_order_release);
  }

  kiwami_parallel_task task_;
  void* data_;
  std::atomic<size_t> calls_{0};
  std::atomic<bool> has_failed_{false};
  std::exception_ptr exception_;
};

#if defined(KIWAMI_TASKING_TBB)
/// One loop of tasks, which tells the tasks' own exceptions from those of the scheduler.
class TaskLoop {
 public:
  TaskLoop(kiwami_parallel_task task, void* data) : task_(task), data_(data) {}

  void run(size_t begin, size_t end) {
    // Read first, so that threads do not fight for the line.
    if (!has_begun()) has_begun_.store(true, std::memory_order_relaxed);
    const DefaultFloatEnvironment environment;
    try {
      for (size_t index = begin; index != end; ++index) task_(data_, index);
    } catch (...) {
      has_failed_.store(true, std::memory_order_relaxed);
      throw;
    }
  }

  bool has_begun() const { return has_begun_.load(std::memory_order_relaxed); }
  bool has_failed() const { return has_failed_.load(std::memory_order_relaxed); }

 private:
  kiwami_parallel_task task_;
  void* data_;
  std::atomic<bool> has_begun_{false};
  std::atomic<bool> has_failed_{false};
};
#endif

}  // namespace

Parallel::Parallel(unsigned thread_count, kiwami_parallel_runner runner, void* runner_user,
                   unsigned runner_width)
    : runner_(runner),
      runner_user_(runner_user),
      width_(width_of(thread_count, runner, runner_width)) {
#if defined(KIWAMI_TASKING_TBB)
  if (!runner_ && width_ > 1) arena_ = std::make_shared<Arena>(width_);
#endif
}

Parallel::~Parallel() = default;

Parallel::Parallel(const Parallel& other, Progress& progress)
    : arena_(other.arena_),
      progress_(&progress),
      runner_(other.runner_),
      runner_user_(other.runner_user_),
      width_(other.width_) {}

Parallel Parallel::part_of(const Parallel& other, bool on_one_thread) {
  Parallel part;
  part.progress_ = other.progress_;
  part.is_part_ = true;
  if (on_one_thread) return part;
  part.arena_ = other.arena_;
  part.runner_ = other.runner_;
  part.runner_user_ = other.runner_user_;
  part.width_ = other.width_;
  return part;
}

void Parallel::begin_stage(double end, size_t expected_tasks) const {
  if (progress_ && !is_part_) progress_->begin_stage(end, expected_tasks);
}

void Parallel::finish() const {
  if (progress_ && !is_part_) progress_->finish();
}

void Parallel::check_cancelled() const {
  if (progress_) progress_->begin_task();
}

void Parallel::run(size_t count, kiwami_parallel_task task, void* data) const {
  if (!progress_) {
    run_unwatched(count, task, data);
    return;
  }
  progress_->begin_task();
  struct Watched {
    kiwami_parallel_task task;
    void* data;
    Progress* progress;
  } watched{task, data, progress_};
  run_unwatched(
      count,
      [](void* of, size_t index) {
        const Watched& loop = *static_cast<const Watched*>(of);
        loop.progress->begin_task();
        loop.task(loop.data, index);
      },
      &watched);
}

void Parallel::run_unwatched(size_t count, kiwami_parallel_task task, void* data) const {
  if (count <= 1 || width_ == 1) {
    run_here(count, task, data);
    return;
  }
  if (runner_) {
    RunnerLoop(task, data).run(runner_, runner_user_, count);
    return;
  }
#if defined(KIWAMI_TASKING_TBB)
  TaskLoop loop(task, data);
  try {
    arena_->tasks.execute([&] {
      tbb::parallel_for(
          tbb::blocked_range<size_t>(0, count, 1),
          [&](const tbb::blocked_range<size_t>& range) { loop.run(range.begin(), range.end()); },
          tbb::simple_partitioner());
    });
  } catch (...) {
    if (loop.has_failed()) throw;
    if (loop.has_begun()) {
      throw Error(KIWAMI_ERROR_OUT_OF_MEMORY,
                  "the task scheduler failed in the middle of a loop, expected threads and memory");
    }
    // The scheduler could not start a thread: it throws before anything has run.
    run_here(count, task, data);
  }
#endif
}

}  // namespace kiwami

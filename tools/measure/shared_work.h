// SPDX-License-Identifier: Apache-2.0
// How long parallel loops would take on several processors, on a machine that has none to spare.
#pragma once

#include <kiwami/kiwami.h>

#include <cstddef>
#include <cstdint>

namespace kiwami::tools {

/// A runner for parallel loops that runs every task on the calling thread and shares them out to
/// imagined processors: each takes the next one as soon as it is free. So the time that a number of
/// processors would save is known from processor time alone, whatever else the machine does; what
/// threads cost each other (waking up, caches, memory) is not in it. Loops within tasks count as a
/// part of their task. For one thread at a time.
class SharedWork {
 public:
  explicit SharedWork(uint32_t processors) : processors_(processors) {}

  uint32_t processors() const { return processors_; }

  /// A kiwami_parallel_runner; `user` is a SharedWork.
  static int32_t run(void* user, size_t count, kiwami_parallel_task task, void* task_data);

  /// Processor seconds of all loops that other processors would have taken over.
  double saved_seconds() const { return saved_seconds_; }

 private:
  void share(size_t count, kiwami_parallel_task task, void* task_data);

  uint32_t processors_;
  bool is_in_task_ = false;
  double saved_seconds_ = 0.0;
};

}  // namespace kiwami::tools

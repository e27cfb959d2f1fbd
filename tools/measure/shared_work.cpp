// SPDX-License-Identifier: Apache-2.0
#include "measure/shared_work.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "measure/contest.h"

namespace kiwami::tools {

int32_t SharedWork::run(void* user, size_t count, kiwami_parallel_task task, void* task_data) {
  SharedWork& work = *static_cast<SharedWork*>(user);
  // A loop of one task leaves the processors to the loops within it.
  if (count == 1 || work.is_in_task_) {
    for (size_t i = 0; i < count; ++i) task(task_data, i);
  } else {
    work.share(count, task, task_data);
  }
  return 0;
}

void SharedWork::share(size_t count, kiwami_parallel_task task, void* task_data) {
  std::vector<double> busy(processors_, 0.0);
  is_in_task_ = true;
  double last = seconds_now(Clock::kProcessor);
  for (size_t i = 0; i < count; ++i) {
    task(task_data, i);
    const double now = seconds_now(Clock::kProcessor);
    *std::min_element(busy.begin(), busy.end()) += now - last;
    last = now;
  }
  is_in_task_ = false;
  saved_seconds_ +=
      std::accumulate(busy.begin(), busy.end(), 0.0) - *std::max_element(busy.begin(), busy.end());
}

}  // namespace kiwami::tools

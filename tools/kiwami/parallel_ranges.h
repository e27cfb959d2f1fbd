// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <thread>
#include <vector>

namespace kiwami::tools {

/// Runs body(first, last) on as many threads as given, over equal shares of 0 to count. `body` must
/// not throw, and what it makes of an element may not depend on the shares.
template <typename Body>
void parallel_ranges(size_t threads, size_t count, const Body& body) {
  if (threads <= 1 || count < 1024) {
    body(size_t{0}, count);
    return;
  }
  std::vector<std::jthread> workers;
  for (size_t i = 0; i < threads; ++i) {
    workers.emplace_back(body, count * i / threads, count * (i + 1) / threads);
  }
}

}  // namespace kiwami::tools

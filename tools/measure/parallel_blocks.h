// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace kiwami::tools {

/// Runs body(first, last) for every block of `block` elements of 0 to count, the blocks being taken
/// one after the other by as many threads as given; on the calling thread alone if that is one.
/// `body` must not throw.
template <typename Body>
void parallel_blocks(size_t threads, size_t count, size_t block, const Body& body) {
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (;;) {
      const size_t first = next.fetch_add(block);
      if (first >= count) return;
      body(first, std::min(first + block, count));
    }
  };
  std::vector<std::jthread> helpers;
  for (size_t i = 1; i < threads; ++i) helpers.emplace_back(work);
  work();
}

}  // namespace kiwami::tools

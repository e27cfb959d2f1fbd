// SPDX-License-Identifier: Apache-2.0
#include "measure/contest.h"

#include <algorithm>
#include <chrono>

namespace kiwami::tools {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> interleaved_medians(std::span<const std::function<void()>> contenders,
                                        uint32_t rounds,
                                        const std::function<void(size_t)>& after_run) {
  std::vector<std::vector<double>> seconds(contenders.size());
  for (uint32_t round = 0; round < rounds; ++round) {
    for (size_t turn = 0; turn < contenders.size(); ++turn) {
      const size_t i = round % 2 == 0 ? turn : contenders.size() - 1 - turn;
      const auto start = std::chrono::steady_clock::now();
      contenders[i]();
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
      seconds[i].push_back(spent.count());
      after_run(i);
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& of_one : seconds) medians.push_back(median(std::move(of_one)));
  return medians;
}

uint64_t hash_hits(std::span<const kiwami_hit> hits) {
  const auto bytes = std::as_bytes(hits);
  uint64_t hash = 14695981039346656037u;
  for (const std::byte byte : bytes) {
    hash ^= static_cast<uint64_t>(byte);
    hash *= 1099511628211u;
  }
  return hash;
}

}  // namespace kiwami::tools

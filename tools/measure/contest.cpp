// SPDX-License-Identifier: Apache-2.0
#include "measure/contest.h"

#include <algorithm>
#include <chrono>
#include <ctime>

namespace kiwami::tools {

double seconds_now(Clock clock) {
  if (clock == Clock::kProcessor) {
    timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
  }
  const std::chrono::duration<double> now = std::chrono::steady_clock::now().time_since_epoch();
  return now.count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<std::vector<double>> interleaved_seconds(std::span<const Contender> contenders,
                                                     uint32_t rounds, Clock clock) {
  std::vector<std::vector<double>> seconds(contenders.size());
  for (uint32_t round = 0; round < rounds; ++round) {
    for (size_t turn = 0; turn < contenders.size(); ++turn) {
      const size_t i = round % 2 == 0 ? turn : contenders.size() - 1 - turn;
      contenders[i].prepare();
      const double start = seconds_now(clock);
      contenders[i].run();
      seconds[i].push_back(seconds_now(clock) - start);
      contenders[i].check();
    }
  }
  return seconds;
}

std::vector<double> interleaved_medians(std::span<const std::function<void()>> contenders,
                                        uint32_t rounds,
                                        const std::function<void(size_t)>& after_run) {
  std::vector<Contender> prepared;
  for (size_t i = 0; i < contenders.size(); ++i) {
    prepared.push_back({[] {}, contenders[i], [&after_run, i] { after_run(i); }});
  }
  std::vector<double> medians;
  for (const std::vector<double>& seconds : interleaved_seconds(prepared, rounds)) {
    medians.push_back(median(seconds));
  }
  return medians;
}

uint64_t hash_bytes(std::span<const std::byte> bytes) {
  uint64_t hash = 14695981039346656037u;
  for (const std::byte byte : bytes) {
    hash ^= static_cast<uint64_t>(byte);
    hash *= 1099511628211u;
  }
  return hash;
}

uint64_t hash_hits(std::span<const kiwami_hit> hits) { return hash_bytes(std::as_bytes(hits)); }

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>

namespace kiwami::tools {

/// A bar on stderr with the share done, the rate and the time left; silent unless stderr is a
/// terminal.
class Progress {
 public:
  explicit Progress(uint64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of the total; `rays` traced so far, for the rate.
  void update(uint64_t done, uint64_t rays);
  /// Takes the bar away until the next update, so that a line can be printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  uint64_t total_;
  bool on_terminal_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point last_drawn_;
};

}  // namespace kiwami::tools

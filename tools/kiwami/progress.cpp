// SPDX-License-Identifier: Apache-2.0
#include "kiwami/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace kiwami::tools {
namespace {

constexpr size_t kBarLength = 30;
constexpr std::chrono::milliseconds kRedrawEvery{100};

}  // namespace

Progress::Progress(uint64_t total)
    : total_(std::max<uint64_t>(total, 1)),
      on_terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_drawn_(start_) {}

Progress::~Progress() { clear(); }

void Progress::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

void Progress::update(uint64_t done, uint64_t rays) {
  if (!on_terminal_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_drawn_ < kRedrawEvery) return;
  last_drawn_ = now;
  drawn_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double share = static_cast<double>(done) / static_cast<double>(total_);
  const double left = share > 0.0 ? seconds * (1.0 - share) / share : 0.0;
  const auto filled = static_cast<size_t>(share * kBarLength);
  const std::string bar = std::string(filled, '#') + std::string(kBarLength - filled, '.');
  std::fprintf(stderr, "\r[%s] %3.0f %%  %.2f Mrays/s  %d:%02d left \033[K", bar.c_str(),
               100.0 * share, static_cast<double>(rays) / seconds * 1e-6,
               static_cast<int>(left) / 60, static_cast<int>(left) % 60);
  std::fflush(stderr);
}

}  // namespace kiwami::tools

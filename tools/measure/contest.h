// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace kiwami::tools {

/// The middle of the sorted values; the lower of the two middle ones. At least one value.
double median(std::vector<double> values);

/// What contests are timed by.
enum class Clock {
  kWall,       ///< the time that passes
  kProcessor,  ///< the time that the process spends on processors: for one thread, on a machine
               ///< that is busy with other work
};

/// The seconds that a clock shows.
double seconds_now(Clock clock);

/// One side of a comparison. `prepare` and `check` are not timed.
struct Contender {
  std::function<void()> prepare;
  std::function<void()> run;
  std::function<void()> check;
};

/// Times each contender once a round, all of them in turn, so that a disturbance of the machine or
/// a change of its clock meets all alike; the order turns around from round to round. Returns the
/// seconds of each contender, round by round.
std::vector<std::vector<double>> interleaved_seconds(std::span<const Contender> contenders,
                                                     uint32_t rounds, Clock clock = Clock::kWall);

/// The same for contenders that need no preparation; returns the median seconds of each.
/// `after_run` is called untimed after each run, with the contender's number.
std::vector<double> interleaved_medians(std::span<const std::function<void()>> contenders,
                                        uint32_t rounds,
                                        const std::function<void(size_t)>& after_run);

/// A number that differs, as good as surely, when any bit of any byte differs (FNV-1a, 64 bits:
/// G. Fowler, L. C. Noll, P. Vo, "The FNV Non-Cryptographic Hash Algorithm", 1991).
uint64_t hash_bytes(std::span<const std::byte> bytes);
uint64_t hash_hits(std::span<const kiwami_hit> hits);

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace kiwami::tools {

/// The middle of the sorted values; the lower of the two middle ones. At least one value.
double median(std::vector<double> values);

/// Times each contender once a round, all of them in turn, so that a disturbance of the machine or
/// a change of its clock meets all alike; the order turns around from round to round. Returns the
/// median seconds of each. `after_run` is called untimed after each run, with the contender's
/// number.
std::vector<double> interleaved_medians(std::span<const std::function<void()>> contenders,
                                        uint32_t rounds,
                                        const std::function<void(size_t)>& after_run);

/// A number that differs, as good as surely, when any bit of any hit differs (FNV-1a, 64 bits:
/// G. Fowler, L. C. Noll, P. Vo, "The FNV Non-Cryptographic Hash Algorithm", 1991).
uint64_t hash_hits(std::span<const kiwami_hit> hits);

}  // namespace kiwami::tools

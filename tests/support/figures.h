// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>

namespace kiwami_tests {

/// How much of something a test did, for scripts/harden and docs/reliability.md.
inline void print_figure(const char* what, uint64_t count) {
  std::printf("figure: %llu %s\n", static_cast<unsigned long long>(count), what);
}

}  // namespace kiwami_tests

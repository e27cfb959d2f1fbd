// SPDX-License-Identifier: Apache-2.0
// The floating-point control state of a thread, and the one that all results are defined in.
#pragma once

#include <cstdint>

#if defined(__x86_64__) || defined(__SSE__)
#include <xmmintrin.h>
#elif !defined(__aarch64__)
#include <cfenv>
#endif

namespace kiwami {

/// While it lives, the thread rounds to nearest, keeps denormal numbers and raises no signals,
/// whatever its caller had set; afterwards the caller's state is back. Code whose arithmetic
/// depends on it must be called out of line, since compilers move arithmetic across the switch.
class DefaultFloatEnvironment {
 public:
  DefaultFloatEnvironment(const DefaultFloatEnvironment&) = delete;
  DefaultFloatEnvironment& operator=(const DefaultFloatEnvironment&) = delete;

#if defined(__x86_64__) || defined(__SSE__)
  DefaultFloatEnvironment() : saved_(_mm_getcsr()) {
    if ((saved_ & kControlBits) != kDefault) _mm_setcsr(kDefault);
  }
  ~DefaultFloatEnvironment() {
    if ((saved_ & kControlBits) != kDefault) _mm_setcsr(saved_);
  }

 private:
  /// Flush-to-zero, rounding, exception masks, denormals-are-zero: all but the sticky flags.
  static constexpr uint32_t kControlBits = 0xFFC0;
  /// All exceptions masked, everything else off: the state that a process starts in.
  static constexpr uint32_t kDefault = 0x1F80;
  uint32_t saved_;
#elif defined(__aarch64__)
  DefaultFloatEnvironment() {
    asm volatile("mrs %0, fpcr" : "=r"(saved_));
    if (saved_ != 0) asm volatile("msr fpcr, %0" : : "r"(uint64_t{0}));
  }
  ~DefaultFloatEnvironment() {
    if (saved_ != 0) asm volatile("msr fpcr, %0" : : "r"(saved_));
  }

 private:
  uint64_t saved_;
#else
  DefaultFloatEnvironment() {
    std::fegetenv(&saved_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~DefaultFloatEnvironment() { std::fesetenv(&saved_); }

 private:
  std::fenv_t saved_;
#endif
};

}  // namespace kiwami

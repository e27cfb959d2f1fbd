// SPDX-License-Identifier: Apache-2.0
// Errors inside the library: thrown here, translated to a kiwami_result by src/api.
#pragma once

#include <exception>

#include "kiwami/base.h"

namespace kiwami {

/// A result with its sentence. The text lives in the object, so that reporting an error never
/// allocates.
class Error : public std::exception {
 public:
  static constexpr int kCapacity = 320;

  /// printf-style sentence: the argument's name, its value, what was expected.
  Error(kiwami_result result, const char* format, ...)
#if defined(__GNUC__)
      __attribute__((format(printf, 3, 4)))
#endif
      ;

  kiwami_result result() const { return result_; }
  const char* what() const noexcept override { return text_; }

 private:
  kiwami_result result_;
  char text_[kCapacity];
};

}  // namespace kiwami

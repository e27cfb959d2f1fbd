// SPDX-License-Identifier: Apache-2.0
// Arguments of calls out of a fuzzer's input: right ones, and wrong ones of every kind.
#pragma once

#include <kiwami/kiwami.h>

#include <iterator>
#include <limits>

#include "fuzz/fuzz.h"

namespace kiwami_fuzz {

/// Few, so that what is in them meets.
constexpr uint32_t kMostElements = 40;

/// That a call came back with one of the documented results, with a sentence if it is an error.
inline kiwami_result check(kiwami_result result) {
  require(result <= KIWAMI_OK && result >= KIWAMI_ERROR_CANCELLED, "a result that is none");
  require(result != KIWAMI_ERROR_INTERNAL, "an internal error");
  if (result != KIWAMI_OK) {
    require(kiwami_last_error(nullptr, nullptr, 0) > 1, "an error without a sentence");
  }
  return result;
}

class Arguments {
 public:
  explicit Arguments(Input& input) : input_(input) {}

  bool is_empty() const { return input_.is_empty(); }
  uint32_t below(uint32_t count) { return input_.below(count); }
  bool rarely() { return input_.below(16) == 0; }
  uint32_t bits() { return input_.take<uint32_t>(); }

  float number() {
    constexpr float kNumbers[] = {0.0f,
                                  -0.0f,
                                  1.0f,
                                  std::numeric_limits<float>::quiet_NaN(),
                                  std::numeric_limits<float>::infinity(),
                                  -std::numeric_limits<float>::infinity(),
                                  std::numeric_limits<float>::max(),
                                  std::numeric_limits<float>::denorm_min(),
                                  KIWAMI_MAX_COORDINATE};
    const auto form = input_.take<uint8_t>();
    if (form < std::size(kNumbers)) return kNumbers[form];
    if (form < 20) return input_.take<float>();
    return static_cast<float>(form) / 64.0f - 2.0f;
  }

  std::vector<float> numbers(size_t count) {
    std::vector<float> made(count);
    for (float& value : made) value = number();
    return made;
  }

  uint32_t whole() {
    constexpr uint32_t kNumbers[] = {0, 1, 2, 7, 255, 256, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF};
    return kNumbers[input_.below(std::size(kNumbers))];
  }

  /// A count that no buffer has.
  uint64_t huge() { return uint64_t{1} << (32 + input_.below(31)); }

  /// Each below count, but for rare ones.
  std::vector<uint32_t> indices(size_t size, uint32_t count) {
    std::vector<uint32_t> made(size);
    for (uint32_t& index : made) index = rarely() ? whole() : below(count);
    return made;
  }

  /// A struct_size that is wrong but not beyond what is there, or so large that nothing is read.
  uint32_t wrong_size(size_t size) {
    const uint32_t sizes[] = {0, 1, 7, static_cast<uint32_t>(size) - 4, 0x10001, 0xFFFFFFFF};
    return sizes[input_.below(std::size(sizes))];
  }

 private:
  Input& input_;
};

}  // namespace kiwami_fuzz

// SPDX-License-Identifier: Apache-2.0
// What each target of the fuzzers is: a function of bytes that must come to an end without a crash.
// libFuzzer calls it where Clang builds the targets for it (KIWAMI_FUZZ), driver.cpp elsewhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace kiwami_fuzz {

using Bytes = std::vector<unsigned char>;

/// Inputs to begin with; each target has its own.
std::vector<Bytes> make_seeds();

/// Ends the process, so that the fuzzer keeps the input, after saying why.
[[noreturn]] void fail(const char* why);
inline void require(bool condition, const char* why) {
  if (!condition) fail(why);
}

/// The input, taken piece by piece; zeros after its end.
class Input {
 public:
  Input(const uint8_t* data, size_t size) : data_(data), size_(size) {}

  bool is_empty() const { return size_ == 0; }
  template <typename T>
  T take() {
    T value{};
    const size_t part = sizeof(T) < size_ ? sizeof(T) : size_;
    if (part != 0) std::memcpy(&value, data_, part);
    data_ += part;
    size_ -= part;
    return value;
  }
  /// A number below count, which is at least 1.
  uint32_t below(uint32_t count) { return take<uint16_t>() % count; }
  /// All that is left.
  Bytes rest() {
    Bytes bytes(data_, data_ + size_);
    size_ = 0;
    return bytes;
  }

 private:
  const uint8_t* data_;
  size_t size_;
};

}  // namespace kiwami_fuzz

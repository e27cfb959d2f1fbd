// SPDX-License-Identifier: Apache-2.0
// Checksums of sections: XXH3 over pieces of a fixed size, and once more over their sums, so that
// several threads can take part. (Y. Collet, xxHash, https://xxhash.com.)
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami::file {

/// XXH3, 64 bits, seed 0.
uint64_t hash_of(const void* data, size_t size);

/// The checksum of bytes that come bit by bit.
class Checksum {
 public:
  Checksum();
  void add(const void* data, size_t size);
  /// Of all that was added. Nothing may be added after it.
  uint64_t finish();

 private:
  static constexpr size_t kStateSize = 576;

  void end_piece();

  alignas(64) unsigned char piece_[kStateSize];
  alignas(64) unsigned char sums_[kStateSize];
  size_t piece_bytes_ = 0;
};

/// The same of bytes that are all there.
uint64_t checksum_of(const unsigned char* data, size_t size, Memory& memory,
                     const Parallel& parallel);

}  // namespace kiwami::file

// SPDX-License-Identifier: Apache-2.0
#include "io/checksum.h"

#include <algorithm>
#include <new>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace kiwami::file {
namespace {

/// Part of the format.
constexpr size_t kPieceSize = size_t{1} << 20;

XXH3_state_t& state_of(unsigned char* storage) {
  return *std::launder(reinterpret_cast<XXH3_state_t*>(storage));
}

}  // namespace

uint64_t hash_of(const void* data, size_t size) { return XXH3_64bits(data, size); }

Checksum::Checksum() {
  static_assert(sizeof(XXH3_state_t) == kStateSize && alignof(XXH3_state_t) <= 64);
  XXH3_64bits_reset(::new (piece_) XXH3_state_t);
  XXH3_64bits_reset(::new (sums_) XXH3_state_t);
}

void Checksum::add(const void* data, size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  while (size != 0) {
    const size_t part = std::min(size, kPieceSize - piece_bytes_);
    XXH3_64bits_update(&state_of(piece_), bytes, part);
    piece_bytes_ += part;
    bytes += part;
    size -= part;
    if (piece_bytes_ == kPieceSize) end_piece();
  }
}

void Checksum::end_piece() {
  const uint64_t sum = XXH3_64bits_digest(&state_of(piece_));
  XXH3_64bits_update(&state_of(sums_), &sum, sizeof sum);
  XXH3_64bits_reset(&state_of(piece_));
  piece_bytes_ = 0;
}

uint64_t Checksum::finish() {
  if (piece_bytes_ != 0) end_piece();
  return XXH3_64bits_digest(&state_of(sums_));
}

uint64_t checksum_of(const unsigned char* data, size_t size, Memory& memory,
                     const Parallel& parallel) {
  Array<uint64_t> sums(memory, (size + kPieceSize - 1) / kPieceSize);
  parallel.for_blocks(size, kPieceSize, [&](size_t begin, size_t end) {
    sums[begin / kPieceSize] = XXH3_64bits(data + begin, end - begin);
  });
  return XXH3_64bits(sums.data(), sums.bytes());
}

}  // namespace kiwami::file

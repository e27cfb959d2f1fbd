// SPDX-License-Identifier: Apache-2.0
// A stable sort by integer keys, parallel over blocks, least significant digit first.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Sorts by rising key(element), an unsigned number of key_bits bits. Elements of equal keys keep
/// their order, so the result does not depend on the number of threads.
template <typename T, typename Key>
void radix_sort(Array<T>& elements, uint32_t key_bits, Key&& key, Memory& memory,
                const Parallel& parallel) {
  constexpr uint32_t kDigitBits = 8, kDigits = 1u << kDigitBits;
  constexpr size_t kBlockSize = 32768;
  const size_t blocks = (elements.size() + kBlockSize - 1) / kBlockSize;
  Array<T> other(memory, elements.size());
  Array<uint32_t> offsets(memory, blocks * kDigits);
  for (uint32_t shift = 0; shift < key_bits; shift += kDigitBits) {
    // Copies, so that what the loops write cannot change them.
    const auto digit = [key, shift](const T& element) {
      return static_cast<uint32_t>(key(element) >> shift) & (kDigits - 1);
    };
    const T* const from = elements.data();
    T* const to = other.data();
    offsets.fill_zero();
    parallel.for_blocks(elements.size(), kBlockSize, [&, digit, from](size_t begin, size_t end) {
      uint32_t* const counts = offsets.data() + begin / kBlockSize * kDigits;
      for (const T* element = from + begin; element != from + end; ++element) {
        ++counts[digit(*element)];
      }
    });
    uint32_t next = 0;
    for (uint32_t value = 0; value < kDigits; ++value) {
      for (size_t block = 0; block < blocks; ++block) {
        uint32_t& offset = offsets[block * kDigits + value];
        const uint32_t count = offset;
        offset = next;
        next += count;
      }
    }
    parallel.for_blocks(elements.size(), kBlockSize,
                        [&, digit, from, to](size_t begin, size_t end) {
                          uint32_t* const places = offsets.data() + begin / kBlockSize * kDigits;
                          for (const T* element = from + begin; element != from + end; ++element) {
                            to[places[digit(*element)]++] = *element;
                          }
                        });
    std::swap(elements, other);
  }
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "core/strided_buffer.h"

#include <cstring>
#include <limits>

#include "core/error.h"

namespace kiwami {
namespace {

/// Elements that one task copies.
constexpr size_t kBlockSize = 16384;

using ull = unsigned long long;

}  // namespace

void check_extent(const char* name, const void* data, uint64_t offset, uint64_t stride,
                  uint64_t count, size_t element_size) {
  if (count == 0) return;
  const uint64_t limit = std::numeric_limits<uintptr_t>::max() - reinterpret_cast<uintptr_t>(data);
  const bool fits = offset <= limit && element_size <= limit - offset &&
                    (count == 1 || stride <= (limit - offset - element_size) / (count - 1));
  if (!fits) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "the %s (offset %llu, stride %llu, count %llu) reach beyond the address space, "
                "expected an extent of at most %llu bytes",
                name, ull{offset}, ull{stride}, ull{count}, ull{limit});
  }
}

void check_stride(const char* name, uint64_t stride, size_t element_size) {
  if (stride != 0 && stride < element_size) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.%s is %llu, expected at least %zu, or 0 for %zu", name, ull{stride},
                element_size, element_size);
  }
}

void pack(const unsigned char* source, size_t stride, size_t count, size_t element_size,
          unsigned char* target, const Device& device) {
  device.parallel().for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
    if (stride == element_size) {
      std::memcpy(target + begin * element_size, source + begin * element_size,
                  (end - begin) * element_size);
      return;
    }
    for (size_t i = begin; i < end; ++i) {
      std::memcpy(target + i * element_size, source + i * stride, element_size);
    }
  });
}

Array<unsigned char> packed_copy(const unsigned char* source, size_t stride, size_t count,
                                 size_t element_size, Device& device) {
  Array<unsigned char> packed(device.memory(), count * element_size);
  pack(source, stride, count, element_size, packed.data(), device);
  return packed;
}

}  // namespace kiwami

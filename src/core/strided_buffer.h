// SPDX-License-Identifier: Apache-2.0
// The caller's buffers of elements that lie a stride apart: checks and packed copies.
#pragma once

#include <cstdint>

#include "core/device.h"
#include "core/memory.h"

namespace kiwami {

/// Throws Error(INVALID_ARGUMENT) unless count elements of element_size bytes, stride bytes apart
/// from data + offset on, end within the address space.
void check_extent(const char* name, const void* data, uint64_t offset, uint64_t stride,
                  uint64_t count, size_t element_size);

/// Throws Error(INVALID_ARGUMENT) for a stride of desc.<name> that is neither 0 nor at least
/// element_size.
void check_stride(const char* name, uint64_t stride, size_t element_size);

/// Copies count elements, stride bytes apart, close together, on the device's threads.
void pack(const unsigned char* source, size_t stride, size_t count, size_t element_size,
          unsigned char* target, const Device& device);

/// The same, into an array of just that size.
Array<unsigned char> packed_copy(const unsigned char* source, size_t stride, size_t count,
                                 size_t element_size, Device& device);

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/device.h"
#include "core/memory.h"
#include "core/object.h"

namespace kiwami {

/// A packed copy of a caller's buffer. What was committed holds the copy that it was made of, so
/// that a geometry can receive other contents meanwhile.
class BufferCopy : public Object<BufferCopy> {
 public:
  /// Throws Error(OUT_OF_MEMORY).
  static BufferCopy* create(Device& device, Array<unsigned char> bytes) {
    return make_object<BufferCopy>(device.memory(), device, std::move(bytes));
  }
  static void destroy(BufferCopy* copy) noexcept {
    const Reference<Device> device = copy->device_;
    destroy_object(device->memory(), copy);
  }

  BufferCopy(Device& device, Array<unsigned char> bytes)
      : device_(device), bytes_(std::move(bytes)) {}

  const Array<unsigned char>& bytes() const { return bytes_; }
  /// For one that nobody else holds.
  Array<unsigned char>& bytes() { return bytes_; }

 private:
  Reference<Device> device_;
  Array<unsigned char> bytes_;
};

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "core/object.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Which kernels run, on which threads, with whose memory. Everything else holds a device.
class Device : public Object<Device> {
 public:
  /// Threads that a device may be asked for.
  static constexpr uint32_t kMaxThreadCount = 1024;

  /// Reads the environment variable KIWAMI_ISA where desc.isa is KIWAMI_ISA_AUTO. Throws
  /// Error(INVALID_ARGUMENT, UNSUPPORTED_ISA or OUT_OF_MEMORY).
  static Device* create(const kiwami_device_desc& desc);
  static void destroy(Device* device) noexcept;

  Device(const kiwami_device_desc& desc, uint32_t isa);

  Memory& memory() { return memory_; }
  const Parallel& parallel() const { return parallel_; }
  uint32_t isa() const { return isa_; }
  bool validates_arguments() const { return (flags_ & KIWAMI_DEVICE_VALIDATE) != 0; }
  kiwami_device_info info() const;

  /// Hands a sentence to the caller's log, if there is one.
  void log(kiwami_result severity, const char* sentence) const {
    if (log_) log_(log_user_, severity, sentence);
  }

 private:
  MemoryBudget budget_;
  Memory memory_;
  Parallel parallel_;
  uint32_t isa_;
  uint32_t flags_;
  kiwami_log log_;
  void* log_user_;
};

}  // namespace kiwami

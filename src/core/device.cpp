// SPDX-License-Identifier: Apache-2.0
#include "core/device.h"

#include <cstdio>
#include <cstdlib>

#include "core/error.h"
#include "dispatch/dispatch.h"

namespace kiwami {

namespace {

/// The names of a set of ISAs, such as "scalar, sse".
struct IsaList {
  explicit IsaList(uint32_t isas) {
    size_t length = 0;
    for (uint32_t isa = KIWAMI_ISA_SCALAR; isa <= KIWAMI_ISA_AVX512; ++isa) {
      if ((isas >> isa & 1) == 0) continue;
      length += static_cast<size_t>(std::snprintf(text + length, sizeof(text) - length, "%s%s",
                                                  length ? ", " : "", isa_name(isa)));
    }
  }
  char text[64] = "";
};

/// The ISA that the environment asks for, AUTO where it does not.
uint32_t isa_of_environment() {
  const char* name = std::getenv("KIWAMI_ISA");
  uint32_t isa = KIWAMI_ISA_AUTO;
  if (name && name[0] != '\0' && !isa_of_name(name, isa)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "the environment variable KIWAMI_ISA is '%.64s', expected auto, scalar, sse, avx2 "
                "or avx512",
                name);
  }
  return isa;
}

uint32_t choose_isa(uint32_t asked) {
  if (!isa_name(asked)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.isa is %u, expected one of KIWAMI_ISA_*",
                asked);
  }
  const uint32_t isa = asked == KIWAMI_ISA_AUTO ? isa_of_environment() : asked;
  if (isa == KIWAMI_ISA_AUTO) return best_isa();
  const uint32_t available = built_isas() & runnable_isas();
  if (available >> isa & 1) return isa;
  const char* source =
      asked == KIWAMI_ISA_AUTO ? "the environment variable KIWAMI_ISA" : "desc.isa";
  if ((built_isas() >> isa & 1) == 0) {
    throw Error(KIWAMI_ERROR_UNSUPPORTED_ISA,
                "%s is %s, which this build lacks, expected one of: %s", source, isa_name(isa),
                IsaList(available).text);
  }
  throw Error(KIWAMI_ERROR_UNSUPPORTED_ISA,
              "%s is %s, which this processor or its operating system lacks, expected one of: %s",
              source, isa_name(isa), IsaList(available).text);
}

void check_fields(const kiwami_device_desc& desc) {
  if (desc.flags & ~uint32_t{KIWAMI_DEVICE_VALIDATE}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x%x, expected KIWAMI_DEVICE_* bits",
                desc.flags);
  }
  if (desc.reserved != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.reserved is %u, expected 0", desc.reserved);
  }
  if (!desc.allocate != !desc.deallocate) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.%s is NULL, expected desc.allocate and desc.deallocate both or none",
                desc.allocate ? "deallocate" : "allocate");
  }
  if (!desc.runner && desc.thread_count > Device::kMaxThreadCount) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.thread_count is %u, expected at most %u",
                desc.thread_count, Device::kMaxThreadCount);
  }
}

}  // namespace

Device* Device::create(const kiwami_device_desc& desc) {
  check_fields(desc);
  const uint32_t isa = choose_isa(desc.isa);
  // The device's own bytes cannot be counted by the memory that lies in them.
  const Allocator allocator{desc.allocate, desc.deallocate, desc.allocator_user, nullptr};
  void* place = allocator.allocate(sizeof(Device), alignof(Device));
  try {
    return ::new (place) Device(desc, isa);
  } catch (...) {
    allocator.deallocate(place, sizeof(Device), alignof(Device));
    throw;
  }
}

void Device::destroy(Device* device) noexcept {
  Allocator allocator = device->memory_.allocator();
  allocator.budget = nullptr;  // which ends with the device
  device->~Device();
  allocator.deallocate(device, sizeof(Device), alignof(Device));
}

Device::Device(const kiwami_device_desc& desc, uint32_t isa)
    : budget_(desc.memory_limit),
      memory_(Allocator{desc.allocate, desc.deallocate, desc.allocator_user, &budget_}),
      parallel_(desc.thread_count, desc.runner, desc.runner_user, desc.runner_width),
      isa_(isa),
      flags_(desc.flags),
      log_(desc.log),
      log_user_(desc.log_user) {}

kiwami_device_info Device::info() const {
  kiwami_device_info info{};
  info.struct_size = sizeof(info);
  info.isa = isa_;
  info.isa_built = built_isas();
  info.isa_available = built_isas() & runnable_isas();
  info.native_widths = native_widths_of(isa_);
  info.default_bvh_width = default_width_of(isa_);
  info.thread_count = parallel_.width();
  // The device's own bytes lie beside the memory that it counts.
  info.memory_bytes = budget_.bytes_in_use() + sizeof(*this);
  info.memory_peak_bytes = budget_.peak_bytes() + sizeof(*this);
  info.memory_limit = budget_.limit();
  return info;
}

}  // namespace kiwami

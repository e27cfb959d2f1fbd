// SPDX-License-Identifier: Apache-2.0
#include "core/memory.h"

#include <cstdint>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "core/error.h"

namespace kiwami {
namespace {

/// Incoherent rays in a large tree miss the cache of page addresses at nearly every node, so large
/// blocks are laid out for huge pages.
constexpr size_t kHugePageSize = size_t{1} << 21;

size_t runtime_alignment(size_t size, size_t alignment) {
  return size >= kHugePageSize && alignment < kHugePageSize ? kHugePageSize : alignment;
}

void* allocate_from_runtime(size_t size, size_t alignment) {
  const std::align_val_t aligned{runtime_alignment(size, alignment)};
  void* memory = ::operator new(size, aligned, std::nothrow);
#if defined(__linux__)
  // Only a wish: where it is refused, the block has ordinary pages.
  if (memory && size >= kHugePageSize) {
    madvise(memory, size & ~(kHugePageSize - 1), MADV_HUGEPAGE);
  }
#endif
  return memory;
}

}  // namespace

void MemoryBudget::take(size_t size) {
  const uint64_t in_use = in_use_.fetch_add(size, std::memory_order_relaxed) + size;
  if (limit_ != 0 && in_use > limit_) {
    give_back(size);
    throw Error(KIWAMI_ERROR_OUT_OF_MEMORY,
                "allocation of %zu bytes would make %llu of the device, expected at most "
                "desc.memory_limit, which is %llu",
                size, static_cast<unsigned long long>(in_use),
                static_cast<unsigned long long>(limit_));
  }
  uint64_t peak = peak_bytes();
  while (peak < in_use && !peak_.compare_exchange_weak(peak, in_use, std::memory_order_relaxed)) {
  }
}

void* Allocator::allocate(size_t size, size_t alignment) const {
  if (size == 0) return nullptr;
  if (budget) budget->take(size);
  void* memory = allocate_function ? allocate_function(user, size, alignment)
                                   : allocate_from_runtime(size, alignment);
  if (!memory) {
    if (budget) budget->give_back(size);
    throw Error(KIWAMI_ERROR_OUT_OF_MEMORY,
                "allocation of %zu bytes at a multiple of %zu failed, expected memory", size,
                alignment);
  }
  if (reinterpret_cast<uintptr_t>(memory) % alignment != 0) {
    deallocate(memory, size, alignment);
    throw Error(KIWAMI_ERROR_CALLBACK,
                "allocate returned %p for %zu bytes, expected a multiple of %zu", memory, size,
                alignment);
  }
  return memory;
}

void Allocator::deallocate(void* memory, size_t size, size_t alignment) const noexcept {
  if (!memory) return;
  if (budget) budget->give_back(size);
  if (allocate_function) {
    deallocate_function(user, memory, size, alignment);
  } else {
    ::operator delete(memory, std::align_val_t(runtime_alignment(size, alignment)));
  }
}

void* Memory::allocate(size_t size, size_t alignment) {
  void* memory = allocator_.allocate(size, alignment);
  const size_t in_use = in_use_.fetch_add(size, std::memory_order_relaxed) + size;
  size_t peak = peak_.load(std::memory_order_relaxed);
  while (peak < in_use && !peak_.compare_exchange_weak(peak, in_use, std::memory_order_relaxed)) {
  }
  return memory;
}

void Memory::deallocate(void* memory, size_t size, size_t alignment) noexcept {
  if (!memory) return;
  allocator_.deallocate(memory, size, alignment);
  in_use_.fetch_sub(size, std::memory_order_relaxed);
}

}  // namespace kiwami

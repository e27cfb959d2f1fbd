// SPDX-License-Identifier: Apache-2.0
// Memory of a device: every array of the library comes from the device's allocator, which counts.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

#include "kiwami/device.h"

namespace kiwami {

/// How much a device and all that is made from it hold, and may hold. Safe to use from any thread.
class MemoryBudget {
 public:
  /// limit 0: none.
  explicit MemoryBudget(uint64_t limit) : limit_(limit) {}

  /// Throws Error(OUT_OF_MEMORY) where size more bytes would be too many, and then has not changed.
  void take(size_t size);
  void give_back(size_t size) noexcept { in_use_.fetch_sub(size, std::memory_order_relaxed); }

  uint64_t limit() const { return limit_; }
  uint64_t bytes_in_use() const { return in_use_.load(std::memory_order_relaxed); }
  uint64_t peak_bytes() const { return peak_.load(std::memory_order_relaxed); }

 private:
  uint64_t limit_;
  std::atomic<uint64_t> in_use_{0};
  std::atomic<uint64_t> peak_{0};
};

/// Where memory comes from: the caller's functions, or the C++ runtime's when they are null.
struct Allocator {
  kiwami_allocate allocate_function;
  kiwami_deallocate deallocate_function;
  void* user;
  MemoryBudget* budget = nullptr;  ///< nullptr: nothing is counted

  /// Throws Error(OUT_OF_MEMORY) that names the size. size may be 0: returns nullptr.
  void* allocate(size_t size, size_t alignment) const;
  void deallocate(void* memory, size_t size, size_t alignment) const noexcept;
};

/// An allocator with its byte count. Safe to use from any thread.
class Memory {
 public:
  Memory(kiwami_allocate allocate_function, kiwami_deallocate deallocate_function, void* user)
      : allocator_{allocate_function, deallocate_function, user, nullptr} {}
  explicit Memory(const Allocator& allocator) : allocator_(allocator) {}
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  const Allocator& allocator() const { return allocator_; }

  /// Throws Error(OUT_OF_MEMORY) that names the size. size may be 0: returns nullptr.
  void* allocate(size_t size, size_t alignment);
  void deallocate(void* memory, size_t size, size_t alignment) noexcept;

  size_t bytes_in_use() const { return in_use_.load(std::memory_order_relaxed); }
  /// The highest bytes_in_use() since the last reset_peak().
  size_t peak_bytes() const { return peak_.load(std::memory_order_relaxed); }
  void reset_peak() { peak_.store(bytes_in_use(), std::memory_order_relaxed); }

 private:
  Allocator allocator_;
  std::atomic<size_t> in_use_{0};
  std::atomic<size_t> peak_{0};
};

/// A fixed-size array of plain data on a device's memory, aligned to cache lines and not
/// initialised. Move-only.
template <typename T>
class Array {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  static constexpr size_t kAlignment = alignof(T) > 64 ? alignof(T) : 64;

  Array() = default;
  Array(Memory& memory, size_t size)
      : memory_(&memory),
        data_(static_cast<T*>(memory.allocate(size * sizeof(T), kAlignment))),
        size_(size) {}
  /// Over memory of others, which must outlive the array.
  static Array borrow(T* data, size_t size) {
    Array array;
    array.data_ = data;
    array.size_ = size;
    return array;
  }
  Array(Array&& other) noexcept { swap(other); }
  Array& operator=(Array&& other) noexcept {
    Array moved(std::move(other));
    swap(moved);
    return *this;
  }
  ~Array() {
    if (memory_ && data_) memory_->deallocate(data_, capacity_bytes(), kAlignment);
  }

  /// False for memory of others.
  bool owns_memory() const { return memory_ != nullptr; }

  T* data() { return data_; }
  const T* data() const { return data_; }
  size_t size() const { return size_; }
  size_t bytes() const { return size_ * sizeof(T); }
  bool empty() const { return size_ == 0; }
  T& operator[](size_t index) { return data_[index]; }
  const T& operator[](size_t index) const { return data_[index]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }

  void fill_zero() {
    if (size_) std::memset(static_cast<void*>(data_), 0, bytes());
  }

  /// Keeps the first size elements, in memory of just that size.
  void shrink(size_t size) {
    if (size == size_) return;
    Array kept(*memory_, size);
    if (size) std::memcpy(static_cast<void*>(kept.data_), data_, size * sizeof(T));
    swap(kept);
  }

 private:
  size_t capacity_bytes() const { return size_ * sizeof(T); }
  void swap(Array& other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
  }

  Memory* memory_ = nullptr;  ///< nullptr: nothing, or borrowed
  T* data_ = nullptr;
  size_t size_ = 0;
};

/// An array that grows, for counts that are not known beforehand. Doubles its room.
template <typename T>
class GrowingArray {
 public:
  explicit GrowingArray(Memory& memory) : memory_(&memory) {}

  T& push_back(const T& value) {
    if (size_ == array_.size()) grow();
    return array_[size_++] = value;
  }
  void pop_back() { --size_; }
  /// Room for size elements in all: until then push_back does not throw.
  void reserve(size_t size) {
    if (size > array_.size()) grow_to(size < size_ * 2 ? size_ * 2 : size);
  }
  T& back() { return array_[size_ - 1]; }
  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T* data() const { return array_.data(); }
  T& operator[](size_t index) { return array_[index]; }
  const T& operator[](size_t index) const { return array_[index]; }

  /// The elements as an array of exactly their number.
  Array<T> take() {
    if (array_.size() == 0) array_ = Array<T>(*memory_, 0);
    array_.shrink(size_);
    size_ = 0;
    return std::move(array_);
  }

 private:
  void grow() { grow_to(size_ < 8 ? 16 : size_ * 2); }

  void grow_to(size_t capacity) {
    Array<T> larger(*memory_, capacity);
    if (size_) std::memcpy(static_cast<void*>(larger.data()), array_.data(), size_ * sizeof(T));
    array_ = std::move(larger);
  }

  Memory* memory_;
  Array<T> array_;
  size_t size_ = 0;
};

}  // namespace kiwami

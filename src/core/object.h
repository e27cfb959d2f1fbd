// SPDX-License-Identifier: Apache-2.0
// Objects on a device's memory: counted references for what handles name, and single owners.
#pragma once

#include <atomic>
#include <cstdint>
#include <new>
#include <utility>

#include "core/memory.h"

namespace kiwami {

/// Makes a T on memory. Whatever its constructor throws leaves nothing behind.
template <typename T, typename... Arguments>
T* make_object(Memory& memory, Arguments&&... arguments) {
  void* place = memory.allocate(sizeof(T), alignof(T));
  try {
    return ::new (place) T(std::forward<Arguments>(arguments)...);
  } catch (...) {
    memory.deallocate(place, sizeof(T), alignof(T));
    throw;
  }
}

/// Ends what make_object made.
template <typename T>
void destroy_object(Memory& memory, T* object) noexcept {
  object->~T();
  memory.deallocate(object, sizeof(T), alignof(T));
}

/// Base of the objects that handles name. Starts with one reference; the last release calls
/// T::destroy(T*).
template <typename T>
class Object {
 public:
  Object() = default;
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;

  void retain() noexcept { references_.fetch_add(1, std::memory_order_relaxed); }

  void release() noexcept {
    // Acquire-release: whatever other threads did with the object has happened before its end.
    if (references_.fetch_sub(1, std::memory_order_acq_rel) == 1) T::destroy(static_cast<T*>(this));
  }

 protected:
  ~Object() = default;

 private:
  std::atomic<size_t> references_{1};
};

/// One counted reference to an object.
template <typename T>
class Reference {
 public:
  explicit Reference(T& object) : object_(&object) { object_->retain(); }
  Reference(const Reference& other) : object_(other.object_) { object_->retain(); }
  Reference& operator=(const Reference&) = delete;
  ~Reference() { object_->release(); }

  T& operator*() const { return *object_; }
  T* operator->() const { return object_; }

 private:
  T* object_;
};

/// The only owner of an object that make_object made on memory; may own nothing.
template <typename T>
class Owned {
 public:
  Owned() = default;
  Owned(Memory& memory, T* object) : memory_(&memory), object_(object) {}
  Owned(Owned&& other) noexcept
      : memory_(other.memory_), object_(std::exchange(other.object_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(object_, other.object_);
    return *this;
  }
  ~Owned() {
    if (object_) destroy_object(*memory_, object_);
  }

  T* get() const { return object_; }

 private:
  Memory* memory_ = nullptr;
  T* object_ = nullptr;
};

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// Objects on a device's memory, and counted references to them.
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

/// Base of the objects that several may hold, as those that handles name. Starts with one
/// reference; the last release calls T::destroy(T*).
template <typename T>
class Object {
 public:
  Object() = default;
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;

  void retain() noexcept { references_.fetch_add(1, std::memory_order_relaxed); }

  /// Whether there are several references. Where there is one, it is that of the caller, and what
  /// others did with the object has happened before.
  bool is_shared() const noexcept { return references_.load(std::memory_order_acquire) != 1; }

  void release() noexcept {
    // Acquire-release: whatever other threads did with the object has happened before its end.
    if (references_.fetch_sub(1, std::memory_order_acq_rel) == 1) T::destroy(static_cast<T*>(this));
  }

 protected:
  ~Object() = default;

 private:
  std::atomic<size_t> references_{1};
};

/// One counted reference to an object, or none.
template <typename T>
class Reference {
 public:
  Reference() = default;
  explicit Reference(T& object) : object_(&object) { object_->retain(); }
  Reference(const Reference& other) : object_(other.object_) {
    if (object_) object_->retain();
  }
  Reference(Reference&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Reference& operator=(Reference other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Reference() {
    if (object_) object_->release();
  }

  /// Takes over the reference that a new object starts with.
  static Reference adopt(T* object) {
    Reference reference;
    reference.object_ = object;
    return reference;
  }

  T* get() const { return object_; }
  T& operator*() const { return *object_; }
  T* operator->() const { return object_; }

 private:
  T* object_ = nullptr;
};

}  // namespace kiwami

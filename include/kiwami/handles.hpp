// SPDX-License-Identifier: Apache-2.0
//
// Kiwami for C++20: what every object is made of: errors, handles, devices. Use kiwami.hpp.
#ifndef KIWAMI_HANDLES_HPP
#define KIWAMI_HANDLES_HPP

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "kiwami.h"

namespace kiwami {

using Ray = kiwami_ray;
using Hit = kiwami_hit;
using DeviceInfo = kiwami_device_info;

/// Three numbers that lie together.
using Vertex = std::array<float, 3>;
using Triangle = std::array<std::uint32_t, 3>;
/// Three rows of four numbers, from a scene's space to the outer one.
using Transform = std::array<float, 12>;

/// An error of the library: its number, and its sentence as what().
class Error : public std::runtime_error {
 public:
  Error(kiwami_result result, const std::string& sentence)
      : std::runtime_error(sentence), result_(result) {}
  kiwami_result result() const noexcept { return result_; }

 private:
  kiwami_result result_;
};

namespace detail {

inline void check(kiwami_result result, const kiwami_device* device = nullptr) {
  if (result == KIWAMI_OK) return;
  char sentence[1024];
  kiwami_last_error(device, sentence, sizeof(sentence));
  throw Error(result, sentence[0] != '\0' ? sentence : kiwami_result_name(result));
}

/// Owns one reference to an object of the C interface.
template <typename T, void (*kRetain)(T*), void (*kRelease)(T*)>
class Handle {
 public:
  Handle() = default;
  /// Takes over the caller's reference.
  explicit Handle(T* object) noexcept : object_(object) {}
  Handle(const Handle& other) noexcept : object_(other.object_) { kRetain(object_); }
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Handle() { kRelease(object_); }

  /// The object for calls of the C interface; it stays this handle's.
  T* get() const noexcept { return object_; }
  explicit operator bool() const noexcept { return object_ != nullptr; }

 private:
  T* object_ = nullptr;
};

}  // namespace detail

/// How a device is to be made; the defaults are the library's.
struct DeviceOptions {
  std::uint32_t isa = KIWAMI_ISA_AUTO;
  std::uint32_t thread_count = 0;
  bool validate = false;  ///< check the arguments of the trace calls too
};

/// Kernels of one ISA and the threads that run them. Copies name the same device.
class Device : public detail::Handle<kiwami_device, kiwami_device_retain, kiwami_device_release> {
 public:
  Device() : Device(DeviceOptions{}) {}
  explicit Device(const DeviceOptions& options) : Handle(create(options)) {}
  explicit Device(const kiwami_device_desc& desc) : Handle(create(desc)) {}

  DeviceInfo info() const {
    DeviceInfo info{};
    info.struct_size = sizeof(info);
    detail::check(kiwami_device_get_info(get(), &info), get());
    return info;
  }

 private:
  static kiwami_device* create(const kiwami_device_desc& desc) {
    kiwami_device* device = nullptr;
    detail::check(kiwami_device_create(&desc, &device));
    return device;
  }
  static kiwami_device* create(const DeviceOptions& options) {
    kiwami_device_desc desc;
    detail::check(kiwami_device_desc_init(&desc, sizeof(desc)));
    desc.isa = options.isa;
    desc.thread_count = options.thread_count;
    desc.flags = options.validate ? std::uint32_t{KIWAMI_DEVICE_VALIDATE} : 0u;
    return create(desc);
  }
};

/// Geometries of any kind.
class Geometry
    : public detail::Handle<kiwami_geometry, kiwami_geometry_retain, kiwami_geometry_release> {
 public:
  using Handle::Handle;
};

}  // namespace kiwami

#endif

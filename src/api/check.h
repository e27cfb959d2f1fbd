// SPDX-License-Identifier: Apache-2.0
// What every function of the C API does: check, call, translate exceptions.
#pragma once

#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <new>

#include "core/bvh.h"
#include "core/device.h"
#include "core/error.h"
#include "core/geometry.h"
#include "core/scene.h"
#include "core/triangle_mesh.h"

namespace kiwami::api {

/// Keeps the sentence as this thread's last error, hands it to the device's log, and returns
/// result. device may be null: the error concerns none.
kiwami_result report(const Device* device, kiwami_result result, const char* sentence) noexcept;

/// Runs the body of an API function: nothing that it throws gets past.
template <typename Body>
kiwami_result guarded(const Device* device, Body&& body) noexcept {
  try {
    body();
    return KIWAMI_OK;
  } catch (const Error& error) {
    return report(device, error.result(), error.what());
  } catch (const std::bad_alloc&) {
    return report(device, KIWAMI_ERROR_OUT_OF_MEMORY,
                  "an allocation of the C++ runtime or of the task scheduler failed, expected "
                  "memory");
  } catch (const std::exception& exception) {
    return report(device, KIWAMI_ERROR_INTERNAL, exception.what());
  } catch (...) {
    return report(device, KIWAMI_ERROR_INTERNAL, "an unknown exception, expected none");
  }
}

inline void check_not_null(const void* pointer, const char* name) {
  if (!pointer) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "%s is NULL, expected a valid pointer", name);
  }
}

// Handles and the objects behind them.
inline Device* object_of(kiwami_device* handle) { return reinterpret_cast<Device*>(handle); }
inline const Device* object_of(const kiwami_device* handle) {
  return reinterpret_cast<const Device*>(handle);
}
inline Geometry* object_of(kiwami_geometry* handle) { return reinterpret_cast<Geometry*>(handle); }
inline kiwami_geometry* handle_of(Geometry* geometry) {
  return reinterpret_cast<kiwami_geometry*>(geometry);
}
inline Scene* object_of(kiwami_scene* handle) { return reinterpret_cast<Scene*>(handle); }
inline const Scene* object_of(const kiwami_scene* handle) {
  return reinterpret_cast<const Scene*>(handle);
}

inline Bvh* object_of(kiwami_bvh* handle) { return reinterpret_cast<Bvh*>(handle); }
inline const Bvh* object_of(const kiwami_bvh* handle) {
  return reinterpret_cast<const Bvh*>(handle);
}

/// The device of a scene (tree) handle, for reports; null for NULL.
inline const Device* device_of(const kiwami_scene* scene) {
  return scene ? &object_of(scene)->device() : nullptr;
}
inline const Device* device_of(const kiwami_bvh* bvh) {
  return bvh ? &object_of(bvh)->device() : nullptr;
}

inline const Device* device_of(kiwami_geometry* geometry) {
  return geometry ? &object_of(geometry)->device() : nullptr;
}

/// The mesh behind a handle; throws Error for one that is NULL or another kind of geometry.
inline TriangleMesh& triangle_mesh_of(const kiwami_geometry* handle, const char* name) {
  check_not_null(handle, name);
  Geometry& geometry = *object_of(const_cast<kiwami_geometry*>(handle));
  if (geometry.kind() != GeometryKind::kTriangleMesh) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "%s is a geometry of another kind, expected a triangle mesh", name);
  }
  return static_cast<TriangleMesh&>(geometry);
}

/// What a scene committed; throws Error for a scene that is NULL or was never committed.
inline CommittedScene& committed_of(const kiwami_scene* scene) {
  check_not_null(scene, "scene");
  CommittedScene* committed = object_of(scene)->committed();
  if (!committed) {
    throw Error(KIWAMI_ERROR_INVALID_STATE,
                "scene was never committed, expected a successful kiwami_scene_commit before");
  }
  return *committed;
}

inline void check_reserved(const char* name, uint32_t reserved) {
  if (reserved != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "%s is %u, expected 0", name, reserved);
  }
}

/// Throws unless count elements of size bytes, stride bytes apart, end within the address space.
inline void check_array(const char* name, const void* data, size_t stride, size_t size,
                        size_t count) {
  check_not_null(data, name);
  if (stride != 0 && stride < size) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "the stride of %s is %zu, expected at least %zu, or 0 for %zu", name, stride, size,
                size);
  }
  const size_t step = stride ? stride : size;
  const size_t limit = std::numeric_limits<uintptr_t>::max() - reinterpret_cast<uintptr_t>(data);
  if (size > limit || count - 1 > (limit - size) / step) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "the %zu elements of %s, %zu bytes apart, reach beyond the address space, expected "
                "an extent of at most %zu bytes",
                count, name, step, limit);
  }
}

/// No struct of any version of the library is larger; a larger size is an uninitialised one.
constexpr size_t kMaxStructSize = 65536;

/// Checks the size that a caller gives for one of the structs that begin with struct_size.
inline void check_struct_size(const char* name, size_t size, size_t minimum) {
  if (size < minimum || size > kMaxStructSize) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "%s is %zu, expected %zu to %zu", name, size,
                minimum, kMaxStructSize);
  }
}

/// Fills a caller's struct of size bytes with the defaults; a tail that this library does not know
/// becomes zero, which means its default in the library that does.
template <typename Descriptor>
void init_descriptor(Descriptor* target, size_t size, size_t minimum, const char* name,
                     Descriptor defaults) {
  check_not_null(target, name);
  check_struct_size("size", size, minimum);
  defaults.struct_size = static_cast<uint32_t>(size);
  std::memset(static_cast<void*>(target), 0, size);
  std::memcpy(static_cast<void*>(target), &defaults, std::min(size, sizeof(Descriptor)));
}

/// A caller's struct as this library knows it: what an older caller's is too short for has its
/// default, and what a newer caller's holds beyond must be zero, since it would be ignored.
template <typename Descriptor>
Descriptor read_descriptor(const Descriptor* source, size_t minimum, const char* name,
                           Descriptor defaults) {
  check_not_null(source, name);
  const size_t size = source->struct_size;
  if (size == sizeof(Descriptor)) return *source;
  // The size of a struct is a multiple of its alignment: so no field is cut in two below.
  if (size < minimum || size > kMaxStructSize || size % alignof(Descriptor) != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "%s.struct_size is %zu, expected a multiple of %zu from %zu to %zu", name, size,
                alignof(Descriptor), minimum, kMaxStructSize);
  }
  std::memcpy(static_cast<void*>(&defaults), source, std::min(size, sizeof(Descriptor)));
  const unsigned char* bytes = reinterpret_cast<const unsigned char*>(source);
  for (size_t i = sizeof(Descriptor); i < size; ++i) {
    if (bytes[i] != 0) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "%s has a value at byte %zu, where this library knows no field, expected 0", name,
                  i);
    }
  }
  return defaults;
}

/// Fills the fields of a caller's info struct that fit into its struct_size.
template <typename Info>
void write_info(Info* target, size_t minimum, const char* name, const Info& info) {
  check_not_null(target, name);
  const uint32_t size = target->struct_size;
  check_struct_size("info.struct_size", size, minimum);
  // Whole multiples of the alignment cut no field in two.
  const size_t known = std::min(size - size % alignof(Info), sizeof(Info));
  std::memcpy(static_cast<void*>(target), &info, known);
  target->struct_size = size;
}

}  // namespace kiwami::api

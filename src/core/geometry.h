// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/buffer_copy.h"
#include "core/device.h"
#include "core/file_image.h"
#include "core/memory.h"
#include "core/object.h"
#include "kiwami/geometry.h"

namespace kiwami {

enum class GeometryKind : uint32_t {
  kTriangleMesh,
  kInstances,
  kSpheres,
  kDiscs,
  kCurves,
  kUser,
  kMovingMesh
};

/// What a kiwami_geometry is, whatever its kind: what scenes need of all of them. Each kind is a
/// final class that derives from it.
class Geometry : public Object<Geometry> {
 public:
  static void destroy(Geometry* geometry) noexcept;

  Device& device() const { return *device_; }
  GeometryKind kind() const { return kind_; }
  /// A ray meets the geometry only where (ray.mask & mask()) != 0.
  uint32_t mask() const { return mask_; }
  void set_mask(uint32_t mask) {
    mask_ = mask;
    has_changed();
  }
  /// Rises with every change.
  uint64_t version() const { return version_; }
  /// The bytes of copied buffers and of those in a file; 0 for shared ones.
  virtual size_t copied_bytes() const = 0;
  /// What the geometry is to hold other contents of one day, and what is committed is to keep;
  /// nullptr: nothing.
  virtual BufferCopy* replaceable_buffer() const { return nullptr; }

 protected:
  Geometry(Device& device, GeometryKind kind, uint32_t mask)
      : device_(device), kind_(kind), mask_(mask) {}
  /// One whose buffers lie in a file, which it holds.
  Geometry(Device& device, FileImage& image, GeometryKind kind, uint32_t mask)
      : device_(device), image_(image), kind_(kind), mask_(mask) {}
  ~Geometry() = default;
  void has_changed() { ++version_; }

 private:
  /// Calls destroy_object with the object as what it is.
  virtual void end(Memory& memory) noexcept = 0;

  Reference<Device> device_;
  Reference<FileImage> image_;
  GeometryKind kind_;
  uint32_t mask_;
  uint64_t version_ = 0;
};

/// A geometry with its number in a scene.
struct AttachedGeometry {
  Geometry* geometry;
  uint32_t geometry_id;
};

}  // namespace kiwami

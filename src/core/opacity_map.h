// SPDX-License-Identifier: Apache-2.0
// The opacity micromaps of a mesh.
#pragma once

#include "core/device.h"
#include "core/file_image.h"
#include "core/memory.h"
#include "core/object.h"
#include "kiwami/opacity.h"
#include "wide/wide_bvh.h"

namespace kiwami {

/// The bytes of one map.
size_t opacity_map_bytes(uint32_t format, uint32_t level);

/// Copies of the caller's maps, or maps in a file. Never changes, so that scenes can hold it while
/// its mesh gets another.
class OpacityMap : public Object<OpacityMap> {
 public:
  /// Of a mesh of so many triangles. Throws Error(INVALID_ARGUMENT, TOO_LARGE or OUT_OF_MEMORY).
  static Reference<OpacityMap> create(Device& device, const kiwami_opacity_desc& desc,
                                      uint32_t triangle_count);
  static void destroy(OpacityMap* map) noexcept;

  /// Tightly packed maps in a file, and an index for each triangle, or nullptr.
  struct SavedMaps {
    const unsigned char* maps;
    const uint32_t* indices;
    uint64_t map_count;
    uint32_t level;
    uint32_t format;
  };

  OpacityMap(Device& device, const kiwami_opacity_desc& desc, uint32_t triangle_count);
  /// Of maps in a file, which it holds. Checks the indices unless they are trusted. Throws
  /// Error(INVALID_ARGUMENT).
  OpacityMap(Device& device, FileImage& image, const SavedMaps& saved, uint32_t triangle_count,
             bool is_trusted);

  const OpacityView& view() const { return view_; }
  uint64_t map_count() const { return maps_.size() / view_.map_bytes; }

 private:
  void copy_indices(const kiwami_opacity_desc& desc, uint32_t triangle_count);

  Reference<Device> device_;
  Reference<FileImage> image_;
  Array<unsigned char> maps_;
  Array<uint32_t> indices_;
  OpacityView view_{};
};

}  // namespace kiwami

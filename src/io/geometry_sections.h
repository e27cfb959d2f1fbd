// SPDX-License-Identifier: Apache-2.0
// The geometries of a file: a record of each and all their buffers.
#pragma once

#include "bvh/triangle_source.h"
#include "core/geometry.h"
#include "core/instances.h"
#include "core/moving_mesh.h"
#include "core/opacity_map.h"
#include "core/shapes.h"
#include "core/triangle_mesh.h"
#include "io/blame_file.h"
#include "io/file_reader.h"
#include "io/file_writer.h"

namespace kiwami::file {

// What a record says of the buffers, and the buffers themselves, close together in the file.
GeometryRecord record_of(const TriangleMeshView& mesh, const OpacityMap* opacity);
GeometryRecord record_of(const Instances& instances);
GeometryRecord record_of(const Shapes& geometry);
GeometryRecord record_of(const MovingMesh& geometry);
void add_buffers(FileWriter& writer, const TriangleMeshView& mesh, const OpacityMap* opacity);
void add_buffers(FileWriter& writer, const Instances& instances);
void add_buffers(FileWriter& writer, const Shapes& geometry);
void add_buffers(FileWriter& writer, const MovingMesh& geometry);

inline bool is_instances(SavedKind kind) {
  return kind == SavedKind::kInstances || kind == SavedKind::kMovingInstances;
}
inline TransformFormat transform_format_of(const GeometryRecord& record) {
  return (record.flags & kHasQuaternions) != 0 ? TransformFormat::kQuaternion
                                               : TransformFormat::kMatrix;
}

/// One geometry of a file, with its buffers there.
struct SavedGeometry {
  static constexpr size_t kBufferCount = 4;

  const GeometryRecord& record;
  const unsigned char* buffers[kBufferCount];  ///< nullptr: it has none of these
  std::span<const uint32_t> shown;             ///< the scenes that it shows

  SavedKind kind() const { return static_cast<SavedKind>(record.kind); }
  bool has(uint32_t flag) const { return (record.flags & flag) != 0; }
  /// Of instances.
  TransformFormat transform_format() const { return transform_format_of(record); }
};

/// The geometries of a scene in a file, by geometry id.
class SavedGeometries {
 public:
  /// Throws Error(INVALID_FILE) for a record that no geometry has, and where the buffers are not
  /// those of the records, one after the other.
  SavedGeometries(const FileReader& reader, uint32_t scene);

  size_t size() const { return records_.size(); }
  /// Calls visit(geometry_id, SavedGeometry) for those that there are, by rising number.
  template <typename Visit>
  void for_each(Visit&& visit) const {
    Cursor cursor;
    for (uint32_t id = 0; id < records_.size(); ++id) {
      const SavedGeometry geometry = take(id, cursor);
      if (geometry.kind() != SavedKind::kNone) visit(id, geometry);
    }
  }

 private:
  struct Cursor {
    size_t byte = 0, shown = 0;
  };

  SavedGeometry take(uint32_t id, Cursor& cursor) const;

  std::span<const GeometryRecord> records_;
  std::span<const unsigned char> bytes_;
  std::span<const uint32_t> shown_;
};

/// A geometry over its buffers in the image, which is that of the reader. Scenes are those that it
/// shows. Throws Error(INVALID_FILE) for contents that no geometry has, unless they are trusted.
Reference<Geometry> make_geometry(const SavedGeometry& saved, Array<Scene*> scenes, Device& device,
                                  FileImage& image, bool is_trusted);

}  // namespace kiwami::file

// SPDX-License-Identifier: Apache-2.0
// The geometries of a file: their table, all their vertices and all their indices.
#pragma once

#include "bvh/triangle_source.h"
#include "core/error.h"
#include "core/triangle_mesh.h"
#include "io/file_reader.h"
#include "io/file_writer.h"

namespace kiwami::file {

/// What is written of a source whose meshes stand by rising geometry id. Holds the table until the
/// file is written.
class MeshSections {
 public:
  MeshSections(const TriangleSource& source, Memory& memory);
  void add_to(FileWriter& writer) const;

 private:
  TriangleSource source_;
  Array<MeshRecord> records_;
};

/// The geometries of a file, by geometry id.
class SavedMeshes {
 public:
  /// Throws Error(INVALID_FILE) where the buffers are not those of the table's meshes, one after
  /// the other.
  explicit SavedMeshes(const FileReader& reader);

  size_t size() const { return records_.size(); }
  /// Triangles of all meshes.
  uint64_t triangle_count() const { return triangle_count_; }
  /// A mesh over the buffers in the image, which is that of the reader; none for a free number.
  /// Throws Error(INVALID_FILE) for indices without vertices, unless they are trusted.
  Reference<TriangleMesh> make(uint32_t geometry_id, Device& device, FileImage& image,
                               bool is_trusted) const;

 private:
  struct Float3 {
    float value[3];
  };
  struct Index3 {
    uint32_t value[3];
  };

  std::span<const MeshRecord> records_;
  std::span<const Float3> vertices_;
  std::span<const Index3> indices_;
  uint64_t triangle_count_ = 0;
};

/// Runs body; what it finds wrong in its arguments (a tree) is wrong with the file that they are
/// from.
template <typename Body>
void blame_file(Body&& body) {
  try {
    body();
  } catch (const Error& error) {
    if (error.result() != KIWAMI_ERROR_INVALID_ARGUMENT &&
        error.result() != KIWAMI_ERROR_VALIDATION) {
      throw;
    }
    throw Error(KIWAMI_ERROR_INVALID_FILE, "the file is damaged: %s", error.what());
  }
}

}  // namespace kiwami::file

// SPDX-License-Identifier: Apache-2.0
#include "io/mesh_sections.h"

#include "core/error.h"

namespace kiwami::file {
namespace {

using ull = unsigned long long;

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
}

constexpr uint64_t kMaxTriangleCount = 0x7FFFFFFF;
constexpr uint64_t kMaxVertexCount = 0xFFFFFFFF;

}  // namespace

MeshSections::MeshSections(const TriangleSource& source, Memory& memory) : source_(source) {
  if (source.mesh_count == 0) return;
  const size_t count = size_t{source.meshes[source.mesh_count - 1].geometry_id} + 1;
  records_ = Array<MeshRecord>(memory, count);
  uint64_t next_vertex = 0, next_index = 0;
  uint32_t next = 0;
  for (size_t id = 0; id < count; ++id) {
    records_[id] = {next_vertex, 0, kNoIndices, 0, 0};
    if (source.meshes[next].geometry_id != id) continue;
    const TriangleMeshView& mesh = source.meshes[next++];
    records_[id].vertex_count = mesh.vertex_count;
    records_[id].triangle_count = mesh.triangle_count;
    records_[id].mask = mesh.mask;
    next_vertex += mesh.vertex_count;
    if (!mesh.indices) continue;
    records_[id].first_index = next_index;
    next_index += mesh.triangle_count;
  }
}

void MeshSections::add_to(FileWriter& writer) const {
  constexpr size_t kElementSize = 12;
  writer.begin_section(SectionType::kMeshes, 1);
  writer.add(records_.data(), records_.size());
  writer.begin_section(SectionType::kVertices, 1);
  for (uint32_t i = 0; i < source_.mesh_count; ++i) {
    const TriangleMeshView& mesh = source_.meshes[i];
    writer.add(mesh.vertices, kElementSize, mesh.vertex_stride, mesh.vertex_count);
  }
  writer.begin_section(SectionType::kIndices, 1);
  for (uint32_t i = 0; i < source_.mesh_count; ++i) {
    const TriangleMeshView& mesh = source_.meshes[i];
    if (mesh.indices) {
      writer.add(mesh.indices, kElementSize, mesh.index_stride, mesh.triangle_count);
    }
  }
}

SavedMeshes::SavedMeshes(const FileReader& reader)
    : records_(reader.array<MeshRecord>(SectionType::kMeshes)),
      vertices_(reader.array<Float3>(SectionType::kVertices)),
      indices_(reader.array<Index3>(SectionType::kIndices)) {
  uint64_t next_vertex = 0, next_index = 0;
  for (size_t id = 0; id < records_.size(); ++id) {
    const MeshRecord& mesh = records_[id];
    // Buffers do not overlap, or a small file could make much work.
    const bool has_indices = mesh.first_index != kNoIndices;
    if (mesh.first_vertex != next_vertex || mesh.vertex_count > vertices_.size() - next_vertex ||
        mesh.vertex_count > kMaxVertexCount) {
      fail("mesh %zu has %llu vertices from %llu on, expected some of %zu from %llu on", id,
           ull{mesh.vertex_count}, ull{mesh.first_vertex}, vertices_.size(), ull{next_vertex});
    }
    const uint64_t most = has_indices ? indices_.size() - next_index : mesh.vertex_count / 3;
    if ((has_indices && mesh.first_index != next_index) || mesh.triangle_count > most ||
        mesh.triangle_count > kMaxTriangleCount) {
      fail("mesh %zu has %u triangles from %llu on, expected at most %llu from %llu on", id,
           mesh.triangle_count, ull{mesh.first_index}, ull{most}, ull{next_index});
    }
    next_vertex += mesh.vertex_count;
    if (has_indices) next_index += mesh.triangle_count;
    triangle_count_ += mesh.triangle_count;
  }
}

Reference<TriangleMesh> SavedMeshes::make(uint32_t geometry_id, Device& device, FileImage& image,
                                          bool is_trusted) const {
  const MeshRecord& mesh = records_[geometry_id];
  if (mesh.triangle_count == 0) return {};
  TriangleMeshView view{};
  view.vertices = reinterpret_cast<const unsigned char*>(vertices_.data() + mesh.first_vertex);
  view.vertex_stride = sizeof(Float3);
  view.vertex_count = static_cast<size_t>(mesh.vertex_count);
  if (mesh.first_index != kNoIndices) {
    view.indices = reinterpret_cast<const unsigned char*>(indices_.data() + mesh.first_index);
  }
  view.index_stride = sizeof(Index3);
  view.triangle_count = mesh.triangle_count;
  view.mask = mesh.mask;
  Reference<TriangleMesh> made;
  blame_file([&] {
    made = Reference<TriangleMesh>::adopt(
        make_object<TriangleMesh>(device.memory(), device, image, view, is_trusted));
  });
  return made;
}

}  // namespace kiwami::file

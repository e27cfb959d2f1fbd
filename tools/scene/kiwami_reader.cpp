// SPDX-License-Identifier: Apache-2.0
#include "scene/kiwami_reader.h"

#include <algorithm>
#include <cstring>

#include "scene/byte_reader.h"

namespace kiwami::tools {
namespace {

constexpr unsigned char kMagic[8] = {0x89, 'K', 'I', 'W', 'A', 'M', 'I', '\n'};
constexpr uint64_t kHeaderBytes = 64, kEntryBytes = 48, kMeshBytes = 32, kElementBytes = 12;
constexpr uint64_t kVersionAt = 12, kKindAt = 20, kSectionCountAt = 24;
constexpr uint32_t kFormatVersion = 1, kSceneKind = 1;
constexpr uint32_t kMeshes = 3, kVertices = 4, kIndices = 5;
constexpr uint64_t kNoIndices = ~uint64_t{0};

/// A run of the file's bytes.
struct Extent {
  uint64_t offset;
  uint64_t bytes;
};

/// The file as words: all sections begin and end at multiples of four bytes.
class SavedScene {
 public:
  explicit SavedScene(const std::filesystem::path& path)
      : reader_(path), words_(reader_.read_array<uint32_t>(reader_.most_bytes_left() / 4)) {
    reader_.expect_end();
    if (bytes() < kHeaderBytes || std::memcmp(words_.data(), kMagic, sizeof kMagic) != 0) {
      reader_.fail("it does not begin like a file of the library");
    }
    if (read<uint32_t>(kVersionAt) != kFormatVersion || read<uint32_t>(kKindAt) != kSceneKind) {
      reader_.fail("it is no scene of format version 1");
    }
  }

  SceneFile read_meshes() const {
    const Extent meshes = section(kMeshes), vertices = section(kVertices),
                 indices = section(kIndices);
    SceneFile scene;
    for (uint64_t i = 0; i < meshes.bytes / kMeshBytes; ++i) {
      const uint64_t at = meshes.offset + i * kMeshBytes;
      const auto triangle_count = uint64_t{read<uint32_t>(at + 24)};
      const auto first_index = read<uint64_t>(at + 16);
      Mesh mesh;
      mesh.name = "geometry " + std::to_string(i);
      if (triangle_count != 0) {
        mesh.vertices = run<float>(vertices, read<uint64_t>(at), read<uint64_t>(at + 8));
        mesh.indices = first_index == kNoIndices
                           ? counted(triangle_count, mesh)
                           : run<uint32_t>(indices, first_index, triangle_count);
        check_indices(mesh);
      }
      scene.meshes.push_back(std::move(mesh));
    }
    return scene;
  }

 private:
  uint64_t bytes() const { return words_.size() * 4; }

  template <typename T>
  T read(uint64_t at) const {
    T value;
    std::memcpy(&value, reinterpret_cast<const char*>(words_.data()) + at, sizeof value);
    return value;
  }

  Extent section(uint32_t type) const {
    const uint64_t count =
        std::min<uint64_t>(read<uint32_t>(kSectionCountAt), (bytes() - kHeaderBytes) / kEntryBytes);
    for (uint64_t i = 0; i < count; ++i) {
      const uint64_t at = kHeaderBytes + i * kEntryBytes;
      const Extent extent = {read<uint64_t>(at + 16), read<uint64_t>(at + 24)};
      if (read<uint32_t>(at) != type) continue;
      if (extent.offset > bytes() || extent.bytes > bytes() - extent.offset) break;
      return extent;
    }
    reader_.fail("it lacks the section of type " + std::to_string(type));
  }

  /// count elements of three words from the first one on.
  template <typename T>
  std::vector<T> run(const Extent& extent, uint64_t first, uint64_t count) const {
    const uint64_t all = extent.bytes / kElementBytes;
    if (first > all || count > all - first) reader_.fail("a mesh reaches beyond its section");
    std::vector<T> elements(3 * count);
    std::memcpy(
        elements.data(),
        reinterpret_cast<const char*>(words_.data()) + extent.offset + first * kElementBytes,
        count * kElementBytes);
    return elements;
  }

  std::vector<uint32_t> counted(uint64_t triangle_count, const Mesh& mesh) const {
    if (triangle_count > mesh.vertex_count() / 3) reader_.fail("a mesh has too few vertices");
    std::vector<uint32_t> indices(3 * triangle_count);
    for (uint32_t i = 0; i < indices.size(); ++i) indices[i] = i;
    return indices;
  }

  void check_indices(const Mesh& mesh) const {
    const bool is_whole = std::all_of(mesh.indices.begin(), mesh.indices.end(),
                                      [&](uint32_t index) { return index < mesh.vertex_count(); });
    if (!is_whole) reader_.fail("an index of " + mesh.name + " names no vertex");
  }

  ByteReader reader_;
  std::vector<uint32_t> words_;
};

}  // namespace

bool is_saved_scene(const std::filesystem::path& path) { return path.extension() == ".kiwami"; }

SceneFile read_saved_scene(const std::filesystem::path& path) {
  return SavedScene(path).read_meshes();
}

}  // namespace kiwami::tools

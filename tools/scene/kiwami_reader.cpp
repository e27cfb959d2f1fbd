// SPDX-License-Identifier: Apache-2.0
#include "scene/kiwami_reader.h"

#include <algorithm>
#include <cstring>

#include "scene/byte_reader.h"

namespace kiwami::tools {
namespace {

constexpr unsigned char kMagic[8] = {0x89, 'K', 'I', 'W', 'A', 'M', 'I', '\n'};
constexpr uint64_t kHeaderBytes = 64, kEntryBytes = 48, kAlignment = 64;
constexpr uint64_t kVersionAt = 12, kKindAt = 20, kSectionCountAt = 24;
constexpr uint32_t kFormatVersion = 2, kSceneKind = 1;
constexpr uint32_t kGeometries = 3, kBuffers = 4, kShownScenes = 12;
constexpr uint32_t kNoGeometry = 0, kTriangleMesh = 1, kInstances = 2;
constexpr uint32_t kCommitted = 1, kHasIndices = 4, kHasMasks = 8, kHasOpacity = 16,
                   kHasOpacityIndices = 32;
constexpr size_t kMaxDepth = 8;
/// More are not shown to be of use, and nested arrays of few bytes stand for any number.
constexpr size_t kMaxInstances = size_t{1} << 26;

using Transform = std::array<float, 12>;
constexpr Transform kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/// What is moved by inner, then by outer.
Transform product(const Transform& outer, const Transform& inner) {
  Transform both{};
  for (size_t row = 0; row < 3; ++row) {
    for (size_t column = 0; column < 4; ++column) {
      float& entry = both[4 * row + column];
      if (column == 3) entry = outer[4 * row + 3];
      for (size_t k = 0; k < 3; ++k) entry += outer[4 * row + k] * inner[4 * k + column];
    }
  }
  return both;
}

/// As it stands in the file.
struct GeometryRecord {
  uint32_t kind, flags, mask, primitive_count;
  uint64_t point_count;
  uint32_t scene_count, step_count;
  float time_begin, time_end;
  uint32_t opacity_level, opacity_format;
  uint64_t opacity_map_count;
  uint64_t reserved;
};
static_assert(sizeof(GeometryRecord) == 64);

/// A run of the file's bytes.
struct Extent {
  uint64_t offset = 0;
  uint64_t bytes = 0;
};

/// An array of instances: the scenes that it shows, by instance.
struct Group {
  std::vector<uint32_t> shown;
  std::vector<Transform> transforms;
};

/// What is read of one scene.
struct Content {
  std::vector<uint32_t> meshes;  ///< numbers among those of the file; none without triangles
  std::vector<Group> groups;
};

/// The file as words.
class SavedScene {
 public:
  explicit SavedScene(const std::filesystem::path& path)
      : reader_(path), words_(reader_.read_array<uint32_t>(reader_.most_bytes_left() / 4)) {
    reader_.expect_end();
    if (bytes() < kHeaderBytes || std::memcmp(words_.data(), kMagic, sizeof kMagic) != 0) {
      reader_.fail("it does not begin like a file of the library");
    }
    if (read<uint32_t>(kVersionAt) != kFormatVersion || read<uint32_t>(kKindAt) != kSceneKind) {
      reader_.fail("it is no scene of format version 2");
    }
  }

  SceneFile read_scene() {
    for (uint32_t number = 0; has_scene(number); ++number) read_content(number);
    if (contents_.empty()) reader_.fail("it has no scene");
    if (!contents_[0].groups.empty()) place(0, kIdentity, 0, 0);
    return std::move(file_);
  }

 private:
  uint64_t bytes() const { return words_.size() * 4; }

  template <typename T>
  T read(uint64_t at) const {
    T value;
    std::memcpy(&value, reinterpret_cast<const char*>(words_.data()) + at, sizeof value);
    return value;
  }

  uint64_t section_count() const {
    return std::min<uint64_t>(read<uint32_t>(kSectionCountAt),
                              (bytes() - kHeaderBytes) / kEntryBytes);
  }

  /// The sections of a scene stand together, and the scenes by their numbers.
  bool has_scene(uint32_t scene) {
    while (next_entry_ < section_count() && scene_of(next_entry_) < scene) ++next_entry_;
    return next_entry_ < section_count() && scene_of(next_entry_) == scene;
  }
  uint32_t scene_of(uint64_t entry) const {
    return read<uint32_t>(kHeaderBytes + entry * kEntryBytes + 12);
  }

  /// Of the scene that was asked for last; empty where there is none.
  Extent section(uint32_t type) const {
    const uint32_t scene = scene_of(next_entry_);
    for (uint64_t i = next_entry_; i < section_count() && scene_of(i) == scene; ++i) {
      const uint64_t at = kHeaderBytes + i * kEntryBytes;
      if (read<uint32_t>(at) != type) continue;
      const Extent extent = {read<uint64_t>(at + 16), read<uint64_t>(at + 24)};
      if (extent.offset <= bytes() && extent.bytes <= bytes() - extent.offset) return extent;
      reader_.fail("the section of type " + std::to_string(type) + " reaches beyond the end");
    }
    return {};
  }

  void read_content(uint32_t number) {
    const Extent records = section(kGeometries), shown = section(kShownScenes);
    Extent buffers = section(kBuffers);
    const uint64_t first = buffers.offset;
    Content content;
    uint64_t next_shown = 0;
    for (uint64_t id = 0; id < records.bytes / sizeof(GeometryRecord); ++id) {
      const auto record = read<GeometryRecord>(records.offset + id * sizeof(GeometryRecord));
      const std::string name = "geometry " + std::to_string(id);
      const bool is_committed = (record.flags & kCommitted) != 0;
      if (record.kind == kInstances) {
        Group group = read_group(record, name, first, buffers);
        if (record.scene_count > shown.bytes / 4 - next_shown) {
          reader_.fail(name + " shows more scenes than there are");
        }
        for (uint32_t& index : group.shown) {
          if (index >= record.scene_count) reader_.fail(name + " has an index of no scene");
          index = read<uint32_t>(shown.offset + 4 * (next_shown + index));
          if (index <= number) reader_.fail(name + " shows a scene that shows it");
        }
        next_shown += record.scene_count;
        if (is_committed) content.groups.push_back(std::move(group));
        continue;
      }
      if (record.kind != kTriangleMesh && record.kind != kNoGeometry) {
        reader_.fail(name + (number == 0 ? "" : " of a scene that it shows") +
                     " is neither a triangle mesh nor instances, expected nothing else");
      }
      Mesh mesh;
      mesh.name = name;
      if (record.kind == kTriangleMesh) read_mesh(record, first, buffers, mesh);
      if (!is_committed) mesh.vertices.clear(), mesh.indices.clear();
      // Where there are no instances, mesh i is geometry i.
      if (mesh.triangle_count() != 0) {
        content.meshes.push_back(static_cast<uint32_t>(file_.meshes.size()));
      }
      file_.meshes.push_back(std::move(mesh));
    }
    contents_.push_back(std::move(content));
  }

  /// Takes count elements of a buffer that begins at the next multiple of 64.
  template <typename T>
  std::vector<T> take(uint64_t count, size_t element_size, uint64_t first, Extent& rest) const {
    const uint64_t gap = (kAlignment - (rest.offset - first) % kAlignment) % kAlignment;
    if (gap > rest.bytes || count > (rest.bytes - gap) / element_size) {
      reader_.fail("a geometry reaches beyond its section");
    }
    std::vector<T> elements(count * (element_size / sizeof(T)));
    const char* const from = reinterpret_cast<const char*>(words_.data()) + rest.offset + gap;
    if (!elements.empty()) std::memcpy(elements.data(), from, count * element_size);
    rest.offset += gap + count * element_size;
    rest.bytes -= gap + count * element_size;
    return elements;
  }

  void read_mesh(const GeometryRecord& record, uint64_t first, Extent& rest, Mesh& mesh) const {
    mesh.vertices = take<float>(record.point_count, 12, first, rest);
    if ((record.flags & kHasIndices) != 0) {
      mesh.indices = take<uint32_t>(record.primitive_count, 12, first, rest);
    } else {
      if (record.primitive_count > record.point_count / 3) {
        reader_.fail("a mesh has too few vertices");
      }
      mesh.indices.resize(size_t{3} * record.primitive_count);
      for (uint32_t i = 0; i < mesh.indices.size(); ++i) mesh.indices[i] = i;
    }
    // Commands go by the triangles alone.
    if ((record.flags & kHasOpacity) != 0) {
      const uint64_t map_bytes = std::max<uint64_t>(
          1, (uint64_t{record.opacity_format} << (2 * (record.opacity_level % 8))) / 8);
      take<unsigned char>(record.opacity_map_count, map_bytes, first, rest);
    }
    if ((record.flags & kHasOpacityIndices) != 0) {
      take<uint32_t>(record.primitive_count, 4, first, rest);
    }
    const bool is_whole = std::all_of(mesh.indices.begin(), mesh.indices.end(),
                                      [&](uint32_t index) { return index < mesh.vertex_count(); });
    if (!is_whole) reader_.fail("an index of " + mesh.name + " names no vertex");
  }

  Group read_group(const GeometryRecord& record, const std::string& name, uint64_t first,
                   Extent& rest) const {
    Group group;
    group.transforms = take<Transform>(record.primitive_count, sizeof(Transform), first, rest);
    group.shown = (record.flags & kHasIndices) != 0
                      ? take<uint32_t>(record.primitive_count, 4, first, rest)
                      : std::vector<uint32_t>(record.primitive_count, 0);
    if ((record.flags & kHasMasks) != 0) take<uint32_t>(record.primitive_count, 4, first, rest);
    if (record.scene_count == 0) reader_.fail(name + " shows no scene");
    return group;
  }

  /// Puts all meshes of a scene into the world; outermost is the number of the instance that leads
  /// there from the first scene.
  void place(uint32_t number, const Transform& to_world, size_t depth, size_t outermost) {
    if (number >= contents_.size()) reader_.fail("it shows a scene that is not there");
    if (depth > kMaxDepth) reader_.fail("its instances are nested too deeply");
    const Content& content = contents_[number];
    for (const uint32_t mesh : content.meshes) {
      if (depth == 0 || outermost != file_.instances.size()) {
        file_.instances_are_outermost = false;
      }
      if (file_.instances.size() == kMaxInstances) reader_.fail("it has too many instances");
      file_.instances.push_back({mesh, to_world});
    }
    if (depth > 0 && content.meshes.size() != 1) file_.instances_are_outermost = false;
    if (depth > 0 && !content.groups.empty()) file_.instances_are_outermost = false;
    for (const Group& group : content.groups) {
      for (size_t i = 0; i < group.shown.size(); ++i) {
        place(group.shown[i], product(to_world, group.transforms[i]), depth + 1,
              depth == 0 ? outermost++ : outermost);
      }
    }
  }

  ByteReader reader_;
  std::vector<uint32_t> words_;
  uint64_t next_entry_ = 0;
  std::vector<Content> contents_;
  SceneFile file_;
};

}  // namespace

bool is_saved_scene(const std::filesystem::path& path) { return path.extension() == ".kiwami"; }

SceneFile read_saved_scene(const std::filesystem::path& path) {
  return SavedScene(path).read_scene();
}

}  // namespace kiwami::tools

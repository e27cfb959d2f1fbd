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
constexpr uint32_t kTriangleMesh = 1, kInstances = 2, kDiscs = 4, kCurves = 5, kMovingMesh = 6,
                   kMovingInstances = 7;
constexpr uint32_t kCommitted = 1, kHasIndices = 4, kHasMasks = 8, kHasOpacity = 16,
                   kHasOpacityIndices = 32, kHasQuaternions = 64;
/// The time steps that one geometry has at most.
constexpr uint32_t kMostSteps = 129;
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

/// The meshes of one scene: numbers among those of the file; none without triangles.
using MeshNumbers = std::vector<uint32_t>;

Transform transform_of(const SavedInstances& group, size_t instance) {
  Transform transform;
  std::copy_n(group.transforms.begin() + static_cast<std::ptrdiff_t>(12 * instance), 12,
              transform.begin());
  return transform;
}

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
    if (meshes_.empty()) reader_.fail("it has no scene");
    if (meshes_.size() > 1) {
      place(0, kIdentity, 0, 0);
      // Without instances all meshes would stand in the world.
      if (file_.instances.empty()) file_.meshes.clear();
    }
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
    const Extent records = section(kGeometries);
    Extent shown = section(kShownScenes), buffers = section(kBuffers);
    const uint64_t first = buffers.offset;
    MeshNumbers meshes;
    std::vector<SavedInstances> groups;
    for (uint64_t id = 0; id < records.bytes / sizeof(GeometryRecord); ++id) {
      const auto record = read<GeometryRecord>(records.offset + id * sizeof(GeometryRecord));
      const std::string name = "geometry " + std::to_string(id);
      const bool is_committed = (record.flags & kCommitted) != 0;
      if (record.kind == kInstances || record.kind == kMovingInstances) {
        SavedInstances group = read_group(record, name, first, buffers);
        name_scenes(record, name, number, shown, group);
        if (is_committed && group.step_count > 1) ++file_.left_out_count;
        if (is_committed) groups.push_back(std::move(group));
        continue;
      }
      Mesh mesh;
      mesh.name = name;
      if (record.kind == kTriangleMesh) {
        read_mesh(record, first, buffers, mesh);
      } else if (skip_other(record, name, first, buffers) && is_committed) {
        ++file_.left_out_count;
      }
      if (!is_committed) mesh.vertices.clear(), mesh.indices.clear();
      // Where there are no instances, mesh i is geometry i.
      if (mesh.triangle_count() != 0) meshes.push_back(static_cast<uint32_t>(file_.meshes.size()));
      file_.meshes.push_back(std::move(mesh));
    }
    meshes_.push_back(std::move(meshes));
    file_.saved_instances.push_back(std::move(groups));
  }

  /// Makes the scenes that an array shows those of the file.
  void name_scenes(const GeometryRecord& record, const std::string& name, uint32_t number,
                   Extent& shown, SavedInstances& group) const {
    if (record.scene_count > shown.bytes / 4) {
      reader_.fail(name + " shows more scenes than there are");
    }
    for (uint32_t& index : group.shown) {
      if (index >= record.scene_count) reader_.fail(name + " has an index of no scene");
      index = read<uint32_t>(shown.offset + 4 * uint64_t{index});
      if (index <= number) reader_.fail(name + " shows a scene that shows it");
    }
    shown.offset += 4 * uint64_t{record.scene_count};
    shown.bytes -= 4 * uint64_t{record.scene_count};
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

  static uint32_t step_count_of(const GeometryRecord& record) {
    const bool is_moving = record.kind == kMovingMesh || record.kind == kMovingInstances;
    return is_moving ? std::min(record.step_count, kMostSteps) : 1;
  }

  SavedInstances read_group(const GeometryRecord& record, const std::string& name, uint64_t first,
                            Extent& rest) const {
    SavedInstances group;
    group.step_count = step_count_of(record);
    group.has_quaternions = (record.flags & kHasQuaternions) != 0;
    group.time_begin = record.time_begin;
    group.time_end = record.time_end;
    group.transforms = take<float>(uint64_t{record.primitive_count} * group.step_count,
                                   group.has_quaternions ? 64 : 48, first, rest);
    group.shown = (record.flags & kHasIndices) != 0
                      ? take<uint32_t>(record.primitive_count, 4, first, rest)
                      : std::vector<uint32_t>(record.primitive_count, 0);
    if ((record.flags & kHasMasks) != 0) take<uint32_t>(record.primitive_count, 4, first, rest);
    if (record.scene_count == 0) reader_.fail(name + " shows no scene");
    return group;
  }

  /// Passes over the buffers of shapes, or of a mesh that moves; false: there is nothing of that
  /// number.
  bool skip_other(const GeometryRecord& record, const std::string& name, uint64_t first,
                  Extent& rest) const {
    if (record.kind == 0) return false;
    if (record.kind > kMovingMesh) reader_.fail(name + " is of a kind that is not known");
    const bool is_mesh = record.kind == kMovingMesh;
    take<float>(record.point_count * step_count_of(record), is_mesh ? 12 : 16, first, rest);
    if (record.kind == kDiscs) take<float>(record.primitive_count, 12, first, rest);
    if ((record.kind == kCurves || is_mesh) && (record.flags & kHasIndices) != 0) {
      take<uint32_t>(record.primitive_count, is_mesh ? 12 : 4, first, rest);
    }
    return true;
  }

  /// Puts all meshes of a scene into the world; outermost is the number of the instance that leads
  /// there from the first scene.
  void place(uint32_t number, const Transform& to_world, size_t depth, size_t outermost) {
    if (number >= meshes_.size()) reader_.fail("it shows a scene that is not there");
    if (depth > kMaxDepth) reader_.fail("its instances are nested too deeply");
    const std::vector<SavedInstances>& groups = file_.saved_instances[number];
    for (const uint32_t mesh : meshes_[number]) {
      if (depth == 0 || outermost != file_.instances.size()) file_.has_saved_numbers = false;
      if (file_.instances.size() == kMaxInstances) reader_.fail("it has too many instances");
      file_.instances.push_back({mesh, to_world});
    }
    if (depth > 0 && (meshes_[number].size() != 1 || !groups.empty())) {
      file_.has_saved_numbers = false;
    }
    for (const SavedInstances& group : groups) {
      if (group.step_count > 1) continue;
      for (size_t i = 0; i < group.shown.size(); ++i) {
        place(group.shown[i], product(to_world, transform_of(group, i)), depth + 1,
              depth == 0 ? outermost++ : outermost);
      }
    }
  }

  ByteReader reader_;
  std::vector<uint32_t> words_;
  uint64_t next_entry_ = 0;
  std::vector<MeshNumbers> meshes_;  ///< by scene
  SceneFile file_;
};

}  // namespace

bool is_saved_scene(const std::filesystem::path& path) { return path.extension() == ".kiwami"; }

SceneFile read_saved_scene(const std::filesystem::path& path) {
  return SavedScene(path).read_scene();
}

}  // namespace kiwami::tools

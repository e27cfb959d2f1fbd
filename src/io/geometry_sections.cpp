// SPDX-License-Identifier: Apache-2.0
#include "io/geometry_sections.h"

#include "core/error.h"

namespace kiwami::file {
namespace {

using ull = unsigned long long;

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
}

constexpr uint64_t kMaxPrimitiveCount = 0x7FFFFFFF;
constexpr uint64_t kMaxPointCount = 0xFFFFFFFF;

/// Bytes of three floats or indices, and of a point with its radius.
constexpr size_t kTripleSize = 12;
constexpr size_t kPointSize = 16;

/// A buffer of elements that stand close together.
struct BufferExtent {
  uint64_t count;
  size_t element_size;  ///< 0: the geometry has no such buffer
};

struct KindTraits {
  uint32_t flags;     ///< that records may have, beside kCommitted and kEnabled
  size_t point_size;  ///< 0: no points
};

KindTraits traits_of(SavedKind kind) {
  switch (kind) {
    case SavedKind::kTriangleMesh:
      return {kHasIndices | kHasOpacity | kHasOpacityIndices, kTripleSize};
    case SavedKind::kInstances:
      return {kHasIndices | kHasMasks, 0};
    case SavedKind::kSpheres:
    case SavedKind::kDiscs:
      return {0, kPointSize};
    case SavedKind::kCurves:
      return {kHasIndices, kPointSize};
    case SavedKind::kMovingMesh:
      return {kHasIndices, kTripleSize};
    case SavedKind::kMovingInstances:
      return {kHasIndices | kHasMasks | kHasQuaternions, 0};
    case SavedKind::kNone:
      break;
  }
  return {0, 0};
}

bool is_moving(SavedKind kind) {
  return kind == SavedKind::kMovingMesh || kind == SavedKind::kMovingInstances;
}

/// In the order in which they are saved.
void describe_buffers(const GeometryRecord& record,
                      BufferExtent (&extents)[SavedGeometry::kBufferCount]) {
  const auto kind = static_cast<SavedKind>(record.kind);
  const auto size_if = [&](uint32_t flag, size_t size) {
    return (record.flags & flag) != 0 ? size : 0;
  };
  const uint64_t count = record.primitive_count;
  extents[0] = {record.point_count, traits_of(kind).point_size};
  extents[1] = extents[2] = extents[3] = {0, 0};
  switch (kind) {
    case SavedKind::kTriangleMesh:
      extents[1] = {count, size_if(kHasIndices, kTripleSize)};
      // The level of none has not been looked at.
      if ((record.flags & kHasOpacity) != 0) {
        extents[2] = {record.opacity_map_count,
                      opacity_map_bytes(record.opacity_format, record.opacity_level)};
      }
      extents[3] = {count, size_if(kHasOpacityIndices, sizeof(uint32_t))};
      break;
    case SavedKind::kMovingMesh:
      extents[0].count *= record.step_count;
      extents[1] = {count, size_if(kHasIndices, kTripleSize)};
      break;
    case SavedKind::kDiscs:
      extents[1] = {count, kTripleSize};
      break;
    case SavedKind::kCurves:
      extents[1] = {count, size_if(kHasIndices, sizeof(uint32_t))};
      break;
    case SavedKind::kInstances:
    case SavedKind::kMovingInstances:
      extents[0] = {count * (is_moving(kind) ? record.step_count : 1),
                    transform_bytes(transform_format_of(record))};
      extents[1] = {count, size_if(kHasIndices, sizeof(uint32_t))};
      extents[2] = {count, size_if(kHasMasks, sizeof(uint32_t))};
      break;
    case SavedKind::kSpheres:
    case SavedKind::kNone:
      break;
  }
}

/// The most primitives that the points and scenes of a record allow.
uint64_t most_primitives(const GeometryRecord& record) {
  const bool has_indices = (record.flags & kHasIndices) != 0;
  switch (static_cast<SavedKind>(record.kind)) {
    case SavedKind::kTriangleMesh:
    case SavedKind::kMovingMesh:
      return has_indices ? kMaxPrimitiveCount : record.point_count / 3;
    case SavedKind::kCurves:
      if (has_indices) return kMaxPrimitiveCount;
      return record.point_count == 0 ? 0 : record.point_count - 1;
    case SavedKind::kSpheres:
    case SavedKind::kDiscs:
      return record.point_count;
    case SavedKind::kInstances:
    case SavedKind::kMovingInstances:
      return record.scene_count == 0 ? 0 : kMaxPrimitiveCount;
    case SavedKind::kNone:
      break;
  }
  return 0;
}

void check_record(uint32_t id, const GeometryRecord& record) {
  const auto kind = static_cast<SavedKind>(record.kind);
  if (record.kind > static_cast<uint32_t>(SavedKind::kMovingInstances)) {
    fail("geometry %u is of kind %u, expected 0 to %u", id, record.kind,
         static_cast<uint32_t>(SavedKind::kMovingInstances));
  }
  const uint32_t allowed =
      kind == SavedKind::kNone ? 0 : traits_of(kind).flags | kCommitted | kEnabled;
  if ((record.flags & ~allowed) != 0) {
    fail("geometry %u of kind %u has flags 0x%x, expected bits of 0x%x", id, record.kind,
         record.flags, allowed);
  }
  if (record.point_count > kMaxPointCount || record.primitive_count > kMaxPrimitiveCount ||
      record.primitive_count > most_primitives(record)) {
    fail("geometry %u has %u primitives of %llu points, expected at most %llu", id,
         record.primitive_count, ull{record.point_count}, ull{most_primitives(record)});
  }
  if (is_instances(kind) ? record.primitive_count == 0 : record.scene_count != 0) {
    fail("geometry %u of kind %u shows %u scenes %u times, expected instances alone to", id,
         record.kind, record.scene_count, record.primitive_count);
  }
  if (is_moving(kind) && (record.step_count < 2 || record.step_count > KIWAMI_MAX_TIME_STEPS)) {
    fail("geometry %u has %u time steps, expected 2 to %d", id, record.step_count,
         int{KIWAMI_MAX_TIME_STEPS});
  }
  const bool has_opacity = (record.flags & kHasOpacity) != 0;
  if (has_opacity ? record.opacity_level > KIWAMI_OPACITY_MAX_LEVEL || record.opacity_format - 1 > 1
                  : (record.flags & kHasOpacityIndices) != 0) {
    fail("geometry %u has opacity maps of format %u and level %u, expected 1 or 2 and at most %d",
         id, record.opacity_format, record.opacity_level, int{KIWAMI_OPACITY_MAX_LEVEL});
  }
}

TriangleMeshView mesh_view_of(const SavedGeometry& saved) {
  TriangleMeshView view{};
  view.vertices = saved.buffers[0];
  view.vertex_stride = view.index_stride = kTripleSize;
  view.vertex_count = static_cast<size_t>(saved.record.point_count);
  view.indices = saved.buffers[1];
  view.triangle_count = saved.record.primitive_count;
  view.mask = saved.record.mask;
  return view;
}

MovingMeshView moving_view_of(const SavedGeometry& saved) {
  MovingMeshView view{};
  view.vertices = saved.buffers[0];
  view.vertex_stride = view.index_stride = kTripleSize;
  view.vertex_count = static_cast<size_t>(saved.record.point_count);
  view.step_stride = view.vertex_count * kTripleSize;
  view.indices = saved.buffers[1];
  view.triangle_count = saved.record.primitive_count;
  view.time = {saved.record.time_begin, saved.record.time_end, saved.record.step_count - 1};
  view.mask = saved.record.mask;
  return view;
}

ShapeView shape_view_of(const SavedGeometry& saved) {
  ShapeView view{};
  view.points = saved.buffers[0];
  view.point_stride = kPointSize;
  view.point_count = static_cast<size_t>(saved.record.point_count);
  const bool is_disc = saved.kind() == SavedKind::kDiscs;
  view.normals = is_disc ? saved.buffers[1] : nullptr;
  view.normal_stride = kTripleSize;
  view.indices = is_disc ? nullptr : saved.buffers[1];
  view.index_stride = sizeof(uint32_t);
  view.count = saved.record.primitive_count;
  view.mask = saved.record.mask;
  return view;
}

void add_buffer(FileWriter& writer, const void* data, size_t size, size_t stride, size_t count) {
  writer.align();
  if (data) writer.add(data, size, stride, count);
}

Reference<Geometry> adopted(Geometry* geometry) { return Reference<Geometry>::adopt(geometry); }

/// Of instances, of which those at rest have one step.
Instances::SavedBuffers instance_buffers_of(const SavedGeometry& saved) {
  Instances::SavedBuffers buffers{};
  buffers.count = saved.record.primitive_count;
  buffers.mask = saved.record.mask;
  buffers.format = transform_format_of(saved.record);
  if (is_moving(saved.kind())) {
    buffers.time = {saved.record.time_begin, saved.record.time_end, saved.record.step_count - 1};
  }
  buffers.transforms = saved.buffers[0];
  buffers.indices = saved.buffers[1];
  buffers.masks = saved.buffers[2];
  return buffers;
}

Reference<Geometry> make_mesh(const SavedGeometry& saved, Device& device, FileImage& image,
                              bool is_trusted) {
  Memory& memory = device.memory();
  auto mesh = Reference<TriangleMesh>::adopt(
      make_object<TriangleMesh>(memory, device, image, mesh_view_of(saved), is_trusted));
  if (saved.has(kHasOpacity)) {
    const OpacityMap::SavedMaps maps = {
        saved.buffers[2], reinterpret_cast<const uint32_t*>(saved.buffers[3]),
        saved.record.opacity_map_count, saved.record.opacity_level, saved.record.opacity_format};
    mesh->set_opacity(Reference<OpacityMap>::adopt(make_object<OpacityMap>(
        memory, device, image, maps, saved.record.primitive_count, is_trusted)));
  }
  return Reference<Geometry>(*mesh);
}

}  // namespace

GeometryRecord record_of(const TriangleMeshView& mesh, const OpacityMap* opacity) {
  GeometryRecord record{};
  record.kind = static_cast<uint32_t>(SavedKind::kTriangleMesh);
  record.flags = mesh.indices ? uint32_t{kHasIndices} : 0;
  record.mask = mesh.mask;
  record.primitive_count = mesh.triangle_count;
  record.point_count = mesh.vertex_count;
  if (!opacity) return record;
  record.flags |= kHasOpacity | (opacity->view().indices ? uint32_t{kHasOpacityIndices} : 0);
  record.opacity_level = opacity->view().level;
  record.opacity_format = opacity->view().bits;
  record.opacity_map_count = opacity->map_count();
  return record;
}

GeometryRecord record_of(const Instances& instances) {
  GeometryRecord record{};
  record.kind = static_cast<uint32_t>(SavedKind::kInstances);
  record.flags = (instances.indices().first ? uint32_t{kHasIndices} : 0) |
                 (instances.has_masks() ? uint32_t{kHasMasks} : 0);
  record.primitive_count = instances.count();
  record.scene_count = instances.scene_count();
  if (!instances.is_moving()) return record;
  record.kind = static_cast<uint32_t>(SavedKind::kMovingInstances);
  if (instances.format() == TransformFormat::kQuaternion) record.flags |= kHasQuaternions;
  record.step_count = instances.time().segment_count + 1;
  record.time_begin = instances.time().begin;
  record.time_end = instances.time().end;
  return record;
}

GeometryRecord record_of(const Shapes& geometry) {
  const GeometryKind kind = geometry.kind();
  const ShapeView& shapes = geometry.buffers();
  GeometryRecord record{};
  record.kind = static_cast<uint32_t>(kind == GeometryKind::kSpheres ? SavedKind::kSpheres
                                      : kind == GeometryKind::kDiscs ? SavedKind::kDiscs
                                                                     : SavedKind::kCurves);
  record.flags = shapes.indices ? uint32_t{kHasIndices} : 0;
  record.primitive_count = shapes.count;
  record.point_count = shapes.point_count;
  return record;
}

GeometryRecord record_of(const MovingMesh& geometry) {
  const MovingMeshView& mesh = geometry.buffers();
  GeometryRecord record{};
  record.kind = static_cast<uint32_t>(SavedKind::kMovingMesh);
  record.flags = mesh.indices ? uint32_t{kHasIndices} : 0;
  record.primitive_count = mesh.triangle_count;
  record.point_count = mesh.vertex_count;
  record.step_count = mesh.time.segment_count + 1;
  record.time_begin = mesh.time.begin;
  record.time_end = mesh.time.end;
  return record;
}

void add_buffers(FileWriter& writer, const TriangleMeshView& mesh, const OpacityMap* opacity) {
  add_buffer(writer, mesh.vertices, kTripleSize, mesh.vertex_stride, mesh.vertex_count);
  add_buffer(writer, mesh.indices, kTripleSize, mesh.index_stride, mesh.triangle_count);
  if (!opacity) return;
  const OpacityView& view = opacity->view();
  add_buffer(writer, view.maps, view.map_bytes, view.map_bytes, opacity->map_count());
  add_buffer(writer, view.indices, sizeof(uint32_t), sizeof(uint32_t), mesh.triangle_count);
}

void add_buffers(FileWriter& writer, const Instances& instances) {
  const auto add = [&](const Instances::Elements& elements, size_t size) {
    add_buffer(writer, elements.first, size, elements.stride, instances.count());
  };
  writer.align();
  for (uint32_t step = 0; step <= instances.time().segment_count; ++step) {
    const unsigned char* const first =
        instances.transforms().first + step * instances.step_stride();
    writer.add(first, transform_bytes(instances.format()), instances.transforms().stride,
               instances.count());
  }
  add(instances.indices(), sizeof(uint32_t));
  add(instances.masks(), sizeof(uint32_t));
}

void add_buffers(FileWriter& writer, const Shapes& geometry) {
  const ShapeView& shapes = geometry.buffers();
  add_buffer(writer, shapes.points, kPointSize, shapes.point_stride, shapes.point_count);
  add_buffer(writer, shapes.normals, kTripleSize, shapes.normal_stride, shapes.count);
  add_buffer(writer, shapes.indices, sizeof(uint32_t), shapes.index_stride, shapes.count);
}

void add_buffers(FileWriter& writer, const MovingMesh& geometry) {
  const MovingMeshView& mesh = geometry.buffers();
  writer.align();
  for (uint32_t step = 0; step <= mesh.time.segment_count; ++step) {
    const unsigned char* const first = mesh.vertices + step * mesh.step_stride;
    writer.add(first, kTripleSize, mesh.vertex_stride, mesh.vertex_count);
  }
  add_buffer(writer, mesh.indices, kTripleSize, mesh.index_stride, mesh.triangle_count);
}

SavedGeometries::SavedGeometries(const FileReader& reader, uint32_t scene)
    : records_(reader.array<GeometryRecord>(SectionType::kGeometries, scene)),
      bytes_(reader.array<unsigned char>(SectionType::kBuffers, scene)),
      shown_(reader.array<uint32_t>(SectionType::kShownScenes, scene)) {
  Cursor cursor;
  if (records_.size() >= KIWAMI_INVALID_ID) {
    fail("scene %u has %zu geometries, expected less than 2^32", scene, records_.size());
  }
  for (uint32_t id = 0; id < records_.size(); ++id) {
    check_record(id, records_[id]);
    take(id, cursor);
  }
  const bool has_rest = bytes_.size() - cursor.byte >= kSectionAlignment;
  if (has_rest || cursor.shown != shown_.size()) {
    fail("the geometries of scene %u have %zu bytes and show %zu scenes, expected %zu and %zu",
         scene, bytes_.size(), shown_.size(), cursor.byte, cursor.shown);
  }
}

/// Buffers do not overlap, or a small file could make much work.
SavedGeometry SavedGeometries::take(uint32_t id, Cursor& cursor) const {
  const GeometryRecord& record = records_[id];
  SavedGeometry saved{record, {}, {}};
  BufferExtent extents[SavedGeometry::kBufferCount];
  describe_buffers(record, extents);
  for (size_t i = 0; i < SavedGeometry::kBufferCount; ++i) {
    const auto& [count, size] = extents[i];
    if (size == 0) continue;
    const size_t begin =
        (cursor.byte + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
    if (begin > bytes_.size() || count > (bytes_.size() - begin) / size) {
      fail(
          "buffer %zu of geometry %u has %llu elements of %zu bytes from byte %zu of %zu on, "
          "expected less",
          i, id, ull{count}, size, begin, bytes_.size());
    }
    saved.buffers[i] = bytes_.data() + begin;
    cursor.byte = begin + static_cast<size_t>(count) * size;
  }
  if (record.scene_count > shown_.size() - cursor.shown) {
    fail("geometry %u shows %u scenes, expected at most %zu", id, record.scene_count,
         shown_.size() - cursor.shown);
  }
  saved.shown = shown_.subspan(cursor.shown, record.scene_count);
  cursor.shown += record.scene_count;
  return saved;
}

Reference<Geometry> make_geometry(const SavedGeometry& saved, Array<Scene*> scenes, Device& device,
                                  FileImage& image, bool is_trusted) {
  Memory& memory = device.memory();
  Reference<Geometry> made;
  const auto make_shapes = [&](GeometryKind kind) {
    return adopted(
        make_object<Shapes>(memory, device, image, kind, shape_view_of(saved), is_trusted));
  };
  blame_file([&] {
    switch (saved.kind()) {
      case SavedKind::kTriangleMesh:
        made = make_mesh(saved, device, image, is_trusted);
        break;
      case SavedKind::kInstances:
      case SavedKind::kMovingInstances:
        made = adopted(make_object<Instances>(memory, device, image, instance_buffers_of(saved),
                                              std::move(scenes), is_trusted));
        break;
      case SavedKind::kSpheres:
        made = make_shapes(GeometryKind::kSpheres);
        break;
      case SavedKind::kDiscs:
        made = make_shapes(GeometryKind::kDiscs);
        break;
      case SavedKind::kCurves:
        made = make_shapes(GeometryKind::kCurves);
        break;
      case SavedKind::kMovingMesh:
        made = adopted(
            make_object<MovingMesh>(memory, device, image, moving_view_of(saved), is_trusted));
        break;
      case SavedKind::kNone:
        break;
    }
  });
  return made;
}

}  // namespace kiwami::file

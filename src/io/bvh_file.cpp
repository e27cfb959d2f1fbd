// SPDX-License-Identifier: Apache-2.0
#include "io/bvh_file.h"

#include <algorithm>

#include "core/error.h"
#include "io/file_format.h"
#include "io/file_reader.h"
#include "io/file_writer.h"
#include "io/geometry_sections.h"

namespace kiwami {
namespace {

using namespace file;

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
}

/// A section as an array of its own: trees change when they are refitted.
template <typename T>
Array<T> copy_of(const FileReader& reader, SectionType type, Memory& memory) {
  const std::span<const T> elements = reader.array<T>(type);
  Array<T> copy(memory, elements.size());
  std::copy(elements.begin(), elements.end(), copy.begin());
  return copy;
}

/// The mesh of a file; none where there are no triangles.
Reference<TriangleMesh> mesh_of(const FileReader& reader, Device& device, FileImage& image,
                                bool is_trusted) {
  const SavedGeometries geometries(reader, 0);
  Reference<TriangleMesh> mesh;
  geometries.for_each([&](uint32_t id, const SavedGeometry& saved) {
    if (id != 0 || saved.kind() != SavedKind::kTriangleMesh || saved.has(kHasOpacity)) {
      fail("geometry %u of the tree is of kind %u, expected one plain mesh", id, saved.record.kind);
    }
    if (saved.record.primitive_count == 0) return;
    const auto made = make_geometry(saved, {}, device, image, is_trusted);
    mesh = Reference<TriangleMesh>(static_cast<TriangleMesh&>(*made));
  });
  return mesh;
}

/// What the tree itself does not tell: its checks go by these numbers.
void check_numbers(const SavedBvh& saved, uint32_t is_over_boxes) {
  const uint32_t width = saved.width;
  if ((width != 2 && width != 4 && width != 8 && width != 16) || saved.leaf_width == 0 ||
      saved.leaf_width > 16) {
    fail("the tree is %u wide with leaves of %u, expected 2, 4, 8 or 16, and 1 to 16", width,
         saved.leaf_width);
  }
  if ((is_over_boxes != 0) != (saved.mesh.get() == nullptr)) {
    fail("the tree is %s a mesh, expected the contrary",
         is_over_boxes != 0 ? "over boxes with" : "over triangles without");
  }
  const size_t count = saved.mesh.get() ? saved.mesh->triangle_count() : saved.boxes.size();
  if (count > 0x7FFFFFFF || saved.tree.nodes.size() >= KIWAMI_INVALID_ID) {
    fail("the tree has %zu primitives and %zu nodes, expected less than 2^31 and 2^32", count,
         saved.tree.nodes.size());
  }
  uint64_t lowest = 0;
  for (const uint32_t id : saved.skipped_ids) {
    if (id < lowest || id >= count) fail("primitive %u is skipped, expected a number of one", id);
    lowest = uint64_t{id} + 1;
  }
}

/// Nothing but finite boxes: those of nodes lie within the root's, which is checked with the tree.
void check_boxes(const SavedBvh& saved) {
  if (!saved.tree.nodes.empty()) {
    const kiwami_bvh_node& root = saved.tree.nodes[0];
    for (int axis = 0; axis < 3; ++axis) {
      if (-KIWAMI_MAX_COORDINATE <= root.lower[axis] && root.upper[axis] <= KIWAMI_MAX_COORDINATE) {
        continue;
      }
      fail("the root reaches from %g to %g on axis %d, expected finite numbers",
           static_cast<double>(root.lower[axis]), static_cast<double>(root.upper[axis]), axis);
    }
  }
  size_t empty = 0;
  for (const Bounds& box : saved.boxes) empty += box.is_empty() ? 1 : 0;
  if (!saved.boxes.empty() && empty != saved.skipped_ids.size()) {
    fail("the tree skips %zu boxes, expected the %zu that are empty", saved.skipped_ids.size(),
         empty);
  }
}

}  // namespace

uint64_t save_bvh(const Bvh& bvh, const kiwami_save_desc& desc) {
  if (bvh.is_of_scene()) {
    throw Error(KIWAMI_ERROR_INVALID_STATE,
                "the tree is that of a scene, expected one of kiwami_bvh_build: save the scene");
  }
  Memory& memory = bvh.device().memory();
  const BvhRecord record = {bvh.info().width, bvh.info().leaf_width, bvh.is_over_boxes() ? 1u : 0u,
                            0, bvh.info().build_seconds};
  FileWriter writer(KIWAMI_FILE_BVH, memory, bvh.device().parallel());
  writer.begin_section(SectionType::kBvh);
  writer.add(&record, 1);
  writer.begin_section(SectionType::kNodes);
  writer.add(bvh.nodes().data(), bvh.nodes().size());
  writer.begin_section(SectionType::kPrimitives);
  writer.add(bvh.primitive_ids().data(), bvh.primitive_ids().size());
  writer.begin_section(SectionType::kSkipped);
  writer.add(bvh.skipped_ids().data(), bvh.skipped_ids().size());
  writer.begin_section(SectionType::kBoxes);
  writer.add(bvh.boxes().data(), bvh.boxes().size());
  const TriangleSource source = bvh.source();
  Array<GeometryRecord> records(memory, source.mesh_count);
  for (uint32_t i = 0; i < source.mesh_count; ++i)
    records[i] = record_of(source.meshes[i], nullptr);
  writer.add_section(SectionType::kGeometries, 0, records);
  writer.begin_section(SectionType::kBuffers);
  for (uint32_t i = 0; i < source.mesh_count; ++i) add_buffers(writer, source.meshes[i], nullptr);
  return save(writer, desc);
}

Bvh* load_bvh(Device& device, const kiwami_load_desc& desc) {
  Memory& memory = device.memory();
  const bool is_trusted = (desc.flags & KIWAMI_LOAD_TRUSTED) != 0;
  const auto image = Reference<FileImage>::adopt(FileImage::create(device, desc));
  const FileReader reader(image->data(), image->size());
  reader.check_kind(KIWAMI_FILE_BVH);
  if (!is_trusted) reader.check_sums(memory, device.parallel());
  const auto record = reader.record<BvhRecord>(SectionType::kBvh);
  SavedBvh saved{record.width,
                 record.leaf_width,
                 record.build_seconds,
                 {copy_of<kiwami_bvh_node>(reader, SectionType::kNodes, memory),
                  copy_of<uint32_t>(reader, SectionType::kPrimitives, memory)},
                 copy_of<uint32_t>(reader, SectionType::kSkipped, memory),
                 copy_of<Bounds>(reader, SectionType::kBoxes, memory),
                 {}};
  saved.mesh = mesh_of(reader, device, *image, is_trusted);
  check_numbers(saved, record.is_over_boxes);
  if (!is_trusted) check_boxes(saved);
  const auto bvh = Reference<Bvh>::adopt(Bvh::create(device, std::move(saved)));
  if (!is_trusted) blame_file([&] { bvh->validate(); });
  bvh->retain();
  return bvh.get();
}

}  // namespace kiwami

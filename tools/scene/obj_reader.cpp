// SPDX-License-Identifier: Apache-2.0
#include "scene/obj_reader.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <unordered_map>

#include "scene/byte_reader.h"

namespace kiwami::tools {
namespace {

/// The part of tinyobjloader's report that helps: which line is wrong.
std::string reason_of(const std::string& report) {
  const size_t word = report.find("line ");
  const size_t digits = word == std::string::npos ? word : word + 5;
  const size_t end = report.find_first_not_of("0123456789", digits);
  if (digits == std::string::npos || digits == end) return "it is malformed";
  return "line " + report.substr(digits, end - digits) + " is malformed";
}

/// The triangles of a shape, over the vertices that it uses alone: a file holds one list of
/// vertices for all shapes, which would otherwise be copied into each.
Mesh compact_mesh(const tinyobj::shape_t& shape, const std::vector<tinyobj::real_t>& vertices,
                  const ByteReader& reader) {
  Mesh mesh;
  mesh.name = shape.name;
  mesh.indices.reserve(shape.mesh.indices.size());
  std::unordered_map<int, uint32_t> renumbered;
  for (const tinyobj::index_t& index : shape.mesh.indices) {
    if (index.vertex_index < 0 || static_cast<size_t>(index.vertex_index) >= vertices.size() / 3) {
      reader.fail("a face names a vertex that does not exist");
    }
    const auto [entry, added] =
        renumbered.try_emplace(index.vertex_index, static_cast<uint32_t>(mesh.vertices.size() / 3));
    if (added) {
      const auto first = vertices.begin() + ptrdiff_t{index.vertex_index} * 3;
      mesh.vertices.insert(mesh.vertices.end(), first, first + 3);
    }
    mesh.indices.push_back(entry->second);
  }
  return mesh;
}

}  // namespace

SceneFile read_obj(const std::filesystem::path& path) {
  ByteReader reader(path);
  std::istringstream text(reader.read_text());
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warnings;
  std::string errors;
  if (!tinyobj::LoadObj(&attributes, &shapes, &materials, &warnings, &errors, &text,
                        /*readMatFn=*/nullptr, /*triangulate=*/true,
                        /*default_vcols_fallback=*/false)) {
    reader.fail(reason_of(errors));
  }
  // Triangulation drops a polygon whose index is out of bounds with no more than this warning.
  if (warnings.find("Vertex indices out of bounds") != std::string::npos) {
    reader.fail("a face names a vertex that does not exist");
  }
  SceneFile scene;
  for (const tinyobj::shape_t& shape : shapes) {
    const auto& counts = shape.mesh.num_face_vertices;
    if (counts.empty()) continue;
    if (std::any_of(counts.begin(), counts.end(), [](auto count) { return count != 3; })) {
      reader.fail("a polygon cannot be triangulated");
    }
    scene.meshes.push_back(compact_mesh(shape, attributes.vertices, reader));
  }
  return scene;
}

}  // namespace kiwami::tools

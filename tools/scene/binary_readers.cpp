// SPDX-License-Identifier: Apache-2.0
#include "scene/binary_readers.h"

#include <algorithm>
#include <bit>

#include "scene/byte_reader.h"

namespace kiwami::tools {
namespace {

// The arrays of the files are read as they are.
static_assert(std::endian::native == std::endian::little);

constexpr uint32_t four_characters(const char (&text)[5]) {
  return uint32_t{static_cast<unsigned char>(text[0])} |
         uint32_t{static_cast<unsigned char>(text[1])} << 8 |
         uint32_t{static_cast<unsigned char>(text[2])} << 16 |
         uint32_t{static_cast<unsigned char>(text[3])} << 24;
}

void expect_signature(ByteReader& reader, const char (&text)[5]) {
  if (reader.read_u32() != four_characters(text)) {
    reader.fail(std::string("it does not begin with '") + text + "'");
  }
}

Mesh read_mesh(ByteReader& reader, const std::string& name) {
  const uint64_t vertex_count = reader.read_u32();
  const uint64_t triangle_count = reader.read_u32();
  if ((vertex_count + triangle_count) * 12 > reader.most_bytes_left()) {
    reader.fail("it is truncated, or its header's counts are wrong");
  }
  Mesh mesh;
  mesh.name = name;
  mesh.vertices = reader.read_array<float>(vertex_count * 3);
  mesh.indices = reader.read_array<uint32_t>(triangle_count * 3);
  const auto outside = std::find_if(mesh.indices.begin(), mesh.indices.end(),
                                    [&](uint32_t index) { return index >= vertex_count; });
  if (outside != mesh.indices.end()) {
    reader.fail("triangle " + std::to_string((outside - mesh.indices.begin()) / 3) +
                " has the index " + std::to_string(*outside) + ", but there are " +
                std::to_string(vertex_count) + " vertices");
  }
  return mesh;
}

}  // namespace

SceneFile read_tri(const std::filesystem::path& path) {
  ByteReader reader(path);
  expect_signature(reader, "TRI1");
  SceneFile scene;
  scene.meshes.push_back(read_mesh(reader, path.filename().string()));
  reader.expect_end();
  return scene;
}

SceneFile read_ins(const std::filesystem::path& path) {
  ByteReader reader(path);
  expect_signature(reader, "INS1");
  const uint64_t mesh_count = reader.read_u32();
  const uint64_t instance_count = reader.read_u32();
  if (mesh_count * 8 + instance_count * 52 > reader.most_bytes_left()) {
    reader.fail("it is truncated, or its header's counts are wrong");
  }
  SceneFile scene;
  for (uint64_t i = 0; i < mesh_count; ++i) {
    scene.meshes.push_back(read_mesh(reader, "mesh " + std::to_string(i)));
  }
  for (uint64_t i = 0; i < instance_count; ++i) {
    Instance instance{reader.read_u32(), {}};
    if (instance.mesh >= mesh_count) {
      reader.fail("instance " + std::to_string(i) + " names mesh " + std::to_string(instance.mesh) +
                  ", but there are " + std::to_string(mesh_count) + " meshes");
    }
    const std::vector<float> rows = reader.read_array<float>(instance.transform.size());
    std::copy(rows.begin(), rows.end(), instance.transform.begin());
    scene.instances.push_back(instance);
  }
  reader.expect_end();
  return scene;
}

}  // namespace kiwami::tools

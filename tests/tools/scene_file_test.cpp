// SPDX-License-Identifier: Apache-2.0
// Scene files: what is read is what was written, and what is broken is refused.
#include "scene/scene_file.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

namespace kiwami::tools {
namespace {

namespace fs = std::filesystem;

/// Files of a test in a folder of its own.
class SceneFiles : public testing::Test {
 protected:
  SceneFiles() {
    std::string pattern = (fs::temp_directory_path() / "kiwami-test-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~SceneFiles() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }

  fs::path write_gzip(const std::string& name, const std::string& bytes) const {
    gzFile file = gzopen((folder_ / name).c_str(), "wb");
    gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
    gzclose(file);
    return folder_ / name;
  }

  fs::path folder_;
};

void append_u32(std::string& bytes, uint32_t number) {
  for (int shift = 0; shift < 32; shift += 8) {
    bytes += static_cast<char>(number >> shift & 0xFF);
  }
}

void append_float(std::string& bytes, float number) {
  uint32_t bits;
  std::memcpy(&bits, &number, sizeof bits);
  append_u32(bytes, bits);
}

std::string mesh_bytes(const std::vector<float>& vertices, const std::vector<uint32_t>& indices) {
  std::string bytes;
  append_u32(bytes, static_cast<uint32_t>(vertices.size() / 3));
  append_u32(bytes, static_cast<uint32_t>(indices.size() / 3));
  for (const float v : vertices) append_float(bytes, v);
  for (const uint32_t i : indices) append_u32(bytes, i);
  return bytes;
}

const std::vector<float> kVertices = {0, 0, 0, 1.5f, 0, 0, 0, 2.5f, 0, 0, 0, -3.5f};
const std::vector<uint32_t> kIndices = {0, 1, 2, 0, 3, 1};

std::string tri_bytes() { return "TRI1" + mesh_bytes(kVertices, kIndices); }

std::string ins_bytes() {
  std::string bytes = "INS1";
  append_u32(bytes, 1);
  append_u32(bytes, 2);
  bytes += mesh_bytes(kVertices, kIndices);
  for (uint32_t i = 0; i < 2; ++i) {
    append_u32(bytes, 0);
    for (const float v : {2.0f, 0.0f, 0.0f, 10.0f, 0.0f, 1.0f, 0.0f, 20.0f, 0.0f, 0.0f, -1.0f,
                          static_cast<float>(i)}) {
      append_float(bytes, v);
    }
  }
  return bytes;
}

TEST_F(SceneFiles, TriIsReadAsWritten) {
  for (const fs::path& path : {write("a.tri", tri_bytes()), write_gzip("a.tri.gz", tri_bytes())}) {
    const SceneFile scene = load_scene(path);
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].vertices, kVertices);
    EXPECT_EQ(scene.meshes[0].indices, kIndices);
    EXPECT_EQ(scene.triangle_count(), 2u);
  }
}

TEST_F(SceneFiles, InsIsReadAndFlattened) {
  for (const fs::path& path : {write("a.ins", ins_bytes()), write_gzip("a.ins.gz", ins_bytes())}) {
    const SceneFile scene = load_scene(path);
    EXPECT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.triangle_count(), 4u);
    const SceneFile flat = flatten(scene);
    ASSERT_EQ(flat.meshes.size(), 2u);
    EXPECT_TRUE(flat.instances.empty());
    EXPECT_EQ(flat.triangle_count(), 4u);
    const std::vector<float> moved = {10, 20, 1, 13, 20, 1, 10, 22.5f, 1, 10, 20, 4.5f};
    EXPECT_EQ(flat.meshes[1].vertices, moved);
    EXPECT_EQ(flat.meshes[1].indices, kIndices);
  }
}

TEST_F(SceneFiles, EveryTruncationIsRefused) {
  for (const auto& [name, bytes] : {std::pair{"a.tri", tri_bytes()}, {"a.ins", ins_bytes()}}) {
    for (size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_THROW(load_scene(write(name, bytes.substr(0, size))), SceneError) << name << size;
    }
  }
  const std::string compressed = [&] {
    const fs::path path = write_gzip("whole.tri.gz", tri_bytes());
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  }();
  for (size_t size = 3; size < compressed.size(); ++size) {
    EXPECT_THROW(load_scene(write("cut.tri.gz", compressed.substr(0, size))), SceneError) << size;
  }
}

TEST_F(SceneFiles, WhatFollowsTheEndIsRefused) {
  EXPECT_THROW(load_scene(write("a.tri", tri_bytes() + "x")), SceneError);
  EXPECT_THROW(load_scene(write("a.ins", ins_bytes() + "x")), SceneError);
}

TEST_F(SceneFiles, CountsThatLieCostNothing) {
  for (const char* name : {"a.tri", "a.tri.gz"}) {
    std::string bytes = "TRI1";
    append_u32(bytes, 0xFFFFFFFFu);
    append_u32(bytes, 0xFFFFFFFFu);
    EXPECT_THROW(load_scene(write(name, bytes)), SceneError);
    EXPECT_THROW(load_scene(write_gzip(name, bytes)), SceneError);
  }
  std::string bytes = "INS1";
  append_u32(bytes, 0xFFFFFFFFu);
  append_u32(bytes, 0xFFFFFFFFu);
  EXPECT_THROW(load_scene(write("a.ins", bytes)), SceneError);
}

TEST_F(SceneFiles, AnIndexOrInstanceOutOfRangeIsRefused) {
  std::vector<uint32_t> indices = kIndices;
  indices[4] = 4;
  EXPECT_THROW(load_scene(write("a.tri", "TRI1" + mesh_bytes(kVertices, indices))), SceneError);
  std::string bytes = ins_bytes();
  const size_t second_instance = bytes.size() - 52;
  bytes[second_instance] = 1;
  EXPECT_THROW(load_scene(write("a.ins", bytes)), SceneError);
}

TEST_F(SceneFiles, NotANumberIsLoaded) {
  std::vector<float> vertices = kVertices;
  vertices[2] = std::numeric_limits<float>::quiet_NaN();
  const SceneFile scene = load_scene(write("a.tri", "TRI1" + mesh_bytes(vertices, kIndices)));
  EXPECT_TRUE(std::isnan(scene.meshes[0].vertices[2]));
}

TEST_F(SceneFiles, ObjGroupsBecomeMeshesOfTheirOwnVertices) {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\nv 6 5 5\nv 5 6 5\n"
      "o quad\nf 1 2 3 4\ng triangle\nf 5/1 6/2 7/3\nf -3 -2 -1\n";
  for (const fs::path& path : {write("a.obj", text), write_gzip("a.obj.gz", text)}) {
    const SceneFile scene = load_scene(path);
    ASSERT_EQ(scene.meshes.size(), 2u);
    EXPECT_EQ(scene.meshes[0].name, "quad");
    EXPECT_EQ(scene.meshes[0].vertex_count(), 4u);
    EXPECT_EQ(scene.meshes[0].triangle_count(), 2u);
    EXPECT_EQ(scene.meshes[1].vertices, (std::vector<float>{5, 5, 5, 6, 5, 5, 5, 6, 5}));
    EXPECT_EQ(scene.meshes[1].indices, (std::vector<uint32_t>{0, 1, 2, 0, 1, 2}));
  }
}

TEST_F(SceneFiles, AConcavePolygonKeepsItsArea) {
  const SceneFile scene =
      load_scene(write("a.obj", "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n"));
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.triangle_count(), 3u);
  const auto corner = [&](size_t i) {
    const float* v = &mesh.vertices[size_t{mesh.indices[i]} * 3];
    return Vec3{v[0], v[1], v[2]};
  };
  float area = 0;
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vec3 normal = cross(corner(i + 1) - corner(i), corner(i + 2) - corner(i));
    area += 0.5f * length(normal);
  }
  EXPECT_FLOAT_EQ(area, 10.0f);
}

TEST_F(SceneFiles, AnObjWithoutFacesIsRefused) {
  EXPECT_THROW(load_scene(write("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n")), SceneError);
}

}  // namespace
}  // namespace kiwami::tools

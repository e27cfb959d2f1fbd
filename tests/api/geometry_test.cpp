// SPDX-License-Identifier: Apache-2.0
// Triangle meshes: each error of their description.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

class MeshErrors : public testing::Test {
 protected:
  void expect(const kiwami_triangle_mesh_desc& desc, kiwami_result result,
              const std::string& sentence) {
    kiwami_geometry* geometry = reinterpret_cast<kiwami_geometry*>(uintptr_t{8});
    EXPECT_EQ(kiwami_triangle_mesh_create(device_.get(), &desc, &geometry), result) << sentence;
    EXPECT_EQ(geometry, nullptr);
    EXPECT_EQ(last_error(device_.get()), sentence);
  }

  Device device_ = make_device();
  Triangles triangles_ = square(1);
  kiwami_triangle_mesh_desc desc_ = triangles_.desc();
};

TEST_F(MeshErrors, NullArguments) {
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_triangle_mesh_create(nullptr, &desc_, &geometry), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "device is NULL, expected a valid pointer");
  EXPECT_EQ(kiwami_triangle_mesh_create(device_.get(), nullptr, &geometry),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "desc is NULL, expected a valid pointer");
  EXPECT_EQ(kiwami_triangle_mesh_create(device_.get(), &desc_, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "geometry is NULL, expected a valid pointer");
  kiwami_geometry_retain(nullptr);
  kiwami_geometry_release(nullptr);
}

TEST_F(MeshErrors, Flags) {
  desc_.flags = 2;
  expect(desc_, KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x2, expected KIWAMI_MESH_* bits");
}

TEST_F(MeshErrors, Reserved) {
  desc_.reserved = 9;
  expect(desc_, KIWAMI_ERROR_INVALID_ARGUMENT, "desc.reserved is 9, expected 0");
}

TEST_F(MeshErrors, MissingVertices) {
  desc_.vertices = nullptr;
  expect(desc_, KIWAMI_ERROR_INVALID_ARGUMENT,
         "desc.vertices is NULL with desc.vertex_count 4, expected the vertices");
}

TEST_F(MeshErrors, Strides) {
  desc_.vertex_stride = 11;
  expect(desc_, KIWAMI_ERROR_INVALID_ARGUMENT,
         "desc.vertex_stride is 11, expected at least 12, or 0 for 12");
  desc_.vertex_stride = 12;
  desc_.index_stride = 1;
  expect(desc_, KIWAMI_ERROR_INVALID_ARGUMENT,
         "desc.index_stride is 1, expected at least 12, or 0 for 12");
}

TEST_F(MeshErrors, Counts) {
  desc_.vertex_count = uint64_t{1} << 32;
  expect(desc_, KIWAMI_ERROR_TOO_LARGE,
         "desc.vertex_count is 4294967296, expected at most 4294967295");
  desc_ = triangles_.desc();
  desc_.triangle_count = uint64_t{1} << 31;
  expect(desc_, KIWAMI_ERROR_TOO_LARGE,
         "desc.triangle_count is 2147483648, expected at most 2147483647");
}

TEST_F(MeshErrors, TooManyTrianglesForVerticesWithoutIndices) {
  desc_.indices = nullptr;
  expect(desc_, KIWAMI_ERROR_INVALID_ARGUMENT,
         "desc.triangle_count is 2 with desc.indices NULL, expected at most a third of "
         "desc.vertex_count, which is 4");
}

TEST_F(MeshErrors, ExtentsBeyondTheAddressSpace) {
  desc_.vertex_stride = std::numeric_limits<uint64_t>::max() / 3 + 1;
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_triangle_mesh_create(device_.get(), &desc_, &geometry),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error().find("the vertices (offset 0, stride 6148914691236517206, count 4) reach "
                              "beyond the address space, expected an extent of at most "),
            0u)
      << last_error();
  desc_ = triangles_.desc();
  desc_.index_offset = std::numeric_limits<uint64_t>::max() - 5;
  EXPECT_EQ(kiwami_triangle_mesh_create(device_.get(), &desc_, &geometry),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error().find("the indices (offset 18446744073709551610, stride 12, count 2) "), 0u)
      << last_error();
}

TEST_F(MeshErrors, AnIndexBeyondTheVertices) {
  triangles_.indices[4] = 4;
  triangles_.indices[5] = 0xFFFFFFFFu;
  expect(desc_, KIWAMI_ERROR_INVALID_ARGUMENT,
         "index 1 of triangle 1 is 4, expected less than desc.vertex_count, which is 4");
  desc_.flags = KIWAMI_MESH_SHARE_BUFFERS;
  expect(desc_, KIWAMI_ERROR_INVALID_ARGUMENT,
         "index 1 of triangle 1 is 4, expected less than desc.vertex_count, which is 4");
}

TEST_F(MeshErrors, TheLowestFaultyTriangleIsNamedWhateverTheThreads) {
  Triangles many = random_triangles(100000, 3);
  for (uint32_t triangle : {99999u, 70000u, 40001u}) many.indices[3 * triangle + 2] = 300000;
  expect(many.desc(), KIWAMI_ERROR_INVALID_ARGUMENT,
         "index 2 of triangle 40001 is 300000, expected less than desc.vertex_count, which is "
         "300000");
}

TEST(Mesh, MayBeEmpty) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make_mesh(device, default_mesh()));
  EXPECT_EQ(closest_hit(scene, ray_along_z(0, 0)).primitive_id, KIWAMI_INVALID_ID);
}

TEST(Mesh, HasTrianglesInOrderWithoutIndices) {
  const Device device = make_device();
  Triangles triangles{{-1, -1, 3, 1, -1, 3, 0, 1, 3, -1, -1, 2, 1, -1, 2, 0, 1, 2}, {}};
  kiwami_triangle_mesh_desc desc = triangles.desc();
  desc.indices = nullptr;
  desc.triangle_count = 2;
  const Scene scene = make_scene(device, make_mesh(device, desc));
  const kiwami_hit hit = closest_hit(scene, ray_along_z(0, 0));
  EXPECT_EQ(hit.t, 2.0f);
  EXPECT_EQ(hit.primitive_id, 1u);
}

TEST(Mesh, CopiedBuffersMayEndAfterTheCall) {
  const Device device = make_device();
  Geometry mesh;
  {
    Triangles triangles = square(4);
    mesh = make_mesh(device, triangles.desc());
    triangles.vertices.assign(12, 77.0f);
    triangles.indices.assign(6, 77);
  }
  EXPECT_EQ(closest_hit(make_scene(device, mesh), ray_along_z(0.5f, 0.25f)).t, 4.0f);
}

TEST(Mesh, ATriangleWithAVertexOutOfRangeIsSkippedAndTheOthersKeepTheirNumbers) {
  const Device device = make_device();
  const float beyond = std::numeric_limits<float>::max();
  for (float bad : {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity, beyond,
                    -1.0000001f * KIWAMI_MAX_COORDINATE}) {
    for (size_t axis = 0; axis < 3; ++axis) {
      Triangles triangles = square(1);
      triangles.vertices[3 + axis] = bad;  // of vertex 1, which only triangle 0 has
      const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
      kiwami_scene_info info{};
      info.struct_size = sizeof info;
      ASSERT_EQ(kiwami_scene_get_info(scene.get(), &info), KIWAMI_OK);
      EXPECT_EQ(info.skipped_count, 1u) << bad;
      EXPECT_EQ(info.triangle_count, 1u) << bad;
      EXPECT_EQ(closest_hit(scene, ray_along_z(-0.5f, 0.25f)).primitive_id, 1u);
      EXPECT_EQ(closest_hit(scene, ray_along_z(0.5f, 0.25f)).primitive_id, KIWAMI_INVALID_ID);
    }
  }
}

TEST(Mesh, AVertexAtTheLimitIsInRange) {
  const Device device = make_device();
  Triangles triangles = square(KIWAMI_MAX_COORDINATE);
  const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
  EXPECT_EQ(closest_hit(scene, ray_along_z(0.5f, 0.25f)).t, KIWAMI_MAX_COORDINATE);
}

}  // namespace
}  // namespace kiwami_api_tests

// SPDX-License-Identifier: Apache-2.0
// Buffers with odd strides and offsets at odd addresses, in memory that ends with the last element:
// a sanitizer or a memory checker sees any byte read beyond.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <memory>

#include "api/api_support.h"
#include "support/environment.h"

namespace kiwami_api_tests {
namespace {

struct Free {
  void operator()(void* memory) const { std::free(memory); }
};

/// Elements of 12 bytes, stride bytes apart after an offset; not a byte more.
struct ExactBuffer {
  ExactBuffer(const void* elements, size_t count, size_t offset_bytes, size_t stride_bytes)
      : offset(offset_bytes),
        stride(stride_bytes),
        memory(std::malloc(count == 0 ? 1 : offset + (count - 1) * stride + 12)) {
    for (size_t i = 0; i < count; ++i) {
      std::memcpy(static_cast<char*>(memory.get()) + offset + i * stride,
                  static_cast<const char*>(elements) + 12 * i, 12);
    }
  }
  uint64_t offset, stride;
  std::unique_ptr<void, Free> memory;
};

/// Elements of 12 bytes that begin or end where readable memory does: a byte read beyond ends the
/// program.
class GuardedBuffer {
 public:
  GuardedBuffer(const void* elements, size_t count, bool at_end) {
    const auto page = static_cast<size_t>(sysconf(_SC_PAGESIZE));
    const size_t room = (12 * count + page - 1) / page * page;
    size_ = room + 2 * page;
    memory_ = mmap(nullptr, size_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    auto* const begin = static_cast<char*>(memory_) + page;
    EXPECT_EQ(mprotect(begin, room, PROT_READ | PROT_WRITE), 0);
    first_ = at_end ? begin + room - 12 * count : begin;
    std::memcpy(first_, elements, 12 * count);
  }
  ~GuardedBuffer() { munmap(memory_, size_); }
  GuardedBuffer(const GuardedBuffer&) = delete;
  GuardedBuffer& operator=(const GuardedBuffer&) = delete;

  const void* first() const { return first_; }

 private:
  void* memory_;
  size_t size_;
  char* first_;
};

struct Layout {
  size_t vertex_offset, vertex_stride, index_offset, index_stride;
  uint32_t flags;
};

void commit_compact(const Scene& scene, double width) {
  const auto set = [&](uint32_t parameter, double value) {
    ASSERT_EQ(kiwami_scene_set_parameter(scene.get(), parameter, value), KIWAMI_OK);
  };
  set(KIWAMI_PARAMETER_BVH_WIDTH, width);
  set(KIWAMI_PARAMETER_LAYOUT, KIWAMI_LAYOUT_COMPACT);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
}

class BufferTest : public testing::TestWithParam<Layout> {};

TEST_P(BufferTest, GivesTheBitsOfTightlyPackedCopies) {
  const Layout layout = GetParam();
  const Device device = make_device();
  const Triangles triangles = random_triangles(300, kiwami_tests::seed());
  const std::vector<kiwami_ray> rays = random_rays(2000, kiwami_tests::seed());
  const Scene packed = make_scene(device, make_mesh(device, triangles.desc()));

  const ExactBuffer vertices(triangles.vertices.data(), triangles.vertices.size() / 3,
                             layout.vertex_offset, layout.vertex_stride);
  const ExactBuffer indices(triangles.indices.data(), triangles.indices.size() / 3,
                            layout.index_offset, layout.index_stride);
  kiwami_triangle_mesh_desc desc = triangles.desc();
  desc.flags = layout.flags;
  desc.vertices = vertices.memory.get();
  desc.vertex_offset = vertices.offset;
  desc.vertex_stride = vertices.stride;
  desc.indices = indices.memory.get();
  desc.index_offset = indices.offset;
  desc.index_stride = indices.stride;
  const Scene scene = make_scene(device, make_mesh(device, desc));
  EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
  EXPECT_TRUE(are_equal(closest_hits(scene, rays), closest_hits(packed, rays)));

  desc.indices = nullptr;  // the indices are 0, 1, 2, ... in any case
  const Scene unindexed = make_scene(device, make_mesh(device, desc));
  EXPECT_TRUE(are_equal(closest_hits(unindexed, rays), closest_hits(packed, rays)));

  for (const Scene* compact : {&scene, &unindexed}) {
    for (const double width : {4.0, 8.0, 16.0}) {
      commit_compact(*compact, width);
      EXPECT_TRUE(are_equal(closest_hits(*compact, rays), closest_hits(packed, rays)));
    }
  }
}

TEST(SharedBuffer, IsNotReadBeyondItsFirstAndLastElement) {
  const Device device = make_device();
  const Triangles triangles = random_triangles(300, kiwami_tests::seed());
  const std::vector<kiwami_ray> rays = random_rays(2000, kiwami_tests::seed());
  const Scene packed = make_scene(device, make_mesh(device, triangles.desc()));
  for (const bool at_end : {false, true}) {
    const GuardedBuffer vertices(triangles.vertices.data(), triangles.vertices.size() / 3, at_end);
    const GuardedBuffer indices(triangles.indices.data(), triangles.indices.size() / 3, at_end);
    kiwami_triangle_mesh_desc desc = triangles.desc();
    desc.flags = KIWAMI_MESH_SHARE_BUFFERS;
    desc.vertices = vertices.first();
    desc.indices = indices.first();
    const Scene scene = make_scene(device, make_mesh(device, desc));
    EXPECT_TRUE(are_equal(closest_hits(scene, rays), closest_hits(packed, rays)));
    for (const double width : {4.0, 8.0, 16.0}) {
      commit_compact(scene, width);
      EXPECT_TRUE(are_equal(closest_hits(scene, rays), closest_hits(packed, rays)));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, BufferTest,
                         testing::Values(Layout{0, 12, 0, 12, 0}, Layout{3, 13, 1, 15, 0},
                                         Layout{0, 12, 0, 12, KIWAMI_MESH_SHARE_BUFFERS},
                                         Layout{1, 12, 2, 12, KIWAMI_MESH_SHARE_BUFFERS},
                                         Layout{3, 13, 1, 15, KIWAMI_MESH_SHARE_BUFFERS},
                                         Layout{7, 33, 5, 101, KIWAMI_MESH_SHARE_BUFFERS}));

TEST(SharedBuffer, IsReadAgainByTheNextCommit) {
  const Device device = make_device();
  Triangles triangles = square(1);
  kiwami_triangle_mesh_desc desc = triangles.desc();
  desc.flags = KIWAMI_MESH_SHARE_BUFFERS;
  const Scene scene = make_scene(device, make_mesh(device, desc));
  for (size_t z = 2; z < 12; z += 3) triangles.vertices[z] = 6;
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(closest_hit(scene, ray_along_z(0.5f, 0.25f)).t, 6.0f);
}

}  // namespace
}  // namespace kiwami_api_tests

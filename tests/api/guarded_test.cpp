// SPDX-License-Identifier: Apache-2.0
// Buffers between pages that nobody may touch: not one byte is read or written outside, whatever
// the address.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstring>

#include "api/io_support.h"

namespace kiwami_api_tests {
namespace {

/// Bytes with a forbidden page before and after them. They end at the page after them, or begin, at
/// an offset, behind the page before them.
class GuardedBuffer {
 public:
  enum class Side { kBegin, kEnd };

  GuardedBuffer(size_t size, Side side, size_t offset = 0) {
    const auto page = static_cast<size_t>(::sysconf(_SC_PAGESIZE));
    const size_t inner = (size + offset + page - 1) / page * page;
    mapped_size_ = inner + 2 * page;
    mapped_ = static_cast<unsigned char*>(
        ::mmap(nullptr, mapped_size_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    EXPECT_NE(mapped_, MAP_FAILED);
    EXPECT_TRUE(inner == 0 || ::mprotect(mapped_ + page, inner, PROT_READ | PROT_WRITE) == 0);
    data_ = side == Side::kEnd ? mapped_ + page + inner - size - offset : mapped_ + page + offset;
  }
  GuardedBuffer(const void* bytes, size_t size, Side side, size_t offset = 0)
      : GuardedBuffer(size, side, offset) {
    if (size != 0) std::memcpy(data_, bytes, size);
  }
  ~GuardedBuffer() { ::munmap(mapped_, mapped_size_); }
  GuardedBuffer(const GuardedBuffer&) = delete;
  GuardedBuffer& operator=(const GuardedBuffer&) = delete;

  unsigned char* data() const { return data_; }

 private:
  unsigned char* mapped_;
  size_t mapped_size_;
  unsigned char* data_;
};
using Side = GuardedBuffer::Side;

constexpr Side kSides[] = {Side::kBegin, Side::kEnd};

std::vector<uint32_t> isas() {
  kiwami_device_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(kiwami_device_get_info(make_device(KIWAMI_ISA_SCALAR).get(), &info), KIWAMI_OK);
  std::vector<uint32_t> available;
  for (uint32_t isa = KIWAMI_ISA_SCALAR; isa <= KIWAMI_ISA_AVX512; ++isa) {
    if (info.isa_available >> isa & 1) available.push_back(isa);
  }
  return available;
}

/// With gaps of stride - 12 bytes between elements of 12, and none after the last.
std::vector<unsigned char> spread(const void* elements, size_t count, size_t stride) {
  std::vector<unsigned char> bytes(count == 0 ? 0 : (count - 1) * stride + 12, 0xA5);
  for (size_t i = 0; i < count; ++i) {
    std::memcpy(bytes.data() + i * stride, static_cast<const unsigned char*>(elements) + 12 * i,
                12);
  }
  return bytes;
}

TEST(GuardedBuffers, OfMeshesAreReadAtTheirElementsAlone) {
  const Triangles triangles = random_triangles(61, 5);
  const std::vector<kiwami_ray> rays = random_rays(300, 6);
  const Device device = make_device();
  const std::vector<kiwami_hit> expected =
      closest_hits(make_scene(device, make_mesh(device, triangles.desc())), rays);
  for (const size_t stride : {size_t{12}, size_t{13}, size_t{28}}) {
    const auto vertices = spread(triangles.vertices.data(), triangles.vertices.size() / 3, stride);
    const auto indices = spread(triangles.indices.data(), triangles.indices.size() / 3, stride);
    for (const Side side : kSides) {
      // At the end only the offset 0 touches the forbidden page.
      for (size_t offset = 0; offset < (side == Side::kBegin ? 64u : 1u); ++offset) {
        const GuardedBuffer guarded_vertices(vertices.data(), vertices.size(), side, offset);
        const GuardedBuffer guarded_indices(indices.data(), indices.size(), side, offset);
        for (const uint32_t flags : {0u, uint32_t{KIWAMI_MESH_SHARE_BUFFERS}}) {
          kiwami_triangle_mesh_desc desc = triangles.desc();
          desc.flags = flags;
          desc.vertices = guarded_vertices.data();
          desc.indices = guarded_indices.data();
          desc.vertex_stride = desc.index_stride = stride;
          const Scene scene = make_scene(device, make_mesh(device, desc));
          ASSERT_TRUE(are_equal(closest_hits(scene, rays), expected)) << stride << " " << offset;
          ASSERT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK);
        }
      }
    }
  }
}

TEST(GuardedBuffers, OfRaysAndAnswersAreTouchedAtTheirElementsAlone) {
  const Triangles triangles = random_triangles(200, 5);
  const std::vector<kiwami_ray> rays = random_rays(37, 6);
  const size_t ray_bytes = rays.size() * sizeof(kiwami_ray);
  for (const uint32_t isa : isas()) {
    const Device device = make_device(isa);
    const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
    const std::vector<kiwami_hit> expected = closest_hits(scene, rays);
    for (const Side side : kSides) {
      for (size_t offset = 0; offset < (side == Side::kBegin ? 64u : 1u); ++offset) {
        // From one ray to all, so that every length of a last group is met.
        for (size_t count = 1; count <= rays.size(); count += offset == 0 ? 1 : 12) {
          const size_t first = rays.size() - count;
          const GuardedBuffer given(rays.data() + first, ray_bytes - first * sizeof(kiwami_ray),
                                    side, offset);
          const GuardedBuffer hits(count * sizeof(kiwami_hit), side, offset);
          const GuardedBuffer occluded(count, side, offset);
          auto* const from = reinterpret_cast<const kiwami_ray*>(given.data());
          auto* const to = reinterpret_cast<kiwami_hit*>(hits.data());
          ASSERT_EQ(kiwami_closest_hit(scene.get(), from, 0, to, 0, count, nullptr), KIWAMI_OK);
          ASSERT_EQ(kiwami_any_hit(scene.get(), from, 0, occluded.data(), 0, count, nullptr),
                    KIWAMI_OK);
          ASSERT_EQ(std::memcmp(hits.data(), expected.data() + first, count * sizeof(kiwami_hit)),
                    0);
          for (size_t i = 0; i < count; ++i) {
            ASSERT_EQ(occluded.data()[i],
                      expected[first + i].primitive_id != KIWAMI_INVALID_ID ? 1 : 0);
          }
        }
      }
    }
  }
}

TEST(GuardedBuffers, OfFieldsAreTouchedAtTheirElementsAlone) {
  const Triangles triangles = random_triangles(200, 5);
  const std::vector<kiwami_ray> rays = random_rays(37, 6);
  const size_t count = rays.size();
  for (const uint32_t isa : isas()) {
    const Device device = make_device(isa);
    const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
    const std::vector<kiwami_hit> expected = closest_hits(scene, rays);
    for (const Side side : kSides) {
      for (size_t offset = 0; offset < (side == Side::kBegin ? 64u : 1u); offset += 7) {
        std::vector<std::unique_ptr<GuardedBuffer>> buffers;
        const auto column = [&](size_t at) {
          std::vector<unsigned char> bytes(4 * count);
          for (size_t i = 0; i < count; ++i) {
            std::memcpy(bytes.data() + 4 * i, reinterpret_cast<const char*>(&rays[i]) + at, 4);
          }
          buffers.push_back(
              std::make_unique<GuardedBuffer>(bytes.data(), bytes.size(), side, offset));
          return kiwami_input_field{buffers.back()->data(), 4};
        };
        kiwami_ray_fields fields;
        kiwami_hit_fields answers;
        ASSERT_EQ(kiwami_ray_fields_init(&fields, sizeof fields), KIWAMI_OK);
        ASSERT_EQ(kiwami_hit_fields_init(&answers, sizeof answers), KIWAMI_OK);
        fields.origin_x = column(offsetof(kiwami_ray, origin_x));
        fields.origin_y = column(offsetof(kiwami_ray, origin_y));
        fields.origin_z = column(offsetof(kiwami_ray, origin_z));
        fields.direction_x = column(offsetof(kiwami_ray, direction_x));
        fields.direction_y = column(offsetof(kiwami_ray, direction_y));
        fields.direction_z = column(offsetof(kiwami_ray, direction_z));
        fields.tmax = column(offsetof(kiwami_ray, tmax));
        const GuardedBuffer t(4 * count, side, offset), ids(4 * count, side, offset);
        answers.t = {t.data(), 4};
        answers.primitive_id = {ids.data(), 4};
        ASSERT_EQ(kiwami_closest_hit_fields(scene.get(), &fields, &answers, count, nullptr),
                  KIWAMI_OK);
        for (size_t i = 0; i < count; ++i) {
          ASSERT_EQ(std::memcmp(t.data() + 4 * i, &expected[i].t, 4), 0) << i;
          ASSERT_EQ(std::memcmp(ids.data() + 4 * i, &expected[i].primitive_id, 4), 0) << i;
        }
      }
    }
  }
}

void expect_files_are_read_to_their_ends_alone(const Device& device, const Scene& scene) {
  const Bytes file = saved(scene);
  const GuardedBuffer target(file.size(), Side::kEnd, 0);
  kiwami_save_desc save = default_save();
  save.data = target.data();
  save.capacity = file.size();
  ASSERT_EQ(kiwami_scene_save(scene.get(), &save, nullptr), KIWAMI_OK) << last_error();
  EXPECT_EQ(std::memcmp(target.data(), file.data(), file.size()), 0);
  const std::vector<kiwami_ray> rays = random_rays(200, 6);
  for (const Side side : kSides) {
    for (size_t offset = 0; offset < (side == Side::kBegin ? 64u : 1u); ++offset) {
      const GuardedBuffer given(file.data(), file.size(), side, offset);
      kiwami_load_desc desc = default_load();
      desc.data = given.data();
      desc.size = file.size();
      // In place, too, where the address allows it.
      const bool is_aligned = reinterpret_cast<uintptr_t>(given.data()) % 64 == 0;
      desc.flags = is_aligned ? uint32_t{KIWAMI_LOAD_MAP} : 0;
      Scene loaded;
      ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
      ASSERT_TRUE(are_equal(closest_hits(loaded, rays), closest_hits(scene, rays)));
    }
  }
  // The first byte that lacks is noticed before it is read.
  for (size_t size = 0; size < file.size(); size += 1 + size / 16) {
    const GuardedBuffer cut(file.data(), size, Side::kEnd, 0);
    kiwami_load_desc desc = default_load();
    desc.data = cut.data();
    desc.size = size;
    Scene loaded;
    ASSERT_EQ(load(device, desc, loaded), KIWAMI_ERROR_INVALID_FILE) << size;
  }
}

TEST(GuardedBuffers, OfFilesAreReadToTheirEndsAlone) {
  const Device device = make_device();
  expect_files_are_read_to_their_ends_alone(device, make_mixed_scene(device, 100, 8));
  for (const uint32_t parts : {kiwami_tests::kRichShapes, kiwami_tests::kRichMotion,
                               kiwami_tests::kRichTwoLevel, kiwami_tests::kRichAll}) {
    expect_files_are_read_to_their_ends_alone(device, make_rich_scene(device, parts, 9, 8));
  }
}

}  // namespace
}  // namespace kiwami_api_tests

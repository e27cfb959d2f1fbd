// SPDX-License-Identifier: Apache-2.0
// Scenes and trees that are saved and come back.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <thread>

#include "api/io_support.h"

namespace kiwami_api_tests {
namespace {

constexpr uint32_t kAllFlags[] = {0, KIWAMI_LOAD_MAP, KIWAMI_LOAD_TRUSTED,
                                  KIWAMI_LOAD_MAP | KIWAMI_LOAD_TRUSTED};

/// What is the same of a scene and of what was saved of it.
void expect_same_scene_but_time(const Scene& a, const Scene& b) {
  const std::vector<kiwami_ray> rays = random_rays(2000, 7);
  EXPECT_TRUE(are_equal(closest_hits(a, rays), closest_hits(b, rays)));
  const kiwami_scene_info x = info_of(a), y = info_of(b);
  EXPECT_EQ(x.bvh_width, y.bvh_width);
  EXPECT_EQ(x.leaf_width, y.leaf_width);
  EXPECT_EQ(x.bvh_depth, y.bvh_depth);
  EXPECT_EQ(x.triangle_count, y.triangle_count);
  EXPECT_EQ(x.skipped_count, y.skipped_count);
  EXPECT_EQ(x.node_count, y.node_count);
  EXPECT_EQ(x.leaf_block_count, y.leaf_block_count);
  EXPECT_EQ(x.node_fill, y.node_fill);
  EXPECT_EQ(x.leaf_fill, y.leaf_fill);
  EXPECT_EQ(x.sah_cost, y.sah_cost);
  EXPECT_EQ(x.reference_count, y.reference_count);
  EXPECT_EQ(std::memcmp(x.bounds_min, y.bounds_min, sizeof x.bounds_min), 0);
  EXPECT_EQ(std::memcmp(x.bounds_max, y.bounds_max, sizeof x.bounds_max), 0);
}

void expect_same_scene(const Scene& a, const Scene& b) {
  expect_same_scene_but_time(a, b);
  EXPECT_EQ(info_of(a).build_seconds, info_of(b).build_seconds);
}

TEST(SceneFile, ComesBackTheSameFromMemoryAtEveryWidth) {
  const Device device = make_device();
  for (const uint32_t width : {4u, 8u, 16u}) {
    const Scene scene = make_mixed_scene(device, 500, width);
    const Bytes file = saved(scene);
    for (const uint32_t flags : kAllFlags) {
      AlignedCopy copy(file);
      kiwami_load_desc desc = default_load();
      desc.data = copy.data();
      desc.size = file.size();
      desc.flags = flags;
      Scene loaded;
      ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
      // What was copied does not need the file any more.
      if ((flags & KIWAMI_LOAD_MAP) == 0) std::memset(copy.data(), 0xEE, file.size());
      expect_same_scene(scene, loaded);
      EXPECT_EQ(kiwami_scene_validate(loaded.get()), KIWAMI_OK) << last_error();
      EXPECT_EQ(saved(loaded), file);
    }
  }
}

TEST(SceneFile, ComesBackTheSameFromAFile) {
  const TemporaryFolder folder;
  const std::string path = folder.path("scene.kiwami");
  const Device device = make_device();
  const Scene scene = make_mixed_scene(device, 500, 0);
  kiwami_save_desc save = default_save();
  save.path = path.c_str();
  uint64_t size = 0;
  ASSERT_EQ(kiwami_scene_save(scene.get(), &save, &size), KIWAMI_OK) << last_error();
  EXPECT_EQ(read_file(path), saved(scene));
  EXPECT_EQ(folder.names().size(), 1u);
  for (const uint32_t flags : kAllFlags) {
    kiwami_load_desc desc = default_load();
    desc.path = path.c_str();
    desc.flags = flags;
    Scene loaded;
    ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
    expect_same_scene(scene, loaded);
  }
}

/// Larger than what one task reads.
TEST(SceneFile, IsReadInSeveralPieces) {
  const TemporaryFolder folder;
  const std::string path = folder.path("scene.kiwami");
  const Device device = make_device();
  const Bytes file = saved(make_mixed_scene(device, 100000, 8));
  ASSERT_GT(file.size(), size_t{2} << 23);
  write_file(path, file);
  kiwami_load_desc desc = default_load();
  desc.path = path.c_str();
  Scene loaded;
  ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
  EXPECT_TRUE(saved(loaded) == file);
}

TEST(SceneFile, ComesBackTheSameThroughStreams) {
  struct Stream {
    Bytes bytes;
    size_t read = 0;
  } stream;
  const Device device = make_device();
  const Scene scene = make_mixed_scene(device, 3000, 8);
  kiwami_save_desc save = default_save();
  save.write = [](void* user, const void* data, size_t size) {
    const auto* from = static_cast<const unsigned char*>(data);
    Bytes& bytes = static_cast<Stream*>(user)->bytes;
    bytes.insert(bytes.end(), from, from + size);
    return int32_t{0};
  };
  save.write_user = &stream;
  ASSERT_EQ(kiwami_scene_save(scene.get(), &save, nullptr), KIWAMI_OK) << last_error();
  EXPECT_EQ(stream.bytes, saved(scene));

  kiwami_load_desc desc = default_load();
  desc.read = [](void* user, void* data, size_t size) {
    // In uneven bits, as from a socket.
    Stream& from = *static_cast<Stream*>(user);
    const size_t count = std::min({size, size_t{777}, from.bytes.size() - from.read});
    std::memcpy(data, from.bytes.data() + from.read, count);
    from.read += count;
    return static_cast<int64_t>(count);
  };
  desc.read_user = &stream;
  Scene loaded;
  ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
  expect_same_scene(scene, loaded);
}

TEST(SceneFile, IsTracedOnEveryIsa) {
  const Scene scene = make_mixed_scene(make_device(), 500, 16);
  const Bytes file = saved(scene);
  const std::vector<kiwami_ray> rays = random_rays(2000, 7);
  kiwami_device_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(kiwami_device_get_info(make_device().get(), &info), KIWAMI_OK);
  for (uint32_t isa = KIWAMI_ISA_SCALAR; isa <= KIWAMI_ISA_AVX512; ++isa) {
    if ((info.isa_available >> isa & 1) == 0) continue;
    Scene loaded;
    ASSERT_EQ(load(make_device(isa), file, 0, loaded), KIWAMI_OK) << last_error();
    EXPECT_TRUE(are_equal(closest_hits(scene, rays), closest_hits(loaded, rays)));
  }
}

TEST(SceneFile, OfNothingComesBackEmpty) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make_mesh(device, default_mesh()));
  Scene loaded;
  ASSERT_EQ(load(device, saved(scene), 0, loaded), KIWAMI_OK) << last_error();
  EXPECT_EQ(info_of(loaded).node_count, 0u);
  EXPECT_EQ(closest_hit(loaded, ray_along_z(0, 0)).primitive_id, KIWAMI_INVALID_ID);
}

TEST(SceneFile, HoldsTreesOfSpatialSplits) {
  const Device device = make_device();
  const Geometry mesh = make_mesh(device, random_triangles(2000, 5).desc());
  const Scene scene = make_scene(device);
  ASSERT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BUILDER,
                                       KIWAMI_BUILDER_SPATIAL_SPLIT),
            KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
  ASSERT_GT(info_of(scene).reference_count, info_of(scene).triangle_count);
  Scene loaded;
  ASSERT_EQ(load(device, saved(scene), 0, loaded), KIWAMI_OK) << last_error();
  expect_same_scene(scene, loaded);
  EXPECT_EQ(kiwami_scene_validate(loaded.get()), KIWAMI_OK) << last_error();
}

TEST(SceneFile, HoldsTheCompactLayout) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make_mesh(device, random_triangles(2000, 5).desc()));
  const Bytes fast = saved(scene);
  ASSERT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_LAYOUT, KIWAMI_LAYOUT_COMPACT),
            KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
  const Bytes compact = saved(scene);
  EXPECT_LT(compact.size() + 30 * 2000, fast.size());
  Scene loaded;
  ASSERT_EQ(load(device, compact, 0, loaded), KIWAMI_OK) << last_error();
  expect_same_scene(scene, loaded);
  EXPECT_EQ(kiwami_scene_validate(loaded.get()), KIWAMI_OK) << last_error();
}

TEST(SceneFile, CanBeChangedAndCommittedAgain) {
  const Device device = make_device();
  const Scene scene = make_mixed_scene(device, 500, 8);
  Scene loaded;
  ASSERT_EQ(load(device, saved(scene), 0, loaded), KIWAMI_OK) << last_error();
  // Its parameters came along, so that the same tree is made.
  ASSERT_EQ(kiwami_scene_commit(loaded.get()), KIWAMI_OK) << last_error();
  expect_same_scene_but_time(scene, loaded);
  // The lowest free numbers are those that were free.
  uint32_t id = 99;
  const Geometry more = make_mesh(device, square(0).desc());
  ASSERT_EQ(kiwami_scene_attach(loaded.get(), more.get(), &id), KIWAMI_OK) << last_error();
  EXPECT_EQ(id, 0u);
  ASSERT_EQ(kiwami_scene_detach(loaded.get(), 4), KIWAMI_OK) << last_error();
  ASSERT_EQ(kiwami_scene_commit(loaded.get()), KIWAMI_OK) << last_error();
  EXPECT_EQ(info_of(loaded).triangle_count, 1002u);
  EXPECT_EQ(kiwami_scene_validate(loaded.get()), KIWAMI_OK) << last_error();
}

TEST(SceneFile, OutlivesItsSceneAndCanBeMeasured) {
  const Device device = make_device();
  Scene loaded;
  ASSERT_EQ(load(device, saved(make_mixed_scene(device, 500, 8)), 0, loaded), KIWAMI_OK);
  const Bvh bvh = bvh_of(loaded);
  loaded.reset();
  kiwami_bvh_measures measures{};
  measures.struct_size = sizeof measures;
  EXPECT_EQ(kiwami_bvh_measure(bvh.get(), nullptr, &measures, nullptr, 0), KIWAMI_OK);
  EXPECT_GT(measures.epo, 0.0);
  EXPECT_EQ(kiwami_bvh_validate(bvh.get()), KIWAMI_OK) << last_error();
}

TEST(SceneFile, IsBuiltAnewForAnotherWidth) {
  const Device device = make_device();
  const Scene scene = make_mixed_scene(device, 500, 16);
  kiwami_load_desc desc = default_load();
  const Bytes file = saved(scene);
  desc.data = file.data();
  desc.size = file.size();
  desc.bvh_width = 4;
  Scene loaded;
  ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
  EXPECT_EQ(info_of(loaded).bvh_width, 4u);
  const std::vector<kiwami_ray> rays = random_rays(2000, 7);
  EXPECT_TRUE(are_equal(closest_hits(scene, rays), closest_hits(loaded, rays)));
  desc.bvh_width = 16;
  ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
  expect_same_scene(scene, loaded);
}

TEST(SceneFile, TellsWhatItIs) {
  const Device scalar = make_device(KIWAMI_ISA_SCALAR);
  const Scene scene = make_mixed_scene(scalar, 100, 16);
  const Bytes file = saved(scene);
  kiwami_load_desc desc = default_load();
  desc.data = file.data();
  desc.size = file.size();
  kiwami_file_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(kiwami_file_get_info(scalar.get(), &desc, &info), KIWAMI_OK) << last_error();
  EXPECT_EQ(info.kind, uint32_t{KIWAMI_FILE_SCENE});
  EXPECT_EQ(info.fit, uint32_t{KIWAMI_FIT_NATIVE});
  EXPECT_EQ(info.format_version, uint32_t{KIWAMI_FILE_FORMAT_VERSION});
  EXPECT_EQ(info.library_version, kiwami_version());
  EXPECT_EQ(info.bvh_width, 16u);
  EXPECT_EQ(info.section_count, 6u);
  EXPECT_EQ(info.file_bytes, file.size());
  EXPECT_EQ(info.triangle_count, info_of(scene).triangle_count);
  EXPECT_EQ(info.node_count, info_of(scene).node_count);
  kiwami_device_info built{};
  built.struct_size = sizeof built;
  ASSERT_EQ(kiwami_device_get_info(scalar.get(), &built), KIWAMI_OK);
  if ((built.isa_available >> KIWAMI_ISA_SSE & 1) == 0) return;
  ASSERT_EQ(kiwami_file_get_info(make_device(KIWAMI_ISA_SSE).get(), &desc, &info), KIWAMI_OK);
  EXPECT_EQ(info.fit, uint32_t{KIWAMI_FIT_SCALAR});
}

TEST(SceneFile, CountsItsMemory) {
  CountingAllocator allocator;
  kiwami_device_desc desc = default_device();
  allocator.install(desc);
  {
    const Device device = make_device(desc);
    const Scene scene = make_mixed_scene(device, 5000, 8);
    const Bytes file = saved(scene);
    Scene loaded;
    const size_t before = allocator.live_bytes;
    ASSERT_EQ(load(device, file, 0, loaded), KIWAMI_OK) << last_error();
    const size_t copied = allocator.live_bytes - before;
    EXPECT_GE(copied, file.size());
    EXPECT_LE(copied, file.size() + 16384);
    const double total = static_cast<double>(info_of(loaded).total_bytes);
    EXPECT_NEAR(total, static_cast<double>(info_of(scene).total_bytes), 0.05 * total);
    loaded.reset();
    EXPECT_EQ(allocator.live_bytes, before);
    AlignedCopy copy(file);
    kiwami_load_desc in_place = default_load();
    in_place.data = copy.data();
    in_place.size = file.size();
    in_place.flags = KIWAMI_LOAD_MAP;
    ASSERT_EQ(load(device, in_place, loaded), KIWAMI_OK) << last_error();
    EXPECT_LE(allocator.live_bytes - before, 16384u);
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
}

TEST(SceneFile, OldOneStaysWholeWhenItsReplacementFails) {
  const TemporaryFolder folder;
  const std::string path = folder.path("scene.kiwami");
  const Device device = make_device();
  const Bytes old = {'o', 'l', 'd'};
  write_file(path, old);
  ASSERT_EQ(chmod(path.c_str(), 0640), 0);
  CountingAllocator allocator;
  kiwami_device_desc failing_desc = default_device();
  allocator.install(failing_desc);
  const Device failing = make_device(failing_desc);
  const Scene scene = make_mixed_scene(failing, 300, 8);
  kiwami_save_desc save = default_save();
  save.path = path.c_str();
  size_t failures = 0;
  for (size_t later = 0;; ++later) {
    allocator.first_failure = allocator.calls + later;
    const kiwami_result result = kiwami_scene_save(scene.get(), &save, nullptr);
    if (result == KIWAMI_OK) break;
    ASSERT_EQ(result, KIWAMI_ERROR_OUT_OF_MEMORY);
    ASSERT_EQ(read_file(path), old);
    ASSERT_EQ(folder.names().size(), 1u);
    ++failures;
  }
  EXPECT_GT(failures, 2u);
  allocator.first_failure = std::numeric_limits<size_t>::max();
  EXPECT_EQ(read_file(path), saved(scene));
  struct stat status;
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777, 0640u);
}

TEST(SceneFile, StaysWholeForWhoHasMappedIt) {
  const TemporaryFolder folder;
  const std::string path = folder.path("scene.kiwami");
  const Device device = make_device();
  const Scene scene = make_mixed_scene(device, 500, 8);
  kiwami_save_desc save = default_save();
  save.path = path.c_str();
  ASSERT_EQ(kiwami_scene_save(scene.get(), &save, nullptr), KIWAMI_OK) << last_error();
  kiwami_load_desc desc = default_load();
  desc.path = path.c_str();
  desc.flags = KIWAMI_LOAD_MAP | KIWAMI_LOAD_TRUSTED;
  Scene mapped;
  ASSERT_EQ(load(device, desc, mapped), KIWAMI_OK) << last_error();
  const Scene other = make_mixed_scene(device, 5, 4);
  ASSERT_EQ(kiwami_scene_save(other.get(), &save, nullptr), KIWAMI_OK) << last_error();
  expect_same_scene(scene, mapped);
}

TEST(SceneFile, ReplacesWhatALinkLeadsTo) {
  const TemporaryFolder folder;
  const std::string path = folder.path("scene.kiwami"), link = folder.path("link");
  write_file(path, {1, 2, 3});
  std::filesystem::create_symlink("scene.kiwami", link);
  const Device device = make_device();
  const Scene scene = make_mixed_scene(device, 50, 8);
  kiwami_save_desc save = default_save();
  save.path = link.c_str();
  ASSERT_EQ(kiwami_scene_save(scene.get(), &save, nullptr), KIWAMI_OK) << last_error();
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_EQ(read_file(path), saved(scene));
}

TEST(SceneFile, IsSavedAndTracedByManyThreadsAtOnce) {
  const Device device = make_device();
  const Scene scene = make_mixed_scene(device, 500, 8);
  const Bytes file = saved(scene);
  const std::vector<kiwami_ray> rays = random_rays(500, 7);
  const std::vector<kiwami_hit> expected = closest_hits(scene, rays);
  std::vector<std::thread> threads;
  std::atomic<int> differences{0};
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      if (saved(scene) != file) ++differences;
      Scene loaded;
      if (load(device, file, 0, loaded) != KIWAMI_OK) ++differences;
      if (!are_equal(closest_hits(loaded, rays), expected)) ++differences;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(differences, 0);
}

}  // namespace
}  // namespace kiwami_api_tests

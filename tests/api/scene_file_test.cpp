// SPDX-License-Identifier: Apache-2.0
// Scenes of instances, shapes, moving meshes and micromaps that are saved and come back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "api/io_support.h"

namespace kiwami_api_tests {
namespace {

using namespace kiwami_tests;

constexpr uint32_t kKinds[] = {kRichInstances,
                               kRichShapes,
                               kRichMotion,
                               kRichMicromaps,
                               kRichTwoLevel,
                               kRichDisabled,
                               kRichMovingInstances,
                               kRichInstances | kRichMovingInstances | kRichRebraided,
                               kRichInstances | kRichRebraided | kRichShapes | kRichMotion,
                               kRichInstances | kRichTwoLevel | kRichMotion,
                               kRichAll};

constexpr uint32_t kAllFlags[] = {0, KIWAMI_LOAD_MAP, KIWAMI_LOAD_MAP | KIWAMI_LOAD_TRUSTED};

/// All that rays are told of a scene.
struct Answers {
  std::vector<kiwami_hit> closest, several;
  std::vector<uint32_t> paths, counts;
  std::vector<uint8_t> any;
  std::vector<uint64_t> offsets;

  explicit Answers(const Scene& scene) {
    std::vector<kiwami_ray> rays = random_rays(1500, 7);
    for (size_t i = 0; i < rays.size(); i += 2) rays[i].mask = 1u << (i / 2) % 8;
    const size_t count = rays.size();
    closest.resize(count);
    paths.resize(count * KIWAMI_MAX_INSTANCE_DEPTH);
    counts.resize(count);
    any.resize(count);
    several.resize(4 * count);
    offsets.resize(count + 1);
    kiwami_query query;
    EXPECT_EQ(kiwami_query_init(&query, sizeof query), KIWAMI_OK);
    query.instance_paths = paths.data();
    EXPECT_EQ(kiwami_closest_hit(scene.get(), rays.data(), 0, closest.data(), 0, count, &query),
              KIWAMI_OK)
        << last_error();
    EXPECT_EQ(kiwami_any_hit(scene.get(), rays.data(), 0, any.data(), 0, count, nullptr),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_count_hits(scene.get(), rays.data(), 0, counts.data(), 0, count, nullptr),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_multi_hit(scene.get(), rays.data(), 0, count, 4, several.data(),
                               several.size(), offsets.data(), nullptr),
              KIWAMI_OK);
  }

  bool operator==(const Answers& other) const {
    return are_equal(closest, other.closest) && paths == other.paths && counts == other.counts &&
           any == other.any && offsets == other.offsets && are_equal(several, other.several);
  }
};

/// Everything but what a file does not keep: the peak of the build.
void expect_same_info(const Scene& a, const Scene& b) {
  kiwami_scene_info x = info_of(a), y = info_of(b);
  EXPECT_NEAR(static_cast<double>(x.total_bytes), static_cast<double>(y.total_bytes),
              0.2 * static_cast<double>(x.total_bytes) + 65536);
  x.total_bytes = y.total_bytes = x.peak_build_bytes = y.peak_build_bytes = 0;
  EXPECT_EQ(std::memcmp(&x, &y, sizeof x), 0);
}

void expect_comes_back(const Scene& scene, const Bytes& file, uint32_t flags) {
  AlignedCopy copy(file);
  kiwami_load_desc desc = default_load();
  desc.data = copy.data();
  desc.size = file.size();
  desc.flags = flags;
  Scene loaded;
  const Device device = make_device();
  ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
  // What was copied does not need the file any more.
  if ((flags & KIWAMI_LOAD_MAP) == 0) std::memset(copy.data(), 0xEE, file.size());
  EXPECT_TRUE(Answers(scene) == Answers(loaded));
  expect_same_info(scene, loaded);
  EXPECT_EQ(kiwami_scene_validate(loaded.get()), KIWAMI_OK) << last_error();
  EXPECT_EQ(saved(loaded), file);
  // Both go on in the same way.
  ASSERT_EQ(kiwami_scene_commit(loaded.get()), KIWAMI_OK) << last_error();
  EXPECT_EQ(kiwami_scene_validate(loaded.get()), KIWAMI_OK) << last_error();
}

TEST(RichSceneFile, ComesBackTheSame) {
  const Device device = make_device();
  for (const uint32_t parts : kKinds) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      SCOPED_TRACE(std::to_string(parts) + ", " + std::to_string(width) + " wide");
      const Scene scene = make_rich_scene(device, parts, 40, width);
      ASSERT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
      const Bytes file = saved(scene);
      for (const uint32_t flags : kAllFlags) expect_comes_back(scene, file, flags);
    }
  }
}

/// The rays of the tests meet all that there is to be met.
TEST(RichSceneFile, HoldsWhatIsMet) {
  const Device device = make_device();
  const Answers answers(make_rich_scene(device, kRichAll & ~kRichDisabled, 100, 8));
  // Turning, resting and moving instances of the root.
  constexpr uint32_t kInstanceCount = 2 + 5 + 3;
  uint32_t met[2][8] = {}, by_instance[kInstanceCount] = {}, deepest = 0;
  for (size_t i = 0; i < answers.closest.size(); ++i) {
    const kiwami_hit& hit = answers.closest[i];
    if (hit.primitive_id == KIWAMI_INVALID_ID) continue;
    const bool is_inside = hit.instance_id != KIWAMI_INVALID_ID;
    ASSERT_LT(hit.geometry_id, 8u);
    ++met[is_inside ? 1 : 0][hit.geometry_id];
    if (!is_inside) continue;
    ASSERT_LT(answers.paths[8 * i], kInstanceCount);
    ++by_instance[answers.paths[8 * i]];
    if (answers.paths[8 * i + 1] != KIWAMI_INVALID_ID) ++deepest;
  }
  // Two meshes, spheres, discs, two of curves, two moving meshes.
  for (int place = 0; place < 2; ++place) {
    for (int kind = 0; kind < 8; ++kind) EXPECT_GT(met[place][kind], 0u) << place << " " << kind;
  }
  for (uint32_t i = 0; i < kInstanceCount; ++i) EXPECT_GT(by_instance[i], 0u) << i;
  EXPECT_GT(deepest, 0u);
}

/// After changes and new commits, a loaded scene is where the saved one is.
TEST(RichSceneFile, GoesOnAsTheSavedOne) {
  const Device device = make_device();
  for (const uint32_t parts : kKinds) {
    SCOPED_TRACE(parts);
    const Scene scene = make_rich_scene(device, parts, 30, 8);
    Scene loaded;
    ASSERT_EQ(load(device, saved(scene), 0, loaded), KIWAMI_OK) << last_error();
    for (const Scene* either : std::initializer_list<const Scene*>{&scene, &loaded}) {
      ASSERT_EQ(kiwami_scene_commit(either->get()), KIWAMI_OK) << last_error();
    }
    EXPECT_TRUE(Answers(scene) == Answers(loaded));
    for (const Scene* either : std::initializer_list<const Scene*>{&scene, &loaded}) {
      EXPECT_EQ(kiwami_scene_enable(either->get(), 1, 1), KIWAMI_OK) << last_error();
      ASSERT_EQ(kiwami_scene_detach(either->get(), 0), KIWAMI_OK) << last_error();
      ASSERT_EQ(kiwami_scene_commit(either->get()), KIWAMI_OK) << last_error();
    }
    EXPECT_TRUE(Answers(scene) == Answers(loaded));
  }
}

TEST(RichSceneFile, GoesThroughFilesAndStreams) {
  const TemporaryFolder folder;
  const std::string path = folder.path("scene.kiwami");
  const Device device = make_device();
  const Scene scene = make_rich_scene(device, kRichAll, 200, 0);
  const Answers answers(scene);
  Bytes stream;
  kiwami_save_desc save = default_save();
  save.path = path.c_str();
  ASSERT_EQ(kiwami_scene_save(scene.get(), &save, nullptr), KIWAMI_OK) << last_error();
  save.path = nullptr;
  save.write = [](void* user, const void* data, size_t size) {
    const auto* from = static_cast<const unsigned char*>(data);
    static_cast<Bytes*>(user)->insert(static_cast<Bytes*>(user)->end(), from, from + size);
    return int32_t{0};
  };
  save.write_user = &stream;
  ASSERT_EQ(kiwami_scene_save(scene.get(), &save, nullptr), KIWAMI_OK) << last_error();
  EXPECT_EQ(read_file(path), stream);
  for (const uint32_t flags : kAllFlags) {
    kiwami_load_desc desc = default_load();
    desc.path = path.c_str();
    desc.flags = flags;
    Scene loaded;
    ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
    EXPECT_TRUE(answers == Answers(loaded));
  }
}

TEST(RichSceneFile, IsMappedWithoutACopy) {
  CountingAllocator allocator;
  kiwami_device_desc device_desc = default_device();
  allocator.install(device_desc);
  {
    const Device device = make_device(device_desc);
    const Bytes file = saved(make_rich_scene(device, kRichAll, 4000, 8));
    AlignedCopy copy(file);
    kiwami_load_desc desc = default_load();
    desc.data = copy.data();
    desc.size = file.size();
    desc.flags = KIWAMI_LOAD_MAP | KIWAMI_LOAD_TRUSTED;
    const size_t before = allocator.live_bytes;
    allocator.peak_bytes = before;
    Scene loaded;
    ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
    EXPECT_GT(file.size(), size_t{5} << 20);
    EXPECT_LE(allocator.peak_bytes - before, 65536u);
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
}

TEST(RichSceneFile, HoldsASharedChildOnce) {
  const Device device = make_device();
  const Bytes file = saved(make_rich_scene(device, kRichInstances, 10, 4));
  const std::vector<ForgedSection> sections = sections_of(file);
  EXPECT_EQ(std::count_if(sections.begin(), sections.end(),
                          [](const ForgedSection& section) { return section.type == 1; }),
            3);
  Scene loaded;
  ASSERT_EQ(load(device, file, 0, loaded), KIWAMI_OK) << last_error();
  EXPECT_EQ(info_of(loaded).instance_depth, 2u);
  EXPECT_EQ(info_of(loaded).instance_count, 5u);
}

TEST(RichSceneFile, IsBuiltAnewForAnotherWidth) {
  const Device device = make_device();
  for (const uint32_t parts : kKinds) {
    const Scene scene = make_rich_scene(device, parts, 40, 16);
    const Bytes file = saved(scene);
    kiwami_load_desc desc = default_load();
    desc.data = file.data();
    desc.size = file.size();
    desc.bvh_width = 4;
    Scene loaded;
    ASSERT_EQ(load(device, desc, loaded), KIWAMI_OK) << last_error();
    EXPECT_EQ(info_of(loaded).bvh_width, 4u);
    EXPECT_TRUE(Answers(scene) == Answers(loaded)) << parts;
  }
}

/// What was committed counts, whatever has become of it since.
TEST(RichSceneFile, HoldsWhatWasCommitted) {
  const Device device = make_device();
  const Geometry mesh = make_mesh(device, random_triangles(30, 1).desc());
  const Scene child = make_scene(device, mesh);
  float matrix[12] = {1, 0, 0, 0.25f, 0, 1, 0, 0, 0, 0, 1, 0};
  kiwami_scene* const scenes[] = {child.get()};
  kiwami_instances_desc desc;
  ASSERT_EQ(kiwami_instances_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.flags = KIWAMI_INSTANCES_SHARE_BUFFERS;
  desc.scenes = scenes;
  desc.scene_count = 1;
  desc.transforms = matrix;
  desc.count = 1;
  kiwami_geometry* instances = nullptr;
  ASSERT_EQ(kiwami_instances_create(device.get(), &desc, &instances), KIWAMI_OK) << last_error();
  const Geometry owner(instances);
  const Scene scene = make_scene(device, owner);
  const Answers answers(scene);
  // The child commits something else, masks and matrices change, a geometry is taken away.
  const Geometry other = make_mesh(device, random_triangles(30, 2).desc());
  ASSERT_EQ(kiwami_scene_attach(child.get(), other.get(), nullptr), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(child.get()), KIWAMI_OK) << last_error();
  ASSERT_EQ(kiwami_geometry_set_mask(mesh.get(), 0), KIWAMI_OK);
  ASSERT_EQ(kiwami_geometry_set_mask(instances, 0), KIWAMI_OK);
  matrix[3] = -0.5f;
  ASSERT_EQ(kiwami_scene_detach(scene.get(), 0), KIWAMI_OK);
  ASSERT_TRUE(answers == Answers(scene));
  Scene loaded;
  ASSERT_EQ(load(device, saved(scene), 0, loaded), KIWAMI_OK) << last_error();
  EXPECT_TRUE(answers == Answers(loaded));
  EXPECT_EQ(kiwami_scene_validate(loaded.get()), KIWAMI_OK) << last_error();
}

TEST(RichSceneFile, HoldsAlsoEmptyGeometries) {
  const Device device = make_device();
  const Scene scene = make_rich_scene(device, kRichAll, 0, 8);
  Scene loaded;
  ASSERT_EQ(load(device, saved(scene), 0, loaded), KIWAMI_OK) << last_error();
  EXPECT_TRUE(Answers(scene) == Answers(loaded));
  uint32_t before = 0, after = 0;
  const Geometry mesh = make_mesh(device, square(0).desc());
  ASSERT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), &before), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_attach(loaded.get(), mesh.get(), &after), KIWAMI_OK);
  EXPECT_EQ(before, after);
}

}  // namespace
}  // namespace kiwami_api_tests

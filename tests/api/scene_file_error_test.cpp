// SPDX-License-Identifier: Apache-2.0
// Files of instances, shapes, moving meshes and micromaps that are damaged or forged, and scenes
// that files cannot hold.
#include <gtest/gtest.h>

#include <cstring>

#include "api/io_support.h"
#include "support/environment.h"
#include "support/exercise.h"
#include "support/figures.h"

namespace kiwami_api_tests {
namespace {

using namespace kiwami_tests;

constexpr uint32_t kKinds[] = {kRichInstances, kRichShapes,         kRichMotion,
                               kRichMicromaps, kRichTwoLevel,       kRichInstances | kRichRebraided,
                               kRichDisabled,  kRichMovingInstances};
/// Every bit of a byte in the long form; in the short form bits that lie so far apart.
uint64_t bit_step(uint64_t short_form) { return std::max<uint64_t>(1, short_form / ray_budget(1)); }

Bytes small_file(const Device& device, uint32_t parts) {
  return saved(make_rich_scene(device, parts, 2, 4));
}

/// Whether a byte belongs to the header, the directory or a section.
bool counts(const std::vector<ForgedSection>& sections, size_t at) {
  if (at < 64 + 48 * sections.size()) return true;
  for (const ForgedSection& section : sections) {
    if (at >= section.offset && at < section.offset + section.bytes) return true;
  }
  return false;
}

TEST(DamagedRichFile, IsRefusedWithEveryBitFlippedAndCutAtEveryLength) {
  const Device device = make_device();
  uint64_t flipped = 0, cut = 0;
  for (const uint32_t parts : kKinds) {
    const Bytes original = small_file(device, parts);
    const std::vector<ForgedSection> sections = sections_of(original);
    Bytes file = original;
    for (uint64_t bit = 0; bit < original.size() * 8; bit += bit_step(7)) {
      const auto at = static_cast<size_t>(bit / 8);
      if (!counts(sections, at)) continue;
      const auto mask = static_cast<unsigned char>(1u << bit % 8);
      file[at] = static_cast<unsigned char>(file[at] ^ mask);
      Scene scene;
      ASSERT_EQ(load(device, file, 0, scene), KIWAMI_ERROR_INVALID_FILE) << parts << " " << bit;
      file[at] = static_cast<unsigned char>(file[at] ^ mask);
      ++flipped;
    }
    for (size_t size = 0; size < original.size(); size += bit_step(3)) {
      Scene scene;
      const Bytes part(original.begin(), original.begin() + static_cast<std::ptrdiff_t>(size));
      ASSERT_EQ(load(device, part, 0, scene), KIWAMI_ERROR_INVALID_FILE) << size;
      ASSERT_EQ(load(device, part, KIWAMI_LOAD_TRUSTED, scene), KIWAMI_ERROR_INVALID_FILE) << size;
      ++cut;
    }
  }
  print_figure("bits flipped in files of each kind, one at a time: refused", flipped);
  print_figure("cuts of files of each kind: refused", cut);
}

TEST(ForgedRichFile, IsRefusedOrHarmless) {
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  CountingAllocator allocator;
  allocator.install(desc);
  uint64_t accepted = 0, refused = 0;
  {
    const Device device = make_device(desc);
    for (const uint32_t parts : kKinds) {
      const Bytes original = small_file(device, parts);
      const std::vector<ForgedSection> sections = sections_of(original);
      for (uint64_t bit = parts % 5; bit < original.size() * 8; bit += bit_step(13)) {
        const auto at = static_cast<size_t>(bit / 8);
        if (!counts(sections, at)) continue;
        Bytes file = original;
        file[at] = static_cast<unsigned char>(file[at] ^ 1u << bit % 8);
        forge_checksums(file);
        Scene scene;
        const kiwami_result result = load(device, file, 0, scene);
        if (result == KIWAMI_OK) {
          ++accepted;
          exercise(scene.get());
        } else {
          ++refused;
          ASSERT_TRUE(result == KIWAMI_ERROR_INVALID_FILE || result == KIWAMI_ERROR_TOO_LARGE)
              << parts << " " << bit << ": " << last_error();
        }
      }
    }
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
  EXPECT_GT(accepted, 0u);
  EXPECT_GT(refused, 0u);
  print_figure("bits of each kind flipped and signed again: refused", refused);
  print_figure("bits of each kind flipped and signed again: used without harm", accepted);
}

TEST(ForgedRichFile, TakesNoMoreMemoryThanItsSizeAllows) {
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  CountingAllocator allocator;
  allocator.install(desc);
  const Device device = make_device(desc);
  const Bytes original = small_file(device, kRichAll);
  // Every number outside of buffers and trees, one after the other, becomes huge.
  for (const ForgedSection& section : sections_of(original)) {
    if (section.type == 2 || section.type == 4) continue;
    for (uint64_t at = section.offset; at + 4 <= section.offset + section.bytes; at += 4) {
      Bytes file = original;
      std::memset(file.data() + at, 0x7F, 4);
      forge_checksums(file);
      const size_t before = allocator.live_bytes;
      allocator.peak_bytes = before;
      Scene scene;
      const kiwami_result result = load(device, file, 0, scene);
      ASSERT_LE(allocator.peak_bytes - before, 4 * file.size() + 65536) << at << " " << result;
    }
  }
}

/// The first section of a type in a file.
ForgedSection section_of(const Bytes& file, uint32_t type) {
  for (const ForgedSection& section : sections_of(file)) {
    if (section.type == type) return section;
  }
  ADD_FAILURE() << "no section of type " << type;
  return {};
}

void expect_refused(const Device& device, Bytes file, const char* sentence) {
  forge_checksums(file);
  Scene scene;
  EXPECT_EQ(load(device, file, 0, scene), KIWAMI_ERROR_INVALID_FILE);
  EXPECT_NE(last_error().find(sentence), std::string::npos) << last_error();
}

TEST(ForgedRichFile, OfScenesThatShowEachOtherIsRefused) {
  const Device device = make_device();
  const Bytes original = small_file(device, kRichInstances);
  const ForgedSection shown = section_of(original, 12);
  for (const uint32_t number : {0u, 3u, 0xFFFFFFFFu}) {
    Bytes file = original;
    std::memcpy(file.data() + shown.offset, &number, sizeof number);
    expect_refused(device, file, "scene 0 shows scene");
  }
  // The line of a directory that names its scene: those of a scene stand together, in order.
  for (const uint32_t number : {1u, 2u, 0xFFFFFFFFu}) {
    Bytes file = original;
    std::memcpy(file.data() + 64 + 12, &number, sizeof number);
    expect_refused(device, file, "is of scene");
  }
}

TEST(ForgedRichFile, OfInstancesThatRaysCannotEnterIsRefused) {
  const Device device = make_device();
  const Bytes original = small_file(device, kRichInstances | kRichRebraided);
  const float nan = std::numeric_limits<float>::quiet_NaN(), zero = 0.0f, huge = 1e38f;
  for (const float number : {nan, zero, huge}) {
    Bytes file = original;
    unsigned char* const record = file.data() + section_of(file, 14).offset;
    std::memcpy(record, &number, sizeof number);
    if (number == 0.0f) std::memset(record, 0, 48);
    expect_refused(device, file, "instance 0 shows scene");
  }
  const uint32_t many = 77;
  Bytes file = original;
  std::memcpy(file.data() + section_of(file, 14).offset + 48, &many, sizeof many);
  expect_refused(device, file, "instance 0 shows scene 77");
  // Starts: of an instance, a tree or a node that is not there.
  const ForgedSection starts = section_of(original, 16);
  ASSERT_GT(starts.bytes, 0u);
  for (const size_t at : {size_t{0}, size_t{4}}) {
    file = original;
    std::memcpy(file.data() + starts.offset + at, &many, sizeof many);
    expect_refused(device, file, "start 0 is of instance");
  }
  const uint64_t places[] = {uint64_t{1} << 48 | 0x7FFFFF80u, uint64_t{0xFFFF} << 48,
                             uint64_t{1} << 48 | 8, uint64_t{1} << 48 | 9};
  for (const uint64_t place : places) {
    file = original;
    const uint32_t triangles = 0;
    std::memcpy(file.data() + starts.offset + 4, &triangles, sizeof triangles);
    std::memcpy(file.data() + starts.offset + 8, &place, sizeof place);
    expect_refused(device, file, "start 0 is of instance");
  }
}

TEST(SaveError, NamesTheGeometryThatFilesCannotHold) {
  const Device device = make_device();
  kiwami_user_geometry_desc desc;
  ASSERT_EQ(kiwami_user_geometry_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.bounds = [](void*, uint32_t, uint32_t, float*) { return int32_t{0}; };
  desc.intersect = [](void*, kiwami_user_intersection*) { return int32_t{0}; };
  kiwami_geometry* user = nullptr;
  ASSERT_EQ(kiwami_user_geometry_create(device.get(), &desc, &user), KIWAMI_OK) << last_error();
  const Geometry owner(user);
  const Scene scene = make_scene(device, make_mesh(device, square(0).desc()));
  ASSERT_EQ(kiwami_scene_attach(scene.get(), user, nullptr), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
  const kiwami_save_desc save = default_save();
  EXPECT_EQ(kiwami_scene_save(scene.get(), &save, nullptr), KIWAMI_ERROR_INVALID_STATE);
  EXPECT_EQ(last_error(),
            "geometry 1 is a user geometry, expected none in a scene that is saved, nor in one "
            "that it shows: files cannot hold its functions");
}

TEST(SaveError, ReportsAFullDiskAndEveryWriteThatFailsOfEachKind) {
  struct Stream {
    size_t calls = 0, failing = 0;
  };
  const Device device = make_device();
  for (const uint32_t parts : kKinds) {
    const Scene scene = make_rich_scene(device, parts, 2, 4);
    kiwami_save_desc desc = default_save();
    if (std::filesystem::exists("/dev/full")) {
      desc.path = "/dev/full";
      EXPECT_EQ(kiwami_scene_save(scene.get(), &desc, nullptr), KIWAMI_ERROR_IO);
      EXPECT_EQ(last_error(), "cannot write '/dev/full': No space left on device");
      desc.path = nullptr;
    }
    desc.write = [](void* user, const void*, size_t) {
      Stream& stream = *static_cast<Stream*>(user);
      return int32_t{stream.calls++ == stream.failing ? 28 : 0};
    };
    kiwami_result result = KIWAMI_ERROR_CALLBACK;
    for (size_t failing = 0; result == KIWAMI_ERROR_CALLBACK; ++failing) {
      Stream stream{0, failing};
      desc.write_user = &stream;
      result = kiwami_scene_save(scene.get(), &desc, nullptr);
      ASSERT_EQ(stream.calls, result == KIWAMI_OK ? failing : failing + 1);
    }
    EXPECT_EQ(result, KIWAMI_OK) << last_error();
  }
}

TEST(SaveError, SaysThatASceneWasNeverCommitted) {
  const Device device = make_device();
  const Scene child = make_scene(device);
  const float matrix[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  kiwami_scene* const scenes[] = {child.get()};
  kiwami_instances_desc desc;
  ASSERT_EQ(kiwami_instances_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.scenes = scenes;
  desc.scene_count = desc.count = 1;
  desc.transforms = matrix;
  kiwami_geometry* instances = nullptr;
  ASSERT_EQ(kiwami_instances_create(device.get(), &desc, &instances), KIWAMI_OK) << last_error();
  const Geometry owner(instances);
  const Scene scene = make_scene(device, make_mesh(device, square(0).desc()));
  ASSERT_EQ(kiwami_scene_attach(scene.get(), instances, nullptr), KIWAMI_OK);
  const kiwami_save_desc save = default_save();
  EXPECT_EQ(kiwami_scene_save(scene.get(), &save, nullptr), KIWAMI_ERROR_INVALID_STATE);
  EXPECT_EQ(last_error(),
            "scene 0 of geometry 1 was never committed, expected a successful "
            "kiwami_scene_commit before it is saved");
}

/// Of saving and loading each kind, one run each.
TEST(RichSceneFile, EveryFailedAllocationIsAnErrorAndLeaksNothing) {
  size_t failures = 0;
  for (const uint32_t parts : kKinds) {
    CountingAllocator allocator;
    kiwami_device_desc desc = default_device();
    desc.thread_count = 1;
    allocator.install(desc);
    {
      const Device device = make_device(desc);
      const Scene scene = make_rich_scene(device, parts, 5, 4);
      const Bytes file = saved(scene);
      const size_t before = allocator.live_bytes;
      Bytes again(file.size());
      kiwami_save_desc save = default_save();
      save.data = again.data();
      save.capacity = again.size();
      const auto run = [&](auto&& call) {
        for (size_t later = 0;; ++later, ++failures) {
          allocator.first_failure = allocator.calls + later;
          const kiwami_result result = call();
          allocator.first_failure = std::numeric_limits<size_t>::max();
          ASSERT_EQ(allocator.live_bytes, before) << later;
          if (result == KIWAMI_OK) break;
          ASSERT_EQ(result, KIWAMI_ERROR_OUT_OF_MEMORY) << last_error();
        }
      };
      run([&] { return kiwami_scene_save(scene.get(), &save, nullptr); });
      EXPECT_EQ(again, file);
      run([&] {
        Scene loaded;
        return load(device, file, 0, loaded);
      });
    }
    EXPECT_EQ(allocator.live_bytes, 0u);
    EXPECT_EQ(allocator.mismatches, 0u);
  }
  print_figure("allocations failed in saving and loading of each kind, one run each", failures);
}

}  // namespace
}  // namespace kiwami_api_tests

// SPDX-License-Identifier: Apache-2.0
// Files that are damaged, forged or out of reach.
#include <gtest/gtest.h>

#include <cstring>

#include "api/io_support.h"
#include "support/environment.h"
#include "support/exercise.h"
#include "support/figures.h"
#include "support/random.h"

namespace kiwami_api_tests {
namespace {

using kiwami_tests::forge_checksums;
using kiwami_tests::ForgedSection;

/// A small scene's file with all kinds of sections. One triangle fits no block alone.
Bytes small_scene_file(const Device& device, uint32_t width) {
  return saved(make_mixed_scene(device, 20, width));
}

Bytes small_bvh_file(const Device& device) {
  const Triangles triangles = random_triangles(12, 2);
  const Geometry mesh = make_mesh(device, triangles.desc());
  kiwami_bvh_desc desc;
  EXPECT_EQ(kiwami_bvh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.geometry = mesh.get();
  kiwami_bvh* bvh = nullptr;
  EXPECT_EQ(kiwami_bvh_build(device.get(), &desc, &bvh), KIWAMI_OK) << last_error();
  return saved(Bvh(bvh));
}

/// Where nothing stands that means anything: between sections, and in sections that may be passed
/// over. A bit changed there changes nothing.
bool is_padding(const Bytes& original, size_t at) {
  if (at < 64) return false;
  const std::vector<ForgedSection> sections = kiwami_tests::sections_of(original);
  if (at < 64 + 48 * sections.size()) return false;
  for (const ForgedSection& section : sections) {
    if (at >= section.offset && at < section.offset + section.bytes) return false;
  }
  return true;
}

TEST(DamagedFile, IsRefusedWithEveryBitFlipped) {
  const Device device = make_device();
  const Bytes original = small_scene_file(device, 4);
  const uint64_t step = std::max<uint64_t>(1, 8 / kiwami_tests::case_budget(8));
  uint64_t flipped = 0;
  for (uint64_t bit = 0; bit < original.size() * 8; bit += step) {
    const auto at = static_cast<size_t>(bit / 8);
    if (is_padding(original, at)) continue;
    Bytes file = original;
    file[at] = static_cast<unsigned char>(file[at] ^ 1u << bit % 8);
    Scene scene;
    ASSERT_EQ(load(device, file, 0, scene), KIWAMI_ERROR_INVALID_FILE) << bit;
    ++flipped;
  }
  kiwami_tests::print_figure("bits flipped in a file, one at a time: refused", flipped);
}

TEST(DamagedFile, IsRefusedCutAtEveryLength) {
  const Device device = make_device();
  const Bytes scene_file = small_scene_file(device, 4), bvh_file = small_bvh_file(device);
  for (size_t size = 0; size < scene_file.size(); ++size) {
    Scene scene;
    const Bytes file(scene_file.begin(), scene_file.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_EQ(load(device, file, 0, scene), KIWAMI_ERROR_INVALID_FILE) << size;
    ASSERT_EQ(load(device, file, KIWAMI_LOAD_TRUSTED, scene), KIWAMI_ERROR_INVALID_FILE) << size;
  }
  for (size_t size = 0; size < bvh_file.size(); ++size) {
    Bvh bvh;
    const Bytes file(bvh_file.begin(), bvh_file.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_EQ(load(device, file, 0, bvh), KIWAMI_ERROR_INVALID_FILE) << size;
  }
  kiwami_tests::print_figure("cuts of a file: refused", scene_file.size() + bvh_file.size());
}

/// Every bit flipped, and every checksum made right again.
template <typename Handle>
void use_with_every_bit_forged(const Bytes& original) {
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  CountingAllocator allocator;
  allocator.install(desc);
  {
    const Device device = make_device(desc);
    const uint64_t step = std::max<uint64_t>(1, 8 / kiwami_tests::case_budget(8));
    uint64_t accepted = 0, refused = 0;
    for (uint64_t bit = 0; bit < original.size() * 8; bit += step) {
      const auto at = static_cast<size_t>(bit / 8);
      if (is_padding(original, at)) continue;
      Bytes file = original;
      file[at] = static_cast<unsigned char>(file[at] ^ 1u << bit % 8);
      forge_checksums(file);
      Handle handle;
      const kiwami_result result = load(device, file, 0, handle);
      if (result == KIWAMI_OK) {
        ++accepted;
        kiwami_tests::exercise(handle.get());
      } else {
        ++refused;
        ASSERT_TRUE(result == KIWAMI_ERROR_INVALID_FILE || result == KIWAMI_ERROR_TOO_LARGE)
            << bit << ": " << last_error();
      }
    }
    EXPECT_GT(accepted, 0u);
    EXPECT_GT(refused, 0u);
    kiwami_tests::print_figure("bits flipped and signed again: refused", refused);
    kiwami_tests::print_figure("bits flipped and signed again: used without harm", accepted);
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
}

TEST(ForgedFile, OfASceneIsRefusedOrHarmless) {
  for (const uint32_t width : {4u, 8u}) {
    use_with_every_bit_forged<Scene>(small_scene_file(make_device(), width));
  }
}

TEST(ForgedFile, OfATreeIsRefusedOrHarmless) {
  use_with_every_bit_forged<Bvh>(small_bvh_file(make_device()));
}

/// The tree of a scene whose nodes are changed by hand.
struct ForgedTree {
  Bytes file;
  size_t tree_at = 0;

  explicit ForgedTree(const Bytes& from) : file(from) {
    for (const ForgedSection& section : kiwami_tests::sections_of(file)) {
      if (section.type == 2) tree_at = static_cast<size_t>(section.offset);
    }
  }
  /// Of the root's slot: node 0 of width 4.
  uint64_t child(size_t slot) const {
    uint64_t bits;
    std::memcpy(&bits, file.data() + tree_at + 96 + 8 * slot, sizeof bits);
    return bits;
  }
  void set_child(size_t slot, uint64_t bits) {
    std::memcpy(file.data() + tree_at + 96 + 8 * slot, &bits, sizeof bits);
    forge_checksums(file);
  }
};

TEST(ForgedFile, WithReferencesThatKernelsCannotFollowIsRefused) {
  const Device device = make_device();
  const ForgedTree tree(small_scene_file(device, 4));
  const uint64_t mask = tree.child(0) & ~((uint64_t{1} << 48) - 1);
  const struct {
    const char* name;
    uint64_t bits;
    const char* sentence;
  } cases[] = {
      {"to itself", mask, "with mask"},
      {"beyond the end", mask | 0xFFFFFF80u, "refers to byte"},
      {"into a node", mask | 64, "refers to byte"},
      {"to a leaf among nodes", mask | 128 | 1, "refers to byte"},
      {"to what another slot owns", tree.child(1), "with mask"},
      {"to nothing", tree.child(0) & ((uint64_t{1} << 48) - 1), "with mask 0x0"},
      {"with a mask too wide", tree.child(0) | uint64_t{0x10} << 48, "with mask"},
  };
  for (const auto& wrong : cases) {
    SCOPED_TRACE(wrong.name);
    ForgedTree forged(tree.file);
    forged.set_child(0, wrong.bits);
    Scene scene;
    EXPECT_EQ(load(device, forged.file, 0, scene), KIWAMI_ERROR_INVALID_FILE);
    EXPECT_NE(last_error().find(wrong.sentence), std::string::npos) << last_error();
  }
}

TEST(ForgedFile, TakesNoMoreMemoryThanItsSizeAllows) {
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  CountingAllocator allocator;
  allocator.install(desc);
  const Device device = make_device(desc);
  const Bytes original = small_scene_file(device, 4);
  // Every number of the records, one after the other, becomes huge.
  for (const ForgedSection& section : kiwami_tests::sections_of(original)) {
    if (section.type != 1 && section.type != 3) continue;
    for (uint64_t at = section.offset; at + 4 <= section.offset + section.bytes; at += 4) {
      Bytes file = original;
      std::memset(file.data() + at, 0x7F, 4);
      forge_checksums(file);
      const size_t before = allocator.live_bytes;
      allocator.peak_bytes = before;
      Scene scene;
      const kiwami_result result = load(device, file, 0, scene);
      EXPECT_LE(allocator.peak_bytes - before, 2 * file.size() + 65536) << at << " " << result;
    }
  }
}

TEST(LoadError, NamesWhatIsWrongWithTheArguments) {
  const Device device = make_device();
  const Bytes file = small_scene_file(device, 4);
  Scene scene;
  kiwami_load_desc desc = default_load();
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "desc has 0 of path, read and data, expected one of them");
  desc.data = file.data();
  desc.path = "x";
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "desc has 2 of path, read and data, expected one of them");
  desc.path = nullptr;
  desc.flags = 8;
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "desc.flags is 0x8, expected KIWAMI_LOAD_* bits");
  desc.flags = 0;
  desc.bvh_width = 5;
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "desc.bvh_width is 5, expected 0, 4, 8 or 16");
  desc.bvh_width = 0;
  desc.size = UINT64_MAX;
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_INVALID_ARGUMENT);
  desc = default_load();
  desc.path = "x";
  desc.size = 5;
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "desc.size is 5 without desc.data, expected 0");
  desc.size = 0;
  desc.path = "/nowhere/at/all";
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_IO);
  EXPECT_EQ(last_error(), "cannot open '/nowhere/at/all': No such file or directory");
  desc.path = "/";
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_IO);
  EXPECT_EQ(last_error(), "'/' is a folder, expected a file");
  EXPECT_EQ(kiwami_scene_load(nullptr, &desc, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_scene_load(device.get(), &desc, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  kiwami_scene* none = nullptr;
  EXPECT_EQ(kiwami_scene_load(device.get(), nullptr, &none), KIWAMI_ERROR_INVALID_ARGUMENT);
}

TEST(LoadError, AsksForAlignedMemoryToUseInPlace) {
  const Device device = make_device();
  Bytes file(1000);
  kiwami_load_desc desc = default_load();
  // One of two neighbours is odd.
  desc.data = file.data() + 1 + reinterpret_cast<uintptr_t>(file.data()) % 2;
  desc.size = 900;
  desc.flags = KIWAMI_LOAD_MAP;
  Scene scene;
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("expected a multiple of 64"), std::string::npos) << last_error();
}

TEST(LoadError, ReportsAStreamThatFails) {
  const Device device = make_device();
  Scene scene;
  kiwami_load_desc desc = default_load();
  desc.read = [](void*, void*, size_t) { return int64_t{-5}; };
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_CALLBACK);
  EXPECT_EQ(last_error().rfind("read returned -5 for ", 0), 0u) << last_error();
  desc.read = [](void*, void*, size_t size) { return static_cast<int64_t>(size) + 1; };
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_CALLBACK);
  desc.read = [](void*, void*, size_t) { return int64_t{0}; };
  EXPECT_EQ(load(device, desc, scene), KIWAMI_ERROR_INVALID_FILE);
  EXPECT_EQ(last_error(), "the file has 0 bytes, expected at least the 64 of a header");
}

TEST(LoadError, SaysThatANewerLibraryWroteIt) {
  const Device device = make_device();
  Bytes file = small_scene_file(device, 4);
  file[12] = 3;  // the format version
  forge_checksums(file);
  Scene scene;
  EXPECT_EQ(load(device, file, 0, scene), KIWAMI_ERROR_INVALID_FILE);
  EXPECT_EQ(last_error(), "the file is of format version 3, expected 2: a newer library wrote it");
  kiwami_load_desc desc = default_load();
  desc.data = file.data();
  desc.size = file.size();
  kiwami_file_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(kiwami_file_get_info(device.get(), &desc, &info), KIWAMI_OK) << last_error();
  EXPECT_EQ(info.fit, uint32_t{KIWAMI_FIT_NONE});
  file[12] = 1;
  forge_checksums(file);
  EXPECT_EQ(load(device, file, 0, scene), KIWAMI_ERROR_INVALID_FILE);
  EXPECT_EQ(last_error(), "the file is of format version 1, expected 2: an older library wrote it");
  // A section that must be known is not; one that may be passed over is.
  file = small_scene_file(device, 4);
  const size_t tree_records = 64 + 3 * 48;
  for (const bool is_required : {true, false}) {
    Bytes newer = file;
    newer[tree_records] = 200;
    newer[tree_records + 8] = is_required ? 1 : 0;
    forge_checksums(newer);
    EXPECT_EQ(load(device, newer, 0, scene), KIWAMI_ERROR_INVALID_FILE);
    EXPECT_EQ(last_error(), is_required ? "section 3 is of type 200 and version 1, which this "
                                          "library does not know: a newer one wrote the file"
                                        : "scene 0 has no tree, expected one at least");
  }
}

TEST(SaveError, NamesWhatIsWrongWithTheArguments) {
  const Device device = make_device();
  const Scene scene = make_mixed_scene(device, 10, 4);
  unsigned char few[10];
  uint64_t size = 0;
  kiwami_save_desc desc = default_save();
  desc.data = few;
  desc.capacity = sizeof few;
  EXPECT_EQ(kiwami_scene_save(scene.get(), &desc, &size), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "desc.capacity is 10, expected at least " + std::to_string(size));
  EXPECT_EQ(size, saved(scene).size());
  desc.path = "x";
  EXPECT_EQ(kiwami_scene_save(scene.get(), &desc, &size), KIWAMI_ERROR_INVALID_ARGUMENT);
  desc = default_save();
  desc.capacity = 3;
  EXPECT_EQ(kiwami_scene_save(scene.get(), &desc, &size), KIWAMI_ERROR_INVALID_ARGUMENT);
  desc = default_save();
  desc.flags = 1;
  EXPECT_EQ(kiwami_scene_save(scene.get(), &desc, &size), KIWAMI_ERROR_INVALID_ARGUMENT);
  desc = default_save();
  EXPECT_EQ(kiwami_scene_save(nullptr, &desc, &size), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_scene_save(scene.get(), nullptr, &size), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_scene_save(make_scene(device).get(), &desc, &size), KIWAMI_ERROR_INVALID_STATE);
}

TEST(SaveError, ReportsAFullDiskAndAFolderThatIsNone) {
  const Device device = make_device();
  const Scene scene = make_mixed_scene(device, 10, 4);
  kiwami_save_desc desc = default_save();
  desc.path = "/dev/full";
  if (std::filesystem::exists(desc.path)) {
    EXPECT_EQ(kiwami_scene_save(scene.get(), &desc, nullptr), KIWAMI_ERROR_IO);
    EXPECT_EQ(last_error(), "cannot write '/dev/full': No space left on device");
    EXPECT_TRUE(std::filesystem::is_character_file(desc.path));
  }
  desc.path = "/nowhere/at/all";
  EXPECT_EQ(kiwami_scene_save(scene.get(), &desc, nullptr), KIWAMI_ERROR_IO);
  EXPECT_EQ(last_error(), "cannot make a file beside '/nowhere/at/all': No such file or directory");
  const std::string long_path(5000, 'x');
  desc.path = long_path.c_str();
  EXPECT_EQ(kiwami_scene_save(scene.get(), &desc, nullptr), KIWAMI_ERROR_IO);
}

TEST(SaveError, ReportsEveryWriteThatFails) {
  struct Stream {
    size_t calls = 0, failing = 0;
  };
  const Device device = make_device();
  const Scene scene = make_mixed_scene(device, 10, 4);
  kiwami_save_desc desc = default_save();
  desc.write = [](void* user, const void*, size_t) {
    Stream& stream = *static_cast<Stream*>(user);
    return int32_t{stream.calls++ == stream.failing ? 28 : 0};
  };
  size_t failures = 0;
  for (;; ++failures) {
    Stream stream{0, failures};
    desc.write_user = &stream;
    const kiwami_result result = kiwami_scene_save(scene.get(), &desc, nullptr);
    if (result == KIWAMI_OK) break;
    ASSERT_EQ(result, KIWAMI_ERROR_CALLBACK);
    ASSERT_EQ(last_error().rfind("write returned 28 for ", 0), 0u) << last_error();
    ASSERT_EQ(stream.calls, failures + 1) << "written to after a failure";
  }
  EXPECT_GT(failures, 6u);
}

}  // namespace
}  // namespace kiwami_api_tests

// SPDX-License-Identifier: Apache-2.0
// Sets of lights that are saved and come back, and files of them that are damaged or forged.
#include <gtest/gtest.h>

#include <cstring>

#include "api/io_support.h"
#include "support/environment.h"
#include "support/exercise.h"
#include "support/figures.h"
#include "support/random.h"
#include "support/rich_lights.h"

namespace kiwami_api_tests {
namespace {

using namespace kiwami_tests;

struct ReleaseLights {
  void operator()(kiwami_light_tree* tree) const { kiwami_light_tree_release(tree); }
};
using Lights = std::unique_ptr<kiwami_light_tree, ReleaseLights>;

Lights make_lights(const Device& device, const RichLights& what) {
  kiwami_light_tree* tree = nullptr;
  EXPECT_EQ(make_rich_lights(device.get(), what, &tree), KIWAMI_OK) << last_error();
  return Lights(tree);
}

kiwami_light_tree_info info_of(const Lights& lights) {
  kiwami_light_tree_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(kiwami_light_tree_get_info(lights.get(), &info), KIWAMI_OK) << last_error();
  return info;
}

Bytes saved(const Lights& lights) {
  kiwami_save_desc desc = default_save();
  uint64_t size = 0;
  EXPECT_EQ(kiwami_light_tree_save(lights.get(), &desc, &size), KIWAMI_OK) << last_error();
  Bytes bytes(size);
  desc.data = bytes.data();
  desc.capacity = size;
  EXPECT_EQ(kiwami_light_tree_save(lights.get(), &desc, &size), KIWAMI_OK) << last_error();
  return bytes;
}

kiwami_result load(const Device& device, const Bytes& file, uint32_t flags, Lights& lights) {
  static const unsigned char kNothing = 0;
  kiwami_load_desc desc = default_load();
  desc.data = file.empty() ? &kNothing : file.data();
  desc.size = file.size();
  desc.flags = flags;
  kiwami_light_tree* tree = nullptr;
  const kiwami_result result = kiwami_light_tree_load(device.get(), &desc, &tree);
  EXPECT_EQ(tree != nullptr, result == KIWAMI_OK);
  lights.reset(tree);
  return result;
}

/// What receivers are told by every method.
std::vector<kiwami_light_choice> choices_of(const Lights& lights) {
  Random random(5);
  std::vector<kiwami_light_receiver> receivers(100);
  for (kiwami_light_receiver& receiver : receivers) {
    receiver = {};
    for (float& coordinate : receiver.position) coordinate = 3 * random.symmetric();
    for (float& coordinate : receiver.normal) coordinate = random.symmetric();
    receiver.link_mask = random.one_in(3) ? 1 : ~uint64_t{0};
    receiver.random = static_cast<double>(random.unit());
  }
  std::vector<kiwami_light_choice> all;
  for (uint32_t method = KIWAMI_LIGHT_METHOD_TREE; method <= KIWAMI_LIGHT_METHOD_ROULETTE;
       ++method) {
    kiwami_light_query query;
    EXPECT_EQ(kiwami_light_query_init(&query, sizeof query), KIWAMI_OK);
    query.method = method;
    query.max_choices = method <= KIWAMI_LIGHT_METHOD_POWER ? 1 : 4;
    const size_t before = all.size();
    all.resize(before + receivers.size() * query.max_choices);
    EXPECT_EQ(kiwami_light_sample(lights.get(), receivers.data(), 0, &all[before], 0,
                                  receivers.size(), &query),
              KIWAMI_OK)
        << last_error();
  }
  return all;
}

bool are_equal(const std::vector<kiwami_light_choice>& a,
               const std::vector<kiwami_light_choice>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

TEST(LightFile, ComesBackTheSame) {
  const Device device = make_device();
  for (const uint32_t width : {2u, 4u, 8u, 16u}) {
    for (const uint32_t size : {0u, 1u, 2u, 40u}) {
      for (const bool has_instances : {false, true}) {
        SCOPED_TRACE(std::to_string(width) + " wide, " + std::to_string(size));
        const Lights lights = make_lights(device, {width, size, has_instances});
        const Bytes file = saved(lights);
        for (const uint32_t flags : {0u, uint32_t{KIWAMI_LOAD_TRUSTED}}) {
          Lights loaded;
          ASSERT_EQ(load(device, file, flags, loaded), KIWAMI_OK) << last_error();
          EXPECT_TRUE(are_equal(choices_of(lights), choices_of(loaded)));
          EXPECT_EQ(saved(loaded), file);
          const kiwami_light_tree_info a = info_of(lights), b = info_of(loaded);
          EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0);
        }
      }
    }
  }
}

TEST(LightFile, IsMappedFromAPath) {
  const TemporaryFolder folder;
  const std::string path = folder.path("lights.kiwami");
  const Device device = make_device();
  const Lights lights = make_lights(device, {8, 100, true});
  kiwami_save_desc save = default_save();
  save.path = path.c_str();
  ASSERT_EQ(kiwami_light_tree_save(lights.get(), &save, nullptr), KIWAMI_OK) << last_error();
  kiwami_load_desc desc = default_load();
  desc.path = path.c_str();
  desc.flags = KIWAMI_LOAD_MAP;
  kiwami_light_tree* tree = nullptr;
  ASSERT_EQ(kiwami_light_tree_load(device.get(), &desc, &tree), KIWAMI_OK) << last_error();
  EXPECT_TRUE(are_equal(choices_of(lights), choices_of(Lights(tree))));
  kiwami_file_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(kiwami_file_get_info(device.get(), &desc, &info), KIWAMI_OK) << last_error();
  EXPECT_EQ(info.kind, uint32_t{KIWAMI_FILE_LIGHTS});
  EXPECT_EQ(info.bvh_width, 8u);
  EXPECT_EQ(info.triangle_count, 900u);
  EXPECT_EQ(info.node_count, info_of(lights).node_count);
}

TEST(LightFile, GoesOnAsTheSavedOne) {
  const Device device = make_device();
  const Lights lights = make_lights(device, {4, 30, true});
  Lights loaded;
  ASSERT_EQ(load(device, saved(lights), 0, loaded), KIWAMI_OK) << last_error();
  const std::vector<float> powers(50, 2.5f);
  for (const auto call : {kiwami_light_tree_refit, kiwami_light_tree_commit}) {
    for (const Lights* either : std::initializer_list<const Lights*>{&lights, &loaded}) {
      ASSERT_EQ(kiwami_light_tree_set_powers(either->get(), 5, powers.data(), 0, powers.size()),
                KIWAMI_OK);
      ASSERT_EQ(call(either->get()), KIWAMI_OK) << last_error();
    }
    EXPECT_TRUE(are_equal(choices_of(lights), choices_of(loaded)));
  }
  // After a refit the shape is not that of a build.
  EXPECT_EQ(load(device, saved(lights), 0, loaded), KIWAMI_OK) << last_error();
  EXPECT_TRUE(are_equal(choices_of(lights), choices_of(loaded)));
}

TEST(LightFile, HoldsWhatWasCommitted) {
  const Device device = make_device();
  const Lights lights = make_lights(device, {4, 10, true});
  const std::vector<kiwami_light_choice> choices = choices_of(lights);
  const Bytes before = saved(lights);
  const float power = 1000.0f;
  ASSERT_EQ(kiwami_light_tree_set_powers(lights.get(), 3, &power, 0, 1), KIWAMI_OK);
  EXPECT_EQ(saved(lights), before);
  EXPECT_TRUE(are_equal(choices_of(lights), choices));
  ASSERT_EQ(kiwami_light_tree_refit(lights.get()), KIWAMI_OK);
  EXPECT_NE(saved(lights), before);
}

TEST(LightFile, HoldsASharedTreeOnce) {
  const Device device = make_device();
  const std::vector<ForgedSection> sections = sections_of(saved(make_lights(device, {4, 5, true})));
  size_t sets = 0;
  for (const ForgedSection& section : sections) sets += section.type == 18 ? 1 : 0;
  EXPECT_EQ(sets, 3u);
}

TEST(LightFile, NamesWhatIsWrongWithTheArguments) {
  const Device device = make_device();
  kiwami_light_tree* none = nullptr;
  ASSERT_EQ(kiwami_light_tree_create(device.get(), nullptr, &none), KIWAMI_OK);
  const Lights owner(none);
  const kiwami_save_desc save = default_save();
  EXPECT_EQ(kiwami_light_tree_save(none, &save, nullptr), KIWAMI_ERROR_INVALID_STATE);
  EXPECT_EQ(last_error(),
            "tree was never committed, expected a successful kiwami_light_tree_commit before");
  EXPECT_EQ(kiwami_light_tree_save(nullptr, &save, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  const Lights lights = make_lights(device, {4, 3, false});
  EXPECT_EQ(kiwami_light_tree_save(lights.get(), nullptr, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  const Bytes file = saved(lights);
  kiwami_load_desc desc = default_load();
  desc.data = file.data();
  desc.size = file.size();
  desc.bvh_width = 8;
  kiwami_light_tree* tree = nullptr;
  EXPECT_EQ(kiwami_light_tree_load(device.get(), &desc, &tree), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "desc.bvh_width is 8, expected 0 for a set of lights");
  EXPECT_EQ(kiwami_light_tree_load(device.get(), &desc, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_light_tree_load(nullptr, &desc, &tree), KIWAMI_ERROR_INVALID_ARGUMENT);
  Scene scene;
  EXPECT_EQ(load(device, file, 0, scene), KIWAMI_ERROR_INVALID_FILE);
  EXPECT_EQ(last_error(), "the file holds a set of lights, expected a scene");
}

/// In the short form not every bit, but one of so many.
uint64_t bit_step(uint64_t short_form) { return std::max<uint64_t>(1, short_form / ray_budget(1)); }

bool counts(const std::vector<ForgedSection>& sections, size_t at) {
  if (at < 64 + 48 * sections.size()) return true;
  for (const ForgedSection& section : sections) {
    if (at >= section.offset && at < section.offset + section.bytes) return true;
  }
  return false;
}

TEST(DamagedLightFile, IsRefusedWithEveryBitFlippedAndCutAtEveryLength) {
  const Device device = make_device();
  const Bytes original = saved(make_lights(device, {2, 2, true}));
  const std::vector<ForgedSection> sections = sections_of(original);
  uint64_t flipped = 0;
  for (uint64_t bit = 0; bit < original.size() * 8; bit += bit_step(5)) {
    const auto at = static_cast<size_t>(bit / 8);
    if (!counts(sections, at)) continue;
    Bytes file = original;
    file[at] = static_cast<unsigned char>(file[at] ^ 1u << bit % 8);
    Lights lights;
    ASSERT_EQ(load(device, file, 0, lights), KIWAMI_ERROR_INVALID_FILE) << bit;
    ++flipped;
  }
  for (size_t size = 0; size < original.size(); ++size) {
    const Bytes file(original.begin(), original.begin() + static_cast<std::ptrdiff_t>(size));
    Lights lights;
    ASSERT_EQ(load(device, file, 0, lights), KIWAMI_ERROR_INVALID_FILE) << size;
    ASSERT_EQ(load(device, file, KIWAMI_LOAD_TRUSTED, lights), KIWAMI_ERROR_INVALID_FILE) << size;
  }
  print_figure("bits flipped in a file of lights, one at a time: refused", flipped);
  print_figure("cuts of a file of lights: refused", original.size());
}

TEST(ForgedLightFile, IsRefusedOrHarmless) {
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  CountingAllocator allocator;
  allocator.install(desc);
  uint64_t accepted = 0, refused = 0;
  {
    const Device device = make_device(desc);
    const Bytes original = saved(make_lights(device, {2, 2, true}));
    const std::vector<ForgedSection> sections = sections_of(original);
    for (uint64_t bit = 0; bit < original.size() * 8; bit += bit_step(17)) {
      const auto at = static_cast<size_t>(bit / 8);
      if (!counts(sections, at)) continue;
      Bytes file = original;
      file[at] = static_cast<unsigned char>(file[at] ^ 1u << bit % 8);
      forge_checksums(file);
      const size_t before = allocator.live_bytes;
      allocator.peak_bytes = before;
      Lights lights;
      const kiwami_result result = load(device, file, 0, lights);
      ASSERT_LE(allocator.peak_bytes - before, 16 * file.size() + 65536) << bit;
      if (result == KIWAMI_OK) {
        ++accepted;
        exercise(lights.get());
      } else {
        ++refused;
        ASSERT_EQ(result, KIWAMI_ERROR_INVALID_FILE) << bit << ": " << last_error();
      }
    }
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
  EXPECT_GT(accepted, 0u);
  EXPECT_GT(refused, 0u);
  print_figure("bits of lights flipped and signed again: refused", refused);
  print_figure("bits of lights flipped and signed again: used without harm", accepted);
}

TEST(ForgedLightFile, OfAShapeThatIsNoTreeIsRefused) {
  const Device device = make_device();
  const Bytes original = saved(make_lights(device, {4, 3, false}));
  for (const ForgedSection& section : sections_of(original)) {
    if (section.type != 22 && section.type != 23) continue;
    // Every word becomes each small number and some others.
    for (uint64_t at = section.offset; at < section.offset + section.bytes; at += 4) {
      for (const uint32_t word : {0u, 1u, 2u, 5u, 40u, 0x80000000u, 0x80000003u, 0xFFFFFFFFu}) {
        Bytes file = original;
        if (std::memcmp(file.data() + at, &word, sizeof word) == 0) continue;
        std::memcpy(file.data() + at, &word, sizeof word);
        forge_checksums(file);
        Lights lights;
        ASSERT_EQ(load(device, file, 0, lights), KIWAMI_ERROR_INVALID_FILE) << at << " " << word;
      }
    }
  }
}

TEST(LightFile, EveryFailedAllocationIsAnErrorAndLeaksNothing) {
  CountingAllocator allocator;
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  allocator.install(desc);
  size_t failures = 0;
  {
    const Device device = make_device(desc);
    const Lights lights = make_lights(device, {4, 5, true});
    const Bytes file = saved(lights);
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
    run([&] { return kiwami_light_tree_save(lights.get(), &save, nullptr); });
    EXPECT_EQ(again, file);
    run([&] {
      Lights loaded;
      return load(device, file, 0, loaded);
    });
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
  EXPECT_GT(failures, 20u);
  print_figure("allocations failed in saving and loading of lights, one run each", failures);
}

}  // namespace
}  // namespace kiwami_api_tests

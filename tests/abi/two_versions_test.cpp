// SPDX-License-Identifier: Apache-2.0
// Several of the library in one process: two of it with different numbers of their binary
// interfaces, a second copy of one, and Embree with its oneTBB beside them.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <kiwami/kiwami.h>

#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace {

struct Close {
  void operator()(void* library) const { dlclose(library); }
};
using Library = std::unique_ptr<void, Close>;

Library open_library(const std::string& path) {
  Library library(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL));
  EXPECT_NE(library, nullptr) << dlerror();
  return library;
}

template <typename Function>
Function* symbol_of(const Library& library, const char* name) {
  auto* const function = reinterpret_cast<Function*>(dlsym(library.get(), name));
  EXPECT_NE(function, nullptr) << name;
  return function;
}

#define CALL(library, function) symbol_of<decltype(function)>(library, #function)

/// A height field of 2 * 64 * 64 triangles.
struct Field {
  std::vector<float> vertices;
  std::vector<uint32_t> indices;

  Field() {
    constexpr uint32_t kCells = 64;
    for (uint32_t y = 0; y <= kCells; ++y) {
      for (uint32_t x = 0; x <= kCells; ++x) {
        vertices.insert(vertices.end(), {static_cast<float>(x), static_cast<float>(y),
                                         static_cast<float>((x * 7 + y * 13) % 11) * 0.1f});
      }
    }
    for (uint32_t y = 0; y < kCells; ++y) {
      for (uint32_t x = 0; x < kCells; ++x) {
        const uint32_t i = y * (kCells + 1) + x, j = i + kCells + 1;
        indices.insert(indices.end(), {i, i + 1, j, i + 1, j + 1, j});
      }
    }
  }
};

/// Builds, traces, saves, loads and traces again by one library; returns all answers.
std::vector<kiwami_hit> run(const Library& library) {
  const Field field;
  kiwami_device* device = nullptr;
  kiwami_geometry* mesh = nullptr;
  kiwami_scene* scenes[2] = {};
  EXPECT_EQ(CALL(library, kiwami_device_create)(nullptr, &device), KIWAMI_OK);
  kiwami_triangle_mesh_desc desc;
  EXPECT_EQ(CALL(library, kiwami_triangle_mesh_desc_init)(&desc, sizeof desc), KIWAMI_OK);
  desc.vertices = field.vertices.data();
  desc.vertex_count = field.vertices.size() / 3;
  desc.indices = field.indices.data();
  desc.triangle_count = field.indices.size() / 3;
  EXPECT_EQ(CALL(library, kiwami_triangle_mesh_create)(device, &desc, &mesh), KIWAMI_OK);
  EXPECT_EQ(CALL(library, kiwami_scene_create)(device, &scenes[0]), KIWAMI_OK);
  EXPECT_EQ(CALL(library, kiwami_scene_attach)(scenes[0], mesh, nullptr), KIWAMI_OK);
  EXPECT_EQ(CALL(library, kiwami_scene_commit)(scenes[0]), KIWAMI_OK);
  std::vector<unsigned char> file(size_t{4} << 20);
  kiwami_save_desc save;
  kiwami_load_desc load;
  EXPECT_EQ(CALL(library, kiwami_save_desc_init)(&save, sizeof save), KIWAMI_OK);
  EXPECT_EQ(CALL(library, kiwami_load_desc_init)(&load, sizeof load), KIWAMI_OK);
  load.data = save.data = file.data();
  save.capacity = file.size();
  EXPECT_EQ(CALL(library, kiwami_scene_save)(scenes[0], &save, &load.size), KIWAMI_OK);
  EXPECT_EQ(CALL(library, kiwami_scene_load)(device, &load, &scenes[1]), KIWAMI_OK);
  std::vector<kiwami_ray> rays(5000);
  for (size_t i = 0; i < rays.size(); ++i) {
    const float x = static_cast<float>(i % 97) * 0.7f, y = static_cast<float>(i % 89) * 0.8f;
    rays[i] = {x, y, 9.0f, 0.0f, 0.1f, -0.2f, -1.0f, 1e30f, 0.0f, ~0u, 0u, 0u};
  }
  std::vector<kiwami_hit> hits(2 * rays.size());
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(
        CALL(library, kiwami_closest_hit)(scenes[i], rays.data(), 0, hits.data() + i * rays.size(),
                                          0, rays.size(), nullptr),
        KIWAMI_OK);
    CALL(library, kiwami_scene_release)(scenes[i]);
  }
  CALL(library, kiwami_geometry_release)(mesh);
  CALL(library, kiwami_device_release)(device);
  return hits;
}

bool are_equal(const std::vector<kiwami_hit>& a, const std::vector<kiwami_hit>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

TEST(TwoVersions, WorkAtOnceInOneProcessNextToEmbree) {
  const Library first = open_library(KIWAMI_LIBRARY), other = open_library(KIWAMI_OTHER_LIBRARY);
  ASSERT_TRUE(first && other);
  EXPECT_NE(reinterpret_cast<void*>(CALL(first, kiwami_version)),
            reinterpret_cast<void*>(CALL(other, kiwami_version)));
  // Of another build there may be none.
  const Library embree(dlopen("libembree3.so.3", RTLD_NOW | RTLD_LOCAL));
  void* embree_device = nullptr;
  if (embree) {
    embree_device = symbol_of<void*(const char*)>(embree, "rtcNewDevice")("");
    EXPECT_NE(embree_device, nullptr);
  }
  std::vector<kiwami_hit> answers[4];
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, i] { answers[i] = run(i % 2 == 0 ? first : other); });
  }
  for (std::thread& thread : threads) thread.join();
  for (int i = 1; i < 4; ++i) EXPECT_TRUE(are_equal(answers[0], answers[i])) << i;
  if (embree) symbol_of<void(void*)>(embree, "rtcReleaseDevice")(embree_device);
}

TEST(TwoVersions, KeepTheirLastErrorsApart) {
  const Library first = open_library(KIWAMI_LIBRARY), other = open_library(KIWAMI_OTHER_LIBRARY);
  ASSERT_TRUE(first && other);
  EXPECT_EQ(CALL(first, kiwami_scene_commit)(nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_GT(CALL(first, kiwami_last_error)(nullptr, nullptr, 0), 1u);
  EXPECT_EQ(CALL(other, kiwami_last_error)(nullptr, nullptr, 0), 1u);
}

TEST(TwoVersions, CanBeClosedAndOpenedAgain) {
  std::vector<kiwami_hit> before;
  for (int i = 0; i < 3; ++i) {
    const Library library = open_library(KIWAMI_LIBRARY);
    ASSERT_TRUE(library);
    const std::vector<kiwami_hit> answers = run(library);
    EXPECT_TRUE(i == 0 || are_equal(before, answers));
    before = answers;
  }
}

}  // namespace

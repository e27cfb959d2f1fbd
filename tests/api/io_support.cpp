// SPDX-License-Identifier: Apache-2.0
#include "api/io_support.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace kiwami_api_tests {
namespace {

template <typename Save>
Bytes saved_by(Save&& save) {
  kiwami_save_desc desc = default_save();
  uint64_t size = 0;
  EXPECT_EQ(save(&desc, &size), KIWAMI_OK) << last_error();
  Bytes bytes(size);
  desc.data = bytes.data();
  desc.capacity = bytes.size();
  EXPECT_EQ(save(&desc, &size), KIWAMI_OK) << last_error();
  EXPECT_EQ(size, bytes.size());
  return bytes;
}

void attach(const Scene& scene, const Geometry& geometry) {
  EXPECT_EQ(kiwami_scene_attach(scene.get(), geometry.get(), nullptr), KIWAMI_OK) << last_error();
}

/// Triples with a fourth element after each.
template <typename T>
std::vector<T> with_gaps(const std::vector<T>& elements) {
  std::vector<T> spread;
  for (size_t i = 0; i < elements.size(); ++i) {
    spread.push_back(elements[i]);
    if (i % 3 == 2) spread.push_back(T(77777));
  }
  return spread;
}

}  // namespace

kiwami_save_desc default_save() {
  kiwami_save_desc desc;
  EXPECT_EQ(kiwami_save_desc_init(&desc, sizeof desc), KIWAMI_OK);
  return desc;
}

kiwami_load_desc default_load() {
  kiwami_load_desc desc;
  EXPECT_EQ(kiwami_load_desc_init(&desc, sizeof desc), KIWAMI_OK);
  return desc;
}

Bytes saved(const Scene& scene) {
  return saved_by([&](const kiwami_save_desc* desc, uint64_t* size) {
    return kiwami_scene_save(scene.get(), desc, size);
  });
}

Bytes saved(const Bvh& bvh) {
  return saved_by([&](const kiwami_save_desc* desc, uint64_t* size) {
    return kiwami_bvh_save(bvh.get(), desc, size);
  });
}

kiwami_result load(const Device& device, const kiwami_load_desc& desc, Scene& scene) {
  kiwami_scene* loaded = nullptr;
  const kiwami_result result = kiwami_scene_load(device.get(), &desc, &loaded);
  EXPECT_EQ(loaded != nullptr, result == KIWAMI_OK);
  scene.reset(loaded);
  return result;
}

kiwami_result load(const Device& device, const kiwami_load_desc& desc, Bvh& bvh) {
  kiwami_bvh* loaded = nullptr;
  const kiwami_result result = kiwami_bvh_load(device.get(), &desc, &loaded);
  EXPECT_EQ(loaded != nullptr, result == KIWAMI_OK);
  bvh.reset(loaded);
  return result;
}

TemporaryFolder::TemporaryFolder() {
  static unsigned counter = 0;
  folder_ = std::filesystem::temp_directory_path() /
            ("kiwami-io-" + std::to_string(::getpid()) + "-" + std::to_string(counter++));
  std::filesystem::create_directories(folder_);
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::vector<std::string> TemporaryFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

AlignedCopy::AlignedCopy(const Bytes& bytes) : storage_(bytes.size() + 64) {
  const size_t shift = (64 - reinterpret_cast<uintptr_t>(storage_.data()) % 64) % 64;
  data_ = storage_.data() + shift;
  std::copy(bytes.begin(), bytes.end(), data_);
}

void write_file(const std::string& path, const Bytes& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  EXPECT_TRUE(file.good()) << path;
}

Bytes read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return Bytes(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

Scene make_rich_scene(const Device& device, uint32_t parts, uint32_t size, uint32_t width) {
  kiwami_scene* scene = nullptr;
  EXPECT_EQ(kiwami_tests::make_rich_scene(device.get(), {parts, width, size}, &scene), KIWAMI_OK)
      << last_error();
  return Scene(scene);
}

Scene make_mixed_scene(const Device& device, uint32_t triangles, uint32_t width) {
  const Triangles first = random_triangles(triangles, 1), second = random_triangles(triangles, 2);
  kiwami_triangle_mesh_desc plain = second.desc();
  plain.indices = nullptr;
  plain.mask = 0xF0;
  Triangles broken = random_triangles(3, 3);
  broken.vertices[0] = std::numeric_limits<float>::quiet_NaN();
  const Triangles spread = {with_gaps(broken.vertices), with_gaps(broken.indices)};
  kiwami_triangle_mesh_desc strided = spread.desc();
  strided.vertex_count = 9;
  strided.triangle_count = 3;
  strided.vertex_stride = strided.index_stride = 16;

  Scene scene = make_scene(device);
  attach(scene, make_mesh(device, square(0.5f).desc()));
  attach(scene, make_mesh(device, first.desc()));
  attach(scene, make_mesh(device, plain));
  attach(scene, make_mesh(device, default_mesh()));
  attach(scene, make_mesh(device, strided));
  EXPECT_EQ(kiwami_scene_detach(scene.get(), 0), KIWAMI_OK);
  EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BVH_WIDTH, width), KIWAMI_OK);
  EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
  return scene;
}

}  // namespace kiwami_api_tests

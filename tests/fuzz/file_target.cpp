// SPDX-License-Identifier: Apache-2.0
// Files: whatever they hold, they are refused, or what they give can be used; and the memory that
// takes is bounded by their size.
#include "fuzz/handles.h"
#include "support/exercise.h"
#include "support/file_forger.h"
#include "support/random.h"
#include "support/rich_lights.h"
#include "support/rich_scene.h"

namespace kiwami_fuzz {
namespace {

enum : uint8_t { kForges = 1, kWidens = 2 };

std::vector<float> random_corners(uint32_t triangles) {
  kiwami_tests::Random random(triangles);
  std::vector<float> corners;
  for (uint32_t i = 0; i < 9 * triangles; ++i) corners.push_back(random.symmetric());
  return corners;
}

Geometry make_mesh(const Device& device, const std::vector<float>& corners) {
  kiwami_triangle_mesh_desc desc;
  kiwami_triangle_mesh_desc_init(&desc, sizeof desc);
  desc.vertices = corners.data();
  desc.vertex_count = corners.size() / 3;
  desc.triangle_count = corners.size() / 9;
  kiwami_geometry* mesh = nullptr;
  kiwami_triangle_mesh_create(device.get(), &desc, &mesh);
  return Geometry(mesh);
}

/// Saves by save(desc, size), behind the byte that tells how the file is to be used.
template <typename Save>
Bytes saved(uint8_t how, Save&& save) {
  kiwami_save_desc desc;
  kiwami_save_desc_init(&desc, sizeof desc);
  uint64_t size = 0;
  save(&desc, &size);
  Bytes bytes(size + 1);
  bytes[0] = how;
  desc.data = bytes.data() + 1;
  desc.capacity = size;
  save(&desc, &size);
  return bytes;
}

Bytes scene_seed(const Device& device, uint8_t how, uint32_t triangles, uint32_t width,
                 uint32_t builder) {
  const std::vector<float> corners = random_corners(triangles);
  kiwami_scene* made = nullptr;
  kiwami_scene_create(device.get(), &made);
  const Scene scene(made);
  for (int i = 0; i < 2; ++i) {
    kiwami_scene_attach(made, make_mesh(device, corners).get(), nullptr);
  }
  kiwami_scene_set_parameter(made, KIWAMI_PARAMETER_BVH_WIDTH, width);
  kiwami_scene_set_parameter(made, KIWAMI_PARAMETER_BUILDER, builder);
  kiwami_scene_commit(made);
  return saved(how, [&](const kiwami_save_desc* desc, uint64_t* size) {
    kiwami_scene_save(made, desc, size);
  });
}

Bytes rich_seed(const Device& device, uint8_t how, uint32_t parts, uint32_t width) {
  kiwami_scene* made = nullptr;
  kiwami_tests::make_rich_scene(device.get(), {parts, width, 3}, &made);
  const Scene scene(made);
  return saved(how, [&](const kiwami_save_desc* desc, uint64_t* size) {
    kiwami_scene_save(made, desc, size);
  });
}

Bytes light_seed(const Device& device, uint8_t how, bool has_instances) {
  kiwami_light_tree* made = nullptr;
  kiwami_tests::make_rich_lights(device.get(), {4, 2, has_instances}, &made);
  const Lights lights(made);
  return saved(how, [&](const kiwami_save_desc* desc, uint64_t* size) {
    kiwami_light_tree_save(made, desc, size);
  });
}

Bytes bvh_seed(const Device& device, uint8_t how, bool over_boxes) {
  const std::vector<float> corners = random_corners(20);
  const Geometry mesh = make_mesh(device, corners);
  kiwami_bvh_desc desc;
  kiwami_bvh_desc_init(&desc, sizeof desc);
  if (over_boxes) {
    desc.boxes = corners.data();
    desc.box_count = corners.size() / 6;
  } else {
    desc.geometry = mesh.get();
  }
  kiwami_bvh* made = nullptr;
  kiwami_bvh_build(device.get(), &desc, &made);
  const Bvh bvh(made);
  return saved(how, [&](const kiwami_save_desc* save, uint64_t* size) {
    kiwami_bvh_save(made, save, size);
  });
}

kiwami_load_desc desc_of(const Bytes& file) {
  static const unsigned char kNothing = 0;
  kiwami_load_desc desc;
  kiwami_load_desc_init(&desc, sizeof desc);
  desc.data = file.empty() ? &kNothing : file.data();
  desc.size = file.size();
  return desc;
}

void check_result(kiwami_result result, const void* made) {
  require((result == KIWAMI_OK) == (made != nullptr), "a handle and an error, or neither");
  require(result == KIWAMI_OK || result == KIWAMI_ERROR_INVALID_FILE ||
              result == KIWAMI_ERROR_TOO_LARGE,
          "an error that a file cannot cause");
}

}  // namespace

std::vector<Bytes> make_seeds() {
  const Device device = make_device(KIWAMI_ISA_AUTO, 0, nullptr);
  std::vector<Bytes> seeds = {{}};
  for (const uint8_t how : {uint8_t{0}, uint8_t{kForges}, uint8_t{kForges | kWidens}}) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      seeds.push_back(scene_seed(device, how, 12, width, KIWAMI_BUILDER_BINNED_SAH));
    }
    seeds.push_back(scene_seed(device, how, 0, 4, KIWAMI_BUILDER_BINNED_SAH));
    seeds.push_back(scene_seed(device, how, 30, 4, KIWAMI_BUILDER_SPATIAL_SPLIT));
    for (uint32_t parts = 1; parts < kiwami_tests::kRichAll; parts *= 2) {
      seeds.push_back(rich_seed(device, how, parts | kiwami_tests::kRichInstances, 4));
    }
    seeds.push_back(rich_seed(device, how, kiwami_tests::kRichAll, 8));
    seeds.push_back(light_seed(device, how, false));
    seeds.push_back(light_seed(device, how, true));
    seeds.push_back(bvh_seed(device, how, false));
    seeds.push_back(bvh_seed(device, how, true));
  }
  return seeds;
}

}  // namespace kiwami_fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace kiwami_fuzz;
  static CountedMemory memory;
  static const Device device = make_device(KIWAMI_ISA_AUTO, KIWAMI_DEVICE_VALIDATE, &memory);
  Input input(data, size);
  const auto how = input.take<uint8_t>();
  Bytes file = input.rest();
  if (how & kForges) kiwami_tests::forge_checksums(file);
  const size_t before = memory.live;
  memory.peak = before;
  kiwami_load_desc desc = desc_of(file);
  kiwami_file_info info{};
  info.struct_size = sizeof info;
  kiwami_file_get_info(device.get(), &desc, &info);
  {
    kiwami_bvh* bvh = nullptr;
    const kiwami_result result = kiwami_bvh_load(device.get(), &desc, &bvh);
    check_result(result, bvh);
    const Bvh owner(bvh);
    if (bvh) kiwami_tests::exercise(bvh);
  }
  {
    kiwami_light_tree* lights = nullptr;
    const kiwami_result result = kiwami_light_tree_load(device.get(), &desc, &lights);
    check_result(result, lights);
    const Lights owner(lights);
    if (lights) kiwami_tests::exercise(lights);
  }
  {
    kiwami_scene* scene = nullptr;
    desc.bvh_width = how & kWidens ? 8 : 0;
    const kiwami_result result = kiwami_scene_load(device.get(), &desc, &scene);
    check_result(result, scene);
    const Scene owner(scene);
    // Builds take more, in proportion to the triangles, which are in proportion to the file.
    require(memory.peak - before <= 64 * file.size() + 65536, "more memory than the file allows");
    if (scene) kiwami_tests::exercise(scene);
  }
  require(memory.live == before, "memory that is not given back");
  return 0;
}

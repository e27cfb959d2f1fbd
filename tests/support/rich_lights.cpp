// SPDX-License-Identifier: Apache-2.0
#include "support/rich_lights.h"

#include <limits>
#include <memory>
#include <vector>

#include "support/random.h"

namespace kiwami_tests {
namespace {

struct Failure {
  kiwami_result result;
};

void must(kiwami_result result) {
  if (result != KIWAMI_OK) throw Failure{result};
}

struct LightRelease {
  void operator()(kiwami_light_tree* tree) const { kiwami_light_tree_release(tree); }
};
using LightHandle = std::unique_ptr<kiwami_light_tree, LightRelease>;

kiwami_light random_light(uint32_t type, uint32_t number, Random& random) {
  kiwami_light light{};
  light.type = type;
  light.flags = random.one_in(3) && (type == KIWAMI_LIGHT_TRIANGLE || type == KIWAMI_LIGHT_DISC)
                    ? uint32_t{KIWAMI_LIGHT_TWO_SIDED}
                    : 0;
  for (float& coordinate : light.points) coordinate = random.symmetric();
  for (float& coordinate : light.direction) coordinate = random.symmetric();
  light.radius = 0.1f + random.unit();
  light.cos_inner = 0.9f;
  light.cos_outer = 0.3f;
  light.power = random.one_in(6) ? 0.0f : 5.0f * random.unit();
  light.user_id = 1000 + number;
  light.link_mask = random.one_in(4) ? 6 : ~uint64_t{0};
  return light;
}

void add_lights(kiwami_light_tree* tree, uint32_t size, uint32_t last_type, Random& random) {
  std::vector<kiwami_light> lights;
  for (uint32_t i = 0; i < size; ++i) {
    for (uint32_t type = KIWAMI_LIGHT_POINT; type <= last_type; ++type) {
      lights.push_back(random_light(type, static_cast<uint32_t>(lights.size()), random));
    }
  }
  must(kiwami_light_tree_add_lights(tree, lights.data(), 0, lights.size(), nullptr));
}

/// Of which the first triangle has no area, the last one a vertex that is no number.
void add_mesh(kiwami_light_tree* tree, uint32_t size, Random& random) {
  std::vector<float> vertices(9 * size);
  for (float& coordinate : vertices) coordinate = random.symmetric();
  if (size != 0) {
    for (size_t i = 0; i < 9; ++i) vertices[i] = 0.5f;
    vertices.back() = std::numeric_limits<float>::quiet_NaN();
  }
  kiwami_light_mesh_desc desc;
  must(kiwami_light_mesh_desc_init(&desc, sizeof desc));
  desc.vertices = vertices.data();
  desc.vertex_count = vertices.size() / 3;
  desc.triangle_count = size;
  desc.user_id = 7;
  desc.user_id_step = 3;
  must(kiwami_light_tree_add_mesh(tree, &desc, nullptr));
}

LightHandle make_tree(kiwami_device* device, uint32_t width) {
  kiwami_light_tree_desc desc;
  must(kiwami_light_tree_desc_init(&desc, sizeof desc));
  desc.width = width;
  desc.builder = KIWAMI_LIGHT_BUILDER_OCTANTS;
  desc.flags = KIWAMI_LIGHT_TREE_WITH_ROULETTE;
  desc.distant_probability = 0.25f;
  kiwami_light_tree* tree = nullptr;
  must(kiwami_light_tree_create(device, &desc, &tree));
  return LightHandle(tree);
}

void add_instance(kiwami_light_tree* tree, kiwami_light_tree* shown, Random& random) {
  kiwami_light_instance_desc desc;
  must(kiwami_light_instance_desc_init(&desc, sizeof desc));
  desc.tree = shown;
  desc.power_scale = 0.5f + random.unit();
  for (float& entry : desc.local_to_world) entry += 0.3f * random.symmetric();
  must(kiwami_light_tree_add_instance(tree, &desc, nullptr));
}

LightHandle make(kiwami_device* device, const RichLights& what) {
  Random random(what.size + 1);
  LightHandle tree = make_tree(device, what.width);
  add_lights(tree.get(), what.size, KIWAMI_LIGHT_ENVIRONMENT, random);
  add_mesh(tree.get(), what.size, random);
  if (what.has_instances) {
    const LightHandle shown[2] = {make_tree(device, what.width), make_tree(device, what.width)};
    for (const LightHandle& each : shown) {
      add_lights(each.get(), what.size, KIWAMI_LIGHT_DISC, random);
      must(kiwami_light_tree_commit(each.get()));
    }
    add_instance(tree.get(), shown[1].get(), random);
    add_instance(tree.get(), shown[0].get(), random);
    add_instance(tree.get(), shown[1].get(), random);
  }
  must(kiwami_light_tree_commit(tree.get()));
  return tree;
}

}  // namespace

kiwami_result make_rich_lights(kiwami_device* device, const RichLights& what,
                               kiwami_light_tree** tree) {
  *tree = nullptr;
  try {
    *tree = make(device, what).release();
  } catch (const Failure& failure) {
    return failure.result;
  }
  return KIWAMI_OK;
}

}  // namespace kiwami_tests

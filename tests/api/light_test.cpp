// SPDX-License-Identifier: Apache-2.0
// Sets of lights through the C interface: what is accepted, and what is said of the rest.
#include <gtest/gtest.h>
#include <kiwami/light.h>

#include <cmath>

#include "api_support.h"

namespace kiwami_api_tests {
namespace {

struct ReleaseTree {
  void operator()(kiwami_light_tree* tree) const { kiwami_light_tree_release(tree); }
};
using Lights = std::unique_ptr<kiwami_light_tree, ReleaseTree>;

Lights make_lights(const Device& device, const kiwami_light_tree_desc* desc = nullptr) {
  kiwami_light_tree* tree = nullptr;
  EXPECT_EQ(kiwami_light_tree_create(device.get(), desc, &tree), KIWAMI_OK);
  return Lights(tree);
}

kiwami_light light_at(float x, float y, float z, float power = 1.0f) {
  kiwami_light light{};
  light.type = KIWAMI_LIGHT_POINT;
  light.points[0] = x;
  light.points[1] = y;
  light.points[2] = z;
  light.power = power;
  light.link_mask = ~uint64_t{0};
  return light;
}

kiwami_light triangle_light() {
  kiwami_light light = light_at(0, 0, 0);
  light.type = KIWAMI_LIGHT_TRIANGLE;
  light.points[3] = 1.0f;
  light.points[7] = 1.0f;
  return light;
}

kiwami_light_receiver receiver_at(float x, float y, float z) {
  kiwami_light_receiver receiver{};
  receiver.position[0] = x;
  receiver.position[1] = y;
  receiver.position[2] = z;
  receiver.link_mask = ~uint64_t{0};
  return receiver;
}

void add(const Lights& lights, const std::vector<kiwami_light>& all) {
  EXPECT_EQ(kiwami_light_tree_add_lights(lights.get(), all.data(), 0, all.size(), nullptr),
            KIWAMI_OK);
}

float pdf(const Lights& lights, const kiwami_light_receiver& receiver, uint32_t light_id,
          uint32_t instance_id = KIWAMI_INVALID_ID) {
  const kiwami_light_name name{light_id, instance_id};
  float probability = -1.0f;
  EXPECT_EQ(kiwami_light_pdf(lights.get(), &receiver, 0, &name, 0, &probability, 0, 1, nullptr),
            KIWAMI_OK);
  return probability;
}

kiwami_light_tree_info info_of(const Lights& lights) {
  kiwami_light_tree_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(kiwami_light_tree_get_info(lights.get(), &info), KIWAMI_OK);
  return info;
}

TEST(Light, ChoosesByPowerAndDistance) {
  const Device device = make_device();
  const Lights lights = make_lights(device);
  add(lights, {light_at(1, 0, 0), light_at(0, 2, 0), light_at(0, 0, 1, 3.0f)});
  ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
  // Intensities over squared distances: 1, 1/4, 3.
  const kiwami_light_receiver receiver = receiver_at(0, 0, 0);
  EXPECT_NEAR(pdf(lights, receiver, 0), 4.0 / 17.0, 1e-5);
  EXPECT_NEAR(pdf(lights, receiver, 1), 1.0 / 17.0, 1e-5);
  EXPECT_NEAR(pdf(lights, receiver, 2), 12.0 / 17.0, 1e-5);
  const kiwami_light_tree_info info = info_of(lights);
  EXPECT_EQ(info.light_count, 3u);
  EXPECT_EQ(info.power, 5.0);
  EXPECT_EQ(info.node_count, 1u);
}

TEST(Light, ChoosesNothingFromNothing) {
  const Device device = make_device();
  const Lights lights = make_lights(device);
  const kiwami_light_receiver receiver = receiver_at(0, 0, 0);
  kiwami_light_choice choice{};
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, nullptr),
            KIWAMI_ERROR_INVALID_STATE);
  ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, nullptr), KIWAMI_OK);
  EXPECT_EQ(choice.light_id, KIWAMI_INVALID_ID);
  EXPECT_EQ(choice.probability, 0.0f);
  EXPECT_EQ(pdf(lights, receiver, 0), 0.0f);
  // A light of power 0, or one that is linked to nobody, is there but never chosen.
  kiwami_light unlinked = light_at(1, 1, 1);
  unlinked.link_mask = 0;
  add(lights, {light_at(1, 0, 0, 0.0f), unlinked});
  ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, nullptr), KIWAMI_OK);
  EXPECT_EQ(choice.light_id, KIWAMI_INVALID_ID);
  EXPECT_EQ(kiwami_light_sample(lights.get(), nullptr, 0, nullptr, 0, 0, nullptr), KIWAMI_OK);
}

TEST(Light, LinksLightsToReceivers) {
  const Device device = make_device();
  const Lights lights = make_lights(device);
  kiwami_light first = light_at(1, 0, 0), second = light_at(-1, 0, 0);
  first.link_mask = uint64_t{1} << 63;
  second.link_mask = 3;
  add(lights, {first, second});
  ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
  kiwami_light_receiver receiver = receiver_at(0, 0, 0);
  EXPECT_EQ(pdf(lights, receiver, 0), 0.5f);
  receiver.link_mask = uint64_t{1} << 63;
  EXPECT_EQ(pdf(lights, receiver, 0), 1.0f);
  EXPECT_EQ(pdf(lights, receiver, 1), 0.0f);
  receiver.link_mask = 2;
  EXPECT_EQ(pdf(lights, receiver, 1), 1.0f);
  receiver.link_mask = 4;
  EXPECT_EQ(pdf(lights, receiver, 1), 0.0f);
}

TEST(Light, MeshesAreTriangleLights) {
  const Device device = make_device();
  const Lights lights = make_lights(device);
  add(lights, {light_at(9, 9, 9)});
  // The second triangle has no area, the third no place.
  const float vertices[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, NAN, 0, 0};
  const uint32_t indices[] = {0, 1, 2, 0, 1, 1, 0, 1, 3, 0, 2, 1};
  const float radiances[] = {2.0f, 2.0f, 2.0f, 4.0f};
  kiwami_light_mesh_desc desc;
  ASSERT_EQ(kiwami_light_mesh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.vertices = vertices;
  desc.vertex_count = 4;
  desc.indices = indices;
  desc.triangle_count = 4;
  desc.radiances = radiances;
  desc.user_id = 70;
  desc.user_id_step = 1;
  uint32_t first = 0;
  ASSERT_EQ(kiwami_light_tree_add_mesh(lights.get(), &desc, &first), KIWAMI_OK);
  EXPECT_EQ(first, 1u);
  ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
  // pi * area * radiance.
  EXPECT_NEAR(info_of(lights).power, 1.0 + 3.14159265 * 0.5 * (2.0 + 4.0), 1e-5);
  EXPECT_EQ(info_of(lights).light_count, 5u);
  // In front of the first, behind the last.
  kiwami_light_receiver receiver = receiver_at(0.2f, 0.2f, 0.1f);
  receiver.normal[2] = -1.0f;
  receiver.random = 0.5;
  EXPECT_EQ(pdf(lights, receiver, 1), 1.0f);
  EXPECT_EQ(pdf(lights, receiver, 2), 0.0f);
  EXPECT_EQ(pdf(lights, receiver, 3), 0.0f);
  EXPECT_EQ(pdf(lights, receiver, 4), 0.0f);
  kiwami_light_choice choice{};
  ASSERT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, nullptr), KIWAMI_OK);
  EXPECT_EQ(choice.light_id, 1u);
  EXPECT_EQ(choice.user_id, 70u);

  const uint32_t beyond[] = {0, 1, 4};
  desc.indices = beyond;
  desc.triangle_count = 1;
  EXPECT_EQ(kiwami_light_tree_add_mesh(lights.get(), &desc, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("vertex 4"), std::string::npos) << last_error();
  const float negative[] = {-1.0f};
  desc.indices = indices;
  desc.radiances = negative;
  EXPECT_EQ(kiwami_light_tree_add_mesh(lights.get(), &desc, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("radiances[0] is -1"), std::string::npos) << last_error();
  desc.flags = 8;
  EXPECT_EQ(kiwami_light_tree_add_mesh(lights.get(), &desc, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
}

TEST(Light, InstancesShowATreeElsewhere) {
  const Device device = make_device();
  const Lights group = make_lights(device), lights = make_lights(device);
  add(group, {light_at(0, 0, 0), light_at(0, 1, 0)});
  kiwami_light_instance_desc desc;
  ASSERT_EQ(kiwami_light_instance_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.tree = group.get();
  EXPECT_EQ(kiwami_light_tree_add_instance(lights.get(), &desc, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);  // not committed
  ASSERT_EQ(kiwami_light_tree_commit(group.get()), KIWAMI_OK);
  uint32_t id = 7;
  for (const float x : {1.0f, -2.0f}) {
    desc.local_to_world[3] = x;
    ASSERT_EQ(kiwami_light_tree_add_instance(lights.get(), &desc, &id), KIWAMI_OK);
  }
  EXPECT_EQ(id, 1u);
  ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
  kiwami_light_receiver receiver = receiver_at(0, -1, 0);
  float sum = 0.0f;
  for (const uint32_t instance : {0u, 1u}) {
    for (const uint32_t light : {0u, 1u}) sum += pdf(lights, receiver, light, instance);
  }
  EXPECT_NEAR(sum, 1.0f, 1e-6f);
  EXPECT_GT(pdf(lights, receiver, 0, 0), pdf(lights, receiver, 0, 1));
  // Moved: the nearer one is now the other.
  desc.local_to_world[3] = 9.0f;
  ASSERT_EQ(kiwami_light_tree_set_instance(lights.get(), 0, &desc), KIWAMI_OK);
  ASSERT_EQ(kiwami_light_tree_refit(lights.get()), KIWAMI_OK);
  EXPECT_LT(pdf(lights, receiver, 0, 0), pdf(lights, receiver, 0, 1));
  // A group that was shown may go, and an instance of nothing is dark.
  const Lights empty = make_lights(device);
  ASSERT_EQ(kiwami_light_tree_commit(empty.get()), KIWAMI_OK);
  desc.tree = empty.get();
  ASSERT_EQ(kiwami_light_tree_set_instance(lights.get(), 1, &desc), KIWAMI_OK);
  EXPECT_EQ(kiwami_light_tree_refit(lights.get()), KIWAMI_ERROR_INVALID_STATE);
  ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
  EXPECT_EQ(pdf(lights, receiver, 0, 1), 0.0f);

  desc.tree = lights.get();
  EXPECT_EQ(kiwami_light_tree_add_instance(group.get(), &desc, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("2 instances"), std::string::npos) << last_error();
  desc.tree = group.get();
  desc.local_to_world[5] = 0.0f;
  EXPECT_EQ(kiwami_light_tree_add_instance(lights.get(), &desc, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("invertible"), std::string::npos) << last_error();
  EXPECT_EQ(kiwami_light_tree_set_instance(lights.get(), 2, &desc), KIWAMI_ERROR_INVALID_ARGUMENT);
  kiwami_light_tree_desc wide;
  ASSERT_EQ(kiwami_light_tree_desc_init(&wide, sizeof wide), KIWAMI_OK);
  wide.width = 16;
  desc.local_to_world[5] = 1.0f;
  EXPECT_EQ(kiwami_light_tree_add_instance(make_lights(device, &wide).get(), &desc, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
}

TEST(Light, DistantLightsAreChosenBesideTheTree) {
  const Device device = make_device();
  kiwami_light_tree_desc desc;
  ASSERT_EQ(kiwami_light_tree_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.distant_probability = 0.25f;
  const Lights lights = make_lights(device, &desc);
  kiwami_light sun = light_at(0, 0, 0), sky = light_at(0, 0, 0);
  sun.type = KIWAMI_LIGHT_DISTANT;
  sun.direction[2] = -2.0f;
  sun.cos_outer = 1.0f;
  sky.type = KIWAMI_LIGHT_ENVIRONMENT;
  sky.power = 3.0f;
  kiwami_light disc = light_at(5, 0, 0);
  disc.type = KIWAMI_LIGHT_DISC;
  disc.direction[0] = -1.0f;
  disc.radius = 1.0f;
  add(lights, {sun, disc, sky});
  ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
  EXPECT_EQ(info_of(lights).distant_count, 2u);
  kiwami_light_receiver receiver = receiver_at(0, 0, 0);
  receiver.normal[2] = 1.0f;
  EXPECT_FLOAT_EQ(pdf(lights, receiver, 0), 0.0625f);
  EXPECT_FLOAT_EQ(pdf(lights, receiver, 1), 0.75f);
  EXPECT_FLOAT_EQ(pdf(lights, receiver, 2), 0.1875f);
  receiver.normal[2] = -1.0f;  // away from the sun
  EXPECT_EQ(pdf(lights, receiver, 0), 0.0f);
  EXPECT_FLOAT_EQ(pdf(lights, receiver, 2), 0.25f);
  receiver.position[0] = 9.0f;  // behind the disc, too
  EXPECT_EQ(pdf(lights, receiver, 1), 0.0f);
  EXPECT_FLOAT_EQ(pdf(lights, receiver, 2), 1.0f);
}

TEST(Light, PowersAndLightsCanChange) {
  const Device device = make_device();
  const Lights lights = make_lights(device);
  add(lights, {light_at(1, 0, 0), light_at(-1, 0, 0), light_at(0, 1, 0, 0.0f)});
  EXPECT_EQ(kiwami_light_tree_refit(lights.get()), KIWAMI_ERROR_INVALID_STATE);
  ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
  const kiwami_light_receiver receiver = receiver_at(0, 0, 0);
  const float powers[] = {3.0f, 6.0f};
  ASSERT_EQ(kiwami_light_tree_set_powers(lights.get(), 1, powers, 0, 2), KIWAMI_OK);
  EXPECT_EQ(pdf(lights, receiver, 1), 0.5f);  // not before the refit
  ASSERT_EQ(kiwami_light_tree_refit(lights.get()), KIWAMI_OK);
  EXPECT_NEAR(pdf(lights, receiver, 1), 0.3f, 1e-6f);
  EXPECT_NEAR(pdf(lights, receiver, 2), 0.6f, 1e-6f);
  const kiwami_light moved = light_at(0, 2, 0, 4.0f);
  ASSERT_EQ(kiwami_light_tree_set_lights(lights.get(), 2, &moved, 0, 1), KIWAMI_OK);
  ASSERT_EQ(kiwami_light_tree_refit(lights.get()), KIWAMI_OK);
  EXPECT_NEAR(pdf(lights, receiver, 2), 0.2f, 1e-6f);

  const float bad[] = {1.0f, -2.0f};
  EXPECT_EQ(kiwami_light_tree_set_powers(lights.get(), 0, bad, 0, 2),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("powers[1] is -2"), std::string::npos) << last_error();
  EXPECT_EQ(kiwami_light_tree_set_powers(lights.get(), 2, powers, 0, 2),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_light_tree_set_lights(lights.get(), 4, &moved, 0, 0),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  // A refit keeps to the lights of the tree.
  kiwami_light distant = light_at(0, 0, 0);
  distant.type = KIWAMI_LIGHT_ENVIRONMENT;
  ASSERT_EQ(kiwami_light_tree_set_lights(lights.get(), 0, &distant, 0, 1), KIWAMI_OK);
  EXPECT_EQ(kiwami_light_tree_refit(lights.get()), KIWAMI_ERROR_INVALID_STATE);
  add(lights, {moved});
  EXPECT_EQ(kiwami_light_tree_refit(lights.get()), KIWAMI_ERROR_INVALID_STATE);
  EXPECT_NEAR(pdf(lights, receiver, 2), 0.2f, 1e-6f);  // as it was
}

TEST(Light, BadLightsAreNamed) {
  const Device device = make_device();
  const Lights lights = make_lights(device);
  const auto expect_rejected = [&](const kiwami_light& light, const char* sentence) {
    const kiwami_light both[] = {light_at(0, 0, 0), light};
    EXPECT_EQ(kiwami_light_tree_add_lights(lights.get(), both, 0, 2, nullptr),
              KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_NE(last_error().find(sentence), std::string::npos) << last_error();
  };
  kiwami_light light = light_at(0, NAN, 0);
  expect_rejected(light, "lights[1].points[1] is nan");
  light = light_at(0, 0, 0x1p61f);
  expect_rejected(light, "lights[1].points[2]");
  for (const float power : {-1.0f, kInfinity, NAN}) {
    expect_rejected(light_at(0, 0, 0, power), "lights[1].power is");
  }
  light = light_at(0, 0, 0);
  light.type = 8;
  expect_rejected(light, "lights[1].type is 8");
  light = light_at(0, 0, 0);
  light.flags = KIWAMI_LIGHT_TWO_SIDED;
  expect_rejected(light, "lights[1].flags is 0x1");
  light = triangle_light();
  light.points[7] = 0.0f;
  expect_rejected(light, "lights[1].points span no area");
  light.type = KIWAMI_LIGHT_QUAD;
  light.points[9] = 2.0f;
  expect_rejected(light, "lights[1].points span no area");
  light = light_at(0, 0, 0);
  light.type = KIWAMI_LIGHT_SPHERE;
  expect_rejected(light, "lights[1].radius is 0");
  light.type = KIWAMI_LIGHT_DISC;
  light.radius = 1.0f;
  expect_rejected(light, "lights[1].direction, whose length is 0");
  light.type = KIWAMI_LIGHT_SPOT;
  light.direction[0] = 1e-30f;
  light.cos_outer = 0.5f;
  expect_rejected(light, "lights[1].cos_inner is 0, expected cos_outer to 1");
  light.cos_outer = -1.5f;
  expect_rejected(light, "lights[1].cos_outer is -1.5");
  EXPECT_EQ(kiwami_light_tree_add_lights(lights.get(), nullptr, 0, 1, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_light_tree_add_lights(lights.get(), &light, 92, 2, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  // Nothing of all that was added.
  uint32_t first = 9;
  light = triangle_light();
  EXPECT_EQ(kiwami_light_tree_add_lights(lights.get(), &light, 0, 1, &first), KIWAMI_OK);
  EXPECT_EQ(first, 0u);
}

TEST(Light, BadArgumentsAreNamed) {
  const Device device = make_device();
  kiwami_light_tree* tree = nullptr;
  EXPECT_EQ(kiwami_light_tree_create(nullptr, nullptr, &tree), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_light_tree_create(device.get(), nullptr, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  kiwami_light_tree_desc desc;
  ASSERT_EQ(kiwami_light_tree_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.width = 3;
  EXPECT_EQ(kiwami_light_tree_create(device.get(), &desc, &tree), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("desc.width is 3"), std::string::npos) << last_error();
  desc.width = 0;
  desc.builder = 2;
  EXPECT_EQ(kiwami_light_tree_create(device.get(), &desc, &tree), KIWAMI_ERROR_INVALID_ARGUMENT);
  desc.builder = 0;
  desc.distant_probability = 1.0f;
  EXPECT_EQ(kiwami_light_tree_create(device.get(), &desc, &tree), KIWAMI_ERROR_INVALID_ARGUMENT);
  for (const auto& result :
       {kiwami_light_tree_commit(nullptr), kiwami_light_tree_refit(nullptr),
        kiwami_light_tree_get_info(nullptr, nullptr),
        kiwami_light_sample(nullptr, nullptr, 0, nullptr, 0, 0, nullptr),
        kiwami_light_tree_desc_init(nullptr, 16), kiwami_light_mesh_desc_init(nullptr, 16),
        kiwami_light_instance_desc_init(nullptr, 16), kiwami_light_query_init(nullptr, 16)}) {
    EXPECT_EQ(result, KIWAMI_ERROR_INVALID_ARGUMENT);
  }
  kiwami_light_tree_retain(nullptr);
  kiwami_light_tree_release(nullptr);

  kiwami_device_desc device_desc = default_device();
  device_desc.flags = KIWAMI_DEVICE_VALIDATE;
  const Device checking = make_device(device_desc);
  const Lights lights = make_lights(checking);
  ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
  kiwami_light_query query;
  ASSERT_EQ(kiwami_light_query_init(&query, sizeof query), KIWAMI_OK);
  const kiwami_light_receiver receiver = receiver_at(0, 0, 0);
  kiwami_light_choice choice{};
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query), KIWAMI_OK);
  EXPECT_EQ(kiwami_light_sample(lights.get(), nullptr, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 8, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  query.method = 99;
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  query.method = KIWAMI_LIGHT_METHOD_TREE;
  query.max_choices = 2;
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("query.max_choices is 2"), std::string::npos) << last_error();
  query.method = KIWAMI_LIGHT_METHOD_TREE_SPLITTING;
  query.max_choices = KIWAMI_LIGHT_MAX_CHOICES + 1;
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  query.max_choices = 1;
  query.threshold = 1.5f;
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  query.threshold = 0.5f;
  query.method = KIWAMI_LIGHT_METHOD_ROULETTE;
  query.max_choices = 1;
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_STATE);
  query.lobe = 3;
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("query.lobe is 3"), std::string::npos) << last_error();
  query.lobe = KIWAMI_LIGHT_LOBE_GLOSSY;
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("query.lobes"), std::string::npos) << last_error();
  query.lobe = KIWAMI_LIGHT_LOBE_COSINE;
  query.order = 2;
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  query.order = KIWAMI_LIGHT_ORDER_XOR;
  query.reach = -1.0f;
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("query.reach is -1"), std::string::npos) << last_error();
  query.reach = 0.0f;
  query.flags = 2;
  EXPECT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
}

TEST(Light, MemoryIsGivenBackAndFailuresChangeNothing) {
  CountingAllocator allocator;
  kiwami_device_desc desc = default_device();
  desc.thread_count = 1;
  allocator.install(desc);
  {
    const Device device = make_device(desc);
    const Lights lights = make_lights(device), group = make_lights(device);
    add(group, {light_at(0, 0, 0), light_at(0, 1, 0)});
    ASSERT_EQ(kiwami_light_tree_commit(group.get()), KIWAMI_OK);
    add(lights, {light_at(1, 0, 0), light_at(0, 3, 0), triangle_light()});
    kiwami_light_instance_desc instance;
    ASSERT_EQ(kiwami_light_instance_desc_init(&instance, sizeof instance), KIWAMI_OK);
    instance.tree = group.get();
    ASSERT_EQ(kiwami_light_tree_add_instance(lights.get(), &instance, nullptr), KIWAMI_OK);
    ASSERT_EQ(kiwami_light_tree_commit(lights.get()), KIWAMI_OK);
    const kiwami_light_receiver receiver = receiver_at(0, 0, 5);
    const float before = pdf(lights, receiver, 0);
    const std::vector<kiwami_light> more(100, light_at(7, 7, 7));
    add(lights, more);
    const size_t blocks = allocator.live_blocks;
    for (size_t failure = 0;; ++failure) {
      ASSERT_LT(failure, 100u);
      allocator.first_failure = allocator.calls + failure;
      const kiwami_result result = kiwami_light_tree_commit(lights.get());
      allocator.first_failure = SIZE_MAX;
      if (result == KIWAMI_OK) break;
      EXPECT_EQ(result, KIWAMI_ERROR_OUT_OF_MEMORY);
      EXPECT_EQ(allocator.live_blocks, blocks);
      EXPECT_EQ(pdf(lights, receiver, 0), before);
    }
    const size_t calls = allocator.calls;
    pdf(lights, receiver, 0);
    kiwami_light_choice choice{};
    ASSERT_EQ(kiwami_light_sample(lights.get(), &receiver, 0, &choice, 0, 1, nullptr), KIWAMI_OK);
    EXPECT_EQ(allocator.calls, calls) << "sampling allocates nothing";
  }
  EXPECT_EQ(allocator.live_bytes, 0u);
  EXPECT_EQ(allocator.mismatches, 0u);
}

}  // namespace
}  // namespace kiwami_api_tests

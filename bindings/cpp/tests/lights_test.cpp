// SPDX-License-Identifier: Apache-2.0
// Sets of lights against the answers that every binding must give.
#include <algorithm>
#include <cstdio>

#include "support.h"

namespace {

void add_mesh(Words& words, kiwami::LightTree& lights) {
  kiwami::LightMeshOptions options;
  options.is_two_sided = words.int32() != 0;
  options.radiance = words.words<float>();
  const std::uint32_t vertex_count = words.int32(), triangle_count = words.int32();
  const auto vertices = words.array<kiwami::Vertex>(vertex_count);
  lights.add_mesh(vertices, words.array<kiwami::Triangle>(triangle_count), options);
}

/// Plays a set of lights; returns how many choices were compared.
std::size_t play(Words& words, const kiwami::Device& device) {
  kiwami::LightTree lights(device, {.width = words.int32()});
  std::vector<kiwami::LightReceiver> receivers;
  std::vector<kiwami::LightChoice> choices;
  std::size_t compared = 0;
  for (std::string word = words.word(); word != "end"; word = words.word()) {
    if (word == "light") {
      lights.add_lights(words.array<kiwami::Light>(words.int32()));
    } else if (word == "light_mesh") {
      add_mesh(words, lights);
    } else if (word == "powers") {
      const std::uint32_t first = words.int32();
      lights.set_powers(first, words.array<float>(words.int32()));
    } else if (word == "commit") {
      lights.commit();
    } else if (word == "refit") {
      lights.refit();
    } else if (word == "receivers") {
      receivers = words.array<kiwami::LightReceiver>(words.int32());
    } else if (word == "choices") {
      choices = lights.sample(receivers);
      using Bits = std::array<std::uint32_t, sizeof(kiwami::LightChoice) / 4>;
      for (const auto& each : choices) EXPECT_EQ(std::bit_cast<Bits>(each), words.words<Bits>());
      compared += choices.size();
    } else {
      EXPECT_EQ(word, "pdf");
      std::vector<kiwami::LightName> names;
      for (const auto& each : choices) names.push_back({each.light_id, each.instance_id});
      for (const float each : lights.pdf(receivers, names)) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(each), words.int32());
      }
    }
  }
  return compared;
}

TEST(Lights, ChoicesAreTheSameToTheBit) {
  for (const std::uint32_t isa : {KIWAMI_ISA_AUTO, KIWAMI_ISA_SCALAR}) {
    const kiwami::Device device(kiwami::DeviceOptions{.isa = isa, .validate = true});
    Words words("lights");
    std::size_t compared = 0;
    while (words.word() == "lights") compared += play(words, device);
    EXPECT_GT(compared, 100u);
  }
  note("many lights");
}

TEST(Lights, AreSeenThroughInstances) {
  const kiwami::Device device;
  kiwami::LightTree shown(device);
  kiwami::Light light{};
  light.type = KIWAMI_LIGHT_POINT;
  light.power = 1.0f;
  light.user_id = 7;
  light.link_mask = ~std::uint64_t{0};
  EXPECT_EQ(shown.add_lights(std::span(&light, 1)), 0u);
  shown.commit();
  kiwami::LightTree lights(device);
  EXPECT_EQ(lights.add_instance(shown, {1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0}, 2.0f), 0u);
  lights.commit();
  kiwami::LightReceiver receiver{};
  receiver.link_mask = ~std::uint64_t{0};
  const std::vector<kiwami::LightChoice> choices = lights.sample(std::span(&receiver, 1));
  EXPECT_EQ(choices[0].user_id, 7u);
  EXPECT_EQ(choices[0].instance_id, 0u);
  EXPECT_EQ(lights.info().instance_count, 1u);
}

TEST(Lights, FilesGiveTheSameChoices) {
  const kiwami::Device device;
  kiwami::LightTree lights(device, {.width = 4});
  lights.add_mesh(kCorners, std::span(&kTriangle, 1), {.radiance = 3.0f, .user_id = 5});
  lights.add_mesh(kCorners, std::span(&kTriangle, 1), {.radiance = 1.0f, .user_id = 6});
  const std::string path = testing::TempDir() + "kiwami_hpp_lights.kiwami";
  EXPECT_THROW(lights.save(path), kiwami::Error);  // never committed
  lights.commit();
  lights.save(path);
  std::vector<kiwami::LightReceiver> receivers(64);
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    receivers[i].link_mask = ~std::uint64_t{0};
    receivers[i].random = (static_cast<double>(i) + 0.5) / 64.0;
  }
  const std::vector<kiwami::LightChoice> before = lights.sample(receivers);
  EXPECT_NE(before.front().light_id, before.back().light_id);
  for (const std::uint32_t flags : {0u, std::uint32_t{KIWAMI_LOAD_MAP | KIWAMI_LOAD_TRUSTED}}) {
    kiwami::LightTree loaded = kiwami::LightTree::load(device, path, flags);
    const std::vector<kiwami::LightChoice> after = loaded.sample(receivers);
    using Bits = std::array<std::uint32_t, sizeof(kiwami::LightChoice) / 4>;
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_EQ(std::bit_cast<Bits>(after[i]), std::bit_cast<Bits>(before[i]));
    }
    loaded.commit();
    EXPECT_EQ(loaded.info().light_count, 2u);
  }
  std::remove(path.c_str());
  EXPECT_THROW(kiwami::LightTree::load(device, path), kiwami::Error);
}

TEST(Lights, BadOnesAreErrors) {
  const kiwami::Device device;
  kiwami::LightTree lights(device);
  kiwami::Light light{};
  light.type = 99;
  EXPECT_THROW(lights.add_lights(std::span(&light, 1)), kiwami::Error);
  EXPECT_THROW(lights.set_lights(5, std::span(&light, 1)), kiwami::Error);
  const float radiances[] = {1, 2};
  EXPECT_THROW(lights.add_mesh(kCorners, std::span(&kTriangle, 1), {.radiances = radiances}),
               kiwami::Error);
  EXPECT_THROW(lights.sample({}), kiwami::Error);  // never committed
  lights.commit();
  const kiwami::LightReceiver receiver{};
  EXPECT_EQ(lights.sample(std::span(&receiver, 1))[0].light_id, KIWAMI_INVALID_ID);
  EXPECT_THROW(lights.pdf(std::span(&receiver, 1), {}), kiwami::Error);
}

}  // namespace

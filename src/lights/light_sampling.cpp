// SPDX-License-Identifier: Apache-2.0
#include "lights/light_sampling.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "math/float_environment.h"

namespace kiwami {
namespace {

/// Receivers that one task answers; fewer than two tasks stay on the calling thread.
constexpr size_t kBlockSize = 512;

/// Calls answer(batch) for all of a batch, in blocks. answer_count: of each receiver.
template <typename Answer>
void for_blocks(const LightTree& tree, const LightMethod& method, const LightBatch& batch,
                size_t answer_count, Answer&& answer) {
  const Parallel& parallel = tree.device().parallel();
  if (batch.count < 2 * kBlockSize || method.on_calling_thread || parallel.width() == 1) {
    const DefaultFloatEnvironment environment;
    answer(batch);
    return;
  }
  parallel.for_blocks(batch.count, kBlockSize, [&](size_t begin, size_t end) {
    LightBatch block = batch;
    block.receivers += begin * batch.receiver_stride;
    if (batch.lobes) block.lobes += begin * batch.lobe_stride;
    if (batch.pixels) block.pixels += begin * batch.pixel_stride;
    if (batch.names) block.names += begin * batch.name_stride;
    block.answers += begin * answer_count * batch.answer_stride;
    block.count = end - begin;
    answer(block);
  });
}

void sample_by_power(const CommittedLights& lights, const LightBatch& batch) {
  for (size_t i = 0; i < batch.count; ++i) {
    kiwami_light_receiver receiver;
    std::memcpy(&receiver, batch.receivers + i * batch.receiver_stride, sizeof receiver);
    const kiwami_light_choice choice = lights.choose_by_power(receiver.random);
    std::memcpy(batch.answers + i * batch.answer_stride, &choice, sizeof choice);
  }
}

/// The receiver's lobe, or null.
const kiwami_light_lobe* read_lobe(const LightBatch& batch, size_t i, kiwami_light_lobe& lobe) {
  if (!batch.lobes) return nullptr;
  std::memcpy(&lobe, batch.lobes + i * batch.lobe_stride, sizeof lobe);
  return &lobe;
}

void play_roulette(const CommittedLights& lights, const RouletteRules& rules,
                   const LightBatch& batch) {
  for (size_t i = 0; i < batch.count; ++i) {
    kiwami_light_receiver receiver;
    std::memcpy(&receiver, batch.receivers + i * batch.receiver_stride, sizeof receiver);
    kiwami_light_choice choices[kMaxLightChoices];
    kiwami_light_lobe lobe;
    kiwami_light_pixel pixel;
    if (batch.pixels) std::memcpy(&pixel, batch.pixels + i * batch.pixel_stride, sizeof pixel);
    const RouletteExtras extras{read_lobe(batch, i, lobe), batch.pixels ? &pixel : nullptr};
    const uint32_t count = lights.play_roulette(receiver, extras, rules, choices);
    for (uint32_t k = 0; k < batch.max_choices; ++k) {
      if (k >= count) choices[k] = {KIWAMI_INVALID_ID, KIWAMI_INVALID_ID, 0, 0.0f, 0.0};
      std::memcpy(batch.answers + (i * batch.max_choices + k) * batch.answer_stride, &choices[k],
                  sizeof choices[k]);
    }
  }
}

void find_roulette_probabilities(const CommittedLights& lights, const RouletteRules& rules,
                                 const LightBatch& batch) {
  for (size_t i = 0; i < batch.count; ++i) {
    kiwami_light_receiver receiver;
    kiwami_light_name name;
    std::memcpy(&receiver, batch.receivers + i * batch.receiver_stride, sizeof receiver);
    std::memcpy(&name, batch.names + i * batch.name_stride, sizeof name);
    kiwami_light_lobe lobe;
    const float probability =
        lights.roulette_probability(receiver, read_lobe(batch, i, lobe), rules, name);
    std::memcpy(batch.answers + i * batch.answer_stride, &probability, sizeof probability);
  }
}

void find_powers(const CommittedLights& lights, const LightBatch& batch) {
  for (size_t i = 0; i < batch.count; ++i) {
    kiwami_light_name name;
    std::memcpy(&name, batch.names + i * batch.name_stride, sizeof name);
    const double exact = lights.probability_by_power(name);
    const float probability =
        exact > 0.0 ? std::max(static_cast<float>(exact), std::numeric_limits<float>::min()) : 0.0f;
    std::memcpy(batch.answers + i * batch.answer_stride, &probability, sizeof probability);
  }
}

}  // namespace

void sample_lights(const LightTree& tree, const LightMethod& method, const LightBatch& batch) {
  const CommittedLights& lights = *tree.committed();
  for_blocks(tree, method, batch, batch.max_choices, [&](const LightBatch& block) {
    switch (method.method) {
      case KIWAMI_LIGHT_METHOD_POWER:
        return sample_by_power(lights, block);
      case KIWAMI_LIGHT_METHOD_CULLING:
      case KIWAMI_LIGHT_METHOD_ROULETTE:
      case KIWAMI_LIGHT_METHOD_LAZY_ROULETTE:
        return play_roulette(lights, method.rules, block);
      case KIWAMI_LIGHT_METHOD_TREE_SPLITTING:
      case KIWAMI_LIGHT_METHOD_LIGHTCUTS:
        return tree.kernels().sample_split(lights.view(), block);
      default:
        return tree.kernels().sample(lights.view(), block);
    }
  });
}

void find_light_probabilities(const LightTree& tree, const LightMethod& method,
                              const LightBatch& batch) {
  const CommittedLights& lights = *tree.committed();
  for_blocks(tree, method, batch, 1, [&](const LightBatch& block) {
    switch (method.method) {
      case KIWAMI_LIGHT_METHOD_POWER:
        return find_powers(lights, block);
      case KIWAMI_LIGHT_METHOD_CULLING:
      case KIWAMI_LIGHT_METHOD_ROULETTE:
      case KIWAMI_LIGHT_METHOD_LAZY_ROULETTE:
        return find_roulette_probabilities(lights, method.rules, block);
      case KIWAMI_LIGHT_METHOD_TREE_SPLITTING:
      case KIWAMI_LIGHT_METHOD_LIGHTCUTS:
        return tree.kernels().pdf_split(lights.view(), block);
      default:
        return tree.kernels().pdf(lights.view(), block);
    }
  });
}

}  // namespace kiwami

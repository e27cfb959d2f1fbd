// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lights/light_tree.h"

namespace kiwami {

/// Whether a method (KIWAMI_LIGHT_METHOD_*) accepts each light for itself.
inline bool is_roulette(uint32_t method) {
  return method == KIWAMI_LIGHT_METHOD_CULLING || method == KIWAMI_LIGHT_METHOD_ROULETTE ||
         method == KIWAMI_LIGHT_METHOD_LAZY_ROULETTE;
}

/// How a batch is to be answered: what kiwami_light_query says, checked.
struct LightMethod {
  uint32_t method;  ///< KIWAMI_LIGHT_METHOD_*
  bool on_calling_thread;
  RouletteRules rules;  ///< of the roulettes
};

/// Answer a batch of a committed tree, in blocks on the device's threads if it is large.
void sample_lights(const LightTree& tree, const LightMethod& method, const LightBatch& batch);
void find_light_probabilities(const LightTree& tree, const LightMethod& method,
                              const LightBatch& batch);

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// What an ISA offers for trees over lights. Plain data only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/light_kernel_set.h"
#include "kiwami/light.h"
#include "lights/light_node.h"

namespace kiwami {

/// Strided runs of receivers, of names (where probabilities are asked for) and of answers, at any
/// address.
struct LightBatch {
  const unsigned char* receivers;  ///< kiwami_light_receiver
  size_t receiver_stride;
  const unsigned char* names;  ///< kiwami_light_name; pdf alone reads it
  size_t name_stride;
  unsigned char* answers;  ///< kiwami_light_choice, or float from pdf
  size_t answer_stride;
  size_t count;

  // Of the methods that make several choices: those of receiver i are answers i * max_choices on,
  // none where there are fewer.
  uint32_t max_choices;
  /// Of adaptive splitting: clusters are split whose relative deviation is at least this.
  double split_limit;
  /// Whether children are compared, and cuts are made, as by stochastic lightcuts.
  bool is_lightcut;

  // Of glossy receivers, in kernels and in the roulettes, which are none.
  const unsigned char* lobes = nullptr;  ///< kiwami_light_lobe, or null
  size_t lobe_stride = 0;

  // Of the roulettes alone.
  const unsigned char* pixels = nullptr;  ///< kiwami_light_pixel, or null
  size_t pixel_stride = 0;
};

}  // namespace kiwami

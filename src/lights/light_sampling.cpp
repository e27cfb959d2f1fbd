// SPDX-License-Identifier: Apache-2.0
#include "lights/light_sampling.h"

#include "math/float_environment.h"

namespace kiwami {
namespace {

/// Receivers that one task answers; fewer than two tasks stay on the calling thread.
constexpr size_t kBlockSize = 512;

}  // namespace

void run_light_kernel(const Parallel& parallel, const LightTreeView& tree, LightKernel kernel,
                      const LightBatch& batch, bool on_calling_thread) {
  if (batch.count < 2 * kBlockSize || on_calling_thread || parallel.width() == 1) {
    const DefaultFloatEnvironment environment;
    kernel(tree, batch);
    return;
  }
  parallel.for_blocks(batch.count, kBlockSize, [&](size_t begin, size_t end) {
    LightBatch block = batch;
    block.receivers += begin * batch.receiver_stride;
    if (batch.names) block.names += begin * batch.name_stride;
    block.answers += begin * batch.answer_stride;
    block.count = end - begin;
    kernel(tree, block);
  });
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// The tree inside a committed scene, for tests that look behind the C API.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/kernel_table.h"
#include "support/library.h"

namespace kiwami_tests {

const kiwami::SceneView& view_of(const kiwami_scene* scene);
const kiwami::TraversalKernels& kernels_of(const kiwami_scene* scene);

/// A copy of a committed scene's tree with one used box drawn inwards by a part of its extent:
/// tests show that they notice. The scene must outlive it and have inner nodes.
class BrokenTree {
 public:
  BrokenTree(const kiwami_scene* scene, uint32_t node, uint32_t axis, float part);

  const kiwami::SceneView& view() const { return view_; }

 private:
  template <int N>
  void shrink(uint32_t number, uint32_t axis, float part);

  struct alignas(64) Line {
    unsigned char bytes[64];
  };
  std::vector<Line> memory_;
  kiwami::SceneView view_;
};

}  // namespace kiwami_tests

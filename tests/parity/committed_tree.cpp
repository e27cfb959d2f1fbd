// SPDX-License-Identifier: Apache-2.0
#include "parity/committed_tree.h"

#include <cstring>

#include "core/scene.h"

namespace kiwami_tests {
namespace {

const kiwami::CommittedScene& committed(const kiwami_scene* scene) {
  return *reinterpret_cast<const kiwami::Scene*>(scene)->committed();
}

}  // namespace

const kiwami::SceneView& view_of(const kiwami_scene* scene) { return committed(scene).view(); }

const kiwami::TraversalKernels& kernels_of(const kiwami_scene* scene) {
  return committed(scene).kernels();
}

BrokenTree::BrokenTree(const kiwami_scene* scene, uint32_t node, uint32_t axis, float part)
    : view_(view_of(scene)) {
  const kiwami_scene_info info = info_of(scene);
  const size_t bytes = info.node_bytes + info.leaf_bytes;
  memory_.resize((bytes + sizeof(Line) - 1) / sizeof(Line));
  std::memcpy(static_cast<void*>(memory_.data()), view_.tree.memory, bytes);
  view_.tree.memory = reinterpret_cast<const unsigned char*>(memory_.data());
  if (info.bvh_width == 4) shrink<4>(node, axis, part);
  if (info.bvh_width == 8) shrink<8>(node, axis, part);
  if (info.bvh_width == 16) shrink<16>(node, axis, part);
}

template <int N>
void BrokenTree::shrink(uint32_t number, uint32_t axis, float part) {
  static_assert(sizeof(kiwami::WideNode<N>) == N * 32);
  auto& node = reinterpret_cast<kiwami::WideNode<N>*>(memory_.data())[number];
  // An unused slot has lower > upper.
  int slot = 0;
  while (!(node.bounds[axis][0][slot] < node.bounds[axis][1][slot])) ++slot;
  float& lower = node.bounds[axis][0][slot];
  lower += (node.bounds[axis][1][slot] - lower) * part;
}

}  // namespace kiwami_tests

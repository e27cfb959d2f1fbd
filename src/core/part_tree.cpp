// SPDX-License-Identifier: Apache-2.0
#include "core/part_tree.h"

#include <algorithm>

#include "bvh/verify_binary.h"
#include "core/pipeline.h"

namespace kiwami {
namespace {

Array<BuildPrimitive> copy_of(const Array<BuildPrimitive>& boxes, Memory& memory) {
  Array<BuildPrimitive> copy(memory, boxes.size());
  std::copy(boxes.begin(), boxes.end(), copy.begin());
  return copy;
}

}  // namespace

PartTree build_part_tree(Array<BuildPrimitive> boxes, const PartPlan& plan) {
  const bool verifies = plan.parameters.whole(KIWAMI_PARAMETER_VALIDATE_BUILD) != 0;
  const TriangleSource no_triangles{};
  Array<BuildPrimitive> kept;
  if (verifies) kept = copy_of(boxes, plan.memory);

  PartTree part;
  part.primitive_count = boxes.size();
  BinaryBvh binary = build_binary_bvh(std::move(boxes), no_triangles, {}, plan.parameters,
                                      plan.width, plan.memory, plan.parallel);
  part.bounds = binary.nodes.empty() ? Bounds::empty() : binary.nodes[0].bounds;
  if (verifies) {
    verify_binary_bvh(binary, kept.data(), kept.size(),
                      binary_leaf_size_of(plan.parameters, plan.width), plan.memory, nullptr);
  }
  WideTreeConfig config = wide_tree_config(plan.parameters, plan.width);
  config.leaf_layout = LeafLayout::kIndices;
  part.tree = build_wide_tree(std::move(binary), no_triangles, config, plan.memory, plan.parallel);
  optimize_wide_tree(part.tree, no_triangles, {}, plan.parameters, plan.memory, plan.parallel);
  if (verifies) verify_wide_tree(part.tree, {kept.data(), kept.size()}, plan.memory);
  return part;
}

}  // namespace kiwami

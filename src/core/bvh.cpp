// SPDX-License-Identifier: Apache-2.0
#include "core/bvh.h"

#include <algorithm>

#include "wide/flat_tree.h"

namespace kiwami {
namespace {

/// Primitives that one task names.
constexpr size_t kBlockSize = 8192;

Array<kiwami_bvh_primitive> name_primitives(const Array<uint32_t>& ids,
                                            const TriangleSource& source, Memory& memory,
                                            const Parallel& parallel) {
  Array<kiwami_bvh_primitive> names(memory, ids.size());
  parallel.for_blocks(ids.size(), kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const TriangleMeshView& mesh = source.mesh_of(ids[i]);
      names[i] = {mesh.geometry_id, ids[i] - mesh.first_id};
    }
  });
  return names;
}

}  // namespace

Bvh* Bvh::create(Device& device, const CommittedScene& scene) {
  return make_object<Bvh>(device.memory(), device, scene);
}

void Bvh::destroy(Bvh* bvh) noexcept {
  const Reference<Device> device = bvh->device_;
  destroy_object(device->memory(), bvh);
}

Bvh::Bvh(Device& device, const CommittedScene& scene) : device_(device) {
  FlatTree flat = flatten(scene.tree(), device.memory());
  nodes_ = std::move(flat.nodes);
  primitives_ =
      name_primitives(flat.primitive_ids, scene.source(), device.memory(), device.parallel());
  describe(scene.tree().width, scene.tree().leaf_width);
}

void Bvh::describe(uint32_t width, uint32_t leaf_width) {
  info_.struct_size = sizeof(info_);
  info_.width = width;
  info_.leaf_width = leaf_width;
  info_.node_count = static_cast<uint32_t>(nodes_.size());
  info_.primitive_count = static_cast<uint32_t>(primitives_.size());
  for (const kiwami_bvh_node& node : nodes_) {
    info_.depth = std::max(info_.depth, node.depth);
    if (node.child_count == 0) ++info_.leaf_count;
  }
  info_.bytes = sizeof(*this) + nodes_.bytes() + primitives_.bytes();
}

}  // namespace kiwami

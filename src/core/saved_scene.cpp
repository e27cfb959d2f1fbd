// SPDX-License-Identifier: Apache-2.0
#include "core/saved_scene.h"

#include "core/error.h"

namespace kiwami {

WideTree SavedTree::tree() const {
  WideTree tree;
  tree.width = tree.leaf_width = width;
  tree.leaf_layout = view.leaf_layout;
  tree.memory = Array<unsigned char>::borrow(const_cast<unsigned char*>(view.memory),
                                             static_cast<size_t>(view.memory_bytes));
  tree.view = view;
  tree.node_count = node_count;
  tree.leaf_block_count = leaf_block_count;
  tree.used_slots = used_slots;
  tree.used_lanes = used_lanes;
  tree.depth = depth;
  tree.sah_cost = sah_cost;
  return tree;
}

void check_saved_part(const char* name, uint64_t numbered_count, const SavedTree* saved) {
  if ((numbered_count != 0) == (saved != nullptr) &&
      (!saved || saved->primitive_count <= numbered_count)) {
    return;
  }
  throw Error(KIWAMI_ERROR_INVALID_FILE,
              "the scene has %llu %s and a tree of %llu of them, expected a tree of no more",
              static_cast<unsigned long long>(numbered_count), name,
              static_cast<unsigned long long>(saved ? saved->primitive_count : 0));
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "builders/joined_nodes.h"

#include <algorithm>

namespace kiwami {
namespace {

constexpr size_t kNodeAlignment = 64;

}  // namespace

JoinedNodes::~JoinedNodes() {
  for (Part& part : parts_) free_part(part);
}

void JoinedNodes::set_subtree_count(size_t count) {
  parts_ = Array<Part>(memory_, count);
  parts_.fill_zero();
}

void JoinedNodes::keep(size_t index, uint32_t root, const BinaryNode* nodes, uint32_t count) {
  const size_t bytes = count * sizeof(BinaryNode);
  Part& part = parts_[index];
  part.nodes = static_cast<BinaryNode*>(memory_.allocate(bytes, kNodeAlignment));
  part.count = count;
  part.root = root;
  std::copy_n(nodes, count, part.nodes);
}

void JoinedNodes::number_parts() {
  node_count_ = static_cast<uint32_t>(top_.size());
  for (Part& part : parts_) {
    part.first = node_count_;
    node_count_ += part.count;
  }
}

void JoinedNodes::place(Part& part, uint32_t first_id, Array<BinaryNode>& nodes) {
  const auto number = [&](BinaryNode node) {
    node.first += node.is_leaf() ? first_id : part.first;
    return node;
  };
  nodes[part.root] = number(nodes[part.root]);
  for (uint32_t k = 0; k < part.count; ++k) nodes[part.first + k] = number(part.nodes[k]);
  free_part(part);
}

void JoinedNodes::free_part(Part& part) {
  if (part.nodes) memory_.deallocate(part.nodes, part.count * sizeof(BinaryNode), kNodeAlignment);
  part.nodes = nullptr;
}

}  // namespace kiwami

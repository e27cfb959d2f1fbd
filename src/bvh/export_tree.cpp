// SPDX-License-Identifier: Apache-2.0
#include "bvh/export_tree.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/error.h"

namespace kiwami {
namespace {

constexpr uint32_t kAnyLeafSize = 0xFFFFFFFF;

constexpr ExportFormat kFormats[] = {
    {0, 0, 0, false},
    {2, kAnyLeafSize, sizeof(kiwami_binary_node), true},
    {4, kAnyLeafSize, sizeof(kiwami_wide4_node), false},
    {8, kAnyLeafSize, sizeof(kiwami_wide8_node), false},
    {8, 3, sizeof(kiwami_compressed8_node), false},
};
static_assert(sizeof(kiwami_binary_node) == 32 && sizeof(kiwami_wide4_node) == 128 &&
              sizeof(kiwami_wide8_node) == 256 && sizeof(kiwami_compressed8_node) == 80);

Array<uint32_t> positions_in_order(size_t count, Memory& memory) {
  Array<uint32_t> positions(memory, count);
  for (size_t i = 0; i < count; ++i) positions[i] = static_cast<uint32_t>(i);
  return positions;
}

/// Flat nodes are breadth first, so siblings are adjacent already.
ExportedTree export_binary(std::span<const kiwami_bvh_node> nodes, Memory& memory) {
  ExportedTree exported{Array<unsigned char>(memory, nodes.size() * sizeof(kiwami_binary_node)),
                        positions_in_order(nodes[0].primitive_count, memory)};
  auto* const target = reinterpret_cast<kiwami_binary_node*>(exported.nodes.data());
  for (size_t i = 0; i < nodes.size(); ++i) {
    const kiwami_bvh_node& node = nodes[i];
    std::copy_n(node.lower, 3, target[i].lower);
    std::copy_n(node.upper, 3, target[i].upper);
    const bool is_leaf = node.child_count == 0;
    target[i].first = is_leaf ? node.first_primitive : node.first_child;
    target[i].count = is_leaf ? node.primitive_count : 0;
  }
  return exported;
}

template <typename Node>
void clear_slots(Node& node) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (auto* lower : {&node.lower_x, &node.lower_y, &node.lower_z}) {
    std::fill(std::begin(*lower), std::end(*lower), infinity);
  }
  for (auto* upper : {&node.upper_x, &node.upper_y, &node.upper_z}) {
    std::fill(std::begin(*upper), std::end(*upper), -infinity);
  }
  std::fill(std::begin(node.child), std::end(node.child), KIWAMI_INVALID_ID);
  std::fill(std::begin(node.count), std::end(node.count), 0u);
}

/// number: what the child is called among the exported nodes, if it is no leaf.
template <typename Node>
void set_slot(Node& node, uint32_t slot, const kiwami_bvh_node& child, uint32_t number) {
  node.lower_x[slot] = child.lower[0];
  node.lower_y[slot] = child.lower[1];
  node.lower_z[slot] = child.lower[2];
  node.upper_x[slot] = child.upper[0];
  node.upper_y[slot] = child.upper[1];
  node.upper_z[slot] = child.upper[2];
  const bool is_leaf = child.child_count == 0;
  node.child[slot] = is_leaf ? child.first_primitive : number;
  node.count[slot] = is_leaf ? child.primitive_count : 0;
}

template <typename Node>
ExportedTree export_wide(std::span<const kiwami_bvh_node> nodes, size_t count, Memory& memory) {
  ExportedTree exported{Array<unsigned char>(memory, count * sizeof(Node)),
                        positions_in_order(nodes[0].primitive_count, memory)};
  auto* const target = reinterpret_cast<Node*>(exported.nodes.data());
  if (nodes[0].child_count == 0) {
    clear_slots(target[0]);
    set_slot(target[0], 0, nodes[0], KIWAMI_INVALID_ID);
    return exported;
  }
  // Nodes keep their order; leaves, which are in their parents' slots, leave it.
  uint32_t next = 0, next_child = 1;
  for (const kiwami_bvh_node& node : nodes) {
    if (node.child_count == 0) continue;
    clear_slots(target[next]);
    for (uint32_t slot = 0; slot < node.child_count; ++slot) {
      const kiwami_bvh_node& child = nodes[node.first_child + slot];
      set_slot(target[next], slot, child, next_child);
      if (child.child_count != 0) ++next_child;
    }
    ++next;
  }
  return exported;
}

}  // namespace

const ExportFormat& export_format(uint32_t format) {
  if (format == 0 || format >= std::size(kFormats)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "format is %u, expected one of KIWAMI_EXPORT_*",
                format);
  }
  return kFormats[format];
}

size_t exported_node_count(std::span<const kiwami_bvh_node> nodes, uint32_t format) {
  const ExportFormat& asked = export_format(format);
  size_t inner_count = 0;
  for (size_t i = 0; i < nodes.size(); ++i) {
    const kiwami_bvh_node& node = nodes[i];
    const bool is_lonely = asked.has_leaf_nodes && node.child_count == 1;
    if (node.child_count > asked.width || is_lonely) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "node %zu has %u children, expected %s %u for format %u", i, node.child_count,
                  asked.has_leaf_nodes ? "exactly" : "at most", asked.width, format);
    }
    if (node.child_count == 0 && node.primitive_count > asked.most_leaf_size) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "leaf %zu has %u primitives, expected at most %u for format %u (see "
                  "KIWAMI_PARAMETER_MAX_LEAF_SIZE)",
                  i, node.primitive_count, asked.most_leaf_size, format);
    }
    if (node.child_count != 0) ++inner_count;
  }
  if (asked.has_leaf_nodes) return nodes.size();
  return nodes.empty() ? 0 : std::max<size_t>(inner_count, 1);
}

ExportedTree export_tree(std::span<const kiwami_bvh_node> nodes, uint32_t format, Memory& memory) {
  const size_t count = exported_node_count(nodes, format);
  if (count == 0) return {};
  switch (format) {
    case KIWAMI_EXPORT_BINARY:
      return export_binary(nodes, memory);
    case KIWAMI_EXPORT_WIDE4:
      return export_wide<kiwami_wide4_node>(nodes, count, memory);
    case KIWAMI_EXPORT_WIDE8:
      return export_wide<kiwami_wide8_node>(nodes, count, memory);
    default:
      return export_compressed(nodes, memory);
  }
}

}  // namespace kiwami

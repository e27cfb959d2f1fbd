// SPDX-License-Identifier: Apache-2.0
#include "parity/test_tree.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace kiwami_tests {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kMax = std::numeric_limits<float>::max();

/// bound - centre, one step outwards: the subtraction is off by half a step at most.
float moved_down(float bound, float centre) { return std::nextafter(bound - centre, -kInfinity); }
float moved_up(float bound, float centre) { return std::nextafter(bound - centre, kInfinity); }

template <typename Entry>
void bounds_of(const Entry* entries, size_t count, Point& lower, Point& upper) {
  lower = {kInfinity, kInfinity, kInfinity};
  upper = {-kInfinity, -kInfinity, -kInfinity};
  for (size_t i = 0; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], entries[i].lower[axis]);
      upper[axis] = std::max(upper[axis], entries[i].upper[axis]);
    }
  }
}

bool is_usable(Point p) {
  const auto is_in_range = [](float x) { return std::fabs(x) <= KIWAMI_MAX_COORDINATE; };
  return is_in_range(p.x) && is_in_range(p.y) && is_in_range(p.z);
}

}  // namespace

TestTree::TestTree(const Scene& scene, uint32_t width) : width_(width) {
  std::vector<Entry> entries;
  uint32_t first_id = 0;
  for (uint32_t geometry = 0; geometry < scene.meshes.size(); ++geometry) {
    const Mesh& mesh = scene.meshes[geometry];
    ranges_.push_back({first_id, geometry, mesh.mask});
    if (mesh.mask != ~0u) view_.has_masks = 1;
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto corner = mesh.corners(i);
      if (!std::all_of(corner.begin(), corner.end(), is_usable)) continue;
      Entry entry{corner[0], corner[0], first_id + i, {corner[0], corner[1], corner[2]}};
      for (const Point& p : corner) {
        for (int axis = 0; axis < 3; ++axis) {
          entry.lower[axis] = std::min(entry.lower[axis], p[axis]);
          entry.upper[axis] = std::max(entry.upper[axis], p[axis]);
        }
      }
      entries.push_back(entry);
    }
    first_id += static_cast<uint32_t>(mesh.triangles.size());
  }
  view_.ranges = ranges_.data();
  view_.range_count = static_cast<uint32_t>(ranges_.size());
  if (width == 4) build<4>(entries);
  if (width == 8) build<8>(entries);
  if (width == 16) build<16>(entries);
}

template <int N>
void TestTree::build(std::vector<Entry>& entries) {
  if (entries.empty()) return;
  Point lower, upper;
  bounds_of(entries.data(), entries.size(), lower, upper);
  const Point centre = lower * 0.5f + upper * 0.5f;
  view_.tree.centre = {centre.x, centre.y, centre.z};
  for (int axis = 0; axis < 3; ++axis) {
    view_.tree.greatest_bound[axis] = std::max(std::fabs(moved_down(lower[axis], centre[axis])),
                                               std::fabs(moved_up(upper[axis], centre[axis])));
  }
  view_.tree.root = build_node<N>(entries.data(), entries.size());
  join<N>();
}

/// Moves nodes and leaves together, and the references to leaves from their own array to there.
template <int N>
void TestTree::join() {
  using kiwami::ChildReference;
  const size_t node_bytes = nodes<N>().size() * sizeof(kiwami::WideNode<N>);
  const auto moved = [&](ChildReference to) {
    return to.is_leaf() ? ChildReference::to_leaf(node_bytes + to.leaf_offset(), to.mask()) : to;
  };
  for (auto& node : nodes<N>()) {
    for (ChildReference& child : node.child) child = moved(child);
  }
  view_.tree.root = moved(view_.tree.root);
  const size_t leaf_bytes = leaves<N>().size() * sizeof(kiwami::LeafBlock<N>);
  memory_.resize((node_bytes + leaf_bytes + sizeof(Line) - 1) / sizeof(Line));
  auto* const bytes = reinterpret_cast<unsigned char*>(memory_.data());
  if (node_bytes != 0) std::memcpy(bytes, nodes<N>().data(), node_bytes);
  std::memcpy(bytes + node_bytes, leaves<N>().data(), leaf_bytes);
  view_.tree.memory = bytes;
  view_.tree.memory_bytes = node_bytes + leaf_bytes;
}

template <int N>
kiwami::ChildReference TestTree::build_node(Entry* entries, size_t count) {
  if (count <= N) return add_leaf<N>(entries, count);
  Point lower, upper;
  bounds_of(entries, count, lower, upper);
  const Point extent = upper * 0.5f - lower * 0.5f;
  const int axis =
      extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
  std::sort(entries, entries + count, [&](const Entry& a, const Entry& b) {
    const float at = a.lower[axis] + a.upper[axis], bt = b.lower[axis] + b.upper[axis];
    return at != bt ? at < bt : a.id < b.id;
  });
  const size_t number = nodes<N>().size();
  nodes<N>().emplace_back();
  kiwami::WideNode<N> node{};
  uint32_t mask = 0;
  const Point centre{view_.tree.centre.x, view_.tree.centre.y, view_.tree.centre.z};
  for (size_t slot = 0; slot < N; ++slot) {
    const size_t begin = count * slot / N, end = count * (slot + 1) / N;
    for (int a = 0; a < 3; ++a) {
      node.bounds[a][0][slot] = kMax;
      node.bounds[a][1][slot] = -kMax;
    }
    if (begin == end) continue;
    mask |= 1u << slot;
    bounds_of(entries + begin, end - begin, lower, upper);
    for (int a = 0; a < 3; ++a) {
      node.bounds[a][0][slot] = moved_down(lower[a], centre[a]);
      node.bounds[a][1][slot] = moved_up(upper[a], centre[a]);
    }
    node.child[slot] = build_node<N>(entries + begin, end - begin);
  }
  nodes<N>()[number] = node;
  return kiwami::ChildReference::to_node(number * sizeof node, mask);
}

template <int N>
kiwami::ChildReference TestTree::add_leaf(const Entry* entries, size_t count) {
  kiwami::LeafBlock<N> block{};
  for (auto& vertex : block.position) {
    for (auto& axis : vertex) std::fill_n(axis, N, std::numeric_limits<float>::quiet_NaN());
  }
  // The last lanes, so that a mask which is not applied shows.
  const size_t first = N - count;
  uint32_t mask = 0;
  for (size_t i = 0; i < count; ++i) {
    const size_t lane = first + i;
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        block.position[k][axis][lane] = entries[i].corner[k][axis];
      }
    }
    block.id[lane] = entries[i].id;
    mask |= 1u << lane;
  }
  leaves<N>().push_back(block);
  return kiwami::ChildReference::to_leaf((leaves<N>().size() - 1) * sizeof block, mask);
}

template <int N>
void TestTree::shrink(uint32_t number, float part) {
  auto& node = reinterpret_cast<kiwami::WideNode<N>*>(memory_.data())[number % nodes<N>().size()];
  const uint32_t slot = number % N, axis = number % 3, side = number / 3 % 2;
  float& bound = node.bounds[axis][side][slot];
  bound += (node.bounds[axis][1 - side][slot] - bound) * part;
}

void TestTree::shrink_box(uint32_t number, float part) {
  if (width_ == 4) shrink<4>(number, part);
  if (width_ == 8) shrink<8>(number, part);
  if (width_ == 16) shrink<16>(number, part);
}

}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
// Wide trees made without the library's builders, so that the kernels are judged alone.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/kernel_table.h"
#include "support/mesh.h"

namespace kiwami_tests {

/// A scene for the kernels: split at the median along the longest axis, by the format's rules
/// (boxes relative to the centre and rounded outwards), without sharing nodes.
class TestTree {
 public:
  TestTree(const Scene& scene, uint32_t width);

  const kiwami::SceneView& view() const { return view_; }

  /// Draws one side of some used box inwards by this part of the box's extent there, which breaks
  /// the tree: tests show that they notice.
  void shrink_box(uint32_t number, float part);

 private:
  struct Entry {
    Point lower, upper;
    uint32_t id;
    Point corner[3];
  };

  template <int N>
  void build(std::vector<Entry>& entries);
  template <int N>
  kiwami::ChildReference build_node(Entry* entries, size_t count);
  template <int N>
  kiwami::ChildReference add_leaf(const Entry* entries, size_t count);
  template <int N>
  void join();
  template <int N>
  void shrink(uint32_t number, float part);

  struct alignas(64) Line {
    unsigned char bytes[64];
  };

  uint32_t width_;
  std::vector<Line> memory_;  ///< what the view points to
  std::vector<kiwami::WideNode<4>> nodes4_;
  std::vector<kiwami::WideNode<8>> nodes8_;
  std::vector<kiwami::WideNode<16>> nodes16_;
  std::vector<kiwami::LeafBlock<4>> leaves4_;
  std::vector<kiwami::LeafBlock<8>> leaves8_;
  std::vector<kiwami::LeafBlock<16>> leaves16_;
  std::vector<kiwami::GeometryRange> ranges_;
  kiwami::SceneView view_{};

  template <int N>
  auto& nodes() {
    if constexpr (N == 4) return nodes4_;
    if constexpr (N == 8) return nodes8_;
    if constexpr (N == 16) return nodes16_;
  }
  template <int N>
  auto& leaves() {
    if constexpr (N == 4) return leaves4_;
    if constexpr (N == 8) return leaves8_;
    if constexpr (N == 16) return leaves16_;
  }
};

}  // namespace kiwami_tests

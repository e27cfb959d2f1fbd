// SPDX-License-Identifier: Apache-2.0
// The 80-byte nodes of H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal on GPUs
// Through Compressed Wide BVHs", HPG 2017. Departs from it where children are assigned to slots:
// their sum of costs is the least there is, by dynamic programming, in place of an auction's.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "bvh/export_tree.h"

namespace kiwami {
namespace {

constexpr uint32_t kSlots = 8;
constexpr int kExponentBias = 127;
constexpr int kLeastExponent = -126;
constexpr uint8_t kInnerMeta = 0x20 + 24;
constexpr uint32_t kNoChild = kSlots;

/// How many steps of 2^exponent a coordinate lies above the origin, rounded down or up in real
/// numbers. A product of a step is exact and rounding to floats keeps the order, so what is decoded
/// in floats lies as far out.
double steps_down(float origin, float coordinate, int exponent) {
  const double wide_origin = origin, wide_coordinate = coordinate;
  const double difference = wide_coordinate - wide_origin;
  // What the double could not hold where the exponents lie far apart (Knuth's two-sum).
  const double back = difference - wide_coordinate;
  const double error = (wide_coordinate - (difference - back)) - (wide_origin + back);
  const double steps = std::ldexp(difference, -exponent);
  const double whole = std::floor(steps);
  return whole == steps && error < 0.0 ? whole - 1.0 : whole;
}
double steps_up(float origin, float coordinate, int exponent) {
  return -steps_down(-origin, -coordinate, exponent);
}

/// The least step with which 255 reach over the node's box.
int exponent_of(float lower, float upper) {
  const double extent = static_cast<double>(upper) - static_cast<double>(lower);
  int exponent = extent > 0.0 ? std::ilogb(extent) - 7 : kLeastExponent;
  exponent = std::max(exponent, kLeastExponent);
  while (steps_up(lower, upper, exponent) > 255.0) ++exponent;
  return exponent;
}

/// Twice the middle of a box.
void doubled_centre(const kiwami_bvh_node& node, double centre[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    centre[axis] = static_cast<double>(node.lower[axis]) + static_cast<double>(node.upper[axis]);
  }
}

/// Which child goes into which slot: bits 2, 1, 0 of a slot say that it is seen first by rays
/// towards lower x, y, z.
class SlotAssignment {
 public:
  SlotAssignment(const kiwami_bvh_node& node, const kiwami_bvh_node* children) {
    double centre[3];
    doubled_centre(node, centre);
    for (uint32_t i = 0; i < node.child_count; ++i) {
      double of_child[3];
      doubled_centre(children[i], of_child);
      for (uint32_t slot = 0; slot < kSlots; ++slot) {
        double& cost = cost_[i][slot];
        cost = 0.0;
        for (uint32_t axis = 0; axis < 3; ++axis) {
          const double offset = of_child[axis] - centre[axis];
          cost += slot & (4u >> axis) ? -offset : offset;
        }
      }
    }
    assign(node.child_count);
  }

  /// kNoChild for an empty slot.
  uint32_t child_of(uint32_t slot) const { return child_of_[slot]; }

 private:
  /// The least cost of the first children in each set of slots, child by child.
  void assign(uint32_t count) {
    double least[1u << kSlots];
    uint8_t last_slot[1u << kSlots];
    least[0] = 0.0;
    for (uint32_t taken = 1; taken < 1u << kSlots; ++taken) {
      const auto child = static_cast<uint32_t>(std::popcount(taken)) - 1;
      if (child >= count) continue;
      least[taken] = std::numeric_limits<double>::infinity();
      last_slot[taken] = static_cast<uint8_t>(std::countr_zero(taken));
      for (uint32_t left = taken; left != 0; left &= left - 1) {
        const auto slot = static_cast<uint32_t>(std::countr_zero(left));
        const double cost = least[taken ^ (1u << slot)] + cost_[child][slot];
        if (!(cost < least[taken])) continue;
        least[taken] = cost;
        last_slot[taken] = static_cast<uint8_t>(slot);
      }
    }
    uint32_t best = (1u << count) - 1;
    for (uint32_t taken = 1; taken < 1u << kSlots; ++taken) {
      if (std::popcount(taken) == static_cast<int>(count) && least[taken] < least[best]) {
        best = taken;
      }
    }
    std::fill_n(child_of_, kSlots, kNoChild);
    for (uint32_t child = count; child-- > 0;) {
      const uint32_t slot = last_slot[best];
      child_of_[slot] = child;
      best ^= 1u << slot;
    }
  }

  double cost_[kSlots][kSlots];  ///< by child and slot
  uint32_t child_of_[kSlots];
};

/// Numbers nodes and primitives while it writes: the children of a node follow each other in the
/// order of their slots, and so do the primitives of its leaves.
class Compressor {
 public:
  Compressor(std::span<const kiwami_bvh_node> nodes, Memory& memory)
      : nodes_(nodes), order_(memory), compressed_(memory), positions_(memory) {}

  ExportedTree run(Memory& memory) {
    if (nodes_[0].child_count == 0) {
      // A leaf alone: the one child of a node of the same box.
      kiwami_bvh_node parent = nodes_[0];
      parent.child_count = 1;
      write(parent, &nodes_[0], 0);
    } else {
      order_.push_back(0);
    }
    for (size_t i = 0; i < order_.size(); ++i) {
      const kiwami_bvh_node& node = nodes_[order_[i]];
      write(node, &nodes_[node.first_child], node.first_child);
    }
    ExportedTree exported{
        Array<unsigned char>(memory, compressed_.size() * sizeof(kiwami_compressed8_node)),
        positions_.take()};
    const Array<kiwami_compressed8_node> written = compressed_.take();
    std::memcpy(exported.nodes.data(), written.data(), written.bytes());
    return exported;
  }

 private:
  void write(const kiwami_bvh_node& node, const kiwami_bvh_node* children, uint32_t first_child) {
    kiwami_compressed8_node made{};
    int exponent[3];
    for (int axis = 0; axis < 3; ++axis) {
      exponent[axis] = exponent_of(node.lower[axis], node.upper[axis]);
      made.origin[axis] = node.lower[axis];
      made.exponent[axis] = static_cast<uint8_t>(exponent[axis] + kExponentBias);
    }
    made.child_base = static_cast<uint32_t>(order_.size());
    made.primitive_base = static_cast<uint32_t>(positions_.size());
    const SlotAssignment assignment(node, children);
    uint8_t* const lower[3] = {made.lower_x, made.lower_y, made.lower_z};
    uint8_t* const upper[3] = {made.upper_x, made.upper_y, made.upper_z};
    for (uint32_t slot = 0; slot < kSlots; ++slot) {
      const uint32_t i = assignment.child_of(slot);
      if (i == kNoChild) {
        for (uint8_t* bound : lower) bound[slot] = 255;
        continue;
      }
      const kiwami_bvh_node& child = children[i];
      for (int axis = 0; axis < 3; ++axis) {
        lower[axis][slot] =
            static_cast<uint8_t>(steps_down(node.lower[axis], child.lower[axis], exponent[axis]));
        upper[axis][slot] =
            static_cast<uint8_t>(steps_up(node.lower[axis], child.upper[axis], exponent[axis]));
      }
      if (child.child_count != 0) {
        made.inner_mask = static_cast<uint8_t>(made.inner_mask | 1u << slot);
        made.meta[slot] = static_cast<uint8_t>(kInnerMeta + slot);
        order_.push_back(first_child + i);
      } else {
        made.meta[slot] = leaf_meta(child, made.primitive_base);
      }
    }
    compressed_.push_back(made);
  }

  uint8_t leaf_meta(const kiwami_bvh_node& leaf, uint32_t primitive_base) {
    const size_t offset = positions_.size() - primitive_base;
    for (uint32_t i = 0; i < leaf.primitive_count; ++i) {
      positions_.push_back(leaf.first_primitive + i);
    }
    const uint32_t unary = (1u << leaf.primitive_count) - 1;
    return static_cast<uint8_t>(unary << 5 | offset);
  }

  std::span<const kiwami_bvh_node> nodes_;
  GrowingArray<uint32_t> order_;  ///< flat nodes by their number among the compressed ones
  GrowingArray<kiwami_compressed8_node> compressed_;
  GrowingArray<uint32_t> positions_;
};

}  // namespace

ExportedTree export_compressed(std::span<const kiwami_bvh_node> nodes, Memory& memory) {
  return Compressor(nodes, memory).run(memory);
}

}  // namespace kiwami

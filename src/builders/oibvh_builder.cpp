// SPDX-License-Identifier: Apache-2.0
#include "builders/oibvh_builder.h"

#include "builders/morton_order.h"

namespace kiwami {

BinaryBvh OibvhBuilder::build(Array<BuildPrimitive> primitives, Memory& memory,
                              const Parallel& parallel) {
  MortonOrder order = sort_by_morton_code(std::move(primitives), memory, parallel);
  order.codes = {};
  const ImplicitBvh implicit(order.primitives, memory, parallel);
  order.primitives = {};
  return implicit.to_binary(memory, parallel);
}

}  // namespace kiwami

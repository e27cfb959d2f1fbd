// SPDX-License-Identifier: Apache-2.0
#include "unit/binary_tree_test.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>

#include "builders/binned_sah_builder.h"
#include "bvh/verify_binary.h"
#include "support/environment.h"

namespace kiwami_tests {

using kiwami::Array;
using kiwami::BinaryBvh;

void BinaryTreeTest::SetUp() {
  RecordProperty("seed", std::to_string(seed()));
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
}

BinaryBvh BinaryTreeTest::build_binned(const Mesh& mesh, uint32_t max_leaf_size) {
  kiwami::BinnedSahBuilder::Config config;
  config.max_leaf_size = config.block_size = max_leaf_size;
  return kiwami::BinnedSahBuilder::build(primitives_of(mesh, memory_), config, memory_, Threads(1));
}

void BinaryTreeTest::verify(const BinaryBvh& bvh, const Mesh& mesh, uint32_t max_leaf_size) {
  const Array<kiwami::BuildPrimitive> primitives = primitives_of(mesh, memory_);
  kiwami::verify_binary_bvh(bvh, primitives.data(), primitives.size(), max_leaf_size, memory_);
}

BinaryBvh BinaryTreeTest::copy(const BinaryBvh& bvh) {
  BinaryBvh made{Array<kiwami::BinaryNode>(memory_, bvh.nodes.size()),
                 Array<uint32_t>(memory_, bvh.primitive_ids.size())};
  std::copy(bvh.nodes.begin(), bvh.nodes.end(), made.nodes.begin());
  std::copy(bvh.primitive_ids.begin(), bvh.primitive_ids.end(), made.primitive_ids.begin());
  return made;
}

bool are_equal(const BinaryBvh& a, const BinaryBvh& b) {
  const auto have_equal_bytes = [](const auto& one, const auto& other) {
    return one.size() == other.size() &&
           (one.empty() || std::memcmp(one.data(), other.data(), one.bytes()) == 0);
  };
  return have_equal_bytes(a.nodes, b.nodes) && have_equal_bytes(a.primitive_ids, b.primitive_ids);
}

std::string text_of(const BinaryBvh& bvh, uint32_t index) {
  const kiwami::BinaryNode& node = bvh.nodes[index];
  if (node.is_leaf()) return std::to_string(bvh.primitive_ids[node.first]);
  return "(" + text_of(bvh, node.first) + " " + text_of(bvh, node.first + 1) + ")";
}

float area_of_both(const kiwami::Bounds& a, const kiwami::Bounds& b) {
  kiwami::Bounds both = a;
  both.extend(b);
  return both.half_area();
}

}  // namespace kiwami_tests

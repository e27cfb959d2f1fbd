// SPDX-License-Identifier: Apache-2.0
#include "wide/leaf_merging.h"

#include <gtest/gtest.h>

#include <bit>
#include <vector>

#include "support/environment.h"
#include "support/random.h"

namespace kiwami_tests {
namespace {

using kiwami::Array;
using kiwami::SharedPlace;
using kiwami::SharedPlaces;

class LeafMerging : public testing::Test {
 protected:
  LeafMerging() : memory_(nullptr, nullptr, nullptr) {}

  Array<uint8_t> sizes_of(const std::vector<int>& values) {
    Array<uint8_t> sizes(memory_, values.size());
    for (size_t i = 0; i < values.size(); ++i) sizes[i] = static_cast<uint8_t>(values[i]);
    return sizes;
  }

  kiwami::Memory memory_;
};

void check(const Array<uint8_t>& sizes, const SharedPlaces& shared, uint32_t width) {
  std::vector<uint32_t> owned(shared.count(), 0);
  ASSERT_EQ(shared.places.size(), sizes.size());
  for (size_t i = 0; i < sizes.size(); ++i) {
    const SharedPlace& place = shared.places[i];
    ASSERT_LT(place.index, shared.count());
    EXPECT_EQ(std::popcount(place.mask), sizes[i]);
    EXPECT_EQ(place.mask, ((1u << sizes[i]) - 1) << place.first);
    EXPECT_EQ(place.mask >> width, 0);
    EXPECT_EQ(owned[place.index] & place.mask, 0u) << "owner " << i;
    owned[place.index] |= place.mask;
  }
  for (size_t i = 0; i < owned.size(); ++i) {
    EXPECT_NE(owned[i], 0u);
    EXPECT_EQ(owned[i], shared.used[i]);
  }
}

TEST_F(LeafMerging, MasksAreDisjointAndOfTheirSize) {
  Random random(seed());
  for (const uint32_t width : {4u, 8u, 16u}) {
    for (const uint32_t ring : {0u, 1u, 2u, 8u, 100u}) {
      Array<uint8_t> sizes(memory_, 2000);
      for (uint8_t& size : sizes) size = static_cast<uint8_t>(1 + random.below(width));
      const SharedPlaces shared = kiwami::place_shared(sizes, width, ring, memory_);
      check(sizes, shared, width);
      EXPECT_LT(shared.count(), sizes.size());
    }
  }
}

TEST_F(LeafMerging, ExactFitsFillEveryNode) {
  const Array<uint8_t> sizes = sizes_of({5, 2, 4, 8, 6, 3, 4, 2, 2, 4});
  const SharedPlaces shared = kiwami::place_shared(sizes, 8, 8, memory_);
  check(sizes, shared, 8);
  EXPECT_EQ(shared.count(), 5u);
}

TEST_F(LeafMerging, OwnersThatNobodyCanJoinStayAlone) {
  const Array<uint8_t> sizes = sizes_of({7, 7, 8, 7, 2});
  const SharedPlaces shared = kiwami::place_shared(sizes, 8, 8, memory_);
  check(sizes, shared, 8);
  EXPECT_EQ(shared.count(), 5u);
}

TEST_F(LeafMerging, ARingOfOneGivesUpTheOpenNode) {
  const Array<uint8_t> sizes = sizes_of({5, 4, 4});
  const SharedPlaces shared = kiwami::place_shared(sizes, 8, 1, memory_);
  check(sizes, shared, 8);
  EXPECT_EQ(shared.count(), 2u);
  EXPECT_NE(shared.places[0].index, shared.places[1].index);
  EXPECT_EQ(shared.places[1].index, shared.places[2].index);
}

TEST_F(LeafMerging, AGivenUpNodeIsCompletedByAnExactFit) {
  const Array<uint8_t> sizes = sizes_of({5, 4, 4, 6, 3, 2});
  const SharedPlaces shared = kiwami::place_shared(sizes, 8, 1, memory_);
  check(sizes, shared, 8);
  EXPECT_EQ(shared.count(), 3u);
  EXPECT_EQ(shared.places[0].index, shared.places[4].index);
}

TEST_F(LeafMerging, NodesAreNumberedByTheirLastOwner) {
  // 6 and 2 share a node; the 8 between them comes before the last of its owners.
  const Array<uint8_t> sizes = sizes_of({6, 8, 2});
  const SharedPlaces shared = kiwami::place_shared(sizes, 8, 8, memory_);
  EXPECT_EQ(shared.places[1].index, 0u);
  EXPECT_EQ(shared.places[0].index, 1u);
  EXPECT_EQ(shared.places[2].index, 1u);
}

TEST_F(LeafMerging, AloneMeansOneNodeEach) {
  const Array<uint8_t> sizes = sizes_of({2, 3, 8});
  const SharedPlaces alone = kiwami::place_alone(sizes, memory_);
  check(sizes, alone, 8);
  EXPECT_EQ(alone.count(), 3u);
}

TEST_F(LeafMerging, NoOwnersNeedNoNodes) {
  EXPECT_EQ(kiwami::place_shared(Array<uint8_t>(memory_, 0), 8, 8, memory_).count(), 0u);
}

}  // namespace
}  // namespace kiwami_tests

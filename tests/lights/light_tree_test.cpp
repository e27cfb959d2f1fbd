// SPDX-License-Identifier: Apache-2.0
// The trees over lights themselves: every light once, and what bounds it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

#include "lights/committed_lights.h"
#include "lights/light_scene.h"
#include "lights/light_tree.h"
#include "support/environment.h"
#include "support/library.h"

namespace kiwami_tests {
namespace {

using kiwami::LightNode;
using kiwami::LightTreeView;

const LightTreeView& view_of(const LightTreeHandle& tree) {
  return reinterpret_cast<const kiwami::LightTree*>(tree.get())->committed()->view();
}

kiwami_light_tree_info info_of(const LightTreeHandle& tree) {
  kiwami_light_tree_info info{};
  info.struct_size = sizeof info;
  check(kiwami_light_tree_get_info(tree.get(), &info));
  return info;
}

/// Walks the nodes: slots refer to each other, boxes and energies of nodes hold those below.
template <int N>
class Walk {
 public:
  explicit Walk(const LightTreeView& view) : view_(view) {}

  void run() {
    std::vector<uint32_t> leaf_visits(view_.light_count + view_.instance_count, 0);
    if (view_.node_count != 0) visit(0, 1, leaf_visits);
    for (uint32_t leaf = 0; leaf < leaf_visits.size() && view_.node_count != 0; ++leaf) {
      const bool is_in_tree = view_.leaf_slots[leaf] != kiwami::kNoLightSlot;
      EXPECT_EQ(leaf_visits[leaf], is_in_tree ? 1u : 0u) << "leaf " << leaf;
    }
    EXPECT_EQ(nodes_, view_.node_count);
  }

  uint32_t depth() const { return depth_; }

 private:
  const LightNode<N>& node(uint32_t index) const {
    return static_cast<const LightNode<N>*>(view_.nodes)[index];
  }

  static void expect_inside(const LightNode<N>& inner, int i, const LightNode<N>& outer, int o) {
    for (int axis = 0; axis < 3; ++axis) {
      const double difference = std::fabs(static_cast<double>(inner.centre[axis][i]) -
                                          static_cast<double>(outer.centre[axis][o]));
      const double slack = 4e-7 * (std::fabs(static_cast<double>(inner.centre[axis][i])) +
                                   static_cast<double>(outer.half_extent[axis][o]));
      EXPECT_LE(difference + static_cast<double>(inner.half_extent[axis][i]),
                static_cast<double>(outer.half_extent[axis][o]) + slack);
    }
  }

  void visit(uint32_t index, uint32_t depth, std::vector<uint32_t>& leaf_visits) {
    ++nodes_;
    depth_ = std::max(depth_, depth);
    for (uint32_t slot = 0; slot < N; ++slot) {
      const uint32_t child = node(index).child[slot];
      const float energy = node(index).energy[slot];
      if (child == kiwami::kNoLightSlot) {
        EXPECT_EQ(energy, 0.0f);
        continue;
      }
      if (child & kiwami::kLightLeafBit) {
        const uint32_t leaf = child & ~kiwami::kLightLeafBit;
        ++leaf_visits.at(leaf);
        EXPECT_EQ(view_.leaf_slots[leaf], index * N + slot);
        continue;
      }
      EXPECT_EQ(view_.parent_slots[child], index * N + slot);
      double below = 0.0;
      uint64_t masks = 0;
      for (int i = 0; i < N; ++i) {
        if (node(child).child[i] == kiwami::kNoLightSlot) continue;
        below += static_cast<double>(node(child).energy[i]);
        masks |= node(child).link_mask[i];
        expect_inside(node(child), i, node(index), static_cast<int>(slot));
      }
      EXPECT_NEAR(below, static_cast<double>(energy), 1e-5 * below);
      EXPECT_EQ(masks, node(index).link_mask[slot]);
      visit(child, depth + 1, leaf_visits);
    }
  }

  const LightTreeView& view_;
  uint32_t nodes_ = 0;
  uint32_t depth_ = 0;
};

uint32_t walk(const LightTreeView& view, uint32_t width) {
  const auto run = [](auto walk) {
    walk.run();
    return walk.depth();
  };
  // Nodes of two children have four slots.
  if (width <= 4) return run(Walk<4>(view));
  if (width == 8) return run(Walk<8>(view));
  return run(Walk<16>(view));
}

TEST(LightTree, HoldsEachLightOnceInEveryWidth) {
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed(), 610);
  const DeviceHandle device = make_device(KIWAMI_ISA_SCALAR, 1);
  for (const uint32_t count : {1u, 2u, 3u, 8u, 9u, 17u, 100u, 3000u}) {
    LightSceneOptions options;
    options.light_count = count;
    options.group_count = count % 3;
    options.distant_count = count % 2;
    options.has_link_masks = count > 8;
    const LightScene scene = random_light_scene(options, random);
    for (const uint32_t width : {2u, 4u, 8u, 16u}) {
      for (const uint32_t builder : {KIWAMI_LIGHT_BUILDER_SAOH, KIWAMI_LIGHT_BUILDER_OCTANTS}) {
        const LightTreeHandle tree = make_light_tree(device.get(), scene, width, builder);
        const kiwami_light_tree_info info = info_of(tree);
        EXPECT_EQ(info.width, width);
        EXPECT_EQ(info.depth, walk(view_of(tree), width));
        EXPECT_EQ(info.light_count, scene.lights.size());
        EXPECT_EQ(info.instance_count, scene.groups.size());
        EXPECT_EQ(info.distant_count, options.distant_count);
      }
    }
  }
}

TEST(LightTree, DegenerateSetsAreShallowEnough) {
  const DeviceHandle device = make_device(KIWAMI_ISA_SCALAR, 1);
  for (const int kind : {0, 1, 2}) {
    LightScene scene;
    for (int i = 0; i < 5000; ++i) {
      kiwami_light light{};
      light.type = KIWAMI_LIGHT_POINT;
      light.power = kind == 2 ? 0.0f : 1.0f;
      light.link_mask = ~uint64_t{0};
      // All at one place; or each a thousandth of the distance of the next, down to nothing.
      if (kind == 1) light.points[0] = std::ldexp(1.0f, 60 - i % 180);
      scene.lights.push_back(light);
    }
    for (const uint32_t width : {2u, 8u}) {
      const LightTreeHandle tree = make_light_tree(device.get(), scene, width);
      EXPECT_LE(walk(view_of(tree), width), kiwami::kMaxLightDepth);
    }
  }
}

TEST(LightTree, IsTheSameForEveryNumberOfThreads) {
  Random random(seed(), 611);
  LightSceneOptions options;
  options.light_count = 20000;
  const LightScene scene = random_light_scene(options, random);
  std::vector<unsigned char> first;
  for (const uint32_t threads : {1u, 2u, 5u}) {
    const DeviceHandle device = make_device(KIWAMI_ISA_SCALAR, threads);
    const LightTreeHandle tree = make_light_tree(device.get(), scene, 8);
    const auto* bytes = static_cast<const unsigned char*>(view_of(tree).nodes);
    const std::vector<unsigned char> nodes(bytes,
                                           bytes + view_of(tree).node_count * sizeof(LightNode<8>));
    if (first.empty()) first = nodes;
    EXPECT_EQ(nodes, first);
  }
}

TEST(LightTree, RefitOfTheSameLightsChangesNothing) {
  Random random(seed(), 612);
  LightSceneOptions options;
  options.light_count = 500;
  options.group_count = 2;
  const LightScene scene = random_light_scene(options, random);
  const DeviceHandle device = make_device(KIWAMI_ISA_SCALAR, 1);
  const LightTreeHandle tree = make_light_tree(device.get(), scene, 8);
  const size_t bytes = view_of(tree).node_count * sizeof(LightNode<8>);
  const std::vector<unsigned char> before(
      static_cast<const unsigned char*>(view_of(tree).nodes),
      static_cast<const unsigned char*>(view_of(tree).nodes) + bytes);
  check(kiwami_light_tree_refit(tree.get()));
  EXPECT_EQ(std::memcmp(view_of(tree).nodes, before.data(), bytes), 0);
}

TEST(LightTree, RefitFollowsMovedLights) {
  Random random(seed(), 613);
  LightSceneOptions options;
  options.light_count = 300;
  LightScene scene = random_light_scene(options, random);
  const DeviceHandle device = make_device(KIWAMI_ISA_SCALAR, 1);
  const LightTreeHandle tree = make_light_tree(device.get(), scene, 4);
  const double cost = info_of(tree).cost;
  // Other places and powers, at random: the shape no longer fits, but the bounds do.
  const LightScene other = random_light_scene(options, random);
  check(kiwami_light_tree_set_lights(tree.get(), 0, other.lights.data(), 0, 300));
  check(kiwami_light_tree_refit(tree.get()));
  walk(view_of(tree), 4);
  EXPECT_GT(info_of(tree).cost, cost);
  const LightTreeHandle rebuilt = make_light_tree(device.get(), other, 4);
  EXPECT_LT(info_of(rebuilt).cost, info_of(tree).cost);
}

TEST(LightTree, OrientationMatters) {
  // A sphere of small triangles facing outwards: to a tree that looks at directions, half of them
  // are known to face away.
  LightScene scene;
  Random random(seed(), 614);
  for (int i = 0; i < 2000; ++i) {
    kiwami_light light{};
    float size = 0.0f;
    do {
      for (float& x : light.direction) x = random.symmetric();
      size = std::hypot(light.direction[0], light.direction[1], light.direction[2]);
    } while (size > 1.0f || size < 0.1f);
    for (int axis = 0; axis < 3; ++axis) light.points[axis] = light.direction[axis] / size;
    light.type = KIWAMI_LIGHT_DISC;
    light.radius = 0.01f;
    light.power = 1.0f;
    light.link_mask = ~uint64_t{0};
    scene.lights.push_back(light);
  }
  const DeviceHandle device = make_device(KIWAMI_ISA_SCALAR, 1);
  for (const uint32_t builder : {KIWAMI_LIGHT_BUILDER_SAOH, KIWAMI_LIGHT_BUILDER_OCTANTS}) {
    const LightTreeHandle tree = make_light_tree(device.get(), scene, 8, builder);
    kiwami_light_receiver receiver{};
    receiver.position[0] = 3.0f;
    receiver.link_mask = ~uint64_t{0};
    int away = 0;
    constexpr int kCount = 4000;
    for (int i = 0; i < kCount; ++i) {
      receiver.random = static_cast<double>(random.bits()) * 0x1p-32;
      kiwami_light_choice choice;
      check(kiwami_light_sample(tree.get(), &receiver, 0, &choice, 0, 1, nullptr));
      const kiwami_light& light = scene.lights[choice.light_id];
      if (light.direction[0] * (3.0f - light.points[0]) - light.direction[1] * light.points[1] -
              light.direction[2] * light.points[2] <
          0.0f) {
        ++away;
      }
    }
    // By power alone two of three would face away.
    EXPECT_LT(away, kCount / 3) << "builder " << builder;
  }
}

}  // namespace
}  // namespace kiwami_tests

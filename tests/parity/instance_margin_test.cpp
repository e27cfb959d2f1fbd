// SPDX-License-Identifier: Apache-2.0
// The margin of instances' boxes is needed: where it is taken away, rays lose hits that they have.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>

#include "core/instance_bounds.h"
#include "core/instances.h"
#include "math/rounding.h"
#include "parity/committed_tree.h"
#include "parity/kernel_tables.h"
#include "support/environment.h"
#include "support/ray_generator.h"
#include "support/scene_graph.h"

namespace kiwami_tests {
namespace {

using kiwami::Bounds;
using kiwami::ChildReference;

/// A copy of a scene of instances whose boxes are those of what is shown, without any margin. The
/// scene must outlive it.
template <int N>
class BareBoxes {
 public:
  BareBoxes(const kiwami::SceneView& scene, const Bounds& shown)
      : shown_(shown), view_(scene), part_(scene.parts[0]) {
    kiwami::TreeView& tree = part_.tree;
    lines_.resize((tree.memory_bytes + sizeof(Line) - 1) / sizeof(Line));
    memory_ = reinterpret_cast<unsigned char*>(lines_.data());
    std::memcpy(memory_, tree.memory, tree.memory_bytes);
    tree.memory = memory_;
    tighten(tree.root);
    view_.parts = &part_;
  }

  const kiwami::SceneView& view() const { return view_; }

 private:
  struct alignas(64) Line {
    unsigned char bytes[64];
  };

  Bounds tighten(ChildReference reference) {
    Bounds below = Bounds::empty();
    for (uint32_t mask = reference.mask(); mask != 0; mask &= mask - 1) {
      const int slot = __builtin_ctz(mask);
      if (reference.is_leaf()) {
        const auto& block = kiwami::index_leaf_at<N>(memory_, reference);
        below.extend(bare_box(block.id[slot]));
        continue;
      }
      auto& node = *reinterpret_cast<kiwami::WideNode<N>*>(memory_ + reference.node_offset());
      const Bounds box = tighten(node.child[slot]);
      for (int axis = 0; axis < 3; ++axis) {
        const float centre = part_.tree.centre[axis];
        node.bounds[axis][0][slot] = kiwami::subtract_down(box.lower[axis], centre);
        node.bounds[axis][1][slot] = kiwami::subtract_up(box.upper[axis], centre);
      }
      below.extend(box);
    }
    return below;
  }

  Bounds bare_box(uint32_t number) const {
    const auto& part = *static_cast<const kiwami::InstancePart*>(part_.data);
    const auto transform = kiwami::transform_of(part.instances[number].column);
    return kiwami::image_of(transform.forward, shown_, 0.0);
  }

  Bounds shown_;
  kiwami::SceneView view_;
  kiwami::ScenePart part_;
  std::vector<Line> lines_;
  unsigned char* memory_;
};

/// Two turns with a flattening by 2^-10 between them, moved along x.
Matrix34 ill_conditioned(Random& random, float x) {
  const float a = 3.0f * random.unit(), b = 3.0f * random.unit();
  const float ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b);
  const float flat = 0x1p-10f;
  // About z by a, after the flattening of y, after a turn about z by b.
  return {ca * cb - sa * flat * sb,
          -ca * sb - sa * flat * cb,
          0,
          x,
          sa * cb + ca * flat * sb,
          -sa * sb + ca * flat * cb,
          0,
          0,
          0,
          0,
          1,
          0};
}

/// A graph of squares, and rays to their corners.
struct Corners {
  SceneGraph graph;
  std::vector<kiwami_ray> rays;

  Corners(Random random, size_t ray_count) {
    Mesh square;
    square.add({-1, -1, 0}, {1, -1, 0}, {1, 1, 0});
    square.add({-1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    graph.scenes.push_back({{square}, {}});
    InstanceArray array;
    for (int i = 0; i < 24; ++i) {
      array.shown.push_back(0);
      array.masks.push_back(~0u);
      array.transforms.push_back(ill_conditioned(random, 4.0f * static_cast<float>(i)));
    }
    graph.scenes.push_back({{}, {array}});
    const std::vector<WorldTriangle> world = flatten(graph);
    while (rays.size() < ray_count) {
      const auto& triangle = world[random.below(static_cast<uint32_t>(world.size()))];
      const auto& corner = triangle.corner[random.below(3)];
      const Point target{static_cast<float>(corner[0]), static_cast<float>(corner[1]),
                         static_cast<float>(corner[2])};
      const Point aside{random.symmetric(), random.symmetric(), 2.0f + random.unit()};
      rays.push_back(ray_from(target + aside, aside * -1.0f));
      rays.back().time = 0.5f;
    }
  }

  /// The same by instances that move from where they are to there.
  SceneGraph as_moving() const {
    SceneGraph moving = graph;
    InstanceArray& array = moving.scenes.back().arrays.front();
    array.step_count = 2;
    for (const Matrix34& transform : array.transforms) {
      for (int step = 0; step < 2; ++step) {
        array.steps.insert(array.steps.end(), transform.begin(), transform.end());
      }
    }
    return moving;
  }
};

template <int N>
size_t count_lost(const NamedKernels& kernels, const Corners& corners, size_t& hits) {
  const DeviceHandle device = make_device(kernels.isa, 1);
  const std::vector<SceneHandle> scenes = build(device.get(), corners.graph, kernels.width);
  const kiwami::SceneView& view = view_of(scenes.back().get());
  const BareBoxes<N> bare(view, {{-1, -1, 0}, {1, 1, 0}});
  const std::vector<SceneHandle> moving = build(device.get(), corners.as_moving(), kernels.width);
  const auto any_hit = kernels.kernels.general.any_hit;
  const auto met = run_general<uint8_t>(any_hit, view, corners.rays);
  const auto met_bare = run_general<uint8_t>(any_hit, bare.view(), corners.rays);
  EXPECT_EQ(run_general<uint8_t>(any_hit, view_of(moving.back().get()), corners.rays), met);
  size_t lost = 0;
  for (size_t i = 0; i < met.size(); ++i) {
    hits += met[i];
    lost += met[i] != 0 && met_bare[i] == 0;
    EXPECT_LE(met_bare[i], met[i]);
  }
  return lost;
}

TEST(InstanceMargin, IsNeeded) {
  std::printf("KIWAMI_SEED=%llu\n", static_cast<unsigned long long>(seed()));
  const Corners corners(Random(seed(), 900), ray_budget(2000) + 500);
  for (const NamedKernels& kernels : all_kernels()) {
    size_t hits = 0;
    const size_t lost = kernels.width == 4   ? count_lost<4>(kernels, corners, hits)
                        : kernels.width == 8 ? count_lost<8>(kernels, corners, hits)
                                             : count_lost<16>(kernels, corners, hits);
    std::printf("%-12s %zu of %zu hits are lost without it\n", kernels.name.c_str(), lost, hits);
    EXPECT_GT(lost, 0u) << kernels.name;
    EXPECT_LT(lost, hits);
  }
}

}  // namespace
}  // namespace kiwami_tests

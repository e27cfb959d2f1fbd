// SPDX-License-Identifier: Apache-2.0
// Scenes of spheres, discs, curve segments and triangles against plain loops, bit for bit: every
// kernel of every ISA and width, on one thread and on two.
#include <gtest/gtest.h>

#include <algorithm>

#include "parity/committed_tree.h"
#include "parity/kernel_tables.h"
#include "support/adversarial_scenes.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/plain_oracle.h"
#include "support/ray_generator.h"
#include "support/report.h"
#include "support/shape_oracle.h"

namespace kiwami_tests {
namespace {

using kiwami::TraversalCounters;

kiwami_geometry* make_geometry(kiwami_device* device, const ShapeSet& set) {
  kiwami_geometry* geometry = nullptr;
  if (set.type == ShapeType::kSpheres) {
    kiwami_spheres_desc desc;
    check(kiwami_spheres_desc_init(&desc, sizeof desc));
    desc.points = set.points.data();
    desc.sphere_count = set.count();
    desc.mask = set.mask;
    check(kiwami_spheres_create(device, &desc, &geometry));
  } else if (set.type == ShapeType::kDiscs) {
    kiwami_discs_desc desc;
    check(kiwami_discs_desc_init(&desc, sizeof desc));
    desc.points = set.points.data();
    desc.normals = set.normals.data();
    desc.disc_count = set.count();
    desc.mask = set.mask;
    check(kiwami_discs_create(device, &desc, &geometry));
  } else {
    kiwami_curves_desc desc;
    check(kiwami_curves_desc_init(&desc, sizeof desc));
    desc.points = set.points.data();
    desc.point_count = set.points.size();
    desc.indices = set.indices.data();
    desc.segment_count = set.count();
    desc.mask = set.mask;
    check(kiwami_curves_create(device, &desc, &geometry));
  }
  return geometry;
}

/// Triangles first, then the shapes.
struct MixedScene {
  Scene triangles;
  std::vector<ShapeSet> shapes;

  std::vector<kiwami_hit> hits(const PlainOracle& oracle, const kiwami_ray& ray) const {
    std::vector<kiwami_hit> all = oracle.hits(ray);
    const std::vector<kiwami_hit> of_shapes =
        shape_hits(shapes, static_cast<uint32_t>(triangles.meshes.size()), ray);
    all.insert(all.end(), of_shapes.begin(), of_shapes.end());
    std::stable_sort(all.begin(), all.end(),
                     [](const kiwami_hit& a, const kiwami_hit& b) { return a.t < b.t; });
    return all;
  }
};

MixedScene mixed_scene(uint32_t number) {
  Random random(seed(), 1000 + number);
  MixedScene scene;
  const auto count = [&] { return 1 + random.below(random.one_in(3) ? 4 : 160); };
  if (number % 3 != 0) scene.triangles = adversarial_scene(number, seed());
  constexpr ShapeType types[] = {ShapeType::kSpheres, ShapeType::kDiscs, ShapeType::kCurves};
  const uint32_t sets = 1 + number % 5;
  for (uint32_t i = 0; i < sets; ++i) {
    const ShapeType type = types[(number + (number % 4 == 0 ? 0 : i)) % 3];
    scene.shapes.push_back(random_shapes(type, number, count(), random));
  }
  return scene;
}

struct Expected {
  std::vector<kiwami_ray> rays;
  std::vector<std::vector<kiwami_hit>> hits;
};

Expected expected_of(const MixedScene& scene, uint32_t number, size_t count) {
  Expected expected;
  Random random(seed(), 2000 + number);
  const PlainOracle oracle(scene.triangles);
  Scene targets = targets_of(scene.shapes);
  targets.meshes.insert(targets.meshes.end(), scene.triangles.meshes.begin(),
                        scene.triangles.meshes.end());
  RayGenerator generator(targets, Random(random.bits(), 1));
  const auto add = [&](const kiwami_ray& ray) {
    expected.rays.push_back(ray);
    expected.hits.push_back(scene.hits(oracle, ray));
  };
  while (expected.rays.size() < count) {
    add(generator.next());
    if (!expected.hits.back().empty()) {
      add(with_interval_at(expected.rays.back(), expected.hits.back().front().t, random));
    }
  }
  return expected;
}

SceneHandle make_mixed(kiwami_device* device, const MixedScene& scene,
                       const BuildOptions& options) {
  SceneHandle handle = make_scene(device, scene.triangles, options);
  for (const ShapeSet& set : scene.shapes) {
    kiwami_geometry* geometry = make_geometry(device, set);
    check(kiwami_scene_attach(handle.get(), geometry, nullptr));
    kiwami_geometry_release(geometry);
  }
  check(kiwami_scene_commit(handle.get()));
  return handle;
}

std::string describe_case(const Expected& expected, size_t i, const std::string& what) {
  return "KIWAMI_SEED=" + std::to_string(seed()) + ", ray " + std::to_string(i) + ": " +
         describe(expected.rays[i]) + "\n  oracle " +
         describe(expected.hits[i].empty() ? missing_hit() : expected.hits[i].front()) + "\n  " +
         what;
}

std::string difference(const kiwami_scene* scene, const Expected& expected) {
  const std::vector<kiwami_hit> closest = closest_hits(scene, expected.rays);
  const std::vector<uint8_t> any = any_hits(scene, expected.rays);
  std::vector<uint32_t> counts(expected.rays.size());
  check(
      kiwami_count_hits(scene, expected.rays.data(), 0, counts.data(), 0, counts.size(), nullptr));
  for (size_t i = 0; i < expected.rays.size(); ++i) {
    const auto& hits = expected.hits[i];
    if (!is_same(closest[i], hits.empty() ? missing_hit() : hits.front())) {
      return describe_case(expected, i, "answer " + describe(closest[i]));
    }
    if (any[i] != (hits.empty() ? 0 : 1)) return describe_case(expected, i, "any hit");
    if (counts[i] != hits.size()) {
      return describe_case(
          expected, i,
          std::to_string(counts[i]) + " hits instead of " + std::to_string(hits.size()));
    }
  }
  return "";
}

/// The counting kernels: the same answers, and no broken margin.
std::string difference_counted(const NamedKernels& named, const kiwami::SceneView& view,
                               const Expected& expected) {
  std::vector<kiwami_hit> hits(expected.rays.size());
  TraversalCounters counters{};
  named.kernels.general.closest_hit_counted(
      view,
      {reinterpret_cast<const unsigned char*>(expected.rays.data()), sizeof(kiwami_ray),
       reinterpret_cast<unsigned char*>(hits.data()), sizeof(kiwami_hit), hits.size()},
      {}, counters);
  for (size_t i = 0; i < hits.size(); ++i) {
    const auto& right = expected.hits[i];
    if (!is_same(hits[i], right.empty() ? missing_hit() : right.front())) {
      return describe_case(expected, i, "counted answer " + describe(hits[i]));
    }
  }
  if (counters.margin_violations == 0) return "";
  return std::to_string(counters.margin_violations) + " hits outside their leaf's box";
}

class ShapeParity : public testing::TestWithParam<uint32_t> {};

TEST_P(ShapeParity, AgreesWithThePlainLoops) {
  const DeviceHandle one = make_device(GetParam(), 1), two = make_device(GetParam(), 2);
  const auto scenes = static_cast<uint32_t>(case_budget(36));
  const size_t rays = ray_budget(9000) / scenes + 1;
  uint64_t hits = 0;
  for (uint32_t i = 0; i < scenes; ++i) {
    const MixedScene scene = mixed_scene(i);
    const Expected expected = expected_of(scene, i, rays);
    for (const auto& of_ray : expected.hits) hits += of_ray.size();
    // Blocks of shapes, or the buffers.
    const double layout = i % 3 == 2 ? KIWAMI_LAYOUT_COMPACT : KIWAMI_LAYOUT_FAST;
    const std::vector<std::pair<uint32_t, double>> parameters = {{KIWAMI_PARAMETER_LAYOUT, layout}};
    for (const uint32_t width : {4u, 8u, 16u}) {
      const SceneHandle committed = make_mixed(i % 2 == 0 ? one.get() : two.get(), scene,
                                               {width, i % 4 < 2, 0, true, parameters});
      ASSERT_EQ(difference(committed.get(), expected), "") << "scene " << i << ", width " << width;
    }
    for (const NamedKernels& named : all_kernels()) {
      if (named.isa != GetParam()) continue;
      const SceneHandle committed =
          make_mixed(one.get(), scene, {named.width, true, 0, false, parameters});
      ASSERT_EQ(difference_counted(named, view_of(committed.get()), expected), "")
          << named.name << ", scene " << i << ", KIWAMI_SEED=" << seed();
    }
  }
  EXPECT_GT(hits, scenes * rays / 4);
}

TEST_P(ShapeParity, NoticesAnAnswerThatIsOff) {
  const DeviceHandle device = make_device(GetParam(), 1);
  const MixedScene scene = mixed_scene(1);
  Expected expected = expected_of(scene, 1, 400);
  const SceneHandle committed = make_mixed(device.get(), scene, {});
  ASSERT_EQ(difference(committed.get(), expected), "");
  const auto hit = std::find_if(expected.hits.begin(), expected.hits.end(),
                                [](const auto& hits) { return hits.size() > 1; });
  ASSERT_NE(hit, expected.hits.end());
  hit->front().normal_x += 1.0f;
  EXPECT_NE(difference(committed.get(), expected), "");
  hit->front().normal_x -= 1.0f;
  hit->pop_back();
  EXPECT_NE(difference(committed.get(), expected), "");
}

INSTANTIATE_TEST_SUITE_P(All, ShapeParity, testing::ValuesIn(available_isas()),
                         [](const auto& test) { return std::string(kiwami_isa_name(test.param)); });

}  // namespace
}  // namespace kiwami_tests

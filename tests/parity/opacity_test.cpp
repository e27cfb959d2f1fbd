// SPDX-License-Identifier: Apache-2.0
// Opacity micromaps, through the C interface on every ISA and width and on trees with duplicates,
// against the plain loop and a search for the micro-triangle in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/plain_oracle.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

using HitList = std::vector<kiwami_hit>;

/// The number of the micro-triangle at (u, v), by going through the rows.
uint32_t find_micro_triangle(float u, float v, uint32_t level) {
  const int n = 1 << level;
  const long double x = std::max(0.0L, static_cast<long double>(u) * n);
  const long double y = std::max(0.0L, static_cast<long double>(v) * n);
  const int row = std::min(static_cast<int>(y), n - 1);
  uint32_t number = 0;
  for (int r = 0; r < row; ++r) number += static_cast<uint32_t>(2 * (n - r) - 1);
  const int last = n - 1 - row;
  const int column = std::min(static_cast<int>(x), last);
  const bool is_turned = column < last && (x - column) + (y - row) > 1.0L;
  return number + static_cast<uint32_t>(2 * column + (is_turned ? 1 : 0));
}

TEST(MicroTriangles, AreFoundAtEveryLevel) {
  Random random(seed(), 900);
  for (uint32_t level = 0; level <= KIWAMI_OPACITY_MAX_LEVEL; ++level) {
    for (uint64_t i = 0; i < ray_budget(100000); ++i) {
      float u = random.unit(), v = random.unit();
      if (random.one_in(2)) v *= 1.0f - u;
      if (random.one_in(4)) u = std::ldexp(std::floor(std::ldexp(u, 6)), -6);
      if (random.one_in(4)) v = std::ldexp(std::floor(std::ldexp(v, 6)), -6);
      if (random.one_in(8)) v = 1.0f - u;
      if (random.one_in(16)) u = random.power_of_two(-149, 0);
      ASSERT_EQ(kiwami_opacity_micro_triangle(u, v, level), find_micro_triangle(u, v, level))
          << u << ", " << v << ", level " << level << ", KIWAMI_SEED=" << seed();
    }
  }
  EXPECT_EQ(kiwami_opacity_micro_triangle(-1.0f, -0.0f, 3), 0u);
  EXPECT_EQ(kiwami_opacity_micro_triangle(2.0f, 0.0f, 3), 14u);
  EXPECT_EQ(kiwami_opacity_micro_triangle(0.0f, 1.5f, 3), 63u);
  EXPECT_EQ(kiwami_opacity_micro_triangle(NAN, NAN, 3), 0u);
}

/// Each has a number of its own, by which its middle is found.
TEST(MicroTriangles, HaveNumbersFromZeroOn) {
  for (uint32_t level = 0; level <= KIWAMI_OPACITY_MAX_LEVEL; ++level) {
    const uint32_t n = 1u << level;
    std::set<uint32_t> numbers;
    for (uint32_t row = 0; row < n; ++row) {
      for (uint32_t column = 0; row + column < n; ++column) {
        const auto at = [&](float third) {
          return kiwami_opacity_micro_triangle((static_cast<float>(column) + third) / n,
                                               (static_cast<float>(row) + third) / n, level);
        };
        numbers.insert(at(1.0f / 3));
        if (row + column + 1 < n) numbers.insert(at(2.0f / 3));
      }
    }
    EXPECT_EQ(numbers.size(), size_t{1} << (2 * level));
    EXPECT_EQ(*numbers.rbegin() + 1, 1u << (2 * level));
  }
}

/// Random micromaps of a mesh, some shared, some triangles in one state as a whole.
struct RandomMaps {
  uint32_t bits, level;
  std::vector<unsigned char> bytes;
  std::vector<uint32_t> indices;
  size_t stride;

  RandomMaps(size_t triangle_count, uint32_t bit_count, Random& random)
      : bits(bit_count), level(random.below(KIWAMI_OPACITY_MAX_LEVEL + 1)) {
    stride = std::max<size_t>(1, (size_t{bits} << (2 * level)) / 8) + random.below(3);
    const uint32_t map_count = 1 + random.below(5);
    bytes.resize(map_count * stride);
    for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(random.bits());
    for (size_t i = 0; i < triangle_count; ++i) {
      indices.push_back(random.one_in(8) ? KIWAMI_OPACITY_ALL_TRANSPARENT + random.below(4)
                                         : random.below(map_count));
    }
  }

  kiwami_opacity_desc desc() const {
    kiwami_opacity_desc desc;
    check(kiwami_opacity_desc_init(&desc, sizeof desc));
    desc.format = bits;
    desc.level = level;
    desc.maps = bytes.data();
    desc.map_stride = stride;
    desc.map_count = bytes.size() / stride;
    desc.indices = indices.data();
    return desc;
  }

  uint32_t state(const kiwami_hit& hit) const {
    const uint32_t map = indices[hit.primitive_id];
    if (map >= KIWAMI_OPACITY_ALL_TRANSPARENT) return map & 3u;
    const uint32_t number = find_micro_triangle(hit.u, hit.v, level);
    uint32_t state = 0;
    for (uint32_t bit = 0; bit < bits; ++bit) {
      const uint32_t place = number * bits + bit;
      state |= ((bytes[map * stride + place / 8] >> (place % 8)) & 1u) << bit;
    }
    return state;
  }
};

bool is_odd(const kiwami_hit& hit) { return (hit.primitive_id & 1u) != 0; }

struct OddFilter {
  const RandomMaps* maps;
  std::atomic<uint32_t> calls{0}, wrong_calls{0};
};
int32_t accept_odd(void* user, const kiwami_filter_candidate* candidate) {
  auto& filter = *static_cast<OddFilter*>(user);
  ++filter.calls;
  if (filter.maps->state(candidate->hit) < KIWAMI_OPACITY_UNKNOWN_TRANSPARENT) {
    ++filter.wrong_calls;
  }
  return is_odd(candidate->hit) ? KIWAMI_FILTER_ACCEPT : KIWAMI_FILTER_REJECT;
}

/// A scene of one mesh with micromaps.
SceneHandle masked_scene(kiwami_device* device, const Mesh& mesh, const RandomMaps& maps,
                         const BuildOptions& build) {
  kiwami_triangle_mesh_desc desc;
  check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc));
  desc.vertices = mesh.vertices.data();
  desc.vertex_count = mesh.vertices.size();
  desc.indices = mesh.triangles.data();
  desc.triangle_count = mesh.triangles.size();
  desc.mask = mesh.mask;
  kiwami_geometry* geometry = nullptr;
  check(kiwami_triangle_mesh_create(device, &desc, &geometry));
  const kiwami_opacity_desc opacity = maps.desc();
  check(kiwami_triangle_mesh_set_opacity(geometry, &opacity));
  kiwami_scene* scene = nullptr;
  check(kiwami_scene_create(device, &scene));
  SceneHandle handle(scene);
  check(kiwami_scene_attach(scene, geometry, nullptr));
  kiwami_geometry_release(geometry);
  check(kiwami_scene_set_parameter(scene, KIWAMI_PARAMETER_BVH_WIDTH, build.width));
  for (const auto& [parameter, value] : build.parameters) {
    check(kiwami_scene_set_parameter(scene, parameter, value));
  }
  check(kiwami_scene_commit(scene));
  return handle;
}

/// "" where all queries find what the lists hold.
std::string difference(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays,
                       const kiwami_query& query, const std::vector<HitList>& lists) {
  const size_t count = rays.size();
  size_t total = 1;
  for (const HitList& list : lists) total += list.size();
  HitList closest(count), hits(total);
  std::vector<uint8_t> any(count);
  std::vector<uint32_t> counts(count);
  std::vector<uint64_t> offsets(count + 1);
  check(kiwami_closest_hit(scene, rays.data(), 0, closest.data(), 0, count, &query));
  check(kiwami_any_hit(scene, rays.data(), 0, any.data(), 0, count, &query));
  check(kiwami_count_hits(scene, rays.data(), 0, counts.data(), 0, count, &query));
  check(kiwami_multi_hit(scene, rays.data(), 0, count, 0, hits.data(), hits.size(), offsets.data(),
                         &query));
  for (size_t i = 0; i < count; ++i) {
    const kiwami_hit expected = lists[i].empty() ? missing_hit() : lists[i].front();
    const auto begin = hits.begin() + static_cast<ptrdiff_t>(offsets[i]);
    const auto end = hits.begin() + static_cast<ptrdiff_t>(offsets[i + 1]);
    if (is_same(closest[i], expected) && any[i] == (lists[i].empty() ? 0 : 1) &&
        counts[i] == lists[i].size() &&
        std::equal(begin, end, lists[i].begin(), lists[i].end(), is_same)) {
      continue;
    }
    return describe(rays[i]) + "\n  expected " + std::to_string(lists[i].size()) + ", first " +
           describe(expected) + "\n  counted " + std::to_string(counts[i]) + ", listed " +
           std::to_string(end - begin) + ", any " + std::to_string(any[i]) + ", closest " +
           describe(closest[i]);
  }
  return "";
}

class Opacity : public testing::TestWithParam<uint32_t> {
 protected:
  const DeviceHandle device_ = make_device(GetParam(), 2);

  /// Compares one scene with random maps, without and with a filter.
  void compare(const Scene& scene, uint32_t bits, const BuildOptions& build, Random& random) {
    const Mesh& mesh = scene.meshes.front();
    const RandomMaps maps(mesh.triangles.size(), bits, random);
    const Scene alone{scene.name, {mesh}};
    RayGenerator generator(alone, Random(random.bits(), 1));
    std::vector<kiwami_ray> rays(ray_budget(4000) / 40 + 1);
    for (kiwami_ray& ray : rays) ray = generator.next();
    const PlainOracle oracle(alone);
    std::vector<HitList> plain, filtered;
    for (const kiwami_ray& ray : rays) {
      plain.emplace_back();
      filtered.emplace_back();
      for (const kiwami_hit& hit : oracle.hits(ray)) {
        const uint32_t state = maps.state(hit);
        const bool is_unknown = state >= KIWAMI_OPACITY_UNKNOWN_TRANSPARENT;
        const bool is_opaque =
            state == KIWAMI_OPACITY_OPAQUE || state == KIWAMI_OPACITY_UNKNOWN_OPAQUE;
        if (is_opaque) plain.back().push_back(hit);
        if (is_unknown ? is_odd(hit) : is_opaque) filtered.back().push_back(hit);
      }
    }
    const SceneHandle built = masked_scene(device_.get(), mesh, maps, build);
    kiwami_query query;
    check(kiwami_query_init(&query, sizeof query));
    ASSERT_EQ(difference(built.get(), rays, query, plain), "")
        << scene.name << ", level " << maps.level << ", KIWAMI_SEED=" << seed();
    OddFilter filter{&maps};
    query.filter = accept_odd;
    query.filter_user = &filter;
    ASSERT_EQ(difference(built.get(), rays, query, filtered), "")
        << scene.name << ", filtered, level " << maps.level << ", KIWAMI_SEED=" << seed();
    EXPECT_EQ(filter.wrong_calls, 0u);
    calls_ += filter.calls;
  }

  uint64_t calls_ = 0;
};

TEST_P(Opacity, OfRandomMapsIsThatOfThePlainLoop) {
  Random random(seed(), 910);
  for (const ClosedMesh& closed : closed_meshes()) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const uint32_t bits : {KIWAMI_OPACITY_2_STATES, KIWAMI_OPACITY_4_STATES}) {
        BuildOptions build;
        build.width = width;
        compare(scene_of(closed), bits, build, random);
        build.parameters = {{KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_SPATIAL_SPLIT},
                            {KIWAMI_PARAMETER_SPLIT_BUDGET, 4.0},
                            {KIWAMI_PARAMETER_SPLIT_ALPHA, 0.0}};
        compare(scene_of(closed), bits, build, random);
      }
    }
  }
  EXPECT_GT(calls_, 0u);
}

TEST_P(Opacity, OfAdversarialScenesIsThatOfThePlainLoop) {
  Random random(seed(), 911);
  for (uint32_t i = 0; i < case_budget(40); ++i) {
    const Scene scene = adversarial_scene(i, seed());
    if (scene.meshes.empty() || scene.meshes.front().triangles.empty()) continue;
    compare(scene, 1 + i % 2, {}, random);
  }
}

/// Were a bit of a map another, the comparison would say so.
TEST_P(Opacity, IsCaughtWhereAMapIsWrong) {
  Random random(seed(), 912);
  const Scene scene = scene_of(closed_meshes().front());
  const Mesh& mesh = scene.meshes.front();
  const RandomMaps maps(mesh.triangles.size(), 1, random);
  const SceneHandle built = masked_scene(device_.get(), mesh, maps, {});
  const PlainOracle oracle(scene);
  RayGenerator generator(scene, random);
  std::vector<kiwami_ray> rays(500);
  std::vector<HitList> all;
  for (kiwami_ray& ray : rays) {
    ray = generator.next();
    all.push_back(oracle.hits(ray));
  }
  kiwami_query query;
  check(kiwami_query_init(&query, sizeof query));
  EXPECT_NE(difference(built.get(), rays, query, all), "");
}

INSTANTIATE_TEST_SUITE_P(All, Opacity, testing::ValuesIn(available_isas()),
                         [](const auto& test) { return std::string(kiwami_isa_name(test.param)); });

}  // namespace
}  // namespace kiwami_tests

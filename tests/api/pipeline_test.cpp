// SPDX-License-Identifier: Apache-2.0
// Every method of every stage of a build, by its number: names, errors, and equal answers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "api/api_support.h"
#include "support/random.h"

namespace kiwami_api_tests {
namespace {

/// The numbers that name a method of a stage.
std::vector<uint32_t> methods_of(uint32_t stage) {
  std::vector<uint32_t> methods;
  for (uint32_t method = 0; method < 256; ++method) {
    if (kiwami_method_name(stage, method)) methods.push_back(method);
  }
  return methods;
}

using kiwami_tests::Random;

bool makes_no_binary_tree(uint32_t builder) {
  return builder == KIWAMI_BUILDER_WIDE_BOTTOM_UP || builder == KIWAMI_BUILDER_WIDE_TOP_DOWN ||
         builder == KIWAMI_BUILDER_WIDE_LINEAR;
}

class Pipeline : public testing::Test {
 protected:
  Pipeline() : device_(make_device()) {}

  /// The answers of a scene that is built by these methods, with the validator after each stage.
  std::vector<kiwami_hit> answers(const Triangles& triangles, uint32_t builder,
                                  const std::vector<uint32_t>& optimizers, uint32_t contraction) {
    const Geometry mesh = make_mesh(device_, triangles.desc());
    const Scene scene = make_scene(device_);
    EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    set(scene, KIWAMI_PARAMETER_VALIDATE_BUILD, 1);
    set(scene, KIWAMI_PARAMETER_BUILDER, builder);
    set(scene, KIWAMI_PARAMETER_CONTRACTION, contraction);
    EXPECT_EQ(kiwami_scene_set_optimizers(scene.get(), optimizers.data(), optimizers.size()),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error(device_.get());
    return closest_hits(scene, random_rays(500, 11));
  }

  void set(const Scene& scene, uint32_t parameter, double value) {
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), parameter, value), KIWAMI_OK);
  }

  Device device_;
};

TEST_F(Pipeline, MethodsHaveNamesOfTheirOwn) {
  for (const uint32_t stage :
       {KIWAMI_STAGE_BUILDER, KIWAMI_STAGE_OPTIMIZER, KIWAMI_STAGE_CONTRACTION}) {
    std::set<std::string> names;
    for (const uint32_t method : methods_of(stage)) {
      EXPECT_TRUE(names.insert(kiwami_method_name(stage, method)).second);
    }
  }
  EXPECT_STREQ(kiwami_method_name(KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_BINNED_SAH), "binned_sah");
  EXPECT_STREQ(kiwami_method_name(KIWAMI_STAGE_CONTRACTION, KIWAMI_CONTRACTION_OPTIMAL), "optimal");
  EXPECT_EQ(kiwami_method_name(KIWAMI_STAGE_BUILDER, 255), nullptr);
  EXPECT_EQ(kiwami_method_name(0, 0), nullptr);
  EXPECT_EQ(kiwami_method_name(77, 0), nullptr);
}

TEST_F(Pipeline, EveryMethodGivesTheSameAnswers) {
  for (const uint32_t count : {0u, 1u, 2u, 3u, 9u, 400u}) {
    const Triangles triangles = random_triangles(count, count);
    const std::vector<kiwami_hit> expected =
        answers(triangles, KIWAMI_BUILDER_BINNED_SAH, {}, KIWAMI_CONTRACTION_OPTIMAL);
    for (const uint32_t builder : methods_of(KIWAMI_STAGE_BUILDER)) {
      for (const uint32_t contraction : methods_of(KIWAMI_STAGE_CONTRACTION)) {
        EXPECT_TRUE(are_equal(answers(triangles, builder, {}, contraction), expected))
            << kiwami_method_name(KIWAMI_STAGE_BUILDER, builder) << ", " << count;
        if (makes_no_binary_tree(builder)) continue;
        for (const uint32_t optimizer : methods_of(KIWAMI_STAGE_OPTIMIZER)) {
          EXPECT_TRUE(are_equal(answers(triangles, builder, {optimizer}, contraction), expected))
              << kiwami_method_name(KIWAMI_STAGE_BUILDER, builder) << " + "
              << kiwami_method_name(KIWAMI_STAGE_OPTIMIZER, optimizer) << ", " << count;
        }
      }
    }
    EXPECT_TRUE(are_equal(answers(triangles, KIWAMI_BUILDER_BINNED_SAH,
                                  methods_of(KIWAMI_STAGE_OPTIMIZER), KIWAMI_CONTRACTION_OPTIMAL),
                          expected));
  }
}

TEST_F(Pipeline, SpatialSplitsKeepWithinTheirBudget) {
  const Triangles triangles = random_triangles(400, 3);
  const Geometry mesh = make_mesh(device_, triangles.desc());
  const auto references = [&](uint32_t builder, double budget) {
    const Scene scene = make_scene(device_);
    EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    set(scene, KIWAMI_PARAMETER_VALIDATE_BUILD, 1);
    set(scene, KIWAMI_PARAMETER_BUILDER, builder);
    set(scene, KIWAMI_PARAMETER_SPLIT_BUDGET, budget);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error(device_.get());
    EXPECT_EQ(info_of(scene).triangle_count, 400u);
    return info_of(scene).reference_count;
  };
  EXPECT_EQ(references(KIWAMI_BUILDER_BINNED_SAH, 4.0), 400u);
  EXPECT_EQ(references(KIWAMI_BUILDER_SPATIAL_SPLIT, 0.0), 400u);
  const uint64_t few = references(KIWAMI_BUILDER_SPATIAL_SPLIT, 0.1);
  const uint64_t many = references(KIWAMI_BUILDER_SPATIAL_SPLIT, 1.0);
  EXPECT_GT(few, 400u);
  EXPECT_LE(few, 440u);
  EXPECT_GE(many, few);
  EXPECT_LE(many, 800u);
}

TEST_F(Pipeline, RepresentativeRaysChangeTheTreeAndNotTheAnswers) {
  const Triangles triangles = random_triangles(3000, 5);
  const Geometry mesh = make_mesh(device_, triangles.desc());
  const std::vector<kiwami_ray> asked = random_rays(500, 11);
  const uint32_t order = KIWAMI_OPTIMIZER_REORDER_NARY;
  std::vector<kiwami_hit> expected;
  std::vector<uint64_t> visits;
  // None, which is sampled ones; some; the same among rays that can hit nothing, further apart.
  for (const size_t stride : {size_t{0}, sizeof(kiwami_ray), 2 * sizeof(kiwami_ray)}) {
    const Scene scene = make_scene(device_);
    EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    set(scene, KIWAMI_PARAMETER_VALIDATE_BUILD, 1);
    set(scene, KIWAMI_PARAMETER_CONTRACTION, KIWAMI_CONTRACTION_RAY_DISTRIBUTION);
    EXPECT_EQ(kiwami_scene_set_optimizers(scene.get(), &order, 1), KIWAMI_OK);
    if (stride != 0) {
      std::vector<kiwami_ray> rays;
      kiwami_ray bad = asked[0];
      bad.direction_x = std::numeric_limits<float>::quiet_NaN();
      for (const kiwami_ray& ray : asked) rays.insert(rays.end(), {ray, bad});
      if (stride == sizeof(kiwami_ray)) rays = asked;
      EXPECT_EQ(
          kiwami_scene_set_representative_rays(scene.get(), rays.data(), stride, asked.size()),
          KIWAMI_OK);
      // Copied: what happens to them afterwards does not matter.
      std::fill(rays.begin(), rays.end(), kiwami_ray{});
    }
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error(device_.get());
    const std::vector<kiwami_hit> hits = closest_hits(scene, asked);
    if (expected.empty()) expected = hits;
    EXPECT_TRUE(are_equal(hits, expected));
    kiwami_visits counted{};
    counted.struct_size = sizeof counted;
    EXPECT_EQ(kiwami_scene_count_visits(scene.get(), asked.data(), 0, asked.size(),
                                        KIWAMI_COUNT_CLOSEST_HIT, &counted, nullptr, 0),
              KIWAMI_OK);
    visits.push_back(counted.node_visits + counted.leaf_visits);
  }
  EXPECT_LT(visits[1], visits[0]);
  EXPECT_EQ(visits[2], visits[1]);
}

TEST_F(Pipeline, ParametersOfBuildersChangeTheTreeAndNoAnswer) {
  const Triangles triangles = random_triangles(1000, 5);
  const std::vector<kiwami_hit> expected =
      answers(triangles, KIWAMI_BUILDER_BINNED_SAH, {}, KIWAMI_CONTRACTION_OPTIMAL);
  const Geometry mesh = make_mesh(device_, triangles.desc());
  const auto cost = [&](uint32_t builder, uint32_t parameter, double value) {
    const Scene scene = make_scene(device_);
    EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    set(scene, KIWAMI_PARAMETER_VALIDATE_BUILD, 1);
    set(scene, KIWAMI_PARAMETER_BUILDER, builder);
    set(scene, parameter, value);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error(device_.get());
    EXPECT_TRUE(are_equal(closest_hits(scene, random_rays(500, 11)), expected)) << parameter;
    kiwami_scene_info info{};
    info.struct_size = sizeof info;
    EXPECT_EQ(kiwami_scene_get_info(scene.get(), &info), KIWAMI_OK);
    return info.sah_cost;
  };
  const uint32_t cases[][2] = {{KIWAMI_BUILDER_LBVH, KIWAMI_PARAMETER_LBVH_DELTA},
                               {KIWAMI_BUILDER_LBVH, KIWAMI_PARAMETER_LBVH_CHUNK_SIZE},
                               {KIWAMI_BUILDER_LBVH, KIWAMI_PARAMETER_CURVE_CODE},
                               {KIWAMI_BUILDER_PLOC, KIWAMI_PARAMETER_CURVE_CODE},
                               {KIWAMI_BUILDER_AAC, KIWAMI_PARAMETER_CURVE_CODE},
                               {KIWAMI_BUILDER_WIDE_BOTTOM_UP, KIWAMI_PARAMETER_CURVE_CODE},
                               {KIWAMI_BUILDER_WIDE_TOP_DOWN, KIWAMI_PARAMETER_BIN_COUNT},
                               {KIWAMI_BUILDER_AAC, KIWAMI_PARAMETER_AAC_QUALITY}};
  for (const auto& [builder, parameter] : cases) {
    double bounds[2];
    ASSERT_EQ(kiwami_parameter_bounds(parameter, &bounds[0], &bounds[1], nullptr), KIWAMI_OK);
    EXPECT_NE(cost(builder, parameter, bounds[0]), cost(builder, parameter, bounds[1]))
        << builder << " " << parameter;
  }
}

/// The cost of a scene's tree tells pipelines apart.
TEST_F(Pipeline, AQualityStandsForItsMethods) {
  const Triangles triangles = random_triangles(3000, 5);
  const Geometry mesh = make_mesh(device_, triangles.desc());
  const auto info_after = [&](const Scene& scene) {
    EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error(device_.get());
    return info_of(scene);
  };
  std::set<double> costs;
  for (const uint32_t quality :
       {KIWAMI_QUALITY_BALANCED, KIWAMI_QUALITY_FAST, KIWAMI_QUALITY_BEST}) {
    const Scene named = make_scene(device_), spelled = make_scene(device_);
    set(named, KIWAMI_PARAMETER_QUALITY, quality);
    uint32_t builder, contraction, optimizers[KIWAMI_MAX_OPTIMIZERS];
    size_t count;
    ASSERT_EQ(kiwami_quality_methods(quality, &builder, optimizers, &count, &contraction),
              KIWAMI_OK);
    set(spelled, KIWAMI_PARAMETER_BUILDER, builder);
    set(spelled, KIWAMI_PARAMETER_CONTRACTION, contraction);
    EXPECT_EQ(kiwami_scene_set_optimizers(spelled.get(), optimizers, count), KIWAMI_OK);
    const kiwami_scene_info info = info_after(named);
    EXPECT_EQ(info.sah_cost, info_after(spelled).sah_cost);
    costs.insert(info.sah_cost);
    if (quality == KIWAMI_QUALITY_BALANCED) {
      EXPECT_EQ(info.sah_cost, info_after(make_scene(device_)).sah_cost);
    }
  }
  EXPECT_GE(costs.size(), 2u);
}

void add_triangle(const float corner[3], const float size[3], Random& random,
                  Triangles& triangles) {
  for (int k = 0; k < 3; ++k) {
    triangles.indices.push_back(static_cast<uint32_t>(triangles.vertices.size() / 3));
    for (int axis = 0; axis < 3; ++axis) {
      triangles.vertices.push_back(corner[axis] + size[axis] * random.symmetric());
    }
  }
}

/// Long thin triangles side by side: splits from the top serve them better.
Triangles fibres(uint32_t count, uint64_t seed) {
  Triangles triangles;
  Random random(seed);
  for (uint32_t i = 0; i < count; ++i) {
    const float corner[] = {random.symmetric(), random.symmetric(), random.symmetric()};
    add_triangle(corner, std::array{0.01f, 0.01f, 0.4f}.data(), random, triangles);
  }
  return triangles;
}

/// Small objects of many triangles between walls of a few: joining from below keeps them whole.
Triangles furniture(uint32_t object_count, uint64_t seed) {
  Triangles triangles;
  Random random(seed);
  for (uint32_t i = 0; i < object_count; ++i) {
    const float centre[] = {random.symmetric(), random.symmetric(), random.symmetric()};
    const float size = 0.02f + 0.05f * std::abs(random.symmetric());
    for (int k = 0; k < 60; ++k) {
      const float corner[] = {centre[0] + size * random.symmetric(),
                              centre[1] + size * random.symmetric(),
                              centre[2] + size * random.symmetric()};
      add_triangle(corner, std::array{0.1f * size, 0.1f * size, 0.1f * size}.data(), random,
                   triangles);
    }
    if (i % 4 == 0) add_triangle(centre, std::array{1.0f, 1.0f, 0.01f}.data(), random, triangles);
  }
  return triangles;
}

TEST_F(Pipeline, TrialKeepsTheTreeThatRaysVisitLess) {
  const std::vector<kiwami_ray> rays = random_rays(3000, 7);
  const auto cost_of = [&](const Triangles& triangles, uint32_t builder) {
    const Geometry mesh = make_mesh(device_, triangles.desc());
    const Scene scene = make_scene(device_);
    EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    set(scene, KIWAMI_PARAMETER_BUILDER, builder);
    EXPECT_EQ(kiwami_scene_set_representative_rays(scene.get(), rays.data(), 0, rays.size()),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error(device_.get());
    kiwami_visits visits{};
    visits.struct_size = sizeof visits;
    EXPECT_EQ(kiwami_scene_count_visits(scene.get(), rays.data(), 0, rays.size(),
                                        KIWAMI_COUNT_CLOSEST_HIT, &visits, nullptr, 0),
              KIWAMI_OK);
    return static_cast<double>(visits.node_visits + visits.leaf_visits);
  };
  std::set<bool> winners;
  for (const Triangles& triangles : {fibres(3000, 3), furniture(50, 5)}) {
    const double top_down = cost_of(triangles, KIWAMI_BUILDER_BINNED_SAH);
    const double bottom_up = cost_of(triangles, KIWAMI_BUILDER_PLOC);
    std::printf("binned_sah %g, ploc %g visits\n", top_down, bottom_up);
    ASSERT_NE(top_down, bottom_up);
    EXPECT_EQ(cost_of(triangles, KIWAMI_BUILDER_TRIAL), std::min(top_down, bottom_up));
    winners.insert(bottom_up < top_down);
  }
  EXPECT_EQ(winners.size(), 2u);
}

TEST_F(Pipeline, WhatIsSetAfterAQualityReplacesItsPart) {
  const Triangles triangles = random_triangles(3000, 5);
  const Geometry mesh = make_mesh(device_, triangles.desc());
  const auto cost = [&](bool builder_last) {
    const Scene scene = make_scene(device_);
    EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    if (!builder_last) set(scene, KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_PLOC);
    set(scene, KIWAMI_PARAMETER_QUALITY, KIWAMI_QUALITY_FAST);
    if (builder_last) set(scene, KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_PLOC);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
    return info_of(scene).sah_cost;
  };
  EXPECT_NE(cost(false), cost(true));
}

TEST_F(Pipeline, BuildersOfWideTreesTakeOptimizersOfWideTreesOnly) {
  const Triangles triangles = random_triangles(400, 9);
  const std::vector<kiwami_hit> expected =
      answers(triangles, KIWAMI_BUILDER_BINNED_SAH, {}, KIWAMI_CONTRACTION_OPTIMAL);
  EXPECT_TRUE(are_equal(answers(triangles, KIWAMI_BUILDER_WIDE_TOP_DOWN,
                                {KIWAMI_OPTIMIZER_REORDER_SATO, KIWAMI_OPTIMIZER_REORDER_NARY},
                                KIWAMI_CONTRACTION_RAY_DISTRIBUTION),
                        expected));
  const Scene scene = make_scene(device_);
  const uint32_t optimizers[] = {KIWAMI_OPTIMIZER_REORDER_SATO, KIWAMI_OPTIMIZER_ROTATION};
  set(scene, KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_WIDE_BOTTOM_UP);
  EXPECT_EQ(kiwami_scene_set_optimizers(scene.get(), optimizers, 2), KIWAMI_OK);
  EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()),
            "builder wide_bottom_up makes no binary tree that rotation could change, expected no "
            "optimizers but those of wide trees");
}

TEST_F(Pipeline, WhatAsksForABinaryTreeGetsThatOfTheSameSplits) {
  const Triangles triangles = random_triangles(12000, 5);
  const Geometry mesh = make_mesh(device_, triangles.desc());
  const auto cost = [&](uint32_t builder, uint32_t contraction, bool rotates, bool is_extended) {
    const Scene scene = make_scene(device_);
    EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    set(scene, KIWAMI_PARAMETER_BUILDER, builder);
    set(scene, KIWAMI_PARAMETER_CONTRACTION, contraction);
    set(scene, KIWAMI_PARAMETER_CURVE_CODE, is_extended ? 1 : 0);
    const uint32_t optimizers[] = {KIWAMI_OPTIMIZER_ROTATION};
    EXPECT_EQ(kiwami_scene_set_optimizers(scene.get(), optimizers, rotates ? 1 : 0), KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error(device_.get());
    return info_of(scene).sah_cost;
  };
  constexpr uint32_t kTwins[][2] = {{KIWAMI_BUILDER_WIDE_TOP_DOWN, KIWAMI_BUILDER_BINNED_SAH},
                                    {KIWAMI_BUILDER_WIDE_LINEAR, KIWAMI_BUILDER_LBVH}};
  for (const auto& [wide, binary] : kTwins) {
    for (const uint32_t contraction :
         {KIWAMI_CONTRACTION_SURFACE_AREA, KIWAMI_CONTRACTION_OPTIMAL}) {
      for (const bool rotates : {false, true}) {
        const double of_wide = cost(wide, contraction, rotates, false);
        const double of_binary = cost(binary, contraction, rotates, binary == KIWAMI_BUILDER_LBVH);
        const bool is_direct = contraction == KIWAMI_CONTRACTION_OPTIMAL && !rotates;
        EXPECT_EQ(of_wide == of_binary, !is_direct) << wide << " " << contraction;
      }
    }
  }
}

TEST_F(Pipeline, ErrorsNameWhatIsWrong) {
  const Scene scene = make_scene(device_);
  const uint32_t methods[KIWAMI_MAX_OPTIMIZERS + 1] = {200};
  const auto expect = [&](kiwami_result result, const char* sentence) {
    EXPECT_EQ(result, KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(last_error(device_.get()), sentence);
  };
  expect(kiwami_scene_set_optimizers(scene.get(), nullptr, 1),
         "methods is NULL, expected a valid pointer");
  expect(kiwami_scene_set_optimizers(scene.get(), methods, 1),
         "there is no optimizer of number 200, expected one that kiwami_method_name names");
  expect(kiwami_scene_set_optimizers(scene.get(), methods, KIWAMI_MAX_OPTIMIZERS + 1),
         "count is 9, expected at most 8 optimizers");
  EXPECT_EQ(kiwami_scene_set_optimizers(scene.get(), nullptr, 0), KIWAMI_OK);
  expect(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_QUALITY, 3),
         "value is 3 for parameter 30, expected 0 to 2");
  EXPECT_EQ(kiwami_quality_methods(0, nullptr, nullptr, nullptr, nullptr), KIWAMI_OK);
  EXPECT_EQ(kiwami_quality_methods(3, nullptr, nullptr, nullptr, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "quality is 3, expected one of KIWAMI_QUALITY_*");
  const kiwami_ray ray{};
  expect(kiwami_scene_set_representative_rays(scene.get(), nullptr, 0, 1),
         "rays is NULL, expected a valid pointer");
  expect(kiwami_scene_set_representative_rays(scene.get(), &ray, 4, 1),
         "the stride of rays is 4, expected at least 48, or 0 for 48");
  EXPECT_EQ(kiwami_scene_set_representative_rays(scene.get(), &ray, 0, 1), KIWAMI_OK);
  EXPECT_EQ(kiwami_scene_set_representative_rays(scene.get(), nullptr, 0, 0), KIWAMI_OK);
  EXPECT_EQ(kiwami_scene_set_representative_rays(nullptr, nullptr, 0, 0),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_scene_set_optimizers(nullptr, nullptr, 0), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "scene is NULL, expected a valid pointer");
}

}  // namespace
}  // namespace kiwami_api_tests

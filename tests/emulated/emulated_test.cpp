// SPDX-License-Identifier: Apache-2.0
// The emulated kernels against the scalar ones: every answer of every kernel, to the bit.
#include <gtest/gtest.h>

#include <cstdio>
#include <ostream>
#include <string>
#include <vector>

#include "core/scene.h"
#include "kernels/kernel_table.h"
#include "kiwami/kiwami.h"
#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/ray_generator.h"
#include "support/report.h"

extern "C" {
void kiwami_emulated_sse_kernel_table(kiwami::KernelTable* table);
void kiwami_emulated_avx2_kernel_table(kiwami::KernelTable* table);
void kiwami_emulated_avx512_kernel_table(kiwami::KernelTable* table);
}

namespace {

using namespace kiwami_tests;
using kiwami::KernelTable;
using kiwami::RayBatch;
using kiwami::SceneView;
using kiwami::TraversalCounters;
using kiwami::TraversalKernels;

struct Kernels {
  const char* isa;
  void (*get)(KernelTable*);
  uint32_t width;
};

std::ostream& operator<<(std::ostream& stream, const Kernels& kernels) {
  return stream << kernels.isa << " " << kernels.width;
}

const SceneView& view_of(const kiwami_scene* scene) {
  return reinterpret_cast<const kiwami::Scene*>(scene)->committed()->view();
}

/// What all kernels of a width say about the same rays.
struct Answers {
  std::vector<kiwami_hit> closest, closest_counted, closest_general;
  std::vector<uint8_t> any, any_counted, any_general;
  std::vector<uint32_t> all, all_general;
  TraversalCounters counters{};
};

template <typename Answer>
RayBatch batch_of(const std::vector<kiwami_ray>& rays, std::vector<Answer>& answers) {
  answers.resize(rays.size());
  return {reinterpret_cast<const unsigned char*>(rays.data()), sizeof(kiwami_ray),
          reinterpret_cast<unsigned char*>(answers.data()), sizeof(Answer), rays.size()};
}

Answers trace(const TraversalKernels& kernels, const SceneView& view,
              const std::vector<kiwami_ray>& rays) {
  Answers answers;
  TraversalCounters any_counters{};
  kernels.closest_hit(view, batch_of(rays, answers.closest));
  kernels.closest_hit_counted(view, batch_of(rays, answers.closest_counted), answers.counters);
  kernels.any_hit(view, batch_of(rays, answers.any));
  kernels.any_hit_counted(view, batch_of(rays, answers.any_counted), any_counters);
  kernels.all_hits(view, batch_of(rays, answers.all));
  const kiwami::QueryOptions none{};
  kernels.general.closest_hit(view, batch_of(rays, answers.closest_general), none);
  kernels.general.any_hit(view, batch_of(rays, answers.any_general), none);
  kernels.general.all_hits(view, batch_of(rays, answers.all_general), none);
  return answers;
}

void expect_equal(const Answers& answers, const Answers& reference,
                  const std::vector<kiwami_ray>& rays) {
  for (size_t i = 0; i < rays.size(); ++i) {
    for (const auto* hits :
         {&answers.closest, &answers.closest_counted, &answers.closest_general}) {
      ASSERT_TRUE(is_same((*hits)[i], reference.closest[i]))
          << describe(rays[i]) << "\n  " << describe((*hits)[i]) << "\n  scalar "
          << describe(reference.closest[i]);
    }
    ASSERT_EQ(answers.any[i], reference.any[i]) << describe(rays[i]);
    ASSERT_EQ(answers.any_counted[i], reference.any[i]) << describe(rays[i]);
    ASSERT_EQ(answers.any_general[i], reference.any[i]) << describe(rays[i]);
    ASSERT_EQ(answers.all[i], reference.all[i]) << describe(rays[i]);
    ASSERT_EQ(answers.all_general[i], reference.all[i]) << describe(rays[i]);
  }
  EXPECT_EQ(answers.counters.margin_violations, 0u);
}

std::vector<Scene> test_scenes() {
  std::vector<Scene> scenes;
  const uint64_t count = case_budget(60);
  for (uint32_t i = 0; i < count; ++i) scenes.push_back(adversarial_scene(i, seed()));
  for (const auto& closed : closed_meshes()) scenes.push_back(scene_of(closed));
  return scenes;
}

class Emulated : public testing::TestWithParam<Kernels> {};

TEST_P(Emulated, AnswersEqualTheScalarOnesToTheBit) {
  const auto [isa, get, width] = GetParam();
  KernelTable emulated, scalar;
  get(&emulated);
  kiwami_scalar_kernel_table(&scalar);
  const DeviceHandle device = make_device(KIWAMI_ISA_SCALAR, 1);
  const std::vector<Scene> scenes = test_scenes();
  const size_t count = ray_budget(100000) / scenes.size() + 1;
  size_t traced = 0, hits = 0;
  for (size_t i = 0; i < scenes.size() && !HasFatalFailure(); ++i) {
    SCOPED_TRACE(scenes[i].name + ", KIWAMI_SEED=" + std::to_string(seed()));
    const SceneHandle scene =
        make_scene(device.get(), scenes[i],
                   {.width = width,
                    .merges_leaves = i % 2 == 0,
                    .parameters = {{KIWAMI_PARAMETER_LAYOUT, i % 3 == 0 ? 1.0 : 0.0}}});
    RayGenerator generator(scenes[i], Random(seed(), i));
    std::vector<kiwami_ray> rays(count);
    for (kiwami_ray& ray : rays) ray = generator.next();
    const SceneView& view = view_of(scene.get());
    const kiwami::LeafLayout layout = view.tree.leaf_layout;
    const Answers reference = trace(scalar.of(width, layout), view, rays);
    expect_equal(trace(emulated.of(width, layout), view, rays), reference, rays);
    traced += count;
    for (const uint8_t hit : reference.any) hits += hit;
  }
  EXPECT_GT(hits, traced / 20) << "too few hits to say anything";
  std::printf("%s %u: %zu rays, %zu of them hit, equal\n", isa, width, traced, hits);
}

INSTANTIATE_TEST_SUITE_P(Kernels, Emulated,
                         testing::Values(Kernels{"sse", kiwami_emulated_sse_kernel_table, 4},
                                         Kernels{"avx2", kiwami_emulated_avx2_kernel_table, 4},
                                         Kernels{"avx2", kiwami_emulated_avx2_kernel_table, 8},
                                         Kernels{"avx512", kiwami_emulated_avx512_kernel_table, 8},
                                         Kernels{"avx512", kiwami_emulated_avx512_kernel_table,
                                                 16}),
                         [](const auto& test) {
                           return std::string(test.param.isa) + "_" +
                                  std::to_string(test.param.width);
                         });

}  // namespace

// SPDX-License-Identifier: Apache-2.0
#include "support/exercise.h"

#include <stdexcept>
#include <vector>

#include "support/random.h"

namespace kiwami_tests {
namespace {

constexpr size_t kRayCount = 16;

kiwami_result check(kiwami_result result) {
  if (result == KIWAMI_ERROR_INTERNAL) throw std::runtime_error("an internal error");
  return result;
}

/// Into and out of the cube from -1 to 1.
std::vector<kiwami_ray> make_rays() {
  Random random(9);
  std::vector<kiwami_ray> rays(kRayCount);
  for (kiwami_ray& ray : rays) {
    ray = {2 * random.symmetric(),
           2 * random.symmetric(),
           2 * random.symmetric(),
           0.0f,
           random.symmetric(),
           random.symmetric(),
           random.symmetric(),
           1e30f,
           random.unit(),
           ~0u,
           0u,
           0u};
  }
  return rays;
}

void trace(const kiwami_scene* scene) {
  const std::vector<kiwami_ray> rays = make_rays();
  kiwami_hit hits[kRayCount];
  uint8_t occluded[kRayCount];
  uint32_t counts[kRayCount];
  uint64_t offsets[kRayCount + 1];
  check(kiwami_closest_hit(scene, rays.data(), 0, hits, 0, kRayCount, nullptr));
  check(kiwami_any_hit(scene, rays.data(), 0, occluded, 0, kRayCount, nullptr));
  check(kiwami_count_hits(scene, rays.data(), 0, counts, 0, kRayCount, nullptr));
  check(kiwami_multi_hit(scene, rays.data(), 0, kRayCount, 3, hits, kRayCount, offsets, nullptr));
  check(kiwami_scene_count_visits(scene, rays.data(), 0, kRayCount, KIWAMI_COUNT_CLOSEST_HIT,
                                  nullptr, nullptr, 0));
}

void export_as(const kiwami_bvh* bvh, uint32_t format) {
  size_t nodes = 0, primitives = 0;
  if (check(kiwami_bvh_export_counts(bvh, format, &nodes, &primitives)) != KIWAMI_OK) return;
  std::vector<kiwami_wide8_node> to(nodes);  // the largest
  std::vector<kiwami_bvh_primitive> names(primitives);
  check(kiwami_bvh_export(bvh, format, to.data(), nodes * sizeof to[0], names.data(), primitives));
}

}  // namespace

void exercise(kiwami_scene* scene) {
  trace(scene);
  kiwami_bvh* bvh = nullptr;
  if (check(kiwami_scene_get_bvh(scene, &bvh)) == KIWAMI_OK) exercise(bvh);
  kiwami_bvh_release(bvh);
  check(kiwami_scene_validate(scene));
  check(kiwami_scene_refit(scene));
  check(kiwami_scene_commit(scene));
}

void exercise(kiwami_bvh* bvh) {
  kiwami_bvh_info info{};
  info.struct_size = sizeof info;
  check(kiwami_bvh_get_info(bvh, &info));
  std::vector<kiwami_bvh_node> nodes(info.node_count);
  std::vector<kiwami_bvh_primitive> primitives(info.primitive_count);
  check(kiwami_bvh_get_nodes(bvh, 0, nodes.size(), nodes.data(), 0));
  check(kiwami_bvh_get_primitives(bvh, 0, primitives.size(), primitives.data(), 0));
  check(kiwami_bvh_measure(bvh, nullptr, nullptr, nullptr, 0));
  check(kiwami_bvh_validate(bvh));
  for (uint32_t format = KIWAMI_EXPORT_BINARY; format <= KIWAMI_EXPORT_COMPRESSED8; ++format) {
    export_as(bvh, format);
  }
  check(kiwami_bvh_refit(bvh, nullptr, 0, 0));
}

void exercise(kiwami_light_tree* lights) {
  const auto sample = [&] {
    Random random(5);
    kiwami_light_receiver receivers[kRayCount] = {};
    kiwami_light_choice choices[4 * kRayCount];
    for (kiwami_light_receiver& receiver : receivers) {
      for (float& coordinate : receiver.position) coordinate = 2 * random.symmetric();
      for (float& coordinate : receiver.normal) coordinate = random.symmetric();
      receiver.link_mask = ~uint64_t{0};
      receiver.random = static_cast<double>(random.unit());
    }
    for (uint32_t method = KIWAMI_LIGHT_METHOD_TREE; method <= KIWAMI_LIGHT_METHOD_ROULETTE;
         ++method) {
      kiwami_light_query query;
      check(kiwami_light_query_init(&query, sizeof query));
      query.method = method;
      query.max_choices = method <= KIWAMI_LIGHT_METHOD_POWER ? 1 : 4;
      check(kiwami_light_sample(lights, receivers, 0, choices, 0, kRayCount, &query));
    }
  };
  const float power = 3.0f;
  sample();
  check(kiwami_light_tree_set_powers(lights, 0, &power, 0, 1));
  for (const auto call : {kiwami_light_tree_refit, kiwami_light_tree_commit}) {
    check(call(lights));
    sample();
  }
}

}  // namespace kiwami_tests

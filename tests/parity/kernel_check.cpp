// SPDX-License-Identifier: Apache-2.0
#include "parity/kernel_check.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

std::string describe_ray(const Expected& expected, size_t i) {
  return "ray " + std::to_string(i) + ": " + describe(expected.rays[i]) + "\n  oracle " +
         describe(expected.hits[i]);
}

std::string count_difference(const std::vector<uint32_t>& counts, const Expected& expected) {
  for (size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == expected.counts[i]) continue;
    return std::to_string(counts[i]) + " hits instead of " + std::to_string(expected.counts[i]) +
           ", " + describe_ray(expected, i);
  }
  return "";
}

/// The octant into which a ray points; 8 for one that may be no ray at all.
int octant_of(const kiwami_ray& ray) {
  const float sum = ray.origin_x + ray.origin_y + ray.origin_z + ray.direction_x + ray.direction_y +
                    ray.direction_z;
  const bool is_zero = ray.direction_x == 0 && ray.direction_y == 0 && ray.direction_z == 0;
  if (!std::isfinite(sum) || is_zero || !(ray.tmin <= ray.tmax) || ray.mask == 0) return 8;
  return int{std::signbit(ray.direction_x)} + 2 * int{std::signbit(ray.direction_y)} +
         4 * int{std::signbit(ray.direction_z)};
}

std::string difference_in_order(const NamedKernels& named, const kiwami::SceneView& view,
                                const Expected& expected) {
  const auto& kernels = named.kernels;
  const auto& rays = expected.rays;
  kiwami::TraversalCounters counters{};
  std::string found = difference(run_closest_hit(kernels.closest_hit, view, rays), expected);
  if (found.empty()) found = difference(run_any_hit(kernels.any_hit, view, rays), expected);
  if (found.empty()) {
    found = count_difference(run_all_hits(kernels.all_hits, view, rays), expected);
  }
  if (found.empty()) {
    found = difference(run_counted_closest_hit(kernels.closest_hit_counted, view, rays, counters),
                       expected);
  }
  if (found.empty()) {
    found =
        difference(run_counted_any_hit(kernels.any_hit_counted, view, rays, counters), expected);
  }
  if (found.empty() && counters.margin_violations) {
    found = std::to_string(counters.margin_violations) + " hits outside their leaf's box";
  }
  return found;
}

/// As difference_in_order, of the kernels for all kinds of scenes.
std::string general_difference(const kiwami::GeneralKernels& kernels, const kiwami::SceneView& view,
                               const Expected& expected) {
  const auto& rays = expected.rays;
  kiwami::TraversalCounters counters{};
  std::string found =
      difference(run_general<kiwami_hit>(kernels.closest_hit, view, rays), expected);
  if (found.empty()) {
    found = difference(run_general<uint8_t>(kernels.any_hit, view, rays), expected);
  }
  if (found.empty()) {
    found = count_difference(run_general<uint32_t>(kernels.all_hits, view, rays), expected);
  }
  if (found.empty()) {
    found = difference(run_general<kiwami_hit>(kernels.closest_hit_counted, view, rays, counters),
                       expected);
  }
  if (found.empty()) {
    found =
        difference(run_general<uint8_t>(kernels.any_hit_counted, view, rays, counters), expected);
  }
  if (found.empty() && counters.margin_violations) {
    found = std::to_string(counters.margin_violations) + " hits outside their leaf's box";
  }
  return found.empty() ? "" : "general kernels: " + found;
}

}  // namespace

Expected grouped_by_octant(const Expected& expected) {
  std::vector<size_t> order(expected.rays.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return octant_of(expected.rays[a]) < octant_of(expected.rays[b]);
  });
  Expected grouped;
  for (const size_t i : order) {
    grouped.rays.push_back(expected.rays[i]);
    grouped.hits.push_back(expected.hits[i]);
    grouped.counts.push_back(expected.counts[i]);
  }
  return grouped;
}

Expected expected_of(const PlainOracle& oracle, const Scene& scene, uint64_t count, Random random) {
  Expected expected;
  RayGenerator generator(scene, Random(random.bits(), 1));
  const auto add = [&](const kiwami_ray& ray) {
    expected.rays.push_back(ray);
    expected.hits.push_back(oracle.closest_hit(ray));
    expected.counts.push_back(oracle.all_hits(ray));
    return expected.hits.back();
  };
  while (expected.rays.size() < count) {
    const kiwami_ray ray = generator.next();
    const kiwami_hit hit = add(ray);
    if (hit.primitive_id != KIWAMI_INVALID_ID) add(with_interval_at(ray, hit.t, random));
  }
  return expected;
}

std::string difference(const std::vector<kiwami_hit>& hits, const Expected& expected) {
  for (size_t i = 0; i < hits.size(); ++i) {
    if (is_same(hits[i], expected.hits[i])) continue;
    return "closest hit, " + describe_ray(expected, i) + "\n  answer " + describe(hits[i]);
  }
  return "";
}

std::string difference(const std::vector<uint8_t>& any, const Expected& expected) {
  for (size_t i = 0; i < any.size(); ++i) {
    if (any[i] == (expected.counts[i] != 0 ? 1 : 0)) continue;
    return "any hit " + std::to_string(any[i]) + ", " + describe_ray(expected, i);
  }
  return "";
}

std::string difference(const NamedKernels& named, const kiwami::SceneView& view,
                       const Expected& expected) {
  std::string found = difference_in_order(named, view, expected);
  if (found.empty()) {
    found = difference_in_order(named, view, grouped_by_octant(expected));
    if (!found.empty()) found = "grouped by octant: " + found;
  }
  if (found.empty()) {
    kiwami::SceneView beyond_caches = view;
    beyond_caches.tree.memory_bytes = uint64_t{1} << 40;
    found = difference_in_order(named, beyond_caches, expected);
    if (!found.empty()) found = "as in a tree beyond the caches: " + found;
  }
  if (found.empty()) found = general_difference(named.kernels.general, view, expected);
  return found.empty() ? "" : named.name + ": " + found;
}

}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "measure/ray_sets.h"

namespace kiwami::tools {

/// A ray set of the benchmark.
struct BenchRays {
  RaySet set;
  bool any_hit;
};

/// primary, bounce, bounce_shuffled, ao, shadow and random.
const std::vector<std::string>& bench_ray_names();

/// Makes the ray sets of these names, each of `count` rays; the primary rays are the largest square
/// picture of at most as many:
/// - primary: one ray through each pixel of the view, in scan order;
/// - bounce: from each primary hit, distributed by the cosine, over and over until there are
/// enough;
/// - bounce_shuffled: the same, so that neighbours have nothing in common;
/// - ao (any hit): as bounce, as long as a fifth of the diagonal;
/// - shadow (any hit): from the primary hits to one of 16 points in the box;
/// - random: from anywhere in the box to anywhere.
/// Throws SceneError when the view sees nothing that the others could start from.
std::vector<BenchRays> make_bench_rays(const Tracer& tracer, const View& view, const Box& box,
                                       const std::vector<std::string>& names, size_t count);

}  // namespace kiwami::tools

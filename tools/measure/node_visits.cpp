// SPDX-License-Identifier: Apache-2.0
#include "measure/node_visits.h"

#include <algorithm>

#include "measure/ray_sets.h"

namespace kiwami::tools {
namespace {

/// A ray up to where it ends.
struct Segment {
  double origin[3];
  double direction[3];
  double begin;
  double end;
};

Segment segment_of(const kiwami_ray& ray, const kiwami_hit& hit) {
  return {{ray.origin_x, ray.origin_y, ray.origin_z},
          {ray.direction_x, ray.direction_y, ray.direction_z},
          ray.tmin,
          is_hit(hit) ? hit.t : ray.tmax};
}

/// Slab by slab (T. L. Kay, J. T. Kajiya: Ray Tracing Complex Scenes, SIGGRAPH 1986), in double; a
/// direction along a slab is decided by the origin, so that no NaN comes up.
bool passes(const Segment& segment, const kiwami_bvh_node& node) {
  double begin = segment.begin;
  double end = segment.end;
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = node.lower[axis] - segment.origin[axis];
    const double upper = node.upper[axis] - segment.origin[axis];
    if (segment.direction[axis] == 0.0) {
      if (lower > 0.0 || upper < 0.0) return false;
      continue;
    }
    const double a = lower / segment.direction[axis];
    const double b = upper / segment.direction[axis];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return begin <= end;
}

}  // namespace

std::vector<uint64_t> node_visits(std::span<const kiwami_bvh_node> nodes, const Tracer& tracer,
                                  std::span<const kiwami_ray> rays) {
  std::vector<uint64_t> visits(nodes.size());
  if (nodes.empty()) return visits;
  std::vector<kiwami_hit> hits(rays.size());
  tracer.closest_hits(rays, hits);
  std::vector<uint32_t> open;
  for (size_t i = 0; i < rays.size(); ++i) {
    const Segment segment = segment_of(rays[i], hits[i]);
    open.assign(1, 0);
    while (!open.empty()) {
      const kiwami_bvh_node& node = nodes[open.back()];
      const size_t number = open.back();
      open.pop_back();
      if (!passes(segment, node)) continue;
      ++visits[number];
      for (uint32_t child = 0; child < node.child_count; ++child) {
        open.push_back(node.first_child + child);
      }
    }
  }
  return visits;
}

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#include "core/build_primitives.h"

#include <numeric>

#include "core/collect_boxes.h"

namespace kiwami {

namespace {

/// The box of a triangle; false when it can never be hit.
bool make_primitive(const TriangleMeshView& mesh, uint32_t primitive, BuildPrimitive& made) {
  Vec3f corner[3];
  mesh.checked_corners_of(primitive, corner);
  if (!can_be_hit(corner)) return false;
  Bounds bounds = Bounds::empty();
  for (const Vec3f& vertex : corner) bounds.extend(vertex);
  made = {bounds.lower, mesh.first_id + primitive, bounds.upper, 0};
  return true;
}

/// Makes the primitives of the ids from begin to end; returns how many there are.
size_t make_block(const TriangleSource& source, size_t begin, size_t end, BuildPrimitive* made) {
  const TriangleMeshView* mesh = &source.mesh_of(static_cast<uint32_t>(begin));
  size_t made_count = 0;
  for (size_t id = begin; id < end; ++id) {
    while (id - mesh->first_id >= mesh->triangle_count) ++mesh;
    const uint32_t primitive = static_cast<uint32_t>(id) - mesh->first_id;
    if (make_primitive(*mesh, primitive, made[made_count])) ++made_count;
  }
  return made_count;
}

}  // namespace

Array<BuildPrimitive> collect_build_primitives(const TriangleSource& source, size_t count,
                                               Memory& memory, const Parallel& parallel) {
  return collect_blocks(count, memory, parallel,
                        [&](size_t begin, size_t end, BuildPrimitive* made) {
                          return make_block(source, begin, end, made);
                        });
}

size_t count_hittable(const TriangleSource& source, size_t count, Memory& memory,
                      const Parallel& parallel) {
  Array<size_t> counts(memory, blocks_of(count));
  parallel.for_blocks(count, kCollectedBlock, [&](size_t begin, size_t end) {
    size_t hittable = 0;
    for (size_t id = begin; id < end; ++id) {
      Vec3f corner[3];
      source.corners_of(static_cast<uint32_t>(id), corner);
      if (can_be_hit(corner)) ++hittable;
    }
    counts[begin / kCollectedBlock] = hittable;
  });
  return std::accumulate(counts.begin(), counts.end(), size_t{0});
}

Array<uint32_t> missing_ids(const Array<BuildPrimitive>& primitives, size_t count, Memory& memory) {
  Array<uint32_t> missing(memory, count - primitives.size());
  size_t found = 0;
  uint32_t id = 0;
  for (size_t i = 0; found < missing.size(); ++i, ++id) {
    const uint32_t next = i < primitives.size() ? primitives[i].id : static_cast<uint32_t>(count);
    for (; id < next; ++id) missing[found++] = id;
  }
  return missing;
}

}  // namespace kiwami

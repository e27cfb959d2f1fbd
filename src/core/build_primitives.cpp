// SPDX-License-Identifier: Apache-2.0
#include "core/build_primitives.h"

#include <simde/x86/sse2.h>

#include <cstring>
#include <numeric>

#include "core/collect_boxes.h"

namespace kiwami {

namespace {

/// The three coordinates at any address, and no byte beyond them; lane 3 is 0.
simde__m128 load_vertex(const unsigned char* at) {
  double xy;
  float z;
  std::memcpy(&xy, at, sizeof xy);
  std::memcpy(&z, at + sizeof xy, sizeof z);
  return simde_mm_movelh_ps(simde_mm_castpd_ps(simde_mm_set_sd(xy)), simde_mm_set_ss(z));
}

/// The box of a triangle; false when it can never be hit (can_be_hit).
bool make_primitive(const TriangleMeshView& mesh, uint32_t primitive, BuildPrimitive& made) {
  uint32_t index[3];
  mesh.checked_indices_of(primitive, index);
  const simde__m128 first = load_vertex(mesh.vertex(index[0]));
  const simde__m128 second = load_vertex(mesh.vertex(index[1]));
  const simde__m128 third = load_vertex(mesh.vertex(index[2]));
  // In this order the first of equal zeros stays, as in Bounds::extend.
  const simde__m128 lower = simde_mm_min_ps(third, simde_mm_min_ps(second, first));
  const simde__m128 upper = simde_mm_max_ps(third, simde_mm_max_ps(second, first));
  const simde__m128 most = simde_mm_set1_ps(KIWAMI_MAX_COORDINATE);
  const auto is_within = [&](simde__m128 vertex) {
    const simde__m128 size = simde_mm_andnot_ps(simde_mm_set1_ps(-0.0f), vertex);
    return simde_mm_cmple_ps(size, most);
  };
  const simde__m128 all_within =
      simde_mm_and_ps(is_within(first), simde_mm_and_ps(is_within(second), is_within(third)));
  if (simde_mm_movemask_ps(all_within) != 15) return false;
  float* const words = reinterpret_cast<float*>(&made);
  simde_mm_storeu_ps(words, lower);
  simde_mm_storeu_ps(words + 4, upper);
  made.id = mesh.first_id + primitive;
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

// SPDX-License-Identifier: Apache-2.0
#include "core/build_primitives.h"

#include <cmath>

#include "core/error.h"

namespace kiwami {

namespace {

/// Triangles that one task looks at.
constexpr size_t kBlockSize = 8192;

bool is_in_range(const Vec3f& vertex) {
  // A comparison with NaN is false, so NaN is out of range as well.
  return std::fabs(vertex.x) <= KIWAMI_MAX_COORDINATE &&
         std::fabs(vertex.y) <= KIWAMI_MAX_COORDINATE &&
         std::fabs(vertex.z) <= KIWAMI_MAX_COORDINATE;
}

/// Throws unless every index of a triangle names a vertex: only then may its corners be read.
void check_indices(const TriangleMeshView& mesh, uint32_t primitive) {
  uint32_t corner[3];
  mesh.indices_of(primitive, corner);
  for (uint32_t k = 0; k < 3; ++k) {
    if (corner[k] < mesh.vertex_count) continue;
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "index %u of triangle %u of geometry %u is %u, expected less than its vertex "
                "count, which is %zu",
                k, primitive, mesh.geometry_id, corner[k], mesh.vertex_count);
  }
}

/// The box of a triangle; false when it can never be hit.
bool make_primitive(const TriangleMeshView& mesh, uint32_t primitive, BuildPrimitive& made) {
  check_indices(mesh, primitive);
  Vec3f corner[3];
  mesh.corners_of(primitive, corner);
  Bounds bounds = Bounds::empty();
  for (const Vec3f& vertex : corner) {
    if (!is_in_range(vertex)) return false;
    bounds.extend(vertex);
  }
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
  Array<BuildPrimitive> primitives(memory, count);
  Array<size_t> made_counts(memory, (count + kBlockSize - 1) / kBlockSize);
  parallel.for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
    made_counts[begin / kBlockSize] = make_block(source, begin, end, primitives.data() + begin);
  });

  // Close the gaps that left-out triangles made; mostly there are none.
  size_t kept = 0;
  for (size_t block = 0; block < made_counts.size(); ++block) {
    const BuildPrimitive* made = primitives.data() + block * kBlockSize;
    if (made != primitives.data() + kept) {
      std::memmove(primitives.data() + kept, made, made_counts[block] * sizeof(BuildPrimitive));
    }
    kept += made_counts[block];
  }
  primitives.shrink(kept);
  return primitives;
}

}  // namespace kiwami

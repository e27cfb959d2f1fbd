// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "bvh/triangle_source.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// The boxes of the triangles that can be hit, by rising id: one with a vertex that is NaN,
/// infinite or beyond KIWAMI_MAX_COORDINATE is left out. count is the number of triangles of the
/// source. Throws Error(INVALID_ARGUMENT) for an index at or beyond its mesh's vertex count, which
/// a shared buffer can hold by now.
Array<BuildPrimitive> collect_build_primitives(const TriangleSource& source, size_t count,
                                               Memory& memory, const Parallel& parallel);

/// How many of the triangles can be hit.
size_t count_hittable(const TriangleSource& source, size_t count, Memory& memory,
                      const Parallel& parallel);

/// The ids below count that none of the primitives, which stand by rising id, has.
Array<uint32_t> missing_ids(const Array<BuildPrimitive>& primitives, size_t count, Memory& memory);

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// What an ISA offers: one table of functions per ISA, chosen per device. Plain data only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/light_kernel_set.h"
#include "kiwami/trace.h"
#include "wide/wide_bvh.h"

namespace kiwami {

/// A strided run of rays and its answers. Rays and answers lie at any address.
struct RayBatch {
  const unsigned char* rays;  ///< kiwami_ray, ray_stride bytes apart
  size_t ray_stride;
  unsigned char* answers;  ///< kiwami_hit, or one uint8_t, or one uint32_t (see TraversalKernels)
  size_t answer_stride;
  size_t count;
};

/// Sums over a batch, added to what is there.
struct TraversalCounters {
  uint64_t node_visits;
  uint64_t leaf_visits;
  uint64_t accepted;           ///< triangles accepted on the way
  uint64_t margin_violations;  ///< accepted hits that lie before the ray enters their own leaf's
                               ///< box, or, where triangles stand in several leaves, in no box of
                               ///< theirs; any other number than 0 is a defect of the margin
  uint64_t double_fallbacks;   ///< edge functions decided in double precision
};

/// What a query asks beyond its rays; plain kernels know nothing of it. Element i of a strided
/// field belongs to ray i of the batch.
struct QueryOptions {
  unsigned char* instance_paths = nullptr;  ///< KIWAMI_MAX_INSTANCE_DEPTH uint32_t a ray, or null
  size_t instance_path_stride = 0;
  const unsigned char* exclusions = nullptr;  ///< kiwami_exclusion a ray, or null
  size_t exclusion_stride = 0;
  const unsigned char* exclusion_paths = nullptr;  ///< as instance_paths, or null
  size_t exclusion_path_stride = 0;
  kiwami_filter_function filter = nullptr;
  void* filter_user = nullptr;
  uint64_t first_ray = 0;               ///< the number of ray 0 in the call
  uint32_t* failed_callback = nullptr;  ///< set to 1 where a callback fails; shared by threads

  void report_failed_callback() const {
    if (failed_callback) __atomic_store_n(failed_callback, 1u, __ATOMIC_RELAXED);
  }
  bool has_failed_callback() const {
    return failed_callback && __atomic_load_n(failed_callback, __ATOMIC_RELAXED) != 0;
  }

  bool is_empty() const { return !instance_paths && !exclusions && !filter; }

  /// The options of the rays from first on.
  QueryOptions from(size_t first) const {
    QueryOptions rest = *this;
    rest.first_ray += first;
    if (rest.instance_paths) rest.instance_paths += first * instance_path_stride;
    if (rest.exclusions) rest.exclusions += first * exclusion_stride;
    if (rest.exclusion_paths) rest.exclusion_paths += first * exclusion_path_stride;
    return rest;
  }
};

using TraversalKernel = void (*)(const SceneView& scene, const RayBatch& batch);
using CountingKernel = void (*)(const SceneView& scene, const RayBatch& batch,
                                TraversalCounters& counters);

/// What hits are sorted by, and the slot that each is in.
struct HitKey {
  float t;
  uint32_t slot;
};

/// Lists of the nearest hits of the rays of a batch: ray i has the slots from i * limit on. Its
/// keys are sorted, and say where from there each hit is.
struct HitLists {
  kiwami_hit* hits;
  HitKey* keys;
  uint32_t limit;  ///< at most this many of a ray
};
/// Answers: uint32_t, the number of hits in the ray's list, each hit being there once.
using NearestHitsKernel = void (*)(const SceneView& scene, const RayBatch& batch,
                                   const HitLists& lists);

/// Room for the hits of one ray.
struct HitRoom {
  kiwami_hit* hits;
  HitKey* keys;  ///< as many, to work with
  size_t capacity;
  uint32_t limit;  ///< of the nearest ones; 0: none
};
/// Fills the room with a ray's hits, sorted, each once. Returns their number, or more than the
/// capacity where that is too small. The rays of the batch are one; its answers are not used.
using ManyHitsKernel = size_t (*)(const SceneView& scene, const RayBatch& batch,
                                  const HitRoom& room);

/// The kernels that list several hits of a ray.
struct MultiHitKernels {
  NearestHitsKernel nearest = nullptr;
  ManyHitsKernel many = nullptr;
};

/// The numbers of the instances that lead from the traced scene to another.
struct InstancePath {
  uint32_t depth;
  uint32_t number[KIWAMI_MAX_INSTANCE_DEPTH];
};

/// A hit in a list of a general kernel.
struct GeneralHit {
  kiwami_hit hit;
  InstancePath path;
  uint32_t is_asked;  ///< 1: the filter, if there is one, decides whether it counts
};

/// A list of the nearest hits of one ray. Its keys are sorted, and say where each hit is.
struct GeneralHitList {
  GeneralHit* hits;
  HitKey* keys;
  uint32_t limit;           ///< at most this many
  const GeneralHit* after;  ///< hits up to this one, included, are left out; nullptr: none
};
/// Returns the number of hits in the list, each being there once. No filter is called: the hits are
/// those that may count. The rays of the batch are one; its answers are not used.
using GeneralListKernel = uint32_t (*)(const SceneView& scene, const RayBatch& batch,
                                       const QueryOptions& options, const GeneralHitList& list);

using GeneralKernel = void (*)(const SceneView& scene, const RayBatch& batch,
                               const QueryOptions& options);
using CountingGeneralKernel = void (*)(const SceneView& scene, const RayBatch& batch,
                                       const QueryOptions& options, TraversalCounters& counters);

/// Kernels for every scene and query. The answers are those of the plain kernels.
struct GeneralKernels {
  GeneralKernel closest_hit;
  GeneralKernel any_hit;
  GeneralKernel all_hits;
  CountingGeneralKernel closest_hit_counted;
  CountingGeneralKernel any_hit_counted;
  GeneralListKernel nearest_hits;
};

/// The kernels of one node width; all null where the ISA has none. Those that are not in general
/// are for scenes of static triangles alone, and for queries without options.
struct TraversalKernels {
  TraversalKernel closest_hit;         ///< answers: kiwami_hit
  TraversalKernel any_hit;             ///< answers: uint8_t, 1 or 0
  TraversalKernel all_hits;            ///< answers: uint32_t, the number of accepted triangles
  CountingKernel closest_hit_counted;  ///< the same answers, and the counters
  CountingKernel any_hit_counted;
  MultiHitKernels multi_hit = {};
  GeneralKernels general{};
};

struct KernelTable {
  uint32_t isa;                   ///< KIWAMI_ISA_*
  TraversalKernels traversal[3];  ///< widths 4, 8, 16; of trees whose leaves hold triangles
  TraversalKernels compact[3];    ///< the same of leaves of ids alone
  LightKernels lights[4] = {};    ///< widths 2, 4, 8, 16

  const TraversalKernels& of(uint32_t width, LeafLayout layout) const {
    return (layout == LeafLayout::kTriangles ? traversal : compact)[width == 4   ? 0
                                                                    : width == 8 ? 1
                                                                                 : 2];
  }
  const LightKernels& lights_of_width(uint32_t width) const {
    return lights[width == 2 ? 0 : width == 4 ? 1 : width == 8 ? 2 : 3];
  }
};

}  // namespace kiwami

// The one symbol of each ISA's objects. They fill the caller's table, so that they hold no statics.
extern "C" {
void kiwami_scalar_kernel_table(kiwami::KernelTable* table);
void kiwami_sse_kernel_table(kiwami::KernelTable* table);
void kiwami_avx2_kernel_table(kiwami::KernelTable* table);
void kiwami_avx512_kernel_table(kiwami::KernelTable* table);
}

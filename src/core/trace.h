// SPDX-License-Identifier: Apache-2.0
// Batches of rays: their way to the kernels, over threads and from fields that lie apart.
#pragma once

#include "core/committed_scene.h"
#include "kernels/kernel_table.h"

namespace kiwami {

/// Batches below this stay on the calling thread: waking others costs as much as tracing them.
constexpr size_t kParallelCount = 4096;

inline bool is_alone(const Parallel& parallel, size_t count, bool on_calling_thread) {
  return count < kParallelCount || on_calling_thread || parallel.width() == 1;
}

/// A question, by the kernels that answer it.
struct Question {
  TraversalKernel TraversalKernels::*plain;
  GeneralKernel GeneralKernels::*general;

  /// Answers a batch on the calling thread, by the plain kernel where it can.
  void answer(const CommittedScene& scene, const RayBatch& batch,
              const QueryOptions& options) const {
    if (scene.is_plain() && options.is_empty()) {
      (scene.kernels().*plain)(scene.view(), batch);
    } else {
      (scene.kernels().general.*general)(scene.view(), batch, options);
    }
  }
};
constexpr Question kClosestHit = {&TraversalKernels::closest_hit, &GeneralKernels::closest_hit};
constexpr Question kAnyHit = {&TraversalKernels::any_hit, &GeneralKernels::any_hit};
constexpr Question kAllHits = {&TraversalKernels::all_hits, &GeneralKernels::all_hits};

/// Notices when a callback fails while a call is answered.
class CallbackWatch {
 public:
  /// The options, with the watch in them. It must outlive their use.
  QueryOptions watched(QueryOptions options) {
    options.failed_callback = &failed_;
    return options;
  }
  bool has_failed() const { return __atomic_load_n(&failed_, __ATOMIC_RELAXED) != 0; }
  /// Throws Error(CALLBACK) if one has.
  void check() const;

 private:
  uint32_t failed_ = 0;
};

/// How a call is to be answered, beside its rays.
struct TraceRequest {
  QueryOptions options;
  bool on_calling_thread;  ///< and no other
};

/// Answers a batch: on the device's threads if it is large, or on the calling thread.
void trace(const CommittedScene& scene, const Question& question, const RayBatch& batch,
           const TraceRequest& request);

/// The closest hits of rays whose fields lie apart.
void trace_closest_hit(const CommittedScene& scene, const kiwami_ray_fields& rays,
                       const kiwami_hit_fields& hits, size_t count, const TraceRequest& request);

/// How many hits rays whose fields lie apart have.
void trace_all_hits(const CommittedScene& scene, const kiwami_ray_fields& rays,
                    const kiwami_output_field& counts, size_t count, const TraceRequest& request);

/// Whether rays whose fields lie apart have a hit. An occluded.stride of 0 is 1.
void trace_any_hit(const CommittedScene& scene, const kiwami_ray_fields& rays,
                   const kiwami_output_field& occluded, size_t count, const TraceRequest& request);

}  // namespace kiwami

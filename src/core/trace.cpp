// SPDX-License-Identifier: Apache-2.0
#include "core/trace.h"

#include <algorithm>

#include "core/field_access.h"
#include "math/float_environment.h"

namespace kiwami {

namespace {

/// Rays that one task traces.
constexpr size_t kBlockSize = 1024;
/// Calls body(begin, end) for all of count rays, in blocks on the device's threads if they are
/// many.
template <typename Body>
void for_rays(const Parallel& parallel, size_t count, bool on_calling_thread, Body&& body) {
  if (is_alone(parallel, count, on_calling_thread)) {
    const DefaultFloatEnvironment environment;
    body(size_t{0}, count);
  } else {
    parallel.for_blocks(count, kBlockSize, body);
  }
}

/// Gathers the rays chunk by chunk, has the kernel answer each chunk, and calls
/// deliver(answers, first, count).
template <typename Answer, typename Deliver>
void trace_chunks(const CommittedScene& scene, TraversalKernel kernel,
                  const kiwami_ray_fields& fields, size_t count, bool on_calling_thread,
                  Deliver&& deliver) {
  for_rays(scene.parallel(), count, on_calling_thread, [&](size_t begin, size_t end) {
    kiwami_ray rays[kChunkSize];
    Answer answers[kChunkSize];
    for (size_t first = begin; first < end; first += kChunkSize) {
      const size_t chunk = std::min(kChunkSize, end - first);
      gather_rays(fields, first, chunk, rays);
      kernel(scene.view(), {reinterpret_cast<const unsigned char*>(rays), sizeof(kiwami_ray),
                            reinterpret_cast<unsigned char*>(answers), sizeof(Answer), chunk});
      deliver(answers, first, chunk);
    }
  });
}

}  // namespace

void trace(const CommittedScene& scene, TraversalKernel kernel, const RayBatch& batch,
           bool on_calling_thread) {
  if (is_alone(scene.parallel(), batch.count, on_calling_thread)) {
    const DefaultFloatEnvironment environment;
    kernel(scene.view(), batch);
    return;
  }
  scene.parallel().for_blocks(batch.count, kBlockSize, [&](size_t begin, size_t end) {
    kernel(scene.view(),
           {batch.rays + begin * batch.ray_stride, batch.ray_stride,
            batch.answers + begin * batch.answer_stride, batch.answer_stride, end - begin});
  });
}

void trace_closest_hit(const CommittedScene& scene, const kiwami_ray_fields& rays,
                       const kiwami_hit_fields& hits, size_t count, bool on_calling_thread) {
  trace_chunks<kiwami_hit>(scene, scene.kernels().closest_hit, rays, count, on_calling_thread,
                           [&](const kiwami_hit* answers, size_t first, size_t chunk) {
                             scatter_hits(answers, first, chunk, hits);
                           });
}

void trace_all_hits(const CommittedScene& scene, const kiwami_ray_fields& rays,
                    const kiwami_output_field& counts, size_t count, bool on_calling_thread) {
  trace_chunks<uint32_t>(scene, scene.kernels().all_hits, rays, count, on_calling_thread,
                         [&](const uint32_t* answers, size_t first, size_t chunk) {
                           scatter_values(answers, first, chunk, counts);
                         });
}

void trace_any_hit(const CommittedScene& scene, const kiwami_ray_fields& rays,
                   const kiwami_output_field& occluded, size_t count, bool on_calling_thread) {
  unsigned char* target = static_cast<unsigned char*>(occluded.data);
  const size_t stride = occluded.stride ? static_cast<size_t>(occluded.stride) : 1;
  trace_chunks<uint8_t>(scene, scene.kernels().any_hit, rays, count, on_calling_thread,
                        [&](const uint8_t* answers, size_t first, size_t chunk) {
                          if (!target) return;
                          for (size_t i = 0; i < chunk; ++i) {
                            target[(first + i) * stride] = answers[i];
                          }
                        });
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "core/trace.h"

#include <algorithm>

#include "core/error.h"
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

/// Gathers the rays chunk by chunk, has each chunk answered, and calls deliver(answers, first,
/// count).
template <typename Answer, typename Deliver>
void trace_chunks(const CommittedScene& scene, const Question& question,
                  const kiwami_ray_fields& fields, size_t count, const TraceRequest& request,
                  Deliver&& deliver) {
  CallbackWatch watch;
  const QueryOptions options = watch.watched(request.options);
  for_rays(scene.parallel(), count, request.on_calling_thread, [&](size_t begin, size_t end) {
    kiwami_ray rays[kChunkSize];
    Answer answers[kChunkSize];
    for (size_t first = begin; first < end; first += kChunkSize) {
      const size_t chunk = std::min(kChunkSize, end - first);
      gather_rays(fields, first, chunk, rays);
      question.answer(scene,
                      {reinterpret_cast<const unsigned char*>(rays), sizeof(kiwami_ray),
                       reinterpret_cast<unsigned char*>(answers), sizeof(Answer), chunk},
                      options.from(first));
      deliver(answers, first, chunk);
    }
  });
  watch.check();
}

}  // namespace

void CallbackWatch::check() const {
  if (!has_failed()) return;
  throw Error(
      KIWAMI_ERROR_CALLBACK,
      "a callback returned a number that it may not, or more hits than there is room for, expected "
      "one that its description names, and hits that fit");
}

void trace(const CommittedScene& scene, const Question& question, const RayBatch& batch,
           const TraceRequest& request) {
  CallbackWatch watch;
  const QueryOptions options = watch.watched(request.options);
  for_rays(scene.parallel(), batch.count, request.on_calling_thread, [&](size_t begin, size_t end) {
    question.answer(scene,
                    {batch.rays + begin * batch.ray_stride, batch.ray_stride,
                     batch.answers + begin * batch.answer_stride, batch.answer_stride, end - begin},
                    options.from(begin));
  });
  watch.check();
}

void trace_closest_hit(const CommittedScene& scene, const kiwami_ray_fields& rays,
                       const kiwami_hit_fields& hits, size_t count, const TraceRequest& request) {
  trace_chunks<kiwami_hit>(scene, kClosestHit, rays, count, request,
                           [&](const kiwami_hit* answers, size_t first, size_t chunk) {
                             scatter_hits(answers, first, chunk, hits);
                           });
}

void trace_all_hits(const CommittedScene& scene, const kiwami_ray_fields& rays,
                    const kiwami_output_field& counts, size_t count, const TraceRequest& request) {
  trace_chunks<uint32_t>(scene, kAllHits, rays, count, request,
                         [&](const uint32_t* answers, size_t first, size_t chunk) {
                           scatter_values(answers, first, chunk, counts);
                         });
}

void trace_any_hit(const CommittedScene& scene, const kiwami_ray_fields& rays,
                   const kiwami_output_field& occluded, size_t count, const TraceRequest& request) {
  unsigned char* target = static_cast<unsigned char*>(occluded.data);
  const size_t stride = occluded.stride ? static_cast<size_t>(occluded.stride) : 1;
  trace_chunks<uint8_t>(scene, kAnyHit, rays, count, request,
                        [&](const uint8_t* answers, size_t first, size_t chunk) {
                          if (!target) return;
                          for (size_t i = 0; i < chunk; ++i) {
                            target[(first + i) * stride] = answers[i];
                          }
                        });
}

}  // namespace kiwami

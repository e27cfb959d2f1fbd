// SPDX-License-Identifier: Apache-2.0
#include "core/trace.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "math/float_environment.h"

namespace kiwami {

namespace {

/// Rays that one task traces.
constexpr size_t kBlockSize = 1024;
/// Rays that are gathered at once, on the stack: enough for kernels that trace rays together.
constexpr size_t kChunkSize = 256;

inline bool is_alone(const Parallel& parallel, size_t count, bool on_calling_thread) {
  return count < kParallelCount || on_calling_thread || parallel.width() == 1;
}

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

/// Element i of a field.
const unsigned char* element(const kiwami_input_field& field, size_t i) {
  return static_cast<const unsigned char*>(field.data) + i * static_cast<size_t>(field.stride);
}

/// Copies one field of count rays from first on into rays; the preset where the field is absent.
template <typename T>
void gather(const kiwami_input_field& field, T preset, size_t first, size_t count,
            T kiwami_ray::*member, kiwami_ray* rays) {
  for (size_t i = 0; i < count; ++i) {
    T value = preset;
    if (field.data) std::memcpy(&value, element(field, first + i), sizeof(value));
    rays[i].*member = value;
  }
}

void gather_rays(const kiwami_ray_fields& fields, size_t first, size_t count, kiwami_ray* rays) {
  gather(fields.origin_x, 0.0f, first, count, &kiwami_ray::origin_x, rays);
  gather(fields.origin_y, 0.0f, first, count, &kiwami_ray::origin_y, rays);
  gather(fields.origin_z, 0.0f, first, count, &kiwami_ray::origin_z, rays);
  gather(fields.tmin, 0.0f, first, count, &kiwami_ray::tmin, rays);
  gather(fields.direction_x, 0.0f, first, count, &kiwami_ray::direction_x, rays);
  gather(fields.direction_y, 0.0f, first, count, &kiwami_ray::direction_y, rays);
  gather(fields.direction_z, 0.0f, first, count, &kiwami_ray::direction_z, rays);
  gather(fields.tmax, std::numeric_limits<float>::infinity(), first, count, &kiwami_ray::tmax,
         rays);
  gather(fields.time, 0.0f, first, count, &kiwami_ray::time, rays);
  gather(fields.mask, ~uint32_t{0}, first, count, &kiwami_ray::mask, rays);
  gather(fields.flags, uint32_t{0}, first, count, &kiwami_ray::flags, rays);
  for (size_t i = 0; i < count; ++i) rays[i].id = 0;
}

/// Copies one member of count answers out to a field, from element first on.
template <typename T>
void scatter(const kiwami_hit* hits, T kiwami_hit::*member, size_t first, size_t count,
             const kiwami_output_field& field) {
  if (!field.data) return;
  unsigned char* target = static_cast<unsigned char*>(field.data);
  for (size_t i = 0; i < count; ++i) {
    std::memcpy(target + (first + i) * static_cast<size_t>(field.stride), &(hits[i].*member),
                sizeof(T));
  }
}

void scatter_hits(const kiwami_hit* hits, size_t first, size_t count,
                  const kiwami_hit_fields& fields) {
  scatter(hits, &kiwami_hit::t, first, count, fields.t);
  scatter(hits, &kiwami_hit::u, first, count, fields.u);
  scatter(hits, &kiwami_hit::v, first, count, fields.v);
  scatter(hits, &kiwami_hit::normal_x, first, count, fields.normal_x);
  scatter(hits, &kiwami_hit::normal_y, first, count, fields.normal_y);
  scatter(hits, &kiwami_hit::normal_z, first, count, fields.normal_z);
  scatter(hits, &kiwami_hit::primitive_id, first, count, fields.primitive_id);
  scatter(hits, &kiwami_hit::geometry_id, first, count, fields.geometry_id);
  scatter(hits, &kiwami_hit::instance_id, first, count, fields.instance_id);
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

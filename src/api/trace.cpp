// SPDX-License-Identifier: Apache-2.0
#include "kiwami/trace.h"

#include <limits>

#include "api/check.h"
#include "core/multi_hit.h"
#include "core/trace.h"
#include "math/float_environment.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumStructSize = 8;

constexpr kiwami_ray_fields kNoRays{};
constexpr kiwami_hit_fields kNoHits{};
constexpr kiwami_query kDefaultQuery{};

constexpr uint32_t kQueryFlags = KIWAMI_QUERY_CALLING_THREAD;
constexpr size_t kInstancePathSize = KIWAMI_MAX_INSTANCE_DEPTH * sizeof(uint32_t);

/// A stride that stands for itself, or for the size of an element where it is 0.
size_t stride_or(uint64_t stride, size_t size) {
  return stride ? static_cast<size_t>(stride) : size;
}

/// What a checked query asks for.
TraceRequest request_of(const kiwami_query& query) {
  TraceRequest request{};
  QueryOptions& options = request.options;
  options.instance_paths = reinterpret_cast<unsigned char*>(query.instance_paths);
  options.instance_path_stride = stride_or(query.instance_path_stride, kInstancePathSize);
  options.exclusions = reinterpret_cast<const unsigned char*>(query.exclusions);
  options.exclusion_stride = stride_or(query.exclusion_stride, sizeof(kiwami_exclusion));
  options.exclusion_paths = reinterpret_cast<const unsigned char*>(query.exclusion_paths);
  options.exclusion_path_stride = stride_or(query.exclusion_path_stride, kInstancePathSize);
  options.filter = query.filter;
  options.filter_user = query.filter_user;
  request.on_calling_thread = (query.flags & KIWAMI_QUERY_CALLING_THREAD) != 0;
  return request;
}

/// Checks the arrays of a query for count rays, and path_count paths to what they meet.
void check_query_arrays(const kiwami_query& query, size_t count, size_t path_count) {
  if (query.instance_paths && path_count != 0) {
    check_array("query.instance_paths", query.instance_paths,
                static_cast<size_t>(query.instance_path_stride), kInstancePathSize, path_count);
  }
  if (count == 0) return;
  if (query.exclusions) {
    check_array("query.exclusions", query.exclusions, static_cast<size_t>(query.exclusion_stride),
                sizeof(kiwami_exclusion), count);
  }
  if (query.exclusion_paths) {
    check_array("query.exclusion_paths", query.exclusion_paths,
                static_cast<size_t>(query.exclusion_path_stride), kInstancePathSize, count);
  }
}

/// What a query asks for of count rays, of which path_count paths are told.
TraceRequest read_query(const kiwami_query* query, const CommittedScene& committed, size_t count,
                        size_t path_count) {
  if (!query) return request_of(kDefaultQuery);
  const kiwami_query checked = read_descriptor(query, kMinimumStructSize, "query", kDefaultQuery);
  if (checked.flags & ~kQueryFlags) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "query.flags is 0x%x, expected KIWAMI_QUERY_* bits",
                checked.flags);
  }
  if (checked.exclusion_paths && !checked.exclusions) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "query.exclusion_paths is not NULL and query.exclusions is, expected both or none");
  }
  if (committed.validates_arguments()) check_query_arrays(checked, count, path_count);
  return request_of(checked);
}
TraceRequest read_query(const kiwami_query* query, const CommittedScene& committed, size_t count) {
  return read_query(query, committed, count, count);
}

void check_output_field(const char* name, const kiwami_output_field& field, size_t count) {
  if (!field.data) return;
  if (count > 1 && field.stride < sizeof(float)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "the stride of %s is %llu for %zu rays, expected at least 4", name,
                static_cast<unsigned long long>(field.stride), count);
  }
  check_array(name, field.data, static_cast<size_t>(field.stride), sizeof(float), count);
}

/// An input field may repeat one element (stride 0) or overlap itself: only its end is checked.
void check_input_field(const char* name, const kiwami_input_field& field, size_t count) {
  if (!field.data || field.stride == 0) return;
  const size_t limit =
      std::numeric_limits<uintptr_t>::max() - reinterpret_cast<uintptr_t>(field.data);
  if (sizeof(float) > limit || count - 1 > (limit - sizeof(float)) / field.stride) {
    throw Error(
        KIWAMI_ERROR_INVALID_ARGUMENT,
        "the %zu elements of %s, %llu bytes apart, reach beyond the address space, expected "
        "an extent of at most %zu bytes",
        count, name, static_cast<unsigned long long>(field.stride), limit);
  }
}

void check_hit_fields(const kiwami_hit_fields& hits, size_t count) {
  check_output_field("hits.t", hits.t, count);
  check_output_field("hits.u", hits.u, count);
  check_output_field("hits.v", hits.v, count);
  check_output_field("hits.normal_x", hits.normal_x, count);
  check_output_field("hits.normal_y", hits.normal_y, count);
  check_output_field("hits.normal_z", hits.normal_z, count);
  check_output_field("hits.primitive_id", hits.primitive_id, count);
  check_output_field("hits.geometry_id", hits.geometry_id, count);
  check_output_field("hits.instance_id", hits.instance_id, count);
}

void check_ray_fields(const kiwami_ray_fields& rays, size_t count) {
  check_input_field("rays.origin_x", rays.origin_x, count);
  check_input_field("rays.origin_y", rays.origin_y, count);
  check_input_field("rays.origin_z", rays.origin_z, count);
  check_input_field("rays.direction_x", rays.direction_x, count);
  check_input_field("rays.direction_y", rays.direction_y, count);
  check_input_field("rays.direction_z", rays.direction_z, count);
  check_input_field("rays.tmin", rays.tmin, count);
  check_input_field("rays.tmax", rays.tmax, count);
  check_input_field("rays.time", rays.time, count);
  check_input_field("rays.mask", rays.mask, count);
  check_input_field("rays.flags", rays.flags, count);
}

/// The fields of count rays, of which an origin and a direction must be there.
kiwami_ray_fields read_ray_fields(const kiwami_ray_fields* fields, size_t count) {
  const kiwami_ray_fields rays = read_descriptor(fields, kMinimumStructSize, "rays", kNoRays);
  check_reserved("rays.reserved", rays.reserved);
  if (count == 0) return rays;
  check_not_null(rays.origin_x.data, "rays.origin_x.data");
  check_not_null(rays.origin_y.data, "rays.origin_y.data");
  check_not_null(rays.origin_z.data, "rays.origin_z.data");
  check_not_null(rays.direction_x.data, "rays.direction_x.data");
  check_not_null(rays.direction_y.data, "rays.direction_y.data");
  check_not_null(rays.direction_z.data, "rays.direction_z.data");
  return rays;
}

/// Answers a call of few rays, without a query, to a scene that the plain kernels know, and returns
/// true; false leaves it to answer_few. A single ray takes so little time that everything else
/// that a call looks at, and the registers that it saves for it, would be a tenth of it.
inline bool answer_plainly(const kiwami_scene* scene, TraversalKernel TraversalKernels::*kernel,
                           const RayBatch& batch, const kiwami_query* query) {
  if (!scene || query || batch.count >= kParallelCount) return false;
  const CommittedScene* committed = object_of(scene)->committed();
  if (!committed || !committed->is_plain() || committed->validates_arguments()) return false;
  const DefaultFloatEnvironment environment;
  (committed->kernels().*kernel)(committed->view(), batch);
  return true;
}

/// Answers a call of few rays with which nothing is wrong, and returns true; false leaves it to
/// trace_array, also where a callback failed.
bool answer_few(const kiwami_scene* scene, const Question& question, const RayBatch& batch,
                const kiwami_query* query) {
  if (!scene || batch.count >= kParallelCount) return false;
  const CommittedScene* committed = object_of(scene)->committed();
  if (!committed || committed->validates_arguments()) return false;
  if (query && (query->struct_size != sizeof(kiwami_query) || (query->flags & ~kQueryFlags) != 0 ||
                query->filter || query->exclusion_paths)) {
    return false;
  }
  const DefaultFloatEnvironment environment;
  CallbackWatch watch;
  question.answer(*committed, batch,
                  watch.watched(request_of(query ? *query : kDefaultQuery).options));
  return !watch.has_failed();
}

/// Traces an array of rays to an array of answers of answer_size bytes each.
void trace_array(const CommittedScene& committed, const Question& question, const RayBatch& batch,
                 size_t answer_size, const char* answers_name, const kiwami_query* query) {
  const TraceRequest request = read_query(query, committed, batch.count);
  if (batch.count == 0) return;
  if (committed.validates_arguments()) {
    check_array("rays", batch.rays, batch.ray_stride, sizeof(kiwami_ray), batch.count);
    check_array(answers_name, batch.answers, batch.answer_stride, answer_size, batch.count);
  }
  trace(committed, question, batch, request);
}

/// Answers a call that answer_plainly leaves. Out of line, so that the others do without what it
/// needs room for.
__attribute__((noinline)) kiwami_result answer(const kiwami_scene* scene, const Question& question,
                                               const RayBatch& batch, size_t answer_size,
                                               const char* answers_name,
                                               const kiwami_query* query) {
  if (answer_few(scene, question, batch, query)) return KIWAMI_OK;
  return guarded(device_of(scene), [&] {
    trace_array(committed_of(scene), question, batch, answer_size, answers_name, query);
  });
}

/// Checks the arguments that multi-hit calls have of their own. hits is what the caller gave.
void check_multi_hit(const void* hits, uint64_t hit_capacity, const uint64_t* offsets) {
  check_not_null(offsets, "offsets");
  if (!hits && hit_capacity != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "hits is NULL with a hit_capacity of %llu, expected an array, or a hit_capacity of "
                "0 to count hits alone",
                static_cast<unsigned long long>(hit_capacity));
  }
}

/// Throws where the caller's array was too small for all that there is.
void check_capacity(const void* hits, uint64_t hit_capacity, uint64_t needed) {
  if (needed <= hit_capacity || !hits) return;
  throw Error(KIWAMI_ERROR_CAPACITY, "hit_capacity is %llu, expected at least %llu",
              static_cast<unsigned long long>(hit_capacity),
              static_cast<unsigned long long>(needed));
}

}  // namespace

extern "C" {

kiwami_result kiwami_ray_fields_init(kiwami_ray_fields* rays, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(rays, size, kMinimumStructSize, "rays", kNoRays); });
}

kiwami_result kiwami_hit_fields_init(kiwami_hit_fields* hits, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(hits, size, kMinimumStructSize, "hits", kNoHits); });
}

kiwami_result kiwami_query_init(kiwami_query* query, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(query, size, kMinimumStructSize, "query", kDefaultQuery); });
}

kiwami_result kiwami_closest_hit(const kiwami_scene* scene, const kiwami_ray* rays,
                                 size_t ray_stride, kiwami_hit* hits, size_t hit_stride,
                                 size_t count, const kiwami_query* query) {
  const RayBatch batch{
      reinterpret_cast<const unsigned char*>(rays), ray_stride ? ray_stride : sizeof(kiwami_ray),
      reinterpret_cast<unsigned char*>(hits), hit_stride ? hit_stride : sizeof(kiwami_hit), count};
  if (answer_plainly(scene, &TraversalKernels::closest_hit, batch, query)) return KIWAMI_OK;
  return answer(scene, kClosestHit, batch, sizeof(kiwami_hit), "hits", query);
}

kiwami_result kiwami_any_hit(const kiwami_scene* scene, const kiwami_ray* rays, size_t ray_stride,
                             uint8_t* occluded, size_t stride, size_t count,
                             const kiwami_query* query) {
  const RayBatch batch{reinterpret_cast<const unsigned char*>(rays),
                       ray_stride ? ray_stride : sizeof(kiwami_ray), occluded,
                       stride ? stride : sizeof(uint8_t), count};
  if (answer_plainly(scene, &TraversalKernels::any_hit, batch, query)) return KIWAMI_OK;
  return answer(scene, kAnyHit, batch, sizeof(uint8_t), "occluded", query);
}

kiwami_result kiwami_closest_hit_fields(const kiwami_scene* scene, const kiwami_ray_fields* rays,
                                        const kiwami_hit_fields* hits, size_t count,
                                        const kiwami_query* query) {
  return guarded(device_of(scene), [&] {
    const CommittedScene& committed = committed_of(scene);
    const TraceRequest request = read_query(query, committed, count);
    const kiwami_ray_fields inputs = read_ray_fields(rays, count);
    const kiwami_hit_fields outputs = read_descriptor(hits, kMinimumStructSize, "hits", kNoHits);
    check_reserved("hits.reserved", outputs.reserved);
    if (count == 0) return;
    if (committed.validates_arguments()) {
      check_ray_fields(inputs, count);
      check_hit_fields(outputs, count);
    }
    trace_closest_hit(committed, inputs, outputs, count, request);
  });
}

kiwami_result kiwami_any_hit_fields(const kiwami_scene* scene, const kiwami_ray_fields* rays,
                                    const kiwami_output_field* occluded, size_t count,
                                    const kiwami_query* query) {
  return guarded(device_of(scene), [&] {
    const CommittedScene& committed = committed_of(scene);
    const TraceRequest request = read_query(query, committed, count);
    const kiwami_ray_fields inputs = read_ray_fields(rays, count);
    check_not_null(occluded, "occluded");
    if (count == 0) return;
    if (committed.validates_arguments()) {
      check_ray_fields(inputs, count);
      if (occluded->data) {
        check_array("occluded.data", occluded->data, static_cast<size_t>(occluded->stride),
                    sizeof(uint8_t), count);
      }
    }
    trace_any_hit(committed, inputs, *occluded, count, request);
  });
}

kiwami_result kiwami_multi_hit(const kiwami_scene* scene, const kiwami_ray* rays, size_t ray_stride,
                               size_t count, uint32_t max_hits, kiwami_hit* hits,
                               uint64_t hit_capacity, uint64_t* offsets,
                               const kiwami_query* query) {
  return guarded(device_of(scene), [&] {
    const CommittedScene& committed = committed_of(scene);
    const TraceRequest trace =
        read_query(query, committed, count, static_cast<size_t>(hit_capacity));
    const MultiHitRequest request{max_hits, hit_capacity, offsets, trace};
    check_multi_hit(hits, hit_capacity, offsets);
    const RayBatch batch{reinterpret_cast<const unsigned char*>(rays),
                         ray_stride ? ray_stride : sizeof(kiwami_ray), nullptr, 0, count};
    if (count != 0 && committed.validates_arguments()) {
      check_array("rays", rays, batch.ray_stride, sizeof(kiwami_ray), count);
    }
    const uint64_t needed = trace_multi_hit(committed, batch, hits, request);
    check_capacity(hits, hit_capacity, needed);
  });
}

kiwami_result kiwami_count_hits(const kiwami_scene* scene, const kiwami_ray* rays,
                                size_t ray_stride, uint32_t* counts, size_t stride, size_t count,
                                const kiwami_query* query) {
  return guarded(device_of(scene), [&] {
    const RayBatch batch{
        reinterpret_cast<const unsigned char*>(rays), ray_stride ? ray_stride : sizeof(kiwami_ray),
        reinterpret_cast<unsigned char*>(counts), stride ? stride : sizeof(uint32_t), count};
    trace_array(committed_of(scene), kAllHits, batch, sizeof(uint32_t), "counts", query);
  });
}

kiwami_result kiwami_multi_hit_fields(const kiwami_scene* scene, const kiwami_ray_fields* rays,
                                      size_t count, uint32_t max_hits,
                                      const kiwami_hit_fields* hits, uint64_t hit_capacity,
                                      uint64_t* offsets, const kiwami_query* query) {
  return guarded(device_of(scene), [&] {
    const CommittedScene& committed = committed_of(scene);
    const TraceRequest trace =
        read_query(query, committed, count, static_cast<size_t>(hit_capacity));
    const MultiHitRequest request{max_hits, hit_capacity, offsets, trace};
    check_multi_hit(hits, hit_capacity, offsets);
    const kiwami_ray_fields inputs = read_ray_fields(rays, count);
    const kiwami_hit_fields outputs =
        hits ? read_descriptor(hits, kMinimumStructSize, "hits", kNoHits) : kNoHits;
    check_reserved("hits.reserved", outputs.reserved);
    if (committed.validates_arguments()) {
      if (count != 0) check_ray_fields(inputs, count);
      if (hit_capacity != 0) check_hit_fields(outputs, static_cast<size_t>(hit_capacity));
    }
    const uint64_t needed = trace_multi_hit(committed, inputs, count, outputs, request);
    check_capacity(hits, hit_capacity, needed);
  });
}

kiwami_result kiwami_count_hits_fields(const kiwami_scene* scene, const kiwami_ray_fields* rays,
                                       const kiwami_output_field* counts, size_t count,
                                       const kiwami_query* query) {
  return guarded(device_of(scene), [&] {
    const CommittedScene& committed = committed_of(scene);
    const TraceRequest request = read_query(query, committed, count);
    const kiwami_ray_fields inputs = read_ray_fields(rays, count);
    check_not_null(counts, "counts");
    if (count == 0) return;
    if (committed.validates_arguments()) {
      check_ray_fields(inputs, count);
      check_output_field("counts", *counts, count);
    }
    trace_all_hits(committed, inputs, *counts, count, request);
  });
}

}  // extern "C"

// SPDX-License-Identifier: Apache-2.0
#include "kiwami/surface.h"

#include "api/check.h"
#include "core/surface.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumStructSize = 8;
constexpr uint32_t kMostChannels = 1024;
constexpr size_t kVectorSize = 3 * sizeof(float);

kiwami_interpolation no_interpolation() {
  kiwami_interpolation interpolation{};
  interpolation.channels = 3;
  return interpolation;
}

/// A stride that stands for itself, or for the size of an element where it is 0.
uint64_t stride_or(uint64_t stride, uint64_t size) { return stride ? stride : size; }

void check_extent(const char* name, const void* data, uint64_t stride, size_t size,
                  uint64_t count) {
  if (count != 0) {
    check_array(name, data, static_cast<size_t>(stride), size, static_cast<size_t>(count));
  }
}

void check_element_field(const char* name, const kiwami_input_field& field, size_t count) {
  check_not_null(field.data, name);
  if (field.stride != 0) {
    check_array(name, field.data, static_cast<size_t>(field.stride), sizeof(float), count);
  }
}

/// The caller's struct, its strides filled in, for count elements.
kiwami_interpolation read_interpolation(const kiwami_interpolation* given, size_t count) {
  kiwami_interpolation read =
      read_descriptor(given, kMinimumStructSize, "interpolation", no_interpolation());
  check_reserved("interpolation.reserved", read.reserved);
  if (read.channels < 1 || read.channels > kMostChannels) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "interpolation.channels is %u, expected 1 to %u",
                read.channels, kMostChannels);
  }
  const size_t size = read.channels * sizeof(float);
  read.attribute_stride = stride_or(read.attribute_stride, size);
  read.index_stride = stride_or(read.index_stride, 3 * sizeof(uint32_t));
  read.value_stride = stride_or(read.value_stride, size);
  read.derivative_u_stride = stride_or(read.derivative_u_stride, size);
  read.derivative_v_stride = stride_or(read.derivative_v_stride, size);
  check_extent("interpolation.attributes", read.attributes, read.attribute_stride, size,
               read.attribute_count);
  if (count == 0) return read;
  check_element_field("interpolation.primitive_id.data", read.primitive_id, count);
  check_element_field("interpolation.u.data", read.u, count);
  check_element_field("interpolation.v.data", read.v, count);
  if (read.values) {
    check_extent("interpolation.values", read.values, read.value_stride, size, count);
  }
  if (read.derivatives_u) {
    check_extent("interpolation.derivatives_u", read.derivatives_u, read.derivative_u_stride, size,
                 count);
  }
  if (read.derivatives_v) {
    check_extent("interpolation.derivatives_v", read.derivatives_v, read.derivative_v_stride, size,
                 count);
  }
  return read;
}

HitRun hit_run(const CommittedScene& scene, const kiwami_hit* hits, size_t stride, size_t count) {
  const size_t step = stride ? stride : sizeof(kiwami_hit);
  if (count != 0) {
    check_not_null(hits, "hits");
    if (scene.validates_arguments()) check_array("hits", hits, step, sizeof(kiwami_hit), count);
  }
  return {reinterpret_cast<const unsigned char*>(hits), step, count};
}

VectorRun vector_run(const CommittedScene& scene, const char* name, float* vectors, size_t stride,
                     size_t count) {
  const size_t step = stride ? stride : kVectorSize;
  if (vectors && count != 0 && scene.validates_arguments()) {
    check_array(name, vectors, step, kVectorSize, count);
  }
  return {reinterpret_cast<unsigned char*>(vectors), step};
}

}  // namespace

extern "C" {

kiwami_result kiwami_interpolation_init(kiwami_interpolation* interpolation, size_t size) {
  return guarded(nullptr, [&] {
    init_descriptor(interpolation, size, kMinimumStructSize, "interpolation", no_interpolation());
  });
}

kiwami_result kiwami_interpolate(const kiwami_geometry* mesh,
                                 const kiwami_interpolation* interpolation, size_t count) {
  const Device* device = mesh ? &reinterpret_cast<const Geometry*>(mesh)->device() : nullptr;
  return guarded(device, [&] {
    const TriangleMesh& triangles = triangle_mesh_of(mesh, "mesh");
    const kiwami_interpolation read = read_interpolation(interpolation, count);
    check_extent("interpolation.indices", read.indices ? read.indices : &read, read.index_stride,
                 3 * sizeof(uint32_t), read.indices ? triangles.triangle_count() : 0);
    if (count != 0) interpolate(triangles, read, count);
  });
}

kiwami_result kiwami_hit_points(const kiwami_scene* scene, const kiwami_hit* hits,
                                size_t hit_stride, size_t count, float* points, size_t point_stride,
                                float* errors, size_t error_stride) {
  return guarded(device_of(scene), [&] {
    const CommittedScene& committed = committed_of(scene);
    const HitRun run = hit_run(committed, hits, hit_stride, count);
    const VectorRun point_run = vector_run(committed, "points", points, point_stride, count);
    const VectorRun error_run = vector_run(committed, "errors", errors, error_stride, count);
    if (count != 0) find_hit_points(committed, run, point_run, error_run);
  });
}

kiwami_result kiwami_offset_origins(const kiwami_scene* scene, const kiwami_hit* hits,
                                    size_t hit_stride, const float* directions,
                                    size_t direction_stride, size_t count, float* origins,
                                    size_t origin_stride) {
  return guarded(device_of(scene), [&] {
    const CommittedScene& committed = committed_of(scene);
    const HitRun run = hit_run(committed, hits, hit_stride, count);
    const size_t direction_step = direction_stride ? direction_stride : kVectorSize;
    if (count == 0) return;
    check_not_null(directions, "directions");
    check_not_null(origins, "origins");
    if (committed.validates_arguments()) {
      check_array("directions", directions, direction_step, kVectorSize, count);
    }
    const VectorRun origin_run = vector_run(committed, "origins", origins, origin_stride, count);
    find_offset_origins(committed, run, reinterpret_cast<const unsigned char*>(directions),
                        direction_step, origin_run);
  });
}

}  // extern "C"

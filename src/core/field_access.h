// SPDX-License-Identifier: Apache-2.0
// Rays and answers whose fields lie apart: to the structs that kernels read, and back.
#pragma once

#include <cstring>
#include <limits>

#include "kiwami/trace.h"

namespace kiwami {

/// Rays that are gathered at once, on the stack: enough for kernels that trace rays together.
constexpr size_t kChunkSize = 256;

/// Element i of a field.
inline const unsigned char* element(const kiwami_input_field& field, size_t i) {
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

inline void gather_rays(const kiwami_ray_fields& fields, size_t first, size_t count,
                        kiwami_ray* rays) {
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

/// Copies count answers out to a field, from element first on.
template <typename T>
void scatter_values(const T* values, size_t first, size_t count, const kiwami_output_field& field) {
  if (!field.data) return;
  unsigned char* target = static_cast<unsigned char*>(field.data);
  for (size_t i = 0; i < count; ++i) {
    std::memcpy(target + (first + i) * static_cast<size_t>(field.stride), &values[i], sizeof(T));
  }
}

/// The same for one member of each.
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

inline void scatter_hits(const kiwami_hit* hits, size_t first, size_t count,
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

}  // namespace kiwami

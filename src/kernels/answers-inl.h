// SPDX-License-Identifier: Apache-2.0
// How kernels write what they found.
#pragma once

#include "kernels/kernel_table.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// Answers lie at any address.
template <typename Answer>
inline void write_answer(const RayBatch& batch, size_t i, const Answer& answer) {
  __builtin_memcpy(batch.answers + i * batch.answer_stride, &answer, sizeof answer);
}
/// Member by member, from registers: a hit that is put together in memory first and then copied by
/// vectors that span two of its stores waits until those have left the store buffer.
inline void write_answer(const RayBatch& batch, size_t i, const kiwami_hit& hit) {
  unsigned char* const target = batch.answers + i * batch.answer_stride;
  const auto put = [&](size_t offset, const auto& member) {
    __builtin_memcpy(target + offset, &member, sizeof member);
  };
  put(offsetof(kiwami_hit, t), hit.t);
  put(offsetof(kiwami_hit, u), hit.u);
  put(offsetof(kiwami_hit, v), hit.v);
  put(offsetof(kiwami_hit, normal_x), hit.normal_x);
  put(offsetof(kiwami_hit, normal_y), hit.normal_y);
  put(offsetof(kiwami_hit, normal_z), hit.normal_z);
  put(offsetof(kiwami_hit, primitive_id), hit.primitive_id);
  put(offsetof(kiwami_hit, geometry_id), hit.geometry_id);
  put(offsetof(kiwami_hit, instance_id), hit.instance_id);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

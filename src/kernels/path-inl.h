// SPDX-License-Identifier: Apache-2.0
// The order of hits at one distance: by the paths to them, and by their numbers.
#pragma once

#include "kernels/kernel_table.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// By the first number that differs; a path that begins another is less.
inline bool is_less(const InstancePath& a, const InstancePath& b) {
  for (uint32_t i = 0; i < a.depth && i < b.depth; ++i) {
    if (a.number[i] != b.number[i]) return a.number[i] < b.number[i];
  }
  return a.depth < b.depth;
}

inline bool is_equal(const InstancePath& a, const InstancePath& b) {
  if (a.depth != b.depth) return false;
  for (uint32_t i = 0; i < a.depth; ++i) {
    if (a.number[i] != b.number[i]) return false;
  }
  return true;
}

/// As much of a path as there is.
inline void copy_path(const InstancePath& from, InstancePath& to) {
  to.depth = from.depth;
  for (uint32_t i = 0; i < from.depth; ++i) to.number[i] = from.number[i];
}

/// Of two hits at one distance: below 0 where a comes first, 0 where they are the same.
inline int compare_numbers(const kiwami_hit& a, const kiwami_hit& b) {
  if (a.geometry_id != b.geometry_id) return a.geometry_id < b.geometry_id ? -1 : 1;
  if (a.primitive_id != b.primitive_id) return a.primitive_id < b.primitive_id ? -1 : 1;
  return 0;
}

inline int compare_numbers(const GeneralHit& a, const GeneralHit& b) {
  if (!is_equal(a.path, b.path)) return is_less(a.path, b.path) ? -1 : 1;
  return compare_numbers(a.hit, b.hit);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

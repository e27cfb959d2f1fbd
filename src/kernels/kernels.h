// SPDX-License-Identifier: Apache-2.0
// What the files of one ISA know of each other.
#pragma once

#include "kernels/kernel_table.h"

namespace kiwami {
namespace KIWAMI_ISA {

TraversalKernels kernels_w4();
TraversalKernels kernels_w8();
TraversalKernels kernels_w16();

// In objects of their own, so that the plain kernels are compiled as if there were no others.
MultiHitKernels multi_hit_w4();
MultiHitKernels multi_hit_w8();
MultiHitKernels multi_hit_w16();
GeneralKernels general_w4();
GeneralKernels general_w8();
GeneralKernels general_w16();

/// All kernels of one width for trees whose leaves hold ids alone.
TraversalKernels compact_w4();
TraversalKernels compact_w8();
TraversalKernels compact_w16();

inline TraversalKernels joined(TraversalKernels kernels, MultiHitKernels multi_hit,
                               const GeneralKernels& general) {
  kernels.multi_hit = multi_hit;
  kernels.general = general;
  return kernels;
}

/// All kernels of one width.
inline TraversalKernels all_kernels_w4() {
  return joined(kernels_w4(), multi_hit_w4(), general_w4());
}
inline TraversalKernels all_kernels_w8() {
  return joined(kernels_w8(), multi_hit_w8(), general_w8());
}
inline TraversalKernels all_kernels_w16() {
  return joined(kernels_w16(), multi_hit_w16(), general_w16());
}

/// Sets those of the widths that the ISA has.
void set_light_kernels(LightKernels (&kernels)[4]);

}  // namespace KIWAMI_ISA
}  // namespace kiwami

// kiwami_<isa>_kernel_table, the one symbol that the rest of the library uses.
#define KIWAMI_PASTE_GETTER(isa) kiwami_##isa##_kernel_table
#define KIWAMI_EXPAND_GETTER(isa) KIWAMI_PASTE_GETTER(isa)
#define KIWAMI_KERNEL_TABLE_GETTER KIWAMI_EXPAND_GETTER(KIWAMI_ISA)

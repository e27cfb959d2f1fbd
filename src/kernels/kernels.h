// SPDX-License-Identifier: Apache-2.0
// What the files of one ISA know of each other.
#pragma once

#include "kernels/kernel_table.h"

namespace kiwami {
namespace KIWAMI_ISA {

TraversalKernels kernels_w4();
TraversalKernels kernels_w8();
TraversalKernels kernels_w16();

}  // namespace KIWAMI_ISA
}  // namespace kiwami

// kiwami_<isa>_kernel_table, the one symbol that the rest of the library uses.
#define KIWAMI_PASTE_GETTER(isa) kiwami_##isa##_kernel_table
#define KIWAMI_EXPAND_GETTER(isa) KIWAMI_PASTE_GETTER(isa)
#define KIWAMI_KERNEL_TABLE_GETTER KIWAMI_EXPAND_GETTER(KIWAMI_ISA)

// SPDX-License-Identifier: Apache-2.0
#include "kernels/kernels.h"

extern "C" void KIWAMI_KERNEL_TABLE_GETTER(kiwami::KernelTable* table) {
  using namespace kiwami;
  *table = {KIWAMI_ISA_AVX2,
            {KIWAMI_ISA::all_kernels_w4(), KIWAMI_ISA::all_kernels_w8(), TraversalKernels{}},
            {KIWAMI_ISA::compact_w4(), KIWAMI_ISA::compact_w8(), TraversalKernels{}}};
  KIWAMI_ISA::set_light_kernels(table->lights);
}

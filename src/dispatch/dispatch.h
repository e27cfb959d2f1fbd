// SPDX-License-Identifier: Apache-2.0
// What this processor can run, and the kernels for it.
#pragma once

#include <cstdint>

#include "kernels/kernel_table.h"

namespace kiwami {

/// Bit (1 << KIWAMI_ISA_x) for each ISA that the processor and its operating system can run. Tests
/// exactly the features that the ISA's objects are compiled for, and the saved register state.
uint32_t runnable_isas();

/// The same for each ISA that this build contains.
uint32_t built_isas();

/// The table of an ISA that is both built and runnable; nullptr for any other.
const KernelTable* kernel_table_of(uint32_t isa);

/// The kernels of a width: those of the ISA, or the scalar ones where it has none.
const TraversalKernels& kernels_of(uint32_t isa, uint32_t width);

/// The width of scenes that do not choose one.
uint32_t default_width_of(uint32_t isa);

const char* isa_name(uint32_t isa);  ///< "avx2"; nullptr for a number that is none
bool isa_of_name(const char* name, uint32_t& isa);  ///< also "auto"; false for an unknown name

}  // namespace kiwami

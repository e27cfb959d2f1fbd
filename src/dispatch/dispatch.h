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

/// The best ISA that is both built and runnable.
uint32_t best_isa();

/// The kernels of a width, for trees with leaves of one layout: those of the ISA, or the scalar
/// ones where it has none. The ISA must be both built and runnable.
TraversalKernels kernels_of(uint32_t isa, uint32_t width,
                            LeafLayout layout = LeafLayout::kTriangles);

/// The kernels of a light tree's width (2, 4, 8 or 16), likewise.
LightKernels light_kernels_of(uint32_t isa, uint32_t width);

/// Bit (1 << width) for each width of which the ISA has its own kernels. The ISA must be built.
uint32_t native_widths_of(uint32_t isa);

/// The width of scenes that do not choose one.
uint32_t default_width_of(uint32_t isa);

const char* isa_name(uint32_t isa);                 ///< "avx2"; nullptr for a number that is none
bool isa_of_name(const char* name, uint32_t& isa);  ///< also "auto"; false for an unknown name

}  // namespace kiwami

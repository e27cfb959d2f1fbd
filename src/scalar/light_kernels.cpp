// SPDX-License-Identifier: Apache-2.0
#include "scalar/simd.h"
// The vocabulary comes first: the kernels are written over it.
#include "kernels/kernels.h"
#include "kernels/light-split-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {

void set_light_kernels(LightKernels (&kernels)[4]) {
  // Nodes of two children have four slots.
  kernels[0] = kernels[1] = light_kernels_of_width<4>();
  kernels[2] = light_kernels_of_width<8>();
  kernels[3] = light_kernels_of_width<16>();
}

}  // namespace KIWAMI_ISA
}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "avx512/simd.h"
// The vocabulary comes first: the kernels are written over it.
#include "kernels/kernels.h"
#include "kernels/light-split-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {

void set_light_kernels(LightKernels (&kernels)[4]) {
  kernels[2] = light_kernels_of_width<8>();
  kernels[3] = light_kernels_of_width<16>();
}

}  // namespace KIWAMI_ISA
}  // namespace kiwami

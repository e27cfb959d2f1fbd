// SPDX-License-Identifier: Apache-2.0
#include "avx512/simd.h"
// The vocabulary comes first: the kernels are written over it.
#include "kernels/kernels.h"
#include "kernels/multi-hit-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {

MultiHitKernels multi_hit_w8() { return multi_hit_kernels<8>(); }

}  // namespace KIWAMI_ISA
}  // namespace kiwami

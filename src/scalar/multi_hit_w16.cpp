// SPDX-License-Identifier: Apache-2.0
#include "scalar/simd.h"
// The vocabulary comes first: the kernels are written over it.
#include "kernels/kernels.h"
#include "kernels/multi-hit-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {

MultiHitKernels multi_hit_w16() { return multi_hit_kernels<16>(); }

}  // namespace KIWAMI_ISA
}  // namespace kiwami

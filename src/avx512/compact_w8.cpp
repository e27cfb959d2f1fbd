// SPDX-License-Identifier: Apache-2.0
#include "avx512/simd.h"
// The vocabulary comes first: the kernels are written over it.
#include "kernels/kernels-inl.h"
#include "kernels/kernels.h"
#include "kernels/multi-hit-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {

TraversalKernels compact_w8() {
  return joined(kernels_of_width<8, GatheredLeaves<8>>(), multi_hit_kernels<8, GatheredLeaves<8>>(),
                general_w8());
}

}  // namespace KIWAMI_ISA
}  // namespace kiwami

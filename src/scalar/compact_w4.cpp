// SPDX-License-Identifier: Apache-2.0
#include "scalar/simd.h"
// The vocabulary comes first: the kernels are written over it.
#include "kernels/kernels-inl.h"
#include "kernels/kernels.h"
#include "kernels/multi-hit-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {

TraversalKernels compact_w4() {
  return joined(kernels_of_width<4, GatheredLeaves<4>>(), multi_hit_kernels<4, GatheredLeaves<4>>(),
                general_w4());
}

}  // namespace KIWAMI_ISA
}  // namespace kiwami

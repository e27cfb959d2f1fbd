// SPDX-License-Identifier: Apache-2.0
#include "scalar/simd.h"
// The vocabulary comes first: the kernels are written over it.
#include "kernels/kernels-inl.h"
#include "kernels/kernels.h"

namespace kiwami {
namespace KIWAMI_ISA {

TraversalKernels kernels_w8() { return kernels_of_width<8>(); }

}  // namespace KIWAMI_ISA
}  // namespace kiwami

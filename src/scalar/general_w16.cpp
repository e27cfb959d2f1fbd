// SPDX-License-Identifier: Apache-2.0
#include "scalar/simd.h"
// The vocabulary comes first: the kernels are written over it.
#include "kernels/general-inl.h"
#include "kernels/kernels.h"

namespace kiwami {
namespace KIWAMI_ISA {

GeneralKernels general_w16() { return general_of_width<16>(); }

}  // namespace KIWAMI_ISA
}  // namespace kiwami

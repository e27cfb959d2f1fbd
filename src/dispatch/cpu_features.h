// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kiwami {

/// What the processor says of itself and what its operating system saves on a context switch.
struct CpuFeatures {
  bool sse41 = false;
  bool avx2 = false;    ///< AVX2, FMA, BMI1, BMI2, LZCNT, POPCNT, F16C, and the YMM state
  bool avx512 = false;  ///< all of avx2, AVX-512 F, CD, BW, DQ, VL, and the ZMM and mask state
};

CpuFeatures detect_cpu_features();

}  // namespace kiwami

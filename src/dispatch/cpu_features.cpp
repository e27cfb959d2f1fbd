// SPDX-License-Identifier: Apache-2.0
#include "dispatch/cpu_features.h"

#if defined(__x86_64__) || defined(__i386__)
#include <cpuid.h>
#endif

namespace kiwami {

#if defined(__x86_64__) || defined(__i386__)
namespace {

struct Registers {
  uint32_t eax = 0, ebx = 0, ecx = 0, edx = 0;
};

/// All zeros for a leaf that the processor does not have.
Registers cpuid(uint32_t leaf, uint32_t subleaf) {
  Registers r;
  if (!__get_cpuid_count(leaf, subleaf, &r.eax, &r.ebx, &r.ecx, &r.edx)) return {};
  return r;
}

/// Which register states the operating system saves. Only with OSXSAVE. Written as an instruction,
/// since the intrinsic needs a flag that this file is not compiled with.
uint64_t extended_control_register() {
  uint32_t low, high;
  __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return static_cast<uint64_t>(high) << 32 | low;
}

bool has(uint32_t word, uint32_t bits) { return (word & bits) == bits; }

}  // namespace

CpuFeatures detect_cpu_features() {
  CpuFeatures features;
  const Registers basic = cpuid(1, 0), extended = cpuid(7, 0), amd = cpuid(0x80000001u, 0);
  features.sse41 = has(basic.ecx, bit_SSE4_1 | bit_SSSE3 | bit_SSE3);

  const bool has_osxsave = has(basic.ecx, bit_OSXSAVE | bit_AVX);
  const uint64_t state = has_osxsave ? extended_control_register() : 0;
  constexpr uint64_t ymm_state = 0x6, zmm_state = 0xe6;
  features.avx2 = features.sse41 && (state & ymm_state) == ymm_state &&
                  has(basic.ecx, bit_FMA | bit_F16C | bit_POPCNT | bit_SSE4_2) &&
                  has(extended.ebx, bit_AVX2 | bit_BMI | bit_BMI2) && has(amd.ecx, bit_LZCNT);
  features.avx512 =
      features.avx2 && (state & zmm_state) == zmm_state &&
      has(extended.ebx, bit_AVX512F | bit_AVX512CD | bit_AVX512BW | bit_AVX512DQ | bit_AVX512VL);
  return features;
}
#else
CpuFeatures detect_cpu_features() {
  // The build's own target decides: the 4-wide kernels use the vectors that every such CPU has.
  CpuFeatures features;
  features.sse41 = true;
  return features;
}
#endif

}  // namespace kiwami

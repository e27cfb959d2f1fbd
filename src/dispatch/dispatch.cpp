// SPDX-License-Identifier: Apache-2.0
#include "dispatch/dispatch.h"

#include <cstring>

#include "dispatch/cpu_features.h"

namespace kiwami {
namespace {

using TableGetter = void (*)(KernelTable*);

constexpr uint32_t kIsaCount = 5;
constexpr const char* kNames[kIsaCount] = {"auto", "scalar", "sse", "avx2", "avx512"};

constexpr TableGetter kGetters[kIsaCount] = {
    nullptr,
    kiwami_scalar_kernel_table,
#if defined(KIWAMI_HAS_SSE)
    kiwami_sse_kernel_table,
#else
    nullptr,
#endif
#if defined(KIWAMI_HAS_AVX2)
    kiwami_avx2_kernel_table,
#else
    nullptr,
#endif
#if defined(KIWAMI_HAS_AVX512)
    kiwami_avx512_kernel_table,
#else
    nullptr,
#endif
};

KernelTable table_of(uint32_t isa) {
  KernelTable table{};
  kGetters[isa](&table);
  return table;
}

}  // namespace

uint32_t runnable_isas() {
  const CpuFeatures features = detect_cpu_features();
  uint32_t isas = 1u << KIWAMI_ISA_SCALAR;
  if (features.sse41) isas |= 1u << KIWAMI_ISA_SSE;
  if (features.avx2) isas |= 1u << KIWAMI_ISA_AVX2;
  if (features.avx512) isas |= 1u << KIWAMI_ISA_AVX512;
  return isas;
}

uint32_t built_isas() {
  uint32_t isas = 0;
  for (uint32_t isa = KIWAMI_ISA_SCALAR; isa < kIsaCount; ++isa) {
    if (kGetters[isa]) isas |= 1u << isa;
  }
  return isas;
}

uint32_t best_isa() {
  const uint32_t usable = built_isas() & runnable_isas();
  return 31u - static_cast<uint32_t>(__builtin_clz(usable));
}

TraversalKernels kernels_of(uint32_t isa, uint32_t width, LeafLayout layout) {
  const TraversalKernels kernels = table_of(isa).of(width, layout);
  return kernels.closest_hit ? kernels : table_of(KIWAMI_ISA_SCALAR).of(width, layout);
}

LightKernels light_kernels_of(uint32_t isa, uint32_t width) {
  const LightKernels kernels = table_of(isa).lights_of_width(width);
  return kernels.sample ? kernels : table_of(KIWAMI_ISA_SCALAR).lights_of_width(width);
}

uint32_t native_widths_of(uint32_t isa) {
  const KernelTable table = table_of(isa);
  uint32_t widths = 0;
  for (uint32_t width = 4; width <= 16; width *= 2) {
    if (table.of(width, LeafLayout::kTriangles).closest_hit) widths |= 1u << width;
  }
  return widths;
}

uint32_t default_width_of(uint32_t isa) {
  // Without wide vectors a wider node costs more tests than it saves visits.
  return isa == KIWAMI_ISA_AVX2 || isa == KIWAMI_ISA_AVX512 ? 8 : 4;
}

const char* isa_name(uint32_t isa) { return isa < kIsaCount ? kNames[isa] : nullptr; }

bool isa_of_name(const char* name, uint32_t& isa) {
  for (uint32_t candidate = 0; candidate < kIsaCount; ++candidate) {
    if (std::strcmp(name, kNames[candidate]) == 0) {
      isa = candidate;
      return true;
    }
  }
  return false;
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "parity/kernel_tables.h"

#include "dispatch/dispatch.h"

namespace kiwami_tests {
namespace {

template <typename Answer>
kiwami::RayBatch batch_of(const std::vector<kiwami_ray>& rays, std::vector<Answer>& answers) {
  return {reinterpret_cast<const unsigned char*>(rays.data()), sizeof(kiwami_ray),
          reinterpret_cast<unsigned char*>(answers.data()), sizeof(Answer), rays.size()};
}

template <typename Answer, typename Kernel, typename... Counters>
std::vector<Answer> run(Kernel kernel, const kiwami::SceneView& scene,
                        const std::vector<kiwami_ray>& rays, Counters&... counters) {
  std::vector<Answer> answers(rays.size());
  kernel(scene, batch_of(rays, answers), counters...);
  return answers;
}

}  // namespace

std::vector<NamedKernels> all_kernels(kiwami::LeafLayout layout) {
  const uint32_t usable = kiwami::built_isas() & kiwami::runnable_isas();
  std::vector<NamedKernels> found;
  for (uint32_t isa = KIWAMI_ISA_SCALAR; isa <= KIWAMI_ISA_AVX512; ++isa) {
    if (!(usable & (1u << isa))) continue;
    for (const uint32_t width : {4u, 8u, 16u}) {
      if (!(kiwami::native_widths_of(isa) & (1u << width))) continue;
      std::string name = kiwami::isa_name(isa);
      name += '_';
      name += std::to_string(width);
      found.push_back({name, isa, width, kiwami::kernels_of(isa, width, layout)});
    }
  }
  return found;
}

std::vector<kiwami_hit> run_closest_hit(kiwami::TraversalKernel kernel,
                                        const kiwami::SceneView& scene,
                                        const std::vector<kiwami_ray>& rays) {
  return run<kiwami_hit>(kernel, scene, rays);
}

std::vector<uint8_t> run_any_hit(kiwami::TraversalKernel kernel, const kiwami::SceneView& scene,
                                 const std::vector<kiwami_ray>& rays) {
  return run<uint8_t>(kernel, scene, rays);
}

std::vector<uint32_t> run_all_hits(kiwami::TraversalKernel kernel, const kiwami::SceneView& scene,
                                   const std::vector<kiwami_ray>& rays) {
  return run<uint32_t>(kernel, scene, rays);
}

std::vector<kiwami_hit> run_counted_closest_hit(kiwami::CountingKernel kernel,
                                                const kiwami::SceneView& scene,
                                                const std::vector<kiwami_ray>& rays,
                                                kiwami::TraversalCounters& counters) {
  return run<kiwami_hit>(kernel, scene, rays, counters);
}

std::vector<uint8_t> run_counted_any_hit(kiwami::CountingKernel kernel,
                                         const kiwami::SceneView& scene,
                                         const std::vector<kiwami_ray>& rays,
                                         kiwami::TraversalCounters& counters) {
  return run<uint8_t>(kernel, scene, rays, counters);
}

}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
// The kernels of every ISA that can run here, native and emulated.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "kernels/kernel_table.h"

namespace kiwami_tests {

/// The kernels of one ISA and width, which exist.
struct NamedKernels {
  std::string name;
  uint32_t isa;
  uint32_t width;
  kiwami::TraversalKernels kernels;
};

/// How GoogleTest prints one.
inline void PrintTo(const NamedKernels& kernels, std::ostream* stream) { *stream << kernels.name; }

/// For trees of one layout; scalar first.
std::vector<NamedKernels> all_kernels(kiwami::LeafLayout layout = kiwami::LeafLayout::kTriangles);

std::vector<kiwami_hit> run_closest_hit(kiwami::TraversalKernel kernel,
                                        const kiwami::SceneView& scene,
                                        const std::vector<kiwami_ray>& rays);
std::vector<uint8_t> run_any_hit(kiwami::TraversalKernel kernel, const kiwami::SceneView& scene,
                                 const std::vector<kiwami_ray>& rays);
std::vector<uint32_t> run_all_hits(kiwami::TraversalKernel kernel, const kiwami::SceneView& scene,
                                   const std::vector<kiwami_ray>& rays);
std::vector<kiwami_hit> run_counted_closest_hit(kiwami::CountingKernel kernel,
                                                const kiwami::SceneView& scene,
                                                const std::vector<kiwami_ray>& rays,
                                                kiwami::TraversalCounters& counters);
std::vector<uint8_t> run_counted_any_hit(kiwami::CountingKernel kernel,
                                         const kiwami::SceneView& scene,
                                         const std::vector<kiwami_ray>& rays,
                                         kiwami::TraversalCounters& counters);

/// A general kernel, counting or not, without options.
template <typename Answer, typename Kernel, typename... Counters>
std::vector<Answer> run_general(Kernel kernel, const kiwami::SceneView& scene,
                                const std::vector<kiwami_ray>& rays, Counters&... counters) {
  std::vector<Answer> answers(rays.size());
  kernel(scene,
         {reinterpret_cast<const unsigned char*>(rays.data()), sizeof(kiwami_ray),
          reinterpret_cast<unsigned char*>(answers.data()), sizeof(Answer), rays.size()},
         kiwami::QueryOptions{}, counters...);
  return answers;
}

}  // namespace kiwami_tests

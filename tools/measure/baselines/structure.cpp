// SPDX-License-Identifier: Apache-2.0
#include "measure/baselines/structure.h"

namespace kiwami::tools {

std::vector<PreparedTriangle> prepare_triangles(std::span<const Corners> triangles,
                                                std::span<const uint32_t> order) {
  std::vector<PreparedTriangle> prepared;
  prepared.reserve(order.size());
  for (const uint32_t number : order) prepared.emplace_back(triangles[number], number);
  return prepared;
}

}  // namespace kiwami::tools

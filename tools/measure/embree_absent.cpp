// SPDX-License-Identifier: Apache-2.0
#include "measure/tracer.h"

namespace kiwami::tools {

std::unique_ptr<EmbreeTracer> EmbreeTracer::create(const SceneFile&, bool) { return nullptr; }

const char* embree_version() { return ""; }

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#include "measure/embree_contender.h"
#include "measure/embree_queries.h"
#include "measure/embree_refit.h"
#include "measure/shape_scene.h"
#include "measure/tracer.h"

namespace kiwami::tools {

std::unique_ptr<EmbreeTracer> EmbreeTracer::create(const SceneFile&, bool) { return nullptr; }

std::unique_ptr<EmbreeContender> EmbreeContender::create(const SceneFile&, const EmbreeOptions&) {
  return nullptr;
}

std::unique_ptr<EmbreeRefit> EmbreeRefit::create(const SceneFile&, uint32_t, uint32_t) {
  return nullptr;
}

std::string entrance_name(EmbreeEntrance, bool) { return ""; }

std::unique_ptr<EmbreeQueries> EmbreeQueries::create(const SceneFile&, uint32_t) { return nullptr; }

std::unique_ptr<EmbreeShapes> EmbreeShapes::create(const ShapeCloud&, uint32_t) { return nullptr; }

const char* embree_version() { return ""; }

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kiwami/renderer.h"

namespace kiwami::tools {

/// Fills the batch's colors by following diffuse paths, all of them bounce by bounce, so that each
/// bounce is one call for closest hits and one for shadows. Light comes from a sky and a sun (J. T.
/// Kajiya, "The Rendering Equation", SIGGRAPH 1986; the sun is sampled at each bounce).
void trace_paths(Tracing& tracing, const RenderSettings& settings, SampleBatch& batch);

}  // namespace kiwami::tools

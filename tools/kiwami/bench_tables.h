// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kiwami/bench.h"
#include "kiwami/bench_options.h"

namespace kiwami::tools {

constexpr int kWrongAnswer = 1;

/// Makes the table of scenes that the options ask for in place of a race with a peer and returns the
/// exit code, or nothing when they ask for the race.
std::optional<int> run_table(const BenchOptions& options, const BenchSettings& settings,
                             const std::vector<std::string>& scenes);

/// The table of generated scenes of spheres, discs and curve segments.
int run_shape_table(const BenchOptions& options, const BenchSettings& settings);

/// The table of ways to locate points in a mesh of tetrahedra.
int run_tetrahedron_table(const BenchOptions& options, const BenchSettings& settings);

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "measure/answers.h"
#include "measure/double_judge.h"
#include "measure/library.h"
#include "measure/ray_sets.h"

namespace kiwami::tools {

/// A device and a build that must answer as the reference does.
struct Contender {
  uint32_t isa;
  uint32_t bvh_width;
  bool merge_leaves;
  uint32_t threads;
};

/// Compares every kernel that can run here, bit for bit, with the scalar kernels of width 4 on one
/// thread, and those with Embree.
class Verifier {
 public:
  /// What is built is the world, or a file with instances that comes to it. Both must outlive the
  /// verifier. Instances are compared by Embree and double precision with the flattened triangles.
  /// The contenders are built as `build` says, but for width and merging; the reference is built
  /// by the defaults.
  Verifier(const SceneFile& world, const SceneFile& built, const BuildOptions& build,
           size_t rays_per_set, uint64_t seed);
  /// The same of a scene that was saved, with all that it holds, which is loaded again and again:
  /// as it was saved, and built anew for other widths. The file is what the path holds. Rays are of
  /// all times, and Embree is not asked.
  Verifier(const SceneFile& world, const SceneFile& file, const std::string& path,
           size_t rays_per_set, uint64_t seed);

  /// Prints a table and returns true; or prints the first difference and returns false.
  bool run();

 private:
  Verifier(const SceneFile& world, const SceneFile& built, const BuildOptions& build,
           const std::string& path, size_t rays_per_set, uint64_t seed);
  BuiltScene make(const Device& device, const BuildOptions& build) const;
  bool run_contender(const Contender& contender);
  bool compare(const Answers& answers, const std::string& name) const;
  bool compare_with_embree() const;

  const SceneFile& world_;
  const SceneFile& built_;
  BuildOptions build_;
  std::string path_;  ///< empty: scenes are built
  Device device_;
  BuiltScene reference_;
  std::vector<RaySet> sets_;
  Answers expected_;
};

}  // namespace kiwami::tools

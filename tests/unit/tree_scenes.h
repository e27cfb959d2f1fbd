// SPDX-License-Identifier: Apache-2.0
// Triangles for the tests of builders and trees.
#pragma once

#include <string>
#include <vector>

#include "bvh/binary_bvh.h"
#include "bvh/triangle_source.h"
#include "core/memory.h"
#include "parallel/parallel.h"
#include "support/mesh.h"

namespace kiwami_tests {

/// A mesh as the stages below the scene see it. Every vertex must be valid.
class TreeScene {
 public:
  TreeScene(std::string name, Mesh mesh);
  TreeScene(const TreeScene&) = delete;
  TreeScene& operator=(const TreeScene&) = delete;

  const std::string& name() const { return name_; }
  const kiwami::TriangleSource& source() const { return source_; }
  uint32_t count() const { return view_.triangle_count; }
  kiwami::Array<kiwami::BuildPrimitive> primitives(kiwami::Memory& memory) const;

 private:
  std::string name_;
  Mesh mesh_;
  kiwami::TriangleMeshView view_;
  kiwami::TriangleSource source_;
};

/// The primitives of a mesh, one box a triangle.
kiwami::Array<kiwami::BuildPrimitive> primitives_of(const Mesh& mesh, kiwami::Memory& memory);

/// A wavy surface: neighbours touch, sizes are alike.
Mesh terrain(uint32_t rows);
/// Triangles anywhere, of very different sizes.
Mesh soup(uint32_t count, uint64_t seed);
/// Finely and coarsely cut spheres far from each other.
Mesh spheres(uint32_t count, uint64_t seed);

/// A mesh with a name.
struct NamedMesh {
  std::string name;
  Mesh mesh;
};
/// The shapes that builders trip over: few triangles, all equal, in a line, in a plane, nested, two
/// far clusters, a grid of equal centroids, points, and numbers at both ends of the range.
std::vector<NamedMesh> degenerate_meshes(uint64_t seed);

/// The library's own tasks on this many threads.
struct Threads : kiwami::Parallel {
  explicit Threads(unsigned count) : Parallel(count, nullptr, nullptr, 0) {}
};

/// A runner of plain std::threads, for kiwami_device_desc::runner; user is ignored.
int32_t run_on_plain_threads(void* user, size_t count, kiwami_parallel_task task, void* task_data);

}  // namespace kiwami_tests

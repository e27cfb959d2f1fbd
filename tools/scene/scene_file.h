// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene/vector.h"

namespace kiwami::tools {

/// Why a scene cannot be had: one sentence without a full stop, naming the file and the reason.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Triangles over shared vertices: three floats a vertex, three indices a triangle.
struct Mesh {
  std::string name;
  std::vector<float> vertices;
  std::vector<uint32_t> indices;
  std::vector<float> moved = {};  ///< the vertices at time 1, the others being at 0; empty: at rest

  uint64_t vertex_count() const { return vertices.size() / 3; }
  uint64_t triangle_count() const { return indices.size() / 3; }
};

/// A mesh put into the world by a 3x4 row-major object-to-world transform.
struct Instance {
  uint32_t mesh;
  std::array<float, 12> transform;
};

/// An array of instances as a file of the library holds it, at rest (one step) or moving.
struct SavedInstances {
  std::vector<uint32_t> shown;    ///< by instance: the number of its scene in the file
  std::vector<float> transforms;  ///< of all instances, step after step
  uint32_t step_count;
  bool has_quaternions;  ///< transforms are kiwami_quaternion_transform, else 3x4 matrices
  float time_begin, time_end;
};

/// A camera that shows a scene well.
struct View {
  Vec3 eye;
  Vec3 target;
  Vec3 up;
  float vertical_field_of_view;  ///< in degrees
};

/// What a scene file holds. Without instances, each mesh stands in the world once, as it is.
struct SceneFile {
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  /// Whether trees that were saved with the file call meshes or instances by the same numbers. They
  /// do not where these come from instances within instances, or of several meshes.
  bool has_saved_numbers = true;
  /// Of a file that was saved: by its scenes, of which the first is the one that was, all arrays of
  /// instances that were committed.
  std::vector<std::vector<SavedInstances>> saved_instances = {};
  /// Of such a file: geometries that the meshes and instances above leave out.
  uint64_t left_out_count = 0;
  std::optional<View> view;  ///< only procedural scenes suggest one
  /// Of the instances at time 1, the others being at 0; empty: at rest.
  std::vector<std::array<float, 12>> moved_transforms = {};

  /// Triangles in the world: those of a mesh count once for each of its instances.
  uint64_t triangle_count() const;
  /// See scene/motion.h.
  bool is_moving() const;
};

/// What becomes of the shapes of a file that was saved, and of what moves there.
enum class OtherGeometries { kRefused, kLeftOut };

/// Reads an .obj, .tri or .ins file, each also with .gz, or a .kiwami file, or makes a procedural
/// scene by its name (see procedural.h). Indices are checked; vertices may be NaN. Throws
/// SceneError.
SceneFile load_scene(const std::filesystem::path& path,
                     OtherGeometries others = OtherGeometries::kRefused);

/// The same world without instances: mesh i of the result is instance i with its vertices moved, as
/// it is at time 0.
/// Throws SceneError when it has more triangles than the library takes.
SceneFile flatten(const SceneFile& scene);

}  // namespace kiwami::tools

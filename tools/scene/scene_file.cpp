// SPDX-License-Identifier: Apache-2.0
#include "scene/scene_file.h"

#include <algorithm>

#include "scene/binary_readers.h"
#include "scene/byte_reader.h"
#include "scene/kiwami_reader.h"
#include "scene/obj_reader.h"
#include "scene/procedural.h"

namespace kiwami::tools {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxTriangles = 0xFFFFFFFEu;

/// Rules out what can be opened but not read, so that the reader's errors are about contents.
void check_is_readable_file(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) {
    throw SceneError("there is no file '" + path.string() + "'");
  }
  if (error) throw SceneError("cannot read '" + path.string() + "': " + error.message());
  if (fs::is_directory(status)) {
    throw SceneError("'" + path.string() + "' is a directory, expected a scene file");
  }
  if (!fs::is_regular_file(status)) {
    throw SceneError("'" + path.string() + "' is not a regular file");
  }
  if (fs::file_size(path, error) == 0 && !error) {
    throw SceneError("'" + path.string() + "' is empty");
  }
}

/// The extension that names the format: of "a.tri.gz" it is ".tri".
std::string format_extension(const fs::path& path) {
  return path.extension() == ".gz" ? path.stem().extension().string() : path.extension().string();
}

Mesh transformed(const Mesh& mesh, const std::array<float, 12>& m) {
  Mesh moved = mesh;
  moved.moved.clear();
  for (size_t i = 0; i + 2 < moved.vertices.size(); i += 3) {
    const float x = mesh.vertices[i];
    const float y = mesh.vertices[i + 1];
    const float z = mesh.vertices[i + 2];
    for (size_t row = 0; row < 3; ++row) {
      moved.vertices[i + row] =
          m[row * 4] * x + m[row * 4 + 1] * y + m[row * 4 + 2] * z + m[row * 4 + 3];
    }
  }
  return moved;
}

}  // namespace

uint64_t SceneFile::triangle_count() const {
  uint64_t count = 0;
  if (instances.empty()) {
    for (const Mesh& mesh : meshes) count += mesh.triangle_count();
  } else {
    for (const Instance& instance : instances) count += meshes[instance.mesh].triangle_count();
  }
  return count;
}

bool SceneFile::is_moving() const {
  return !moved_transforms.empty() ||
         std::any_of(meshes.begin(), meshes.end(),
                     [](const Mesh& mesh) { return !mesh.moved.empty(); });
}

SceneFile load_scene(const fs::path& path, OtherGeometries others) {
  if (std::optional<SceneFile> scene = make_procedural_scene(path.string())) return *scene;
  check_is_readable_file(path);
  const std::string extension = format_extension(path);
  SceneFile scene;
  if (extension == ".obj") {
    scene = read_obj(path);
  } else if (extension == ".tri") {
    scene = read_tri(path);
  } else if (extension == ".ins") {
    scene = read_ins(path);
  } else if (is_saved_scene(path)) {
    scene = read_saved_scene(path);
  } else {
    throw SceneError(
        "the format of '" + path.string() +
        "' is unknown, expected .obj, .tri or .ins, each also with .gz, .kiwami, or one of " +
        procedural_scene_names());
  }
  if (scene.left_out_count != 0 && others == OtherGeometries::kRefused) {
    throw SceneError("'" + path.string() + "' holds " + std::to_string(scene.left_out_count) +
                     " geometries that are shapes or move, expected triangles at rest, as this "
                     "command goes by them alone");
  }
  if (scene.triangle_count() == 0 && scene.left_out_count == 0) {
    throw SceneError("'" + path.string() + "' holds no triangles");
  }
  return scene;
}

SceneFile flatten(const SceneFile& scene) {
  if (scene.instances.empty()) return scene;
  const uint64_t count = scene.triangle_count();
  if (count > kMaxTriangles) {
    throw SceneError("the instances make " + std::to_string(count) +
                     " triangles, more than a scene can hold");
  }
  SceneFile flat;
  flat.view = scene.view;
  flat.left_out_count = scene.left_out_count;
  flat.meshes.reserve(scene.instances.size());
  for (const Instance& instance : scene.instances) {
    flat.meshes.push_back(transformed(scene.meshes[instance.mesh], instance.transform));
  }
  return flat;
}

}  // namespace kiwami::tools

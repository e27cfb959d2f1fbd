// SPDX-License-Identifier: Apache-2.0
#include "support/public_scene.h"

#include <cctype>
#include <cstring>

#include "scene/scene_file.h"
#include "support/environment.h"

namespace kiwami_tests {

Scene load_public_scene(const std::filesystem::path& path) {
  const kiwami::tools::SceneFile file = kiwami::tools::flatten(kiwami::tools::load_scene(path));
  Scene scene{path.filename().string(), {}};
  for (const kiwami::tools::Mesh& source : file.meshes) {
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.vertices.resize(source.vertex_count());
    mesh.triangles.resize(source.triangle_count());
    static_assert(sizeof(Point) == 12 && sizeof(mesh.triangles[0]) == 12);
    if (!mesh.vertices.empty()) {
      std::memcpy(mesh.vertices.data(), source.vertices.data(), source.vertices.size() * 4);
    }
    if (!mesh.triangles.empty()) {
      std::memcpy(mesh.triangles.data(), source.indices.data(), source.indices.size() * 4);
    }
  }
  return scene;
}

std::string test_name_of(const std::filesystem::path& path) {
  if (path.empty()) return "none";
  std::string name = path.filename().string();
  name.resize(name.find('.'));
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
}

std::vector<std::filesystem::path> public_scenes_or_none() {
  std::vector<std::filesystem::path> scenes = public_scenes();
  if (scenes.empty()) scenes.emplace_back();
  return scenes;
}

}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
#include "kiwami/known_scenes.h"

#include <nlohmann/json.hpp>

#include "kiwami/known_scenes_text.h"

namespace kiwami::tools {
namespace {

/// The build has put benchmarks/scenes.json into the command, so that it works from anywhere.
const nlohmann::ordered_json& known_scenes() {
  static const nlohmann::ordered_json kScenes = nlohmann::ordered_json::parse(kKnownScenesText);
  return kScenes;
}

Vec3 to_vector(const nlohmann::ordered_json& numbers) {
  return {numbers.at(0).get<float>(), numbers.at(1).get<float>(), numbers.at(2).get<float>()};
}

}  // namespace

SceneFile load_known_scene(const std::filesystem::path& path) {
  SceneFile file = flatten(load_scene(path));
  const nlohmann::ordered_json& cameras = known_scenes().at("cameras");
  const auto camera = cameras.find(path.filename().string());
  if (camera != cameras.end()) {
    file.view = View{to_vector(camera->at("eye")), to_vector(camera->at("target")),
                     to_vector(camera->at("up")), camera->at("fov").get<float>()};
  }
  return file;
}

std::vector<std::string> scene_list_names() {
  std::vector<std::string> names;
  for (const auto& [name, scenes] : known_scenes().at("lists").items()) names.push_back(name);
  return names;
}

std::vector<std::string> scenes_of_list(const std::string& list,
                                        const std::filesystem::path& folder) {
  const nlohmann::ordered_json& lists = known_scenes().at("lists");
  if (!lists.contains(list)) throw SceneError("there is no list of scenes '" + list + "'");
  std::vector<std::string> scenes;
  for (const auto& entry : lists.at(list)) {
    const std::string name = entry.get<std::string>();
    const bool is_file = name.find('.') != std::string::npos;
    scenes.push_back(is_file ? (folder / name).string() : name);
  }
  return scenes;
}

}  // namespace kiwami::tools

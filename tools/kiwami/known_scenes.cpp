// SPDX-License-Identifier: Apache-2.0
#include "kiwami/known_scenes.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

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

/// The words that begin the lines of a text file.
std::vector<std::string> read_list(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) {
    throw SceneError("there is no list of scenes '" + path.string() +
                     "', expected tuning, judging or a text file");
  }
  std::vector<std::string> names;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    if (std::string name; words >> name) names.push_back(name);
  }
  if (names.empty()) throw SceneError("the list '" + path.string() + "' names no scene");
  return names;
}

}  // namespace

SceneFile load_known_scene(const std::filesystem::path& path, bool keep_instances,
                           OtherGeometries others) {
  SceneFile file = load_scene(path, others);
  if (!keep_instances) file = flatten(file);
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
  const std::vector<std::string> names =
      lists.contains(list) ? lists.at(list).get<std::vector<std::string>>() : read_list(list);
  std::vector<std::string> scenes;
  for (const std::string& name : names) {
    const bool is_file = name.find('.') != std::string::npos;
    scenes.push_back(is_file ? (folder / name).string() : name);
  }
  return scenes;
}

}  // namespace kiwami::tools

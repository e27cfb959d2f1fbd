// SPDX-License-Identifier: Apache-2.0
#include "support/environment.h"

#include <algorithm>
#include <cstdlib>
#include <string>

namespace kiwami_tests {
namespace {

double number_of(const char* variable, double otherwise) {
  const char* text = std::getenv(variable);
  return text && *text ? std::strtod(text, nullptr) : otherwise;
}

uint64_t scaled(uint64_t count, double scale) {
  return std::max<uint64_t>(1, static_cast<uint64_t>(static_cast<double>(count) * scale));
}

bool is_scene_file(const std::string& name) {
  return name.ends_with(".tri.gz") || name.ends_with(".ins.gz");
}

}  // namespace

uint64_t seed() {
  const char* text = std::getenv("KIWAMI_SEED");
  return text && *text ? std::strtoull(text, nullptr, 0) : 20190904;
}

uint64_t ray_budget(uint64_t short_form) {
  const double rays = number_of("KIWAMI_TEST_RAYS", 0.0);
  if (rays >= 1.0) return static_cast<uint64_t>(rays);
  return scaled(short_form, number_of("KIWAMI_TEST_SCALE", 1.0));
}

uint64_t case_budget(uint64_t short_form) {
  return scaled(short_form, std::min(1.0, number_of("KIWAMI_TEST_SCALE", 1.0)));
}

uint64_t public_scene_limit() {
  return static_cast<uint64_t>(number_of("KIWAMI_TEST_SCENE_TRIANGLES", 100000.0));
}

std::vector<std::filesystem::path> public_scenes() {
  const char* variable = std::getenv("KIWAMI_SCENES");
  const std::filesystem::path folder =
      variable && *variable ? std::filesystem::path(variable)
                            : std::filesystem::path(KIWAMI_SOURCE_DIR) / ".." / "shared" / "scenes";
  std::vector<std::filesystem::path> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (is_scene_file(entry.path().filename().string())) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
// See bindings/benchmark/trace_file.c.
#include <chrono>
#include <fstream>
#include <iostream>
#include <kiwami/kiwami.hpp>

int main(int, char** arguments) {
  std::ifstream file(arguments[2], std::ios::binary | std::ios::ate);
  std::vector<kiwami::Ray> rays(static_cast<std::size_t>(file.tellg()) / sizeof(kiwami::Ray));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(rays.data()),
            static_cast<std::streamsize>(rays.size() * sizeof(kiwami::Ray)));
  const kiwami::Device device;
  const kiwami::Scene scene =
      kiwami::Scene::load(device, arguments[1], KIWAMI_LOAD_MAP | KIWAMI_LOAD_TRUSTED);
  std::vector<kiwami::Hit> hits(rays.size());
  for (int round = std::stoi(arguments[3]); round > 0; --round) {
    const auto began = std::chrono::steady_clock::now();
    scene.closest_hit(rays, hits);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
    std::cout << seconds.count() << '\n';
  }
}

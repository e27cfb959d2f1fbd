// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <kiwami/kiwami.hpp>

int main() {
  const kiwami::Device device;
  kiwami::Scene scene(device);
  const kiwami::Vertex vertices[] = {{-1, -1, 2}, {1, -1, 2}, {0, 1, 2}};
  const kiwami::Triangle triangles[] = {{0, 1, 2}};
  scene.attach(kiwami::Mesh(device, vertices, triangles));
  scene.commit();
  std::cout << "hit at " << scene.closest_hit({0, 0, 0, 0, 0, 0, 1, 100, 0, 1, 0, 0}).t << "\n";
}

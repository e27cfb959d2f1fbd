// SPDX-License-Identifier: Apache-2.0
// OBJ text: it is read, or refused with a sentence.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "fuzz/fuzz.h"
#include "scene/obj_reader.h"

namespace kiwami_fuzz {

std::vector<Bytes> make_seeds() {
  constexpr const char* kTexts[] = {
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
      "o a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1/1/1 2/2/2 3//3 -1\ng b\nf 1 2 4\n",
      "mtllib x.mtl\nusemtl y\nvn 0 0 1\nvt 0 0\nv 1e30 nan inf\nv -0 1.5e-9 2\nv 3 3 3\nf 1 2 3\n",
      "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\ns off\nl 1 2\np 3\n# end\n",
      "f 1 2 3\n",
      "v\nf\n",
      "f 99999999999 -99999999999 0\n"};
  std::vector<Bytes> seeds;
  for (const char* text : kTexts) seeds.emplace_back(text, text + std::strlen(text));
  return seeds;
}

}  // namespace kiwami_fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace kiwami_fuzz;
  static const std::string path = (std::filesystem::temp_directory_path() /
                                   ("kiwami-fuzz-" + std::to_string(::getpid()) + ".obj"))
                                      .string();
  {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  }
  try {
    const kiwami::tools::SceneFile scene = kiwami::tools::read_obj(path);
    for (const kiwami::tools::Mesh& mesh : scene.meshes) {
      for (const uint32_t index : mesh.indices) {
        require(index < mesh.vertex_count(), "an index without a vertex");
      }
    }
  } catch (const kiwami::tools::SceneError& error) {
    require(error.what()[0] != '\0', "an error without a sentence");
  }
  std::filesystem::remove(path);
  return 0;
}

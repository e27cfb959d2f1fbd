// SPDX-License-Identifier: Apache-2.0
// The C++ layer against the answers that every binding must give.
#include <algorithm>
#include <map>
#include <sstream>

#include "support.h"

namespace {

/// A file of vectors: does what it says and compares the answers.
class Player {
 public:
  Player(const std::string& file, const kiwami::Device& device) : words_(file), device_(device) {}

  /// Returns how many rays were compared.
  std::size_t play() {
    while (words_.word() == "scene") play_scene();
    return compared_;
  }

 private:
  void play_scene() {
    const std::string name = words_.word();
    kiwami::Scene scene(device_);
    meshes_.clear();
    std::string word = words_.word();
    for (; word != "end" && !testing::Test::HasFatalFailure(); word = words_.word()) {
      if (!add_geometry(word, scene) && !change(word, scene)) compare(word, scene);
    }
    scenes_.emplace(name, scene);
  }

  bool add_geometry(const std::string& kind, kiwami::Scene& scene) {
    if (kind == "mesh") {
      scene.attach(read_mesh());
    } else if (kind == "moving_mesh") {
      scene.attach(read_moving_mesh());
    } else if (kind == "instances") {
      scene.attach(read_instances());
    } else if (kind == "spheres" || kind == "discs" || kind == "curves") {
      scene.attach(read_shapes(kind));
    } else {
      return false;
    }
    return true;
  }

  kiwami::Mesh read_mesh() {
    const std::uint32_t mask = words_.int32(), vertex_count = words_.int32();
    const std::uint32_t triangle_count = words_.int32();
    const auto vertices = words_.array<kiwami::Vertex>(vertex_count);
    const auto triangles = words_.array<kiwami::Triangle>(triangle_count);
    return meshes_.emplace_back(device_, vertices, triangles, mask);
  }

  kiwami::Geometry read_moving_mesh() {
    const std::uint32_t mask = words_.int32(), step_count = words_.int32();
    const auto times = words_.words<kiwami::TimeRange>();
    const std::uint32_t vertex_count = words_.int32(), triangle_count = words_.int32();
    const auto vertices = words_.array<kiwami::Vertex>(std::size_t{step_count} * vertex_count);
    const auto triangles = words_.array<kiwami::Triangle>(triangle_count);
    return kiwami::MovingMesh(device_, vertices, step_count, triangles, times, mask);
  }

  kiwami::Geometry read_shapes(const std::string& kind) {
    const std::uint32_t mask = words_.int32(), count = words_.int32();
    const std::uint32_t segment_count = kind == "curves" ? words_.int32() : 0;
    const auto points = words_.array<kiwami::Sphere>(count);
    if (kind == "spheres") return kiwami::Spheres(device_, points, mask);
    if (kind == "curves") {
      return kiwami::Curves(device_, points, words_.array<std::uint32_t>(segment_count), mask);
    }
    return kiwami::Discs(device_, points, words_.array<kiwami::Vertex>(count), mask);
  }

  kiwami::Geometry read_instances() {
    const std::uint32_t mask = words_.int32(), scene_count = words_.int32();
    const std::uint32_t count = words_.int32();
    std::vector<kiwami::Scene> shown;
    for (std::uint32_t i = 0; i < scene_count; ++i) shown.push_back(scenes_.at(words_.word()));
    std::vector<std::uint32_t> indices, masks;
    std::vector<kiwami::Transform> transforms;
    for (std::uint32_t i = 0; i < count; ++i) {
      indices.push_back(words_.int32());
      masks.push_back(words_.int32());
      transforms.push_back(words_.words<kiwami::Transform>());
    }
    return kiwami::Instances(device_, shown, transforms, indices, masks, mask);
  }

  bool change(const std::string& word, kiwami::Scene& scene) {
    if (word == "commit") {
      scene.commit();
    } else if (word == "refit") {
      scene.refit();
    } else if (word == "vertices") {
      const std::uint32_t geometry_id = words_.int32(), count = words_.int32();
      meshes_[geometry_id].update_vertices(words_.array<kiwami::Vertex>(count));
    } else if (word == "enable") {
      const std::uint32_t geometry_id = words_.int32();
      scene.enable(geometry_id, words_.int32() != 0);
    } else if (word == "remove") {
      scene.detach(words_.int32());
    } else {
      return false;
    }
    return true;
  }

  void compare(const std::string& word, const kiwami::Scene& scene) {
    if (word == "rays") {
      rays_ = words_.array<kiwami::Ray>(words_.int32());
      compared_ += rays_.size();
    } else if (word == "closest_hit") {
      expect_hits(scene.closest_hit(rays_));
    } else if (word == "any_hit") {
      for (const std::uint8_t each : scene.any_hit(rays_)) EXPECT_EQ(each, words_.int32());
    } else if (word == "multi_hit") {
      compare_multi_hit(scene);
    } else if (word == "file") {
      compare_file(scene);
    } else {
      FAIL() << "the vectors have '" << word << "'";
    }
  }

  void expect_hits(std::span<const kiwami::Hit> hits) {
    for (const kiwami::Hit& hit : hits) EXPECT_EQ(std::bit_cast<Bits>(hit), words_.words<Bits>());
  }

  void compare_multi_hit(const kiwami::Scene& scene) {
    const std::uint32_t max_hits = words_.int32();
    const std::uint64_t total = words_.number();
    const kiwami::MultiHits found = scene.multi_hit(rays_, max_hits);
    for (const std::uint64_t offset : found.offsets) EXPECT_EQ(offset, words_.number());
    ASSERT_EQ(found.hits.size(), total);
    expect_hits(found.hits);
    const std::vector<std::uint32_t> counts = scene.count_hits(rays_);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      EXPECT_EQ(found.of(i).size(), max_hits == 0 ? counts[i] : std::min(counts[i], max_hits));
    }
  }

  void compare_file(const kiwami::Scene& scene) {
    const std::vector<kiwami::Hit> expected = scene.closest_hit(rays_);
    const std::string saved = testing::TempDir() + "kiwami_hpp_test.kiwami";
    scene.save(saved);
    const std::string committed = KIWAMI_VECTORS_FOLDER "/" + words_.word();
    for (const std::string& path : {saved, committed}) {
      for (const std::uint32_t flags : {0u, std::uint32_t{KIWAMI_LOAD_MAP}}) {
        const kiwami::Scene loaded = kiwami::Scene::load(scene.device(), path, flags);
        const std::vector<kiwami::Hit> hits = loaded.closest_hit(rays_);
        for (std::size_t i = 0; i < hits.size(); ++i) {
          EXPECT_EQ(std::bit_cast<Bits>(hits[i]), std::bit_cast<Bits>(expected[i]));
        }
      }
    }
    EXPECT_THROW(kiwami::Scene::load(scene.device(), KIWAMI_VECTORS), kiwami::Error);
    note("files");
  }

  Words words_;
  kiwami::Device device_;
  std::map<std::string, kiwami::Scene> scenes_;
  std::vector<kiwami::Mesh> meshes_;
  std::vector<kiwami::Ray> rays_;
  std::size_t compared_ = 0;
};

struct VectorFile {
  const char* name;
  std::vector<const char*> features;
};

TEST(Conformance, AnswersAreTheSameToTheBit) {
  const VectorFile files[] = {{"vectors", {"closest hit", "any hit", "multi hit", "counts"}},
                              {"shapes", {"spheres, discs, curves"}},
                              {"moving_meshes", {"moving meshes"}},
                              {"instances", {"instances"}},
                              {"changes", {"changes, refit"}}};
  for (const VectorFile& file : files) {
    SCOPED_TRACE(file.name);
    for (const std::uint32_t isa : {KIWAMI_ISA_AUTO, KIWAMI_ISA_SCALAR}) {
      const kiwami::Device device(kiwami::DeviceOptions{.isa = isa, .validate = true});
      EXPECT_GT(Player(file.name, device).play(), 100u);
    }
    for (const char* feature : file.features) note(feature);
  }
}

/// The line of the vectors that an error stands for.
template <typename Call>
std::string line_of(const std::string& name, Call call) {
  try {
    call();
  } catch (const kiwami::Error& error) {
    return "error " + name + " " + std::to_string(error.result()) + " " + error.what();
  }
  return "no error";
}

TEST(Conformance, ErrorsAreTheSame) {
  const kiwami::Device device;
  kiwami::Scene scene(device);
  const kiwami::Triangle beyond{0, 1, 3};
  const std::string found[] = {
      line_of("index_beyond_vertices",
              [&] { kiwami::Mesh(device, kCorners, std::span(&beyond, 1)); }),
      line_of("unknown_geometry", [&] { scene.detach(5); }),
      line_of("parameter_out_of_bounds",
              [&] { scene.set_parameter(KIWAMI_PARAMETER_BIN_COUNT, 1000); }),
      line_of("not_committed", [&] { scene.closest_hit(ray_at(0, 0)); })};
  std::ifstream file(KIWAMI_VECTORS);
  std::size_t next = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("error ", 0) != 0) continue;
    EXPECT_EQ(found[next++], line);
  }
  EXPECT_EQ(next, std::size(found));
  note("errors");
}

}  // namespace

// SPDX-License-Identifier: Apache-2.0
// Load: threads that build, change, trace, save, load and release scenes and sets of lights at
// random, of all kinds, on devices that they share. All answers are compared with those of the scalar kernels, and between the rounds,
// when everything is released, the devices must hold what they held in the beginning.
//
//   kiwami_soak [SECONDS [THREADS]]      KIWAMI_SEED as for other tests
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "support/environment.h"
#include "support/library.h"
#include "support/random.h"
#include "support/rich_lights.h"
#include "support/rich_scene.h"

namespace kiwami_tests {
namespace {

constexpr uint32_t kMeshes = 6;
constexpr uint32_t kRays = 400;
constexpr uint32_t kReceivers = 100;
constexpr uint32_t kSharedScenes = 3;
/// Of support/rich_scene.h.
constexpr uint32_t kKinds[] = {kRichInstances,
                               kRichShapes,
                               kRichMotion | kRichMicromaps,
                               kRichTwoLevel | kRichMotion,
                               kRichMovingInstances,
                               kRichInstances | kRichMovingInstances | kRichRebraided,
                               kRichAll & ~kRichDisabled};
constexpr double kRoundSeconds = 2.0;
/// What the process may gain after the first rounds: allocators keep and divide what was freed.
constexpr double kAllowedGrowth = 1.25;
constexpr uint64_t kAllowedGrowthBytes = uint64_t{64} << 20;

struct Counts {
  std::atomic<uint64_t> commits{0}, rays{0}, saves{0}, loads{0}, trees{0}, failures{0};
};

/// Triangles of one mesh: their number and size differ by mesh.
struct MeshData {
  std::vector<float> vertices;
  std::vector<uint32_t> indices;

  explicit MeshData(uint32_t number) {
    Random random(number, 77);
    const uint32_t triangles = 20u << number;
    const float size = 0.4f / static_cast<float>(number + 1);
    for (uint32_t i = 0; i < triangles; ++i) {
      const float centre[3] = {random.symmetric(), random.symmetric(), random.symmetric()};
      for (uint32_t corner = 0; corner < 3; ++corner) {
        for (const float coordinate : centre) {
          vertices.push_back(coordinate + size * random.symmetric());
        }
        indices.push_back(3 * i + corner);
      }
    }
  }
};

struct LightRelease {
  void operator()(kiwami_light_tree* lights) const { kiwami_light_tree_release(lights); }
};
using LightHandle = std::unique_ptr<kiwami_light_tree, LightRelease>;

/// A file in memory, at a multiple of 64.
class SavedFile {
 public:
  /// Calls save(desc, size) for the size, and again for the contents.
  template <typename Save>
  explicit SavedFile(const Save& save) {
    kiwami_save_desc desc;
    check(kiwami_save_desc_init(&desc, sizeof desc));
    check(save(&desc, &size_));
    data_.reset(std::aligned_alloc(64, (static_cast<size_t>(size_) + 63) / 64 * 64));
    desc.data = data_.get();
    desc.capacity = size_;
    check(save(&desc, nullptr));
  }

  kiwami_load_desc load_desc(uint32_t flags) const {
    kiwami_load_desc desc;
    check(kiwami_load_desc_init(&desc, sizeof desc));
    desc.data = data_.get();
    desc.size = size_;
    desc.flags = flags;
    return desc;
  }

 private:
  struct Free {
    void operator()(void* data) const { std::free(data); }
  };

  std::unique_ptr<void, Free> data_;
  uint64_t size_ = 0;
};

uint64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  uint64_t pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * 4096;
}

class Soak {
 public:
  explicit Soak(uint64_t random_seed) : seed_(random_seed) {
    for (uint32_t i = 0; i < kMeshes; ++i) meshes_.emplace_back(i);
    Random random(random_seed);
    rays_.resize(kRays);
    for (kiwami_ray& ray : rays_) {
      ray = {2 * random.symmetric(),
             2 * random.symmetric(),
             2 * random.symmetric(),
             0.0f,
             random.symmetric(),
             random.symmetric(),
             random.symmetric(),
             1e30f,
             0.0f,
             ~0u,
             0u,
             0u};
      ray.time = random.unit();
    }
    receivers_.resize(kReceivers);
    for (kiwami_light_receiver& receiver : receivers_) {
      receiver = {};
      for (float& coordinate : receiver.position) coordinate = 2 * random.symmetric();
      receiver.random = static_cast<double>(random.unit());
      receiver.link_mask = ~uint64_t{0};
    }
    for (const uint32_t isa : available_isas()) devices_.push_back(make_device(isa, 2));
    // Of each set of meshes the answers that all must give.
    for (uint32_t set = 1; set < 1u << kMeshes; ++set) {
      expected_.push_back(answers_of(make(devices_[0].get(), set, {}).get()));
    }
    for (const uint32_t parts : kKinds) {
      expected_of_kinds_.push_back(answers_of(make_rich(devices_[0].get(), parts, 4).get()));
    }
    expected_choices_ = choices_of(make_lights(devices_[0].get()).get());
    for (const DeviceHandle& device : devices_) {
      held_.push_back(info_of(device.get()).memory_bytes);
    }
  }

  /// Returns whether nothing was wrong.
  bool run(double seconds, unsigned threads) {
    const auto start = std::chrono::steady_clock::now();
    const auto elapsed = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    uint64_t rounds = 0, settled = 0;
    for (; elapsed() < seconds; ++rounds) {
      run_round(std::min(kRoundSeconds, seconds / 4), threads, rounds);
      check_memory();
      if (rounds == 3) settled = resident_bytes();
      if (rounds > 3) check_growth(settled);
    }
    std::printf(
        "%.0f s, %llu rounds of %u threads: %llu commits, %llu rays, %llu saves, %llu loads, %llu "
        "trees; %llu failures; %.0f MB resident\n",
        elapsed(), static_cast<unsigned long long>(rounds), threads, number(counts_.commits),
        number(counts_.rays), number(counts_.saves), number(counts_.loads), number(counts_.trees),
        number(counts_.failures), static_cast<double>(resident_bytes()) * 1e-6);
    return counts_.failures == 0;
  }

 private:
  using Answers = std::vector<kiwami_hit>;
  using Choices = std::vector<kiwami_light_choice>;

  static unsigned long long number(const std::atomic<uint64_t>& count) { return count.load(); }

  void fail(const std::string& what) {
    ++counts_.failures;
    std::fprintf(stderr, "%s\n", what.c_str());
  }

  /// A committed scene of a set of meshes, mesh i as geometry i.
  SceneHandle make(kiwami_device* device, uint32_t set,
                   const std::vector<std::pair<uint32_t, double>>& parameters) {
    kiwami_scene* made = nullptr;
    check(kiwami_scene_create(device, &made));
    SceneHandle scene(made);
    for (const auto& [parameter, value] : parameters) {
      check(kiwami_scene_set_parameter(made, parameter, value));
    }
    for (uint32_t i = 0; i < kMeshes; ++i) attach(device, made, i);
    change(device, made, (1u << kMeshes) - 1, set);
    commit(made);
    return scene;
  }

  void attach(kiwami_device* device, kiwami_scene* scene, uint32_t mesh) {
    kiwami_triangle_mesh_desc desc;
    check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc));
    desc.vertices = meshes_[mesh].vertices.data();
    desc.vertex_count = meshes_[mesh].vertices.size() / 3;
    desc.indices = meshes_[mesh].indices.data();
    desc.triangle_count = meshes_[mesh].indices.size() / 3;
    if (mesh % 2 == 0) desc.flags = KIWAMI_MESH_SHARE_BUFFERS;
    kiwami_geometry* geometry = nullptr;
    check(kiwami_triangle_mesh_create(device, &desc, &geometry));
    uint32_t id = 0;
    const kiwami_result result = kiwami_scene_attach(scene, geometry, &id);
    kiwami_geometry_release(geometry);
    check(result);
    if (id != mesh) throw std::runtime_error("a mesh with another number than the free one");
  }

  /// From one set of meshes to another. The lowest free number is the one that is attached next, so
  /// what is to be left out is attached, too, and leaves last.
  void change(kiwami_device* device, kiwami_scene* scene, uint32_t from, uint32_t to) {
    for (uint32_t i = 0; i < kMeshes; ++i) {
      if ((from >> i & 1) == 0) attach(device, scene, i);
    }
    for (uint32_t i = 0; i < kMeshes; ++i) {
      if ((to >> i & 1) == 0) check(kiwami_scene_detach(scene, i));
    }
  }

  void commit(kiwami_scene* scene) {
    check(kiwami_scene_commit(scene));
    ++counts_.commits;
  }

  Answers answers_of(const kiwami_scene* scene) {
    counts_.rays += rays_.size();
    return closest_hits(scene, rays_);
  }

  void compare(const kiwami_scene* scene, const Answers& expected, const std::string& when) {
    const Answers answers = answers_of(scene);
    if (std::memcmp(answers.data(), expected.data(), answers.size() * sizeof answers[0]) == 0)
      return;
    fail("answers differ " + when);
  }
  void compare(const kiwami_scene* scene, uint32_t set, const char* when) {
    compare(scene, expected_[set - 1], std::string(when) + ", meshes " + std::to_string(set));
  }

  SceneHandle make_rich(kiwami_device* device, uint32_t parts, uint32_t width) {
    kiwami_scene* made = nullptr;
    check(make_rich_scene(device, {parts, width, 20}, &made));
    ++counts_.commits;
    return SceneHandle(made);
  }

  LightHandle make_lights(kiwami_device* device) {
    kiwami_light_tree* made = nullptr;
    check(make_rich_lights(device, {4, 10, true}, &made));
    return LightHandle(made);
  }

  Choices choices_of(const kiwami_light_tree* lights) const {
    Choices choices(receivers_.size());
    check(kiwami_light_sample(lights, receivers_.data(), 0, choices.data(), 0, choices.size(),
                              nullptr));
    return choices;
  }

  void compare(const kiwami_light_tree* lights, const char* when) {
    const Choices choices = choices_of(lights);
    const size_t bytes = choices.size() * sizeof choices[0];
    if (std::memcmp(choices.data(), expected_choices_.data(), bytes) != 0) {
      fail(std::string("choices of lights differ ") + when);
    }
  }

  static uint32_t random_set(Random& random) { return 1 + random.below((1u << kMeshes) - 1); }

  std::vector<std::pair<uint32_t, double>> random_parameters(Random& random) const {
    constexpr double kWidths[] = {0, 4, 8, 16};
    constexpr double kBuilders[] = {KIWAMI_BUILDER_BINNED_SAH, KIWAMI_BUILDER_LBVH,
                                    KIWAMI_BUILDER_PLOC, KIWAMI_BUILDER_SPATIAL_SPLIT};
    return {{KIWAMI_PARAMETER_BVH_WIDTH, kWidths[random.below(4)]},
            {KIWAMI_PARAMETER_BUILDER, kBuilders[random.below(4)]},
            {KIWAMI_PARAMETER_MERGE_LEAVES, random.below(2)}};
  }

  /// Through memory, by copy or in place.
  void save_and_load(kiwami_device* device, kiwami_scene* scene, const Answers& expected,
                     const std::string& what, Random& random) {
    const SavedFile file([&](const kiwami_save_desc* desc, uint64_t* size) {
      return kiwami_scene_save(scene, desc, size);
    });
    ++counts_.saves;
    const kiwami_load_desc load = file.load_desc(random.below(4));  // all of KIWAMI_LOAD_*
    kiwami_scene* loaded = nullptr;
    check(kiwami_scene_load(device, &load, &loaded));
    const SceneHandle owner(loaded);
    ++counts_.loads;
    compare(loaded, expected, "after loading, " + what);
    if (!random.one_in(4)) return;
    commit(loaded);
    compare(loaded, expected, "after loading and committing, " + what);
  }

  void step_of_kinds(kiwami_device* device, Random& random) {
    constexpr uint32_t kWidths[] = {0, 4, 8, 16};
    const uint32_t kind = random.below(static_cast<uint32_t>(std::size(kKinds)));
    const Answers& expected = expected_of_kinds_[kind];
    const std::string what = "kind " + std::to_string(kKinds[kind]);
    const SceneHandle scene = make_rich(device, kKinds[kind], kWidths[random.below(4)]);
    compare(scene.get(), expected, "after a build, " + what);
    save_and_load(device, scene.get(), expected, what, random);
  }

  void step_of_lights(kiwami_device* device, Random& random) {
    const LightHandle lights = make_lights(device);
    compare(lights.get(), "after a commit");
    const SavedFile file([&](const kiwami_save_desc* desc, uint64_t* size) {
      return kiwami_light_tree_save(lights.get(), desc, size);
    });
    ++counts_.saves;
    const kiwami_load_desc load = file.load_desc(random.below(4));
    kiwami_light_tree* loaded = nullptr;
    check(kiwami_light_tree_load(device, &load, &loaded));
    const LightHandle owner(loaded);
    ++counts_.loads;
    compare(loaded, "after loading");
  }

  void look(const kiwami_scene* scene) {
    kiwami_bvh* bvh = nullptr;
    check(kiwami_scene_get_bvh(scene, &bvh));
    const kiwami_result result = kiwami_bvh_measure(bvh, nullptr, nullptr, nullptr, 0);
    kiwami_bvh_release(bvh);
    check(result);
    ++counts_.trees;
  }

  void step(Random& random, const std::vector<SceneHandle>& shared,
            const std::vector<uint32_t>& shared_sets) {
    kiwami_device* const device =
        devices_[random.below(static_cast<uint32_t>(devices_.size()))].get();
    if (random.one_in(4)) return step_of_kinds(device, random);
    if (random.one_in(8)) return step_of_lights(device, random);
    uint32_t set = random_set(random);
    const SceneHandle scene = make(device, set, random_parameters(random));
    compare(scene.get(), set, "after a build");
    for (uint32_t changes = random.below(4); changes != 0; --changes) {
      const uint32_t next = random_set(random);
      change(device, scene.get(), set, next);
      // What was committed before is there until the next commit.
      compare(scene.get(), set, "before a commit");
      commit(scene.get());
      set = next;
      compare(scene.get(), set, "after a change");
    }
    if (random.one_in(2)) {
      save_and_load(device, scene.get(), expected_[set - 1], "meshes " + std::to_string(set),
                    random);
    }
    if (random.one_in(4)) look(scene.get());
    if (random.one_in(4)) check(kiwami_scene_validate(scene.get()));
    const uint32_t other = random.below(kSharedScenes);
    compare(shared[other].get(), shared_sets[other], "of a scene that all threads trace");
  }

  void run_round(double seconds, unsigned threads, uint64_t round) {
    std::vector<SceneHandle> shared;
    std::vector<uint32_t> shared_sets;
    Random random(seed_, round);
    for (uint32_t i = 0; i < kSharedScenes; ++i) {
      shared_sets.push_back(random_set(random));
      shared.push_back(make(devices_[i % devices_.size()].get(), shared_sets[i], {}));
    }
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    std::vector<std::thread> workers;
    for (unsigned i = 0; i < threads; ++i) {
      workers.emplace_back([&, i] {
        Random own(seed_, (round + 1) * 1000 + i);
        try {
          do {
            step(own, shared, shared_sets);
          } while (std::chrono::steady_clock::now() < end);
        } catch (const std::exception& error) {
          fail(error.what());
        }
      });
    }
    for (std::thread& worker : workers) worker.join();
  }

  void check_memory() {
    for (size_t i = 0; i < devices_.size(); ++i) {
      const uint64_t bytes = info_of(devices_[i].get()).memory_bytes;
      if (bytes != held_[i]) {
        fail("a device holds " + std::to_string(bytes) + " bytes, expected " +
             std::to_string(held_[i]));
      }
    }
  }

  void check_growth(uint64_t settled) {
    const uint64_t bytes = resident_bytes();
    const auto most =
        static_cast<uint64_t>(kAllowedGrowth * static_cast<double>(settled)) + kAllowedGrowthBytes;
    if (bytes > most) {
      fail("the process holds " + std::to_string(bytes) + " bytes, expected at most " +
           std::to_string(most));
    }
  }

  uint64_t seed_;
  std::vector<MeshData> meshes_;
  std::vector<kiwami_ray> rays_;
  std::vector<DeviceHandle> devices_;
  std::vector<Answers> expected_, expected_of_kinds_;
  std::vector<kiwami_light_receiver> receivers_;
  Choices expected_choices_;
  std::vector<uint64_t> held_;
  Counts counts_;
};

}  // namespace
}  // namespace kiwami_tests

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 1800.0;
  const auto threads = static_cast<unsigned>(argc > 2 ? std::max(1, std::atoi(argv[2])) : 4);
  std::printf("seed %llu\n", static_cast<unsigned long long>(kiwami_tests::seed()));
  try {
    return kiwami_tests::Soak(kiwami_tests::seed()).run(seconds, threads) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

// SPDX-License-Identifier: Apache-2.0
// The C++ layer against the answers that every binding must give, and its own habits.
#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <fstream>
#include <kiwami/kiwami.hpp>
#include <sstream>
#include <thread>
#include <type_traits>

namespace {

/// Notes that a feature was found right, for the table of the documents.
void note(const char* feature) {
  const char* const path = std::getenv("KIWAMI_FEATURES");
  if (path && !testing::Test::HasFailure()) std::ofstream(path, std::ios::app) << feature << '\n';
}

/// Words of the conformance vectors, one after the other.
class Words {
 public:
  Words() : file_(KIWAMI_VECTORS) {}
  std::string word() {
    std::string text;
    file_ >> text;
    return text;
  }
  std::uint64_t number() { return std::stoull(word()); }
  std::uint32_t int32() { return static_cast<std::uint32_t>(number()); }
  template <typename T>
  T words() {
    std::array<std::uint32_t, sizeof(T) / 4> bits;
    for (std::uint32_t& each : bits) each = int32();
    return std::bit_cast<T>(bits);
  }
  template <typename T>
  std::vector<T> array(std::size_t count) {
    std::vector<T> values(count);
    for (T& value : values) value = words<T>();
    return values;
  }

 private:
  std::ifstream file_;
};

using Bits = std::array<std::uint32_t, sizeof(kiwami::Hit) / 4>;

void expect_hits(Words& words, std::span<const kiwami::Hit> hits) {
  for (const kiwami::Hit& hit : hits) EXPECT_EQ(std::bit_cast<Bits>(hit), words.words<Bits>());
}

void check_multi_hit(Words& words, const kiwami::Scene& scene, std::span<const kiwami::Ray> rays) {
  const std::uint32_t max_hits = words.int32();
  const std::uint64_t total = words.number();
  const kiwami::MultiHits found = scene.multi_hit(rays, max_hits);
  for (const std::uint64_t offset : found.offsets) EXPECT_EQ(offset, words.number());
  ASSERT_EQ(found.hits.size(), total);
  expect_hits(words, found.hits);
  const std::vector<std::uint32_t> counts = scene.count_hits(rays);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    EXPECT_EQ(found.of(i).size(), max_hits == 0 ? counts[i] : std::min(counts[i], max_hits));
  }
}

void check_file(Words& words, const kiwami::Scene& scene, std::span<const kiwami::Ray> rays) {
  const std::vector<kiwami::Hit> expected = scene.closest_hit(rays);
  const std::string saved = testing::TempDir() + "kiwami_hpp_test.kiwami";
  scene.save(saved);
  const std::string committed = KIWAMI_VECTORS_FOLDER "/" + words.word();
  for (const std::string& path : {saved, committed}) {
    for (const std::uint32_t flags : {0u, std::uint32_t{KIWAMI_LOAD_MAP}}) {
      const kiwami::Scene loaded = kiwami::Scene::load(scene.device(), path, flags);
      const std::vector<kiwami::Hit> hits = loaded.closest_hit(rays);
      for (std::size_t i = 0; i < hits.size(); ++i) {
        EXPECT_EQ(std::bit_cast<Bits>(hits[i]), std::bit_cast<Bits>(expected[i]));
      }
    }
  }
  EXPECT_THROW(kiwami::Scene::load(scene.device(), KIWAMI_VECTORS), kiwami::Error);
  note("files");
}

std::size_t check_scene(Words& words, const kiwami::Device& device) {
  kiwami::Scene scene(device);
  words.word();
  std::string word = words.word();
  for (; word == "mesh"; word = words.word()) {
    const std::uint32_t mask = words.int32(), vertex_count = words.int32();
    const std::uint32_t triangle_count = words.int32();
    const auto vertices = words.array<kiwami::Vertex>(vertex_count);
    const auto triangles = words.array<kiwami::Triangle>(triangle_count);
    scene.attach(kiwami::Mesh(device, vertices, triangles, mask));
  }
  EXPECT_EQ(word, "rays");
  const auto rays = words.array<kiwami::Ray>(words.int32());
  scene.commit();
  EXPECT_EQ(words.word(), "closest_hit");
  expect_hits(words, scene.closest_hit(rays));
  EXPECT_EQ(words.word(), "any_hit");
  for (const std::uint8_t occluded : scene.any_hit(rays)) EXPECT_EQ(occluded, words.int32());
  for (word = words.word(); word == "multi_hit"; word = words.word()) {
    check_multi_hit(words, scene, rays);
  }
  if (word == "file") {
    check_file(words, scene, rays);
    word = words.word();
  }
  EXPECT_EQ(word, "end");
  for (const char* each : {"closest hit", "any hit", "multi hit", "counts"}) note(each);
  return rays.size();
}

constexpr std::array<kiwami::Vertex, 3> kCorners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};

kiwami::Ray ray_at(float x, float y) { return {x, y, -1, 0, 0, 0, 1, 1e30f, 0, ~0u, 0, 0}; }

TEST(KiwamiHpp, AnswersAreTheSameToTheBit) {
  for (const std::uint32_t isa : {KIWAMI_ISA_AUTO, KIWAMI_ISA_SCALAR}) {
    const kiwami::Device device(kiwami::DeviceOptions{.isa = isa, .validate = true});
    Words words;
    EXPECT_EQ(words.word(), "kiwami-conformance");
    EXPECT_EQ(words.word(), "1");
    std::size_t compared = 0;
    while (words.word() == "scene") compared += check_scene(words, device);
    EXPECT_GT(compared, 100u);
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

TEST(KiwamiHpp, ErrorsAreTheSame) {
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

TEST(KiwamiHpp, HandlesOwnWhatTheyName) {
  static_assert(std::is_nothrow_move_constructible_v<kiwami::Scene>);
  const kiwami::Triangle triangle{0, 1, 2};
  kiwami::Scene scene = [&] {
    const kiwami::Device device;
    kiwami::Scene made(device);
    const kiwami::Mesh mesh(device, kCorners, std::span(&triangle, 1));
    EXPECT_EQ(made.attach(mesh), 0u);
    made.commit();
    return made;
  }();
  kiwami::Scene copy = scene;
  EXPECT_EQ(copy.get(), scene.get());
  kiwami::Scene moved = std::move(scene);
  EXPECT_FALSE(scene);
  EXPECT_EQ(moved.closest_hit(ray_at(0.25f, 0.25f)).t, 1.0f);
  moved = copy;
  EXPECT_TRUE(moved.any_hit(ray_at(0.25f, 0.25f)));
  EXPECT_FALSE(moved.any_hit(ray_at(2, 2)));
  EXPECT_EQ(moved.info().triangle_count, 1u);
}

TEST(KiwamiHpp, SpansOfDifferentSizesAreAnError) {
  const kiwami::Device device;
  kiwami::Scene scene(device);
  scene.attach(kiwami::Mesh(device, {}, {}));
  scene.commit();
  std::array<kiwami::Ray, 2> rays{ray_at(0, 0), ray_at(1, 1)};
  std::array<kiwami::Hit, 1> hits;
  EXPECT_THROW(scene.closest_hit(rays, hits), kiwami::Error);
  EXPECT_TRUE(scene.closest_hit(std::span<const kiwami::Ray>{}).empty());
  EXPECT_TRUE(scene.multi_hit(std::span<const kiwami::Ray>{}).hits.empty());
}

TEST(KiwamiHpp, ProgressIsToldAndMayCancelOrThrow) {
  const kiwami::Device device;
  kiwami::Scene scene(device);
  const kiwami::Triangle triangle{0, 1, 2};
  scene.attach(kiwami::Mesh(device, kCorners, std::span(&triangle, 1)));
  std::vector<double> fractions;
  scene.commit([&](double fraction) {
    fractions.push_back(fraction);
    return false;
  });
  ASSERT_GE(fractions.size(), 2u);
  EXPECT_EQ(fractions.front(), 0.0);
  EXPECT_EQ(fractions.back(), 1.0);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  try {
    scene.commit([](double) { return true; });
    FAIL() << "the commit was not cancelled";
  } catch (const kiwami::Error& error) {
    EXPECT_EQ(error.result(), KIWAMI_ERROR_CANCELLED);
  }
  struct Stop {
    int why;
  };
  int calls = 0;
  try {
    scene.commit([&](double) -> bool {
      ++calls;
      throw Stop{7};
    });
    FAIL() << "nothing was thrown";
  } catch (const Stop& stop) {
    EXPECT_EQ(stop.why, 7);
  }
  EXPECT_EQ(calls, 1);
  // The function is gone, and what was committed before stays in use.
  EXPECT_TRUE(scene.any_hit(ray_at(0.25f, 0.25f)));
  scene.commit();
  EXPECT_EQ(calls, 1);
  note("progress callback");
}

TEST(KiwamiHpp, ManyThreadsTraceOneScene) {
  const kiwami::Device device;
  kiwami::Scene scene(device);
  const kiwami::Triangle triangle{0, 1, 2};
  scene.attach(kiwami::Mesh(device, kCorners, std::span(&triangle, 1)));
  scene.commit();
  std::vector<kiwami::Ray> rays;
  for (int i = 0; i < 100; ++i) rays.push_back(ray_at(static_cast<float>(i) / 50, 0.1f));
  const std::vector<kiwami::Hit> expected = scene.closest_hit(rays);
  std::array<std::vector<kiwami::Hit>, 4> found;
  std::vector<std::jthread> threads;
  for (auto& hits : found) threads.emplace_back([&] { hits = scene.closest_hit(rays); });
  threads.clear();
  for (const auto& hits : found) {
    ASSERT_EQ(hits.size(), expected.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
      EXPECT_EQ(std::bit_cast<Bits>(hits[i]), std::bit_cast<Bits>(expected[i]));
    }
  }
}

}  // namespace

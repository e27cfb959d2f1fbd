// SPDX-License-Identifier: Apache-2.0
// Points in tetrahedral meshes, against a test of all tetrahedra in exact whole numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "support/environment.h"
#include "support/kuhn_grid.h"
#include "support/library.h"

namespace kiwami_tests {
namespace {

using Location = kiwami_tetrahedron_location;
using Vertex = TetrahedralGrid::Vertex;

constexpr uint32_t kMethods[] = {KIWAMI_TETRAHEDRA_BOXES, KIWAMI_TETRAHEDRA_FACES};

struct ReleaseTetrahedra {
  void operator()(kiwami_tetrahedra* handle) const { kiwami_tetrahedra_release(handle); }
};
using Handle = std::unique_ptr<kiwami_tetrahedra, ReleaseTetrahedra>;

kiwami_tetrahedra_desc describe(const std::vector<float>& vertices,
                                const std::vector<TetrahedralGrid::Tetrahedron>& tetrahedra,
                                uint32_t method) {
  kiwami_tetrahedra_desc desc;
  check(kiwami_tetrahedra_desc_init(&desc, sizeof desc));
  desc.method = method;
  desc.vertices = vertices.data();
  desc.vertex_count = vertices.size() / 3;
  desc.indices = tetrahedra.data();
  desc.tetrahedron_count = tetrahedra.size();
  return desc;
}

Handle make(const DeviceHandle& device, const kiwami_tetrahedra_desc& desc) {
  kiwami_tetrahedra* handle = nullptr;
  check(kiwami_tetrahedra_create(device.get(), &desc, &handle));
  return Handle(handle);
}

kiwami_tetrahedra_info info_of(const Handle& tetrahedra) {
  kiwami_tetrahedra_info info;
  info.struct_size = sizeof info;
  check(kiwami_tetrahedra_get_info(tetrahedra.get(), &info));
  return info;
}

std::vector<Location> locate(const Handle& tetrahedra, const std::vector<float>& points) {
  std::vector<Location> locations(points.size() / 3);
  check(kiwami_tetrahedra_locate(tetrahedra.get(), points.data(), 0, locations.data(), 0,
                                 locations.size()));
  return locations;
}

// ---------------------------------------------------------------- the oracle

__extension__ typedef __int128 Wide;  // NOLINT(modernize-use-using)

/// Six times the signed volume, exactly.
Wide volume(const Vertex& a, const Vertex& b, const Vertex& c, const Vertex& d) {
  const auto along = [&](const Vertex& to, int axis) { return Wide{to.at[axis]} - a.at[axis]; };
  return along(b, 0) * (along(c, 1) * along(d, 2) - along(c, 2) * along(d, 1)) +
         along(b, 1) * (along(c, 2) * along(d, 0) - along(c, 0) * along(d, 2)) +
         along(b, 2) * (along(c, 0) * along(d, 1) - along(c, 1) * along(d, 0));
}

struct Expected {
  uint32_t id = KIWAMI_INVALID_ID;
  double weights[4] = {0.0, 0.0, 0.0, 0.0};
};

Expected expected_at(const TetrahedralGrid& grid, const Vertex& point) {
  for (uint32_t id = 0; id < grid.tetrahedra.size(); ++id) {
    Vertex corner[4];
    for (int i = 0; i < 4; ++i) corner[i] = grid.vertices[grid.tetrahedra[id].vertex[i]];
    const Wide whole = volume(corner[0], corner[1], corner[2], corner[3]);
    if (whole == 0) continue;
    Expected expected;
    expected.id = id;
    bool is_inside = true;
    for (int i = 0; i < 4 && is_inside; ++i) {
      Vertex replaced[4] = {corner[0], corner[1], corner[2], corner[3]};
      replaced[i] = point;
      const Wide part = volume(replaced[0], replaced[1], replaced[2], replaced[3]);
      is_inside = whole > 0 ? part >= 0 : part <= 0;
      expected.weights[i] = static_cast<double>(part) / static_cast<double>(whole);
    }
    if (is_inside) return expected;
  }
  return {};
}

/// A point in or near the cube; often a vertex, or on an edge or a face of a tetrahedron.
Vertex random_point(const TetrahedralGrid& grid, Random& random) {
  const auto& one = grid.tetrahedra[random.below(static_cast<uint32_t>(grid.tetrahedra.size()))];
  const Vertex& a = grid.vertices[one.vertex[random.below(4)]];
  const Vertex& b = grid.vertices[one.vertex[random.below(4)]];
  const Vertex& c = grid.vertices[one.vertex[random.below(4)]];
  Vertex point{};
  switch (random.below(5)) {
    case 0:
      return a;
    case 1:  // where the middle is no whole number, just beside the edge
      for (int axis = 0; axis < 3; ++axis) point.at[axis] = (a.at[axis] + b.at[axis]) / 2;
      return point;
    case 2:
      for (int axis = 0; axis < 3; ++axis) {
        point.at[axis] = a.at[axis] / 2 + (b.at[axis] + c.at[axis]) / 4;
      }
      return point;
    default:
      for (int32_t& at : point.at) at = random.between(-grid.extent / 8, grid.extent * 9 / 8);
      return point;
  }
}

std::vector<float> coordinates_of(const std::vector<Vertex>& points, float scale) {
  std::vector<float> floats;
  for (const Vertex& point : points) {
    for (const int32_t at : point.at) floats.push_back(static_cast<float>(at) * scale);
  }
  return floats;
}

void expect_location(const Location& location, const Expected& expected, const char* what) {
  ASSERT_EQ(location.tetrahedron_id, expected.id) << what;
  for (int i = 0; i < 4; ++i) {
    const double weight = expected.weights[i];
    ASSERT_NEAR(static_cast<double>(location.weights[i]), weight, 0x1p-22 * weight) << what;
  }
}

// ---------------------------------------------------------------- tests

void shuffle(std::vector<TetrahedralGrid::Tetrahedron>& all, Random& random) {
  for (size_t i = all.size(); i > 1; --i) {
    std::swap(all[i - 1], all[random.below(static_cast<uint32_t>(i))]);
  }
}

TEST(Tetrahedra, AreThoseThatContainThePoints) {
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed(), 700);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 2);
  struct Case {
    int32_t cell_size, jitter;
    float scale;
  };
  // Even grids, where points lie on faces and edges; uneven ones, with volumes that doubles do not
  // hold; huge and tiny ones.
  for (const Case each : {Case{64, 0, 1.0f}, Case{1 << 21, 150000, 0x1p-10f}, Case{8, 0, 0x1p53f},
                          Case{1 << 21, 200000, 0x1p-145f}}) {
    TetrahedralGrid grid = kuhn_grid(6, each.cell_size, each.jitter, random);
    shuffle(grid.tetrahedra, random);
    std::vector<Vertex> points(std::max<uint64_t>(200, ray_budget(700)));
    for (Vertex& point : points) point = random_point(grid, random);
    std::vector<Expected> expected;
    size_t found = 0;
    for (const Vertex& point : points) {
      expected.push_back(expected_at(grid, point));
      found += expected.back().id != KIWAMI_INVALID_ID ? 1 : 0;
    }
    EXPECT_GT(found, points.size() / 3);
    EXPECT_LT(found, points.size());
    const std::vector<float> vertices = grid.coordinates(each.scale);
    for (const uint32_t method : kMethods) {
      const Handle tetrahedra = make(device, describe(vertices, grid.tetrahedra, method));
      EXPECT_EQ(info_of(tetrahedra).skipped_count, 0u);
      const std::vector<Location> locations =
          locate(tetrahedra, coordinates_of(points, each.scale));
      for (size_t i = 0; i < points.size(); ++i) {
        expect_location(locations[i], expected[i], method == 0 ? "boxes" : "faces");
      }
    }
  }
}

TEST(Tetrahedra, AreTheSameToTheBitOnEveryIsaAndForAnyThreads) {
  Random random(seed(), 701);
  const TetrahedralGrid grid = kuhn_grid(8, 1 << 16, 5000, random);
  const std::vector<float> vertices = grid.coordinates(0x1p-9f);
  std::vector<Vertex> points(std::max<uint64_t>(9000, ray_budget(20000)));
  for (Vertex& point : points) point = random_point(grid, random);
  const std::vector<float> floats = coordinates_of(points, 0x1p-9f);
  std::vector<Location> expected;
  for (const uint32_t isa : available_isas()) {
    for (const uint32_t threads : {1u, 3u}) {
      const DeviceHandle device = make_device(isa, threads);
      for (const uint32_t method : kMethods) {
        const std::vector<Location> locations =
            locate(make(device, describe(vertices, grid.tetrahedra, method)), floats);
        if (expected.empty()) expected = locations;
        EXPECT_EQ(
            std::memcmp(locations.data(), expected.data(), expected.size() * sizeof(Location)), 0)
            << kiwami_isa_name(isa) << ", method " << method;
      }
    }
  }
}

TEST(Tetrahedra, WithoutVolumeOrOfBadVerticesContainNothing) {
  Random random(seed(), 702);
  TetrahedralGrid grid = kuhn_grid(3, 1024, 0, random);
  std::vector<float> vertices = grid.coordinates(1.0f);
  const auto number = [](size_t count) { return static_cast<uint32_t>(count); };
  const uint32_t first_bad = number(vertices.size() / 3);
  const float infinity = std::numeric_limits<float>::infinity();
  vertices.insert(vertices.end(), {std::nanf(""), 0, 0, 0, infinity, 0, 0, 0, 0x1p61f});
  const size_t good = grid.tetrahedra.size();
  // In front of the others, so that all have other numbers.
  std::vector<TetrahedralGrid::Tetrahedron> all = {{{0, 1, 2, first_bad}},
                                                   {{0, first_bad + 1, 2, 3}},
                                                   {{first_bad + 2, 1, 5, 3}},
                                                   {{0, 1, 2, 2}},
                                                   {{0, 1, 2, 3}}};  // a line
  const size_t bad = all.size();
  for (const auto& one : grid.tetrahedra) {
    all.push_back({{one.vertex[0], one.vertex[1], one.vertex[3], one.vertex[2]}});
  }
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  std::vector<Vertex> points(200);
  for (Vertex& point : points) point = random_point(grid, random);
  for (const uint32_t method : kMethods) {
    const Handle tetrahedra = make(device, describe(vertices, all, method));
    const kiwami_tetrahedra_info info = info_of(tetrahedra);
    EXPECT_EQ(info.tetrahedron_count, all.size());
    EXPECT_EQ(info.skipped_count, bad);
    EXPECT_EQ(info.inverted_count, good);
    EXPECT_EQ(info.crowded_face_count, 0u);
    if (method == KIWAMI_TETRAHEDRA_FACES) {
      EXPECT_EQ(info.boundary_face_count, 6u * 9u * 2u);
      EXPECT_EQ(info.face_count, (4 * good + info.boundary_face_count) / 2);
    }
    const std::vector<Location> locations = locate(tetrahedra, coordinates_of(points, 1.0f));
    for (size_t i = 0; i < points.size(); ++i) {
      Expected expected = expected_at(grid, points[i]);
      std::swap(expected.weights[2], expected.weights[3]);
      if (expected.id != KIWAMI_INVALID_ID) expected.id += number(bad);
      expect_location(locations[i], expected, "behind the bad ones");
    }
    for (const float value : {std::nanf(""), infinity, -infinity, 3e38f}) {
      for (size_t axis = 0; axis < 3; ++axis) {
        std::vector<float> point(3, 1000.0f);
        point[axis] = value;
        const Location nowhere = locate(tetrahedra, point)[0];
        EXPECT_EQ(nowhere.tetrahedron_id, KIWAMI_INVALID_ID);
        for (const float weight : nowhere.weights) EXPECT_EQ(weight, 0.0f);
      }
    }
  }
}

TEST(Tetrahedra, ThatOverlapContainThePointAllTheSame) {
  // A soup, flipped at random, with the same tetrahedron several times.
  Random random(seed(), 703);
  TetrahedralGrid soup;
  soup.extent = 1 << 16;
  for (uint32_t i = 0; i < 400; ++i) {
    if (i % 10 == 9) {
      soup.tetrahedra.push_back(soup.tetrahedra.back());
      continue;
    }
    TetrahedralGrid::Tetrahedron one{};
    for (uint32_t& vertex : one.vertex) {
      vertex = static_cast<uint32_t>(soup.vertices.size());
      Vertex at{};
      for (int32_t& along : at.at) along = random.between(0, soup.extent);
      soup.vertices.push_back(at);
    }
    soup.tetrahedra.push_back(one);
  }
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  for (const uint32_t method : kMethods) {
    const std::vector<float> vertices = soup.coordinates(1.0f);
    const Handle tetrahedra = make(device, describe(vertices, soup.tetrahedra, method));
    if (method == KIWAMI_TETRAHEDRA_FACES) {
      EXPECT_EQ(info_of(tetrahedra).crowded_face_count, 4u * 40u);
    }
    std::vector<Vertex> points(500);
    for (Vertex& point : points) point = random_point(soup, random);
    const std::vector<Location> locations = locate(tetrahedra, coordinates_of(points, 1.0f));
    for (size_t i = 0; i < points.size(); ++i) {
      const Expected lowest = expected_at(soup, points[i]);
      if (lowest.id == KIWAMI_INVALID_ID) {
        EXPECT_EQ(locations[i].tetrahedron_id, KIWAMI_INVALID_ID);
        continue;
      }
      ASSERT_NE(locations[i].tetrahedron_id, KIWAMI_INVALID_ID);
      TetrahedralGrid alone = soup;
      alone.tetrahedra = {soup.tetrahedra[locations[i].tetrahedron_id]};
      EXPECT_EQ(expected_at(alone, points[i]).id, 0u) << "it does not contain the point";
    }
  }
}

TEST(Tetrahedra, NoneAndOneAreMeshes) {
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const std::vector<float> vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (const uint32_t method : kMethods) {
    const Handle none = make(device, describe({}, {}, method));
    EXPECT_EQ(locate(none, {0.0f, 0.0f, 0.0f})[0].tetrahedron_id, KIWAMI_INVALID_ID);
    const Handle one = make(device, describe(vertices, {{{0, 1, 2, 3}}}, method));
    const Location inside = locate(one, {0.25f, 0.5f, 0.125f})[0];
    EXPECT_EQ(inside.tetrahedron_id, 0u);
    EXPECT_EQ(inside.weights[0], 0.125f);
    EXPECT_EQ(inside.weights[1], 0.25f);
    EXPECT_EQ(inside.weights[2], 0.5f);
    EXPECT_EQ(inside.weights[3], 0.125f);
    EXPECT_EQ(locate(one, {0.5f, 0.5f, 0.0f})[0].tetrahedron_id, 0u);
    EXPECT_EQ(locate(one, {0.5f, std::nextafter(0.5f, 1.0f), 0.0f})[0].tetrahedron_id,
              KIWAMI_INVALID_ID);
    EXPECT_EQ(info_of(one).method, method);
    EXPECT_GT(info_of(one).bytes, 0u);
  }
}

TEST(Tetrahedra, MayLieAtAnyAddressAndStride) {
  Random random(seed(), 704);
  const TetrahedralGrid grid = kuhn_grid(3, 512, 40, random);
  const std::vector<float> vertices = grid.coordinates(1.0f);
  std::vector<unsigned char> loose_vertices(1 + vertices.size() / 3 * 17);
  for (size_t i = 0; i < vertices.size() / 3; ++i) {
    std::memcpy(&loose_vertices[1 + 17 * i], &vertices[3 * i], 12);
  }
  std::vector<unsigned char> loose_indices(1 + grid.tetrahedra.size() * 21);
  for (size_t i = 0; i < grid.tetrahedra.size(); ++i) {
    std::memcpy(&loose_indices[1 + 21 * i], &grid.tetrahedra[i], 16);
  }
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  kiwami_tetrahedra_desc desc = describe(vertices, grid.tetrahedra, 0);
  const Handle packed = make(device, desc);
  desc.vertices = &loose_vertices[1];
  desc.vertex_stride = 17;
  desc.indices = &loose_indices[1];
  desc.index_stride = 21;
  const Handle loose = make(device, desc);
  std::vector<Vertex> points(300);
  for (Vertex& point : points) point = random_point(grid, random);
  const std::vector<float> floats = coordinates_of(points, 1.0f);
  const std::vector<Location> expected = locate(packed, floats);
  std::vector<unsigned char> loose_points(1 + points.size() * 13);
  for (size_t i = 0; i < points.size(); ++i) {
    std::memcpy(&loose_points[1 + 13 * i], &floats[3 * i], 12);
  }
  std::vector<unsigned char> answers(1 + points.size() * 23);
  check(kiwami_tetrahedra_locate(loose.get(), &loose_points[1], 13,
                                 reinterpret_cast<Location*>(&answers[1]), 23, points.size()));
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(std::memcmp(&answers[1 + 23 * i], &expected[i], sizeof(Location)), 0) << i;
  }
}

void expect_error(kiwami_result result, kiwami_result expected, const char* part) {
  EXPECT_EQ(result, expected) << part;
  char sentence[512];
  kiwami_last_error(nullptr, sentence, sizeof sentence);
  EXPECT_NE(std::strstr(sentence, part), nullptr) << sentence;
}

TEST(Tetrahedra, BadInputIsRefused) {
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const std::vector<float> vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<TetrahedralGrid::Tetrahedron> one = {{{0, 1, 2, 3}}, {{3, 1, 4, 0}}};
  kiwami_tetrahedra* handle = nullptr;
  const auto create = [&](const kiwami_tetrahedra_desc& desc) {
    const kiwami_result result = kiwami_tetrahedra_create(device.get(), &desc, &handle);
    EXPECT_EQ(handle, nullptr);
    return result;
  };
  const kiwami_tetrahedra_desc good = describe(vertices, one, 0);
  expect_error(create(good), KIWAMI_ERROR_INVALID_ARGUMENT, "index 2 of tetrahedron 1 is 4");
  kiwami_tetrahedra_desc desc = good;
  desc.method = 2;
  expect_error(create(desc), KIWAMI_ERROR_INVALID_ARGUMENT, "desc.method is 2");
  desc = good;
  desc.vertices = nullptr;
  expect_error(create(desc), KIWAMI_ERROR_INVALID_ARGUMENT, "desc.vertices is NULL");
  desc = good;
  desc.indices = nullptr;
  expect_error(create(desc), KIWAMI_ERROR_INVALID_ARGUMENT, "desc.indices is NULL");
  desc = good;
  desc.index_stride = 15;
  expect_error(create(desc), KIWAMI_ERROR_INVALID_ARGUMENT, "the stride of desc.indices is 15");
  desc = good;
  desc.tetrahedron_count = (uint64_t{1} << 28) + 1;
  expect_error(create(desc), KIWAMI_ERROR_TOO_LARGE, "desc.tetrahedron_count");
  desc = good;
  desc.vertex_count = 0xFFFFFFFF;
  expect_error(create(desc), KIWAMI_ERROR_TOO_LARGE, "desc.vertex_count");
  expect_error(kiwami_tetrahedra_create(nullptr, &good, &handle), KIWAMI_ERROR_INVALID_ARGUMENT,
               "device is NULL");
  expect_error(kiwami_tetrahedra_create(device.get(), nullptr, &handle),
               KIWAMI_ERROR_INVALID_ARGUMENT, "desc is NULL");
  expect_error(kiwami_tetrahedra_create(device.get(), &good, nullptr),
               KIWAMI_ERROR_INVALID_ARGUMENT, "tetrahedra is NULL");
  expect_error(kiwami_tetrahedra_locate(nullptr, vertices.data(), 0, nullptr, 0, 1),
               KIWAMI_ERROR_INVALID_ARGUMENT, "tetrahedra is NULL");
  expect_error(kiwami_tetrahedra_get_info(nullptr, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT,
               "tetrahedra is NULL");
  kiwami_tetrahedra_retain(nullptr);
  kiwami_tetrahedra_release(nullptr);
}

TEST(Tetrahedra, ArgumentsAreCheckedWhereTheDeviceIsToldTo) {
  kiwami_device_desc device_desc;
  check(kiwami_device_desc_init(&device_desc, sizeof device_desc));
  device_desc.flags = KIWAMI_DEVICE_VALIDATE;
  kiwami_device* device = nullptr;
  check(kiwami_device_create(&device_desc, &device));
  const DeviceHandle owner(device);
  const std::vector<float> vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const Handle tetrahedra = make(owner, describe(vertices, {{{0, 1, 2, 3}}}, 0));
  Location location;
  expect_error(kiwami_tetrahedra_locate(tetrahedra.get(), nullptr, 0, &location, 0, 1),
               KIWAMI_ERROR_INVALID_ARGUMENT, "points is NULL");
  expect_error(kiwami_tetrahedra_locate(tetrahedra.get(), vertices.data(), 0, &location, 8, 1),
               KIWAMI_ERROR_INVALID_ARGUMENT, "the stride of locations is 8");
  EXPECT_EQ(kiwami_tetrahedra_locate(tetrahedra.get(), nullptr, 0, nullptr, 0, 0), KIWAMI_OK);
}

}  // namespace
}  // namespace kiwami_tests

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <kiwami/kiwami.hpp>
#include <string>
#include <vector>

/// Notes that a feature was found right, for the table of the documents.
inline void note(const char* feature) {
  const char* const path = std::getenv("KIWAMI_FEATURES");
  if (path && !testing::Test::HasFailure()) std::ofstream(path, std::ios::app) << feature << '\n';
}

/// Words of the conformance vectors, one after the other.
class Words {
 public:
  explicit Words(const std::string& file)
      : file_(std::string(KIWAMI_VECTORS_FOLDER "/") + file + ".txt") {
    EXPECT_EQ(word(), "kiwami-conformance");
    EXPECT_EQ(word(), "1");
  }
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

inline constexpr std::array<kiwami::Vertex, 3> kCorners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
inline constexpr kiwami::Triangle kTriangle{0, 1, 2};

inline kiwami::Ray ray_at(float x, float y) { return {x, y, -1, 0, 0, 0, 1, 1e30f, 0, ~0u, 0, 0}; }

/// Of kCorners.
inline kiwami::Scene scene_of_one_triangle(const kiwami::Device& device) {
  kiwami::Scene scene(device);
  scene.attach(kiwami::Mesh(device, kCorners, std::span(&kTriangle, 1)));
  scene.commit();
  return scene;
}

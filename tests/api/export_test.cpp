// SPDX-License-Identifier: Apache-2.0
// Exported trees, read by decoders that know only what the header says: boxes around all below, and
// the answers of the library found again by walking them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "api/api_support.h"
#include "support/mesh.h"
#include "support/plain_oracle.h"
#include "support/random.h"

namespace kiwami_api_tests {
namespace {

using kiwami_tests::PlainOracle;
using kiwami_tests::Point;
using kiwami_tests::Random;

/// A child as a decoder reads it: its box, and a node or a run of primitives.
struct Decoded {
  double lower[3], upper[3];
  bool is_leaf;
  uint32_t first;  ///< the number of a node, or of the first primitive
  uint32_t count;
};

/// An exported tree behind a decoder.
struct Exported {
  std::vector<unsigned char> nodes;
  std::vector<kiwami_bvh_primitive> primitives;
  std::vector<Decoded> (*children_of)(const Exported& tree, uint32_t node);

  template <typename Node>
  Node node(uint32_t index) const {
    Node read;
    EXPECT_LE((index + 1) * sizeof read, nodes.size());
    std::memcpy(&read, nodes.data() + index * sizeof read, sizeof read);
    return read;
  }
};

Decoded decode_binary_node(const kiwami_binary_node& node, uint32_t number) {
  Decoded decoded{};
  for (int axis = 0; axis < 3; ++axis) {
    decoded.lower[axis] = node.lower[axis];
    decoded.upper[axis] = node.upper[axis];
  }
  decoded.is_leaf = node.count != 0;
  decoded.first = decoded.is_leaf ? node.first : number;
  decoded.count = node.count;
  return decoded;
}

std::vector<Decoded> decode_binary(const Exported& tree, uint32_t index) {
  const auto node = tree.node<kiwami_binary_node>(index);
  if (node.count != 0) return {decode_binary_node(node, index)};  // a root that is a leaf
  return {decode_binary_node(tree.node<kiwami_binary_node>(node.first), node.first),
          decode_binary_node(tree.node<kiwami_binary_node>(node.first + 1), node.first + 1)};
}

template <typename Node>
std::vector<Decoded> decode_wide(const Exported& tree, uint32_t index) {
  const Node node = tree.node<Node>(index);
  std::vector<Decoded> children;
  for (size_t i = 0; i < std::size(node.child); ++i) {
    if (node.child[i] == KIWAMI_INVALID_ID) {
      EXPECT_EQ(node.lower_x[i], kInfinity);
      EXPECT_EQ(node.upper_z[i], -kInfinity);
      continue;
    }
    children.push_back({{node.lower_x[i], node.lower_y[i], node.lower_z[i]},
                        {node.upper_x[i], node.upper_y[i], node.upper_z[i]},
                        node.count[i] != 0,
                        node.child[i],
                        node.count[i]});
  }
  return children;
}

float step_of(uint8_t exponent) {
  const uint32_t bits = uint32_t{exponent} << 23;
  float step;
  std::memcpy(&step, &bits, sizeof step);
  return step;
}

/// The same bound in floats, as a tracer would have it.
float decode_float(float origin, uint8_t steps, float step) {
  return origin + static_cast<float>(steps) * step;
}

std::vector<Decoded> decode_compressed(const Exported& tree, uint32_t index) {
  const auto node = tree.node<kiwami_compressed8_node>(index);
  const uint8_t* lower[3] = {node.lower_x, node.lower_y, node.lower_z};
  const uint8_t* upper[3] = {node.upper_x, node.upper_y, node.upper_z};
  std::vector<Decoded> children;
  for (uint32_t i = 0; i < 8; ++i) {
    if (node.meta[i] == 0) continue;
    Decoded child{};
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(node.exponent[axis], 1);
      const float step = step_of(node.exponent[axis]);
      child.lower[axis] = decode_float(node.origin[axis], lower[axis][i], step);
      child.upper[axis] = decode_float(node.origin[axis], upper[axis][i], step);
    }
    child.is_leaf = (node.inner_mask >> i & 1) == 0;
    if (child.is_leaf) {
      child.count = static_cast<uint32_t>(__builtin_popcount(node.meta[i] >> 5));
      EXPECT_EQ(node.meta[i] >> 5, (1 << child.count) - 1);
      child.first = node.primitive_base + (node.meta[i] & 31u);
    } else {
      EXPECT_EQ(node.meta[i], 0x20u + 24 + i);
      const uint32_t before = node.inner_mask & ((1u << i) - 1);
      child.first = node.child_base + static_cast<uint32_t>(__builtin_popcount(before));
    }
    children.push_back(child);
  }
  return children;
}

struct Format {
  const char* name;
  uint32_t number, width;
  double leaf_size;
  size_t node_size;
  std::vector<Decoded> (*children_of)(const Exported& tree, uint32_t node);
};

const Format kFormats[] = {
    {"binary", KIWAMI_EXPORT_BINARY, 2, 2, 32, decode_binary},
    {"wide 4", KIWAMI_EXPORT_WIDE4, 4, 0, 128, decode_wide<kiwami_wide4_node>},
    {"wide 8", KIWAMI_EXPORT_WIDE8, 8, 0, 256, decode_wide<kiwami_wide8_node>},
    {"compressed 8", KIWAMI_EXPORT_COMPRESSED8, 8, 3, 80, decode_compressed},
    {"binary in wide 4", KIWAMI_EXPORT_WIDE4, 2, 1, 128, decode_wide<kiwami_wide4_node>},
    {"binary in compressed 8", KIWAMI_EXPORT_COMPRESSED8, 2, 3, 80, decode_compressed}};

/// A tree over a mesh, in its format.
Exported export_mesh(const Device& device, const Geometry& mesh, const Format& format) {
  const kiwami_parameter_value leaf_size = {KIWAMI_PARAMETER_MAX_LEAF_SIZE, 0, format.leaf_size};
  kiwami_bvh_desc desc;
  EXPECT_EQ(kiwami_bvh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.geometry = mesh.get();
  desc.width = format.width;
  desc.parameters = &leaf_size;
  desc.parameter_count = 1;
  kiwami_bvh* made = nullptr;
  EXPECT_EQ(kiwami_bvh_build(device.get(), &desc, &made), KIWAMI_OK) << last_error();
  const Bvh bvh(made);
  size_t node_count = 0, primitive_count = 0;
  EXPECT_EQ(kiwami_bvh_export_counts(bvh.get(), format.number, &node_count, &primitive_count),
            KIWAMI_OK)
      << last_error();
  Exported exported{std::vector<unsigned char>(node_count * format.node_size),
                    std::vector<kiwami_bvh_primitive>(primitive_count), format.children_of};
  EXPECT_EQ(kiwami_bvh_export(bvh.get(), format.number, exported.nodes.data(),
                              exported.nodes.size(), exported.primitives.data(), primitive_count),
            KIWAMI_OK)
      << last_error();
  return exported;
}

Point corner(const Triangles& mesh, uint32_t primitive, uint32_t k) {
  const float* at = &mesh.vertices[3 * mesh.indices[3 * primitive + k]];
  return {at[0], at[1], at[2]};
}

struct Box {
  Point lower = {kInfinity, kInfinity, kInfinity};
  Point upper = {-kInfinity, -kInfinity, -kInfinity};

  void extend(Point at) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], at[axis]);
      upper[axis] = std::max(upper[axis], at[axis]);
    }
  }
};

/// Walks all of a tree; checks each box against the triangles below, and counts those. Returns
/// them.
std::vector<uint32_t> check_below(const Exported& tree, const Decoded& child, const Triangles& mesh,
                                  std::vector<uint32_t>& visited) {
  std::vector<uint32_t> below;
  if (child.is_leaf) {
    for (uint32_t i = 0; i < child.count; ++i) {
      below.push_back(tree.primitives.at(child.first + i).primitive_id);
    }
  } else {
    ++visited.at(child.first);
    for (const Decoded& next : tree.children_of(tree, child.first)) {
      const std::vector<uint32_t> more = check_below(tree, next, mesh, visited);
      below.insert(below.end(), more.begin(), more.end());
    }
  }
  for (const uint32_t primitive : below) {
    for (uint32_t k = 0; k < 3; ++k) {
      const Point at = corner(mesh, primitive, k);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(child.lower[axis], at[axis]);
        EXPECT_GE(child.upper[axis], at[axis]);
      }
    }
  }
  return below;
}

/// Whether a ray may meet a box, with some room for rounding.
bool may_meet(const kiwami_ray& ray, const Decoded& box) {
  const double origin[3] = {ray.origin_x, ray.origin_y, ray.origin_z};
  const double direction[3] = {ray.direction_x, ray.direction_y, ray.direction_z};
  double near = ray.tmin, far = ray.tmax;
  for (int axis = 0; axis < 3; ++axis) {
    double enter = (box.lower[axis] - 1e-5 - origin[axis]) / direction[axis];
    double leave = (box.upper[axis] + 1e-5 - origin[axis]) / direction[axis];
    if (direction[axis] < 0) std::swap(enter, leave);
    near = std::fmax(near, enter);
    far = std::fmin(far, leave);
  }
  return near <= far * (1 + 1e-6);
}

void collect_candidates(const Exported& tree, const kiwami_ray& ray, const Decoded& child,
                        std::vector<uint32_t>& candidates) {
  if (!may_meet(ray, child)) return;
  if (child.is_leaf) {
    for (uint32_t i = 0; i < child.count; ++i) {
      candidates.push_back(tree.primitives[child.first + i].primitive_id);
    }
    return;
  }
  for (const Decoded& next : tree.children_of(tree, child.first)) {
    collect_candidates(tree, ray, next, candidates);
  }
}

/// The closest hit among the triangles that the walk of a tree reaches.
kiwami_hit trace(const Exported& tree, const kiwami_ray& ray, const Triangles& mesh) {
  std::vector<uint32_t> candidates;
  for (const Decoded& child : tree.children_of(tree, 0)) {
    collect_candidates(tree, ray, child, candidates);
  }
  std::sort(candidates.begin(), candidates.end());
  kiwami_tests::Scene scene;
  scene.meshes.emplace_back();
  for (const uint32_t primitive : candidates) {
    scene.meshes[0].add(corner(mesh, primitive, 0), corner(mesh, primitive, 1),
                        corner(mesh, primitive, 2));
  }
  kiwami_hit hit = PlainOracle(scene).closest_hit(ray);
  if (hit.primitive_id != KIWAMI_INVALID_ID) hit.primitive_id = candidates[hit.primitive_id];
  return hit;
}

/// Rays of no special direction.
std::vector<kiwami_ray> oblique_rays(size_t count) {
  std::vector<kiwami_ray> rays = random_rays(count, 51);
  for (kiwami_ray& ray : rays) {
    if (ray.direction_x == 0) ray.direction_x = 0.5f;
    if (ray.direction_y == 0) ray.direction_y = 0.5f;
    if (ray.direction_z == 0) ray.direction_z = 0.5f;
  }
  return rays;
}

class ExportTest : public testing::Test {
 protected:
  ExportTest() : device_(make_device()) {}

  /// A mesh whose coordinates are scaled and moved.
  Triangles placed(uint32_t count, float scale, float by) {
    Triangles mesh = random_triangles(count, 52);
    for (float& coordinate : mesh.vertices) coordinate = coordinate * scale + by;
    return mesh;
  }

  Device device_;
};

TEST_F(ExportTest, DecodedTreesGiveTheLibrarysHits) {
  const Triangles mesh = random_triangles(700, 53);
  const Geometry geometry = make_mesh(device_, mesh.desc());
  const std::vector<kiwami_ray> rays = oblique_rays(400);
  const std::vector<kiwami_hit> expected = closest_hits(make_scene(device_, geometry), rays);
  EXPECT_GT(std::count_if(expected.begin(), expected.end(),
                          [](const kiwami_hit& hit) { return hit.t < kInfinity; }),
            100);
  for (const Format& format : kFormats) {
    const Exported tree = export_mesh(device_, geometry, format);
    std::vector<kiwami_hit> hits;
    hits.reserve(rays.size());
    for (const kiwami_ray& ray : rays) hits.push_back(trace(tree, ray, mesh));
    EXPECT_TRUE(are_equal(hits, expected)) << format.name;
  }
}

TEST_F(ExportTest, BoxesContainAllThatIsBelowThem) {
  const Triangles meshes[] = {
      placed(600, 1, 0),       placed(300, 1e-3f, 1000), placed(300, 1e12f, -3e11f),
      placed(300, 1e-30f, 0),  placed(200, 1e-41f, 0),   placed(100, 0, 7),
      placed(100, 0x1p59f, 0), placed(1, 1, 0),          placed(2, 1, 0)};
  for (const Triangles& mesh : meshes) {
    const Geometry geometry = make_mesh(device_, mesh.desc());
    for (const Format& format : kFormats) {
      const Exported tree = export_mesh(device_, geometry, format);
      std::vector<uint32_t> visited(tree.nodes.size() / format.node_size);
      std::vector<uint32_t> below;
      ++visited[0];
      for (const Decoded& child : tree.children_of(tree, 0)) {
        const std::vector<uint32_t> more = check_below(tree, child, mesh, visited);
        below.insert(below.end(), more.begin(), more.end());
      }
      std::sort(below.begin(), below.end());
      ASSERT_EQ(below.size(), mesh.indices.size() / 3) << format.name;
      for (uint32_t i = 0; i < below.size(); ++i) EXPECT_EQ(below[i], i);
      if (format.number == KIWAMI_EXPORT_BINARY) continue;
      // Each node once, and no other.
      for (const uint32_t times : visited) EXPECT_EQ(times, 1u) << format.name;
    }
  }
}

/// Checks the bounds of a compressed node in real numbers: around the exact box of each child, less
/// than a step away from it, with the least steps that reach over the node. Returns the exact box.
Box check_steps(const Exported& tree, uint32_t index, const Triangles& mesh) {
  const auto node = tree.node<kiwami_compressed8_node>(index);
  const uint8_t* lower[3] = {node.lower_x, node.lower_y, node.lower_z};
  const uint8_t* upper[3] = {node.upper_x, node.upper_y, node.upper_z};
  Box whole;
  uint32_t inner = node.child_base;
  for (uint32_t i = 0; i < 8; ++i) {
    if (node.meta[i] == 0) {
      EXPECT_EQ(node.lower_x[i], 255);
      EXPECT_EQ(node.upper_z[i], 0);
      continue;
    }
    Box box;
    if (node.inner_mask >> i & 1) {
      box = check_steps(tree, inner++, mesh);
    } else {
      const uint32_t first = node.primitive_base + (node.meta[i] & 31u);
      for (uint32_t k = 0; k < static_cast<uint32_t>(__builtin_popcount(node.meta[i] >> 5)); ++k) {
        for (uint32_t c = 0; c < 3; ++c) {
          box.extend(corner(mesh, tree.primitives.at(first + k).primitive_id, c));
        }
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      const long double step = step_of(node.exponent[axis]);
      const long double low = node.origin[axis] + lower[axis][i] * step;
      const long double high = node.origin[axis] + upper[axis][i] * step;
      EXPECT_LE(low, box.lower[axis]);
      EXPECT_GT(low, box.lower[axis] - step);
      EXPECT_GE(high, box.upper[axis]);
      EXPECT_LT(high, box.upper[axis] + step);
    }
    whole.extend(box.lower);
    whole.extend(box.upper);
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(node.origin[axis], whole.lower[axis]);
    const long double extent =
        static_cast<long double>(whole.upper[axis]) - static_cast<long double>(whole.lower[axis]);
    EXPECT_GT(extent, 127 * static_cast<long double>(step_of(node.exponent[axis])));
  }
  return whole;
}

TEST_F(ExportTest, CompressedBoxesAreRoundedOutwardsAndLessThanAStep) {
  for (const Triangles& mesh : {placed(500, 1, 0), placed(500, 1e-3f, 1000), placed(9, 5, -2)}) {
    check_steps(export_mesh(device_, make_mesh(device_, mesh.desc()), kFormats[3]), 0, mesh);
  }
}

TEST_F(ExportTest, SlotsAreInTheOrderOfOctants) {
  // Eight triangles at the corners of a cube: for each octant, the order is by distance.
  Triangles mesh;
  for (uint32_t i = 0; i < 8; ++i) {
    const float x = i & 4 ? 10 : 0, y = i & 2 ? 10 : 0, z = i & 1 ? 10 : 0;
    mesh.vertices.insert(mesh.vertices.end(), {x, y, z, x + 1, y, z + 1, x, y + 1, z});
    mesh.indices.insert(mesh.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
  }
  const Format single = {"", KIWAMI_EXPORT_COMPRESSED8, 8, 1, 80, decode_compressed};
  const Exported tree = export_mesh(device_, make_mesh(device_, mesh.desc()), single);
  const auto root = tree.node<kiwami_compressed8_node>(0);
  ASSERT_EQ(tree.nodes.size(), 80u);
  for (uint32_t slot = 0; slot < 8; ++slot) {
    // Along (+, +, +) the corner (0, 0, 0) comes first, in slot 0; along (-, +, +) that at x = 10,
    // in slot 4.
    const uint32_t primitive = root.primitive_base + (root.meta[slot] & 31u);
    EXPECT_EQ(tree.primitives[primitive].primitive_id, slot);
  }
}

TEST_F(ExportTest, TreesOfScenesAndOfNothing) {
  const Triangles mesh = random_triangles(500, 54);
  const Scene scene = make_scene(device_);
  const Geometry geometry = make_mesh(device_, mesh.desc());
  ASSERT_EQ(kiwami_scene_attach(scene.get(), geometry.get(), nullptr), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BVH_WIDTH, 8), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  const Bvh bvh = bvh_of(scene);
  size_t nodes = 0, primitives = 0;
  ASSERT_EQ(kiwami_bvh_export_counts(bvh.get(), KIWAMI_EXPORT_WIDE8, &nodes, &primitives),
            KIWAMI_OK);
  Exported tree{std::vector<unsigned char>(nodes * 256),
                std::vector<kiwami_bvh_primitive>(primitives), decode_wide<kiwami_wide8_node>};
  ASSERT_EQ(kiwami_bvh_export(bvh.get(), KIWAMI_EXPORT_WIDE8, tree.nodes.data(), nodes * 256,
                              tree.primitives.data(), primitives),
            KIWAMI_OK);
  std::vector<uint32_t> visited(nodes);
  size_t below = 0;
  for (const Decoded& child : tree.children_of(tree, 0)) {
    below += check_below(tree, child, mesh, visited).size();
  }
  EXPECT_EQ(below, 500u);

  const Bvh nothing = bvh_of(make_scene(device_, make_mesh(device_, Triangles{}.desc())));
  for (uint32_t format = 1; format <= 4; ++format) {
    ASSERT_EQ(kiwami_bvh_export_counts(nothing.get(), format, &nodes, &primitives), KIWAMI_OK);
    EXPECT_EQ(nodes, 0u);
    EXPECT_EQ(primitives, 0u);
    EXPECT_EQ(kiwami_bvh_export(nothing.get(), format, nullptr, 0, nullptr, 0), KIWAMI_OK);
  }
}

TEST_F(ExportTest, BadArguments) {
  kiwami_bvh_desc desc;
  ASSERT_EQ(kiwami_bvh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  const Geometry geometry = make_mesh(device_, random_triangles(200, 55).desc());
  desc.geometry = geometry.get();
  desc.width = 16;
  kiwami_bvh* made = nullptr;
  ASSERT_EQ(kiwami_bvh_build(device_.get(), &desc, &made), KIWAMI_OK);
  const Bvh wide(made);
  for (uint32_t format = 1; format <= 4; ++format) {
    EXPECT_EQ(kiwami_bvh_export_counts(wide.get(), format, nullptr, nullptr),
              KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_NE(last_error().find(" children, expected "), std::string::npos) << last_error();
  }
  desc.width = 8;
  ASSERT_EQ(kiwami_bvh_build(device_.get(), &desc, &made), KIWAMI_OK);
  const Bvh bvh(made);
  EXPECT_EQ(kiwami_bvh_export_counts(bvh.get(), KIWAMI_EXPORT_COMPRESSED8, nullptr, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error().find("expected at most 3 for format 4"), std::string::npos);
  for (const uint32_t format : {0u, 5u}) {
    EXPECT_EQ(kiwami_bvh_export_counts(bvh.get(), format, nullptr, nullptr),
              KIWAMI_ERROR_INVALID_ARGUMENT);
  }
  EXPECT_EQ(last_error(device_.get()), "format is 5, expected one of KIWAMI_EXPORT_*");
  size_t nodes = 0, primitives = 0;
  ASSERT_EQ(kiwami_bvh_export_counts(bvh.get(), KIWAMI_EXPORT_WIDE8, &nodes, &primitives),
            KIWAMI_OK);
  std::vector<kiwami_wide8_node> to(nodes);
  std::vector<kiwami_bvh_primitive> names(primitives);
  const size_t bytes = nodes * sizeof to[0];
  const auto write = [&](void* data, size_t room, kiwami_bvh_primitive* list, size_t count) {
    return kiwami_bvh_export(bvh.get(), KIWAMI_EXPORT_WIDE8, data, room, list, count);
  };
  EXPECT_EQ(write(to.data(), bytes, names.data(), primitives), KIWAMI_OK);
  EXPECT_EQ(write(to.data(), bytes - 1, names.data(), primitives), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(write(to.data(), bytes, names.data(), primitives - 1), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()), "primitive_count is 199, expected at least 200");
  EXPECT_EQ(write(nullptr, bytes, names.data(), primitives), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(write(to.data(), bytes, nullptr, primitives), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_bvh_export_counts(nullptr, 1, nullptr, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace kiwami_api_tests

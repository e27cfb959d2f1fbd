// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_tetrahedra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

#include "kiwami/options.h"
#include "measure/contest.h"
#include "scene/random.h"

namespace kiwami::tools {
namespace {

using Location = kiwami_tetrahedron_location;

struct TetrahedronMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<uint32_t, 4>> tetrahedra;
};

/// Each cube of a grid in six tetrahedra around its diagonal (H. W. Kuhn, "Some Combinatorial
/// Lemmas in Topology", 1960), all of one orientation; inner vertices are moved by up to a tenth.
TetrahedronMesh perturbed_grid(uint32_t cells) {
  TetrahedronMesh mesh;
  Random random(7, 97);
  const uint32_t edge = cells + 1;
  const auto place = [&](uint32_t i) {
    const bool is_inner = i != 0 && i != cells;
    return static_cast<float>(i) + (is_inner ? random.uniform(-0.1f, 0.1f) : 0.0f);
  };
  for (uint32_t i = 0; i < edge * edge * edge; ++i) {
    const float x = place(i % edge), y = place(i / edge % edge);
    mesh.vertices.push_back({x, y, place(i / edge / edge)});
  }
  const uint32_t step[3] = {1, edge, edge * edge};
  constexpr int kPaths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (uint32_t cell = 0; cell < cells * cells * cells; ++cell) {
    const uint32_t corner =
        cell % cells + cell / cells % cells * step[1] + cell / cells / cells * step[2];
    for (int path = 0; path < 6; ++path) {
      std::array<uint32_t, 4> one{corner, 0, 0, 0};
      for (size_t i = 0; i < 3; ++i) one[i + 1] = one[i] + step[kPaths[path][i]];
      if (path >= 3) std::swap(one[1], one[2]);  // a mirror image of the others
      mesh.tetrahedra.push_back(one);
    }
  }
  return mesh;
}

/// One way to locate points.
class Locator {
 public:
  virtual ~Locator() = default;
  virtual const char* name() const = 0;
  virtual std::string isa() const = 0;
  virtual void locate(const std::vector<Vec3>& points, std::vector<Location>& locations) const = 0;
  virtual uint64_t bytes() const = 0;
  virtual double build_seconds() const = 0;
};

class LibraryLocator : public Locator {
 public:
  LibraryLocator(const char* name, uint32_t method, uint32_t isa, const TetrahedronMesh& mesh)
      : name_(name), device_(isa, 1) {
    kiwami_tetrahedra_desc desc;
    throw_on_error(kiwami_tetrahedra_desc_init(&desc, sizeof desc));
    desc.method = method;
    desc.vertices = mesh.vertices.data();
    desc.vertex_stride = sizeof(Vec3);
    desc.vertex_count = mesh.vertices.size();
    desc.indices = mesh.tetrahedra.data();
    desc.tetrahedron_count = mesh.tetrahedra.size();
    throw_on_error(kiwami_tetrahedra_create(device_.get(), &desc, &tetrahedra_));
    info_.struct_size = sizeof info_;
    throw_on_error(kiwami_tetrahedra_get_info(tetrahedra_, &info_));
  }
  ~LibraryLocator() override { kiwami_tetrahedra_release(tetrahedra_); }
  LibraryLocator(const LibraryLocator&) = delete;
  LibraryLocator& operator=(const LibraryLocator&) = delete;

  const char* name() const override { return name_; }
  std::string isa() const override { return kiwami_isa_name(device_.info().isa); }
  void locate(const std::vector<Vec3>& points, std::vector<Location>& locations) const override {
    throw_on_error(kiwami_tetrahedra_locate(tetrahedra_, points.data(), sizeof(Vec3),
                                            locations.data(), 0, points.size()));
  }
  uint64_t bytes() const override { return info_.bytes; }
  double build_seconds() const override { return info_.build_seconds; }

 private:
  const char* name_;
  Device device_;
  kiwami_tetrahedra* tetrahedra_ = nullptr;
  kiwami_tetrahedra_info info_{};
};

struct Vector {
  double x, y, z;
};

Vector between(Vec3 from, Vec3 to) {
  return {static_cast<double>(to.x) - static_cast<double>(from.x),
          static_cast<double>(to.y) - static_cast<double>(from.y),
          static_cast<double>(to.z) - static_cast<double>(from.z)};
}

double volume(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vector u = between(a, b), v = between(a, c), w = between(a, d);
  return u.x * (v.y * w.z - v.z * w.y) + u.y * (v.z * w.x - v.x * w.z) +
         u.z * (v.x * w.y - v.y * w.x);
}

/// What the others are measured by: down a plain binary tree over the boxes, one after the other,
/// with plain double precision at the leaves.
class BinaryLocator : public Locator {
 public:
  explicit BinaryLocator(const TetrahedronMesh& mesh) : mesh_(mesh), device_(KIWAMI_ISA_AUTO, 1) {
    std::vector<std::array<Vec3, 2>> boxes;
    for (const auto& one : mesh.tetrahedra) {
      std::array<Vec3, 2> box{mesh.vertices[one[0]], mesh.vertices[one[0]]};
      for (const uint32_t vertex : one) {
        const Vec3 at = mesh.vertices[vertex];
        box[0] = {std::min(box[0].x, at.x), std::min(box[0].y, at.y), std::min(box[0].z, at.z)};
        box[1] = {std::max(box[1].x, at.x), std::max(box[1].y, at.y), std::max(box[1].z, at.z)};
      }
      boxes.push_back(box);
    }
    const kiwami_parameter_value leaf_size{KIWAMI_PARAMETER_MAX_LEAF_SIZE, 0, 1.0};
    kiwami_bvh_desc desc;
    throw_on_error(kiwami_bvh_desc_init(&desc, sizeof desc));
    desc.width = 2;
    desc.boxes = boxes.data();
    desc.box_count = boxes.size();
    desc.parameters = &leaf_size;
    desc.parameter_count = 1;
    kiwami_bvh* bvh = nullptr;
    throw_on_error(kiwami_bvh_build(device_.get(), &desc, &bvh));
    const std::unique_ptr<kiwami_bvh, void (*)(kiwami_bvh*)> owner(bvh, kiwami_bvh_release);
    kiwami_bvh_info info;
    info.struct_size = sizeof info;
    throw_on_error(kiwami_bvh_get_info(bvh, &info));
    build_seconds_ = info.build_seconds;
    take_nodes(*bvh, info);
  }

  const char* name() const override { return "binary_walk"; }
  std::string isa() const override { return "-"; }
  void locate(const std::vector<Vec3>& points, std::vector<Location>& locations) const override {
    for (size_t i = 0; i < points.size(); ++i) locations[i] = locate(points[i]);
  }
  uint64_t bytes() const override {
    return nodes_.size() * sizeof(Node) + mesh_.vertices.size() * sizeof(Vec3) +
           mesh_.tetrahedra.size() * 4 * sizeof(uint32_t);
  }
  double build_seconds() const override { return build_seconds_; }

 private:
  struct Node {
    Vec3 lower, upper;
    uint32_t first;  ///< child, or tetrahedron
    bool is_leaf;

    bool holds(Vec3 at) const {
      return lower.x <= at.x && at.x <= upper.x && lower.y <= at.y && at.y <= upper.y &&
             lower.z <= at.z && at.z <= upper.z;
    }
  };

  void take_nodes(const kiwami_bvh& bvh, const kiwami_bvh_info& info) {
    std::vector<kiwami_bvh_node> nodes(info.node_count);
    throw_on_error(kiwami_bvh_get_nodes(&bvh, 0, nodes.size(), nodes.data(), 0));
    std::vector<kiwami_bvh_primitive> primitives(info.primitive_count);
    throw_on_error(kiwami_bvh_get_primitives(&bvh, 0, primitives.size(), primitives.data(), 0));
    for (const kiwami_bvh_node& node : nodes) {
      const bool is_leaf = node.child_count == 0;
      nodes_.push_back({{node.lower[0], node.lower[1], node.lower[2]},
                        {node.upper[0], node.upper[1], node.upper[2]},
                        is_leaf ? primitives[node.first_primitive].primitive_id : node.first_child,
                        is_leaf});
    }
  }

  Location locate(Vec3 at) const {
    uint32_t stack[128];
    uint32_t size = 0;
    stack[size++] = 0;
    while (size != 0) {
      const Node& node = nodes_[stack[--size]];
      if (!node.holds(at)) continue;
      if (!node.is_leaf) {
        stack[size++] = node.first + 1;
        stack[size++] = node.first;
        continue;
      }
      Location found{node.first, {}};
      if (weigh(at, found)) return found;
    }
    return {KIWAMI_INVALID_ID, {}};
  }

  bool weigh(Vec3 at, Location& location) const {
    Vec3 corner[4];
    for (size_t i = 0; i < 4; ++i) {
      corner[i] = mesh_.vertices[mesh_.tetrahedra[location.tetrahedron_id][i]];
    }
    double part[4], total = 0.0;
    for (int i = 0; i < 4; ++i) {
      Vec3 replaced[4] = {corner[0], corner[1], corner[2], corner[3]};
      replaced[i] = at;
      part[i] = volume(replaced[0], replaced[1], replaced[2], replaced[3]);
      if (part[i] < 0.0) return false;
      total += part[i];
    }
    for (int i = 0; i < 4; ++i) location.weights[i] = static_cast<float>(part[i] / total);
    return true;
  }

  const TetrahedronMesh& mesh_;
  Device device_;
  std::vector<Node> nodes_;
  double build_seconds_ = 0.0;
};

std::vector<Vec3> random_points(uint32_t cells, uint64_t count) {
  Random random(7, 98);
  const float margin = 0.014f * static_cast<float>(cells);
  const float last = static_cast<float>(cells) + margin;
  std::vector<Vec3> points(count);
  for (Vec3& point : points) {
    const float x = random.uniform(-margin, last), y = random.uniform(-margin, last);
    point = {x, y, random.uniform(-margin, last)};
  }
  return points;
}

/// The points of a grid, row by row, as where a field is sampled anew.
std::vector<Vec3> row_points(uint32_t cells, uint64_t count) {
  const auto edge = static_cast<uint32_t>(std::cbrt(static_cast<double>(count)));
  const float step = 1.028f * static_cast<float>(cells) / static_cast<float>(edge);
  const float first = -0.0141f * static_cast<float>(cells);
  std::vector<Vec3> points;
  const auto place = [&](uint32_t number) { return first + step * static_cast<float>(number); };
  points.reserve(size_t{edge} * edge * edge);
  for (uint32_t i = 0; i < edge * edge * edge; ++i) {
    points.push_back({place(i % edge), place(i / edge % edge), place(i / edge / edge)});
  }
  return points;
}

std::string hash_of(const std::vector<Location>& locations) {
  return format("%016llx",
                static_cast<unsigned long long>(hash_bytes(std::as_bytes(std::span(locations)))));
}

/// Where plain double precision and exact answers may differ: next to a face.
std::string fault_of(const std::vector<Location>& locations, const std::vector<Location>& walked) {
  size_t differences = 0;
  for (size_t i = 0; i < locations.size(); ++i) {
    if (locations[i].tetrahedron_id != walked[i].tetrahedron_id) ++differences;
  }
  if (differences * 1000 <= locations.size()) return {};
  return std::to_string(differences) + " points are not where the binary walk finds them";
}

}  // namespace

std::vector<TetrahedronRow> run_tetrahedra(uint32_t cells, const BenchSettings& settings) {
  const TetrahedronMesh mesh = perturbed_grid(cells);
  std::vector<std::unique_ptr<Locator>> locators;
  locators.push_back(std::make_unique<BinaryLocator>(mesh));
  for (const uint32_t isa : settings.isas) {
    locators.push_back(
        std::make_unique<LibraryLocator>("boxes", KIWAMI_TETRAHEDRA_BOXES, isa, mesh));
    locators.push_back(
        std::make_unique<LibraryLocator>("faces", KIWAMI_TETRAHEDRA_FACES, isa, mesh));
  }
  std::vector<TetrahedronRow> rows;
  for (const std::string set : {"random", "rows"}) {
    const std::vector<Vec3> points = set == "random" ? random_points(cells, settings.ray_count)
                                                     : row_points(cells, settings.ray_count);
    std::vector<std::vector<Location>> locations(locators.size(),
                                                 std::vector<Location>(points.size()));
    std::vector<Contender> contenders;
    for (size_t i = 0; i < locators.size(); ++i) {
      contenders.push_back({[] {}, [&, i] { locators[i]->locate(points, locations[i]); }, [] {}});
    }
    const auto seconds = interleaved_seconds(contenders, settings.rounds, settings.clock);
    for (size_t i = 0; i < locators.size(); ++i) {
      std::vector<double> ratios;
      for (size_t k = 0; k < seconds[i].size(); ++k) {
        ratios.push_back(seconds[0][k] / seconds[i][k]);
      }
      const auto found = std::count_if(
          locations[i].begin(), locations[i].end(),
          [](const Location& each) { return each.tetrahedron_id != KIWAMI_INVALID_ID; });
      const auto count = static_cast<double>(points.size());
      const Locator& locator = *locators[i];
      rows.push_back(
          {mesh.tetrahedra.size(), locator.name(), locator.isa(), set,
           locator.build_seconds() * 1e3,
           static_cast<double>(locator.bytes()) / static_cast<double>(mesh.tetrahedra.size()),
           count / median(seconds[i]) * 1e-6, median(ratios), static_cast<double>(found) / count,
           hash_of(locations[i]), fault_of(locations[i], locations[0])});
      if (i > 1 && rows.back().answers_hash != rows[rows.size() - 2].answers_hash) {
        rows.back().wrong = "the answers are not those of the row before";
      }
    }
  }
  return rows;
}

nlohmann::ordered_json to_json(const TetrahedronRow& row) {
  return {{"tetrahedra", row.tetrahedra},
          {"method", row.method},
          {"isa", row.isa},
          {"points", row.points},
          {"build_ms", row.build_milliseconds},
          {"bytes_per_tetrahedron", row.bytes_per_tetrahedron},
          {"mega_points_per_second", row.mega_points},
          {"ratio", row.ratio},
          {"found", row.found},
          {"answers_hash", row.answers_hash},
          {"wrong", row.wrong}};
}

void print_table(const std::vector<TetrahedronRow>& rows) {
  std::printf("%s tetrahedra\n", grouped(rows.front().tetrahedra).c_str());
  std::printf("%-12s %-7s %-7s %9s %9s %9s %7s %7s\n", "method", "isa", "points", "build ms",
              "B/tet", "Mpoints/s", "ratio", "found");
  for (const TetrahedronRow& row : rows) {
    std::printf("%-12s %-7s %-7s %9.1f %9.1f %9.2f %7.2f %7.3f %s\n", row.method.c_str(),
                row.isa.c_str(), row.points.c_str(), row.build_milliseconds,
                row.bytes_per_tetrahedron, row.mega_points, row.ratio, row.found,
                row.wrong.c_str());
  }
}

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#include "kiwami/inspect_report.h"

#include <nlohmann/json.hpp>

#include "kiwami/inspect_page.h"
#include "kiwami/options.h"

namespace kiwami::tools {
namespace {

/// Numbers are written with the digits that a float needs, which keeps pages small.
using Json = nlohmann::basic_json<nlohmann::ordered_map, std::vector, std::string, bool, int64_t,
                                  uint64_t, float>;

constexpr int kFormatVersion = 1;

std::string library_version() {
  const uint32_t version = kiwami_version();
  return format("%u.%u.%u", version / 1000000, version / 1000 % 1000, version % 1000);
}

/// The numbers that `get` gives for each row.
template <typename Get>
Json column(const std::vector<SummaryRow>& rows, Get get) {
  Json numbers = Json::array();
  for (const SummaryRow& row : rows) numbers.push_back(get(row));
  return numbers;
}

float to_float(double number) { return static_cast<float>(number); }

Json box_column(const std::vector<SummaryRow>& rows) {
  Json numbers = Json::array();
  for (const SummaryRow& row : rows) {
    for (const float bound : row.lower) numbers.push_back(bound);
    for (const float bound : row.upper) numbers.push_back(bound);
  }
  return numbers;
}

Json columns_of(const InspectedTree& tree, uint64_t ray_count) {
  using Row = SummaryRow;
  const std::vector<Row>& rows = tree.rows;
  Json columns;
  columns["parent"] = column(rows, [](const Row& row) { return row.parent; });
  columns["kind"] = column(rows, [](const Row& row) { return static_cast<uint32_t>(row.kind); });
  columns["index"] = column(rows, [](const Row& row) { return row.node; });
  columns["depth"] = column(rows, [](const Row& row) { return row.depth; });
  columns["members"] = column(rows, [](const Row& row) { return row.member_count; });
  columns["box"] = box_column(rows);
  columns["area"] = column(rows, [](const Row& row) { return to_float(row.area); });
  columns["cost"] = column(rows, [](const Row& row) { return to_float(row.cost); });
  columns["subtree_cost"] = column(rows, [](const Row& row) { return to_float(row.subtree_cost); });
  columns["subtree_nodes"] = column(rows, [](const Row& row) { return row.subtree_node_count; });
  columns["primitives"] = column(rows, [](const Row& row) { return row.primitive_count; });
  if (tree.epo) {
    columns["overlap"] = column(rows, [](const Row& row) { return to_float(row.overlap); });
  }
  if (ray_count > 0) {
    columns["visits"] = column(rows, [ray_count](const Row& row) {
      return to_float(static_cast<double>(row.visits) / static_cast<double>(ray_count));
    });
  }
  return columns;
}

Json to_json(const InspectedTree& tree, uint64_t ray_count) {
  Json json;
  json["name"] = pipeline_name(tree.build);
  json["bvh_width"] = tree.info.bvh_width;
  json["tree_node_count"] = tree.node_count;
  json["depth"] = tree.info.bvh_depth;
  json["sah_cost"] = to_float(tree.sah);
  if (tree.epo) json["epo"] = to_float(*tree.epo);
  if (tree.visits_per_ray) json["visits_per_ray"] = to_float(*tree.visits_per_ray);
  json["total_bytes"] = tree.info.total_bytes;
  json["build_seconds"] = to_float(tree.info.build_seconds);
  json["nodes"] = columns_of(tree, ray_count);
  return json;
}

Json to_json(const CoarseShape& shape) {
  Json json;
  json["vertices"] = shape.vertices;
  json["triangles"] = shape.indices;
  return json;
}

/// The box around all that can be hit; of nothing, six zeros.
Json bounds_of_scene(const kiwami_scene_info& info) {
  if (info.triangle_count == 0) return Json::array({0, 0, 0, 0, 0, 0});
  Json bounds = Json::array();
  for (const float bound : info.bounds_min) bounds.push_back(bound);
  for (const float bound : info.bounds_max) bounds.push_back(bound);
  return bounds;
}

}  // namespace

std::string to_json_text(const Inspection& inspection) {
  Json json;
  json["format"] = "kiwami-inspect";
  json["format_version"] = kFormatVersion;
  json["version"] = library_version();
  Json& scene = json["scene"];
  scene["name"] = inspection.scene;
  scene["triangle_count"] = inspection.scene_info.triangle_count;
  scene["bounds"] = bounds_of_scene(inspection.scene_info);
  scene["up"] = {inspection.up.x, inspection.up.y, inspection.up.z};
  scene["shape"] = to_json(inspection.shape);
  if (inspection.ray_count > 0) {
    json["rays"] = {{"name", inspection.rays}, {"count", inspection.ray_count}};
  }
  Json& pipelines = json["pipelines"] = Json::array();
  for (const InspectedTree& tree : inspection.trees) {
    pipelines.push_back(to_json(tree, inspection.ray_count));
  }
  // File names may hold any bytes; those that are no UTF-8 are replaced.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

bool has_inspect_page() { return !kInspectPageHead.empty(); }

std::string make_inspect_page(const std::string& json) {
  std::string page(kInspectPageHead);
  // Nothing in the data may look like the end of its element.
  for (const char character : json) {
    if (character == '<') {
      page += "\\u003c";
    } else {
      page += character;
    }
  }
  page += kInspectPageTail;
  return page;
}

}  // namespace kiwami::tools

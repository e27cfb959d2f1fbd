// SPDX-License-Identifier: Apache-2.0
#include "measure/emissive_lights.h"

#include <algorithm>
#include <cmath>

#include "scene/random.h"

namespace kiwami::tools {
namespace {

Vec3 vertex_of(const Mesh& mesh, uint32_t index) {
  const float* vertex = &mesh.vertices[size_t{3} * index];
  return {vertex[0], vertex[1], vertex[2]};
}

bool is_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

}  // namespace

const std::vector<LightMethodName>& light_methods() {
  static const std::vector<LightMethodName> methods = {
      {"power", KIWAMI_LIGHT_METHOD_POWER, 1},
      {"tree", KIWAMI_LIGHT_METHOD_TREE, 1},
      {"tree_splitting", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 8},
      {"lightcuts", KIWAMI_LIGHT_METHOD_LIGHTCUTS, 8},
      {"culling", KIWAMI_LIGHT_METHOD_CULLING, 32},
      {"roulette", KIWAMI_LIGHT_METHOD_ROULETTE, 32},
      {"roulette_sphere", KIWAMI_LIGHT_METHOD_ROULETTE, 32, KIWAMI_LIGHT_LOBE_TANGENT_SPHERE},
      {"lazy_roulette", KIWAMI_LIGHT_METHOD_LAZY_ROULETTE, 32},
      {"lazy_scrambled", KIWAMI_LIGHT_METHOD_LAZY_ROULETTE, 32, KIWAMI_LIGHT_LOBE_COSINE,
       KIWAMI_LIGHT_ORDER_SCRAMBLED},
      {"roulette_dithered", KIWAMI_LIGHT_METHOD_ROULETTE, 32, KIWAMI_LIGHT_LOBE_COSINE,
       KIWAMI_LIGHT_ORDER_XOR, false, KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE},
      {"lazy_dithered", KIWAMI_LIGHT_METHOD_LAZY_ROULETTE, 32, KIWAMI_LIGHT_LOBE_COSINE,
       KIWAMI_LIGHT_ORDER_XOR, false, KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE},
      {"tree_glossy", KIWAMI_LIGHT_METHOD_TREE, 1, KIWAMI_LIGHT_LOBE_GLOSSY},
      {"tree_mixed", KIWAMI_LIGHT_METHOD_TREE, 2, KIWAMI_LIGHT_LOBE_GLOSSY, KIWAMI_LIGHT_ORDER_XOR,
       true},
      {"splitting_glossy", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 8, KIWAMI_LIGHT_LOBE_GLOSSY},
      {"lightcuts_glossy", KIWAMI_LIGHT_METHOD_LIGHTCUTS, 8, KIWAMI_LIGHT_LOBE_GLOSSY},
      {"roulette_glossy", KIWAMI_LIGHT_METHOD_ROULETTE, 32, KIWAMI_LIGHT_LOBE_GLOSSY},
      {"lazy_glossy", KIWAMI_LIGHT_METHOD_LAZY_ROULETTE, 32, KIWAMI_LIGHT_LOBE_GLOSSY},
  };
  return methods;
}

std::string light_method_list() {
  std::string list;
  for (const LightMethodName& method : light_methods()) {
    list += (list.empty() ? "" : ", ") + std::string(method.name);
  }
  return list;
}

const LightMethodName* find_light_method(const std::string& name) {
  for (const LightMethodName& method : light_methods()) {
    if (name == method.name) return &method;
  }
  return nullptr;
}

float EmissiveTriangle::arriving(Vec3 from, Vec3 at, Vec3 at_normal) const {
  const Vec3 way = from - at;
  const float square = dot(way, way);
  const float cosine = dot(way, at_normal);
  if (!(square > 0.0f) || !(cosine > 0.0f)) return 0.0f;
  return radiance * cosine * std::fabs(dot(way, normal)) / (square * square);
}

float EmissiveTriangle::sent(Vec3 from, Vec3 at) const {
  const Vec3 way = from - at;
  const float square = dot(way, way);
  if (!(square > 0.0f)) return 0.0f;
  return radiance * std::fabs(dot(way, normal)) / (square * std::sqrt(square));
}

float GlossySurface::reflected(Vec3 towards_light) const {
  const float distance = length(towards_light);
  if (!(distance > 0.0f)) return 0.0f;
  const Vec3 in = towards_light * (1.0f / distance);
  const float cos_in = dot(in, normal), cos_out = dot(view, normal);
  if (!(cos_in > 0.0f) || !(cos_out > 0.0f)) return 0.0f;
  const Vec3 sum = in + view;
  const float cos_half = dot(sum, normal) / length(sum);
  const float square = roughness * roughness;
  const float off = cos_half * cos_half * (square - 1.0f) + 1.0f;
  const float density = square / (3.14159265f * off * off);
  const auto hidden = [&](float cosine) {
    return std::sqrt(square + (1.0f - square) * cosine * cosine);
  };
  const float seen =
      2.0f * cos_in * cos_out / (cos_out * hidden(cos_in) + cos_in * hidden(cos_out));
  return density * seen / (4.0f * cos_out);
}

kiwami_light_lobe GlossySurface::lobe() const {
  const Vec3 mirrored = normal * (2.0f * dot(view, normal)) - view;
  return {{mirrored.x, mirrored.y, mirrored.z}, roughness};
}

std::vector<EmissiveTriangle> choose_emissive(const SceneFile& file, double share) {
  std::vector<EmissiveTriangle> chosen;
  for (size_t number = 0; number < file.meshes.size(); ++number) {
    const Mesh& mesh = file.meshes[number];
    Random random(number, 91);
    for (size_t i = 0; i < mesh.triangle_count(); ++i) {
      const double lot = static_cast<double>(random.next()) * 0x1p-32;
      const float radiance = std::exp2(3.0f * (2.0f * random.uniform() - 1.0f));
      if (lot >= share) continue;
      const Vec3 a = vertex_of(mesh, mesh.indices[3 * i]);
      const Vec3 u = vertex_of(mesh, mesh.indices[3 * i + 1]) - a;
      const Vec3 v = vertex_of(mesh, mesh.indices[3 * i + 2]) - a;
      const Vec3 across = cross(u, v);
      const float twice_area = length(across);
      if (!is_finite(a) || !(twice_area > 0.0f) || !std::isfinite(twice_area)) continue;
      chosen.push_back({a, u, v, across * (1.0f / twice_area), 0.5f * twice_area, radiance,
                        static_cast<uint32_t>(number), static_cast<uint32_t>(i)});
    }
  }
  return chosen;
}

LightSet::LightSet(const Device& device, const std::vector<EmissiveTriangle>& triangles,
                   uint32_t width, bool with_roulette, uint32_t builder) {
  std::vector<float> vertices;
  vertices.reserve(triangles.size() * 9);
  for (const EmissiveTriangle& triangle : triangles) {
    for (const Vec3 corner :
         {triangle.corner, triangle.corner + triangle.u, triangle.corner + triangle.v}) {
      vertices.insert(vertices.end(), {corner.x, corner.y, corner.z});
    }
  }
  kiwami_light_tree_desc desc;
  throw_on_error(kiwami_light_tree_desc_init(&desc, sizeof desc));
  desc.width = width;
  desc.builder = builder;
  desc.flags = with_roulette ? KIWAMI_LIGHT_TREE_WITH_ROULETTE : 0;
  throw_on_error(kiwami_light_tree_create(device.get(), &desc, &tree_));
  kiwami_light_mesh_desc mesh;
  throw_on_error(kiwami_light_mesh_desc_init(&mesh, sizeof mesh));
  mesh.flags = KIWAMI_LIGHT_TWO_SIDED;
  mesh.vertices = vertices.data();
  mesh.vertex_count = vertices.size() / 3;
  mesh.triangle_count = triangles.size();
  if (!triangles.empty()) mesh.radiances = &triangles[0].radiance;
  mesh.radiance_stride = sizeof(EmissiveTriangle);
  throw_on_error(kiwami_light_tree_add_mesh(tree_, &mesh, nullptr));
  throw_on_error(kiwami_light_tree_commit(tree_));
  info_.struct_size = sizeof info_;
  throw_on_error(kiwami_light_tree_get_info(tree_, &info_));
}

void LightSet::sample(const LightMethodName& method,
                      std::span<const kiwami_light_receiver> receivers,
                      const ReceiverExtras& extras, std::span<kiwami_light_choice> choices) const {
  kiwami_light_query query;
  throw_on_error(kiwami_light_query_init(&query, sizeof query));
  query.method = method.method;
  query.max_choices = method.max_choices;
  query.lobe = method.lobe;
  query.order = method.order;
  query.lobes = extras.lobes.data();
  query.sequence = method.sequence;
  query.pixels = extras.pixels.data();
  if (method.is_mixed) return sample_mixed(query, receivers, choices);
  throw_on_error(
      kiwami_light_sample(tree_, receivers.data(), 0, choices.data(), 0, receivers.size(), &query));
}

void LightSet::sample_mixed(kiwami_light_query query,
                            std::span<const kiwami_light_receiver> receivers,
                            std::span<kiwami_light_choice> choices) const {
  const size_t count = receivers.size();
  query.max_choices = 1;
  kiwami_light_query diffuse = query;
  diffuse.lobe = KIWAMI_LIGHT_LOBE_COSINE;
  const kiwami_light_query* const queries[2] = {&diffuse, &query};
  // The second choice needs a random number of its own: the receivers' turned by half.
  std::vector<kiwami_light_receiver> turned(receivers.begin(), receivers.end());
  for (kiwami_light_receiver& receiver : turned) {
    receiver.random += receiver.random < 0.5 ? 0.5 : -0.5;
  }
  const kiwami_light_receiver* const sources[2] = {receivers.data(), turned.data()};
  std::vector<float> other(count);
  for (size_t k = 0; k < 2; ++k) {
    constexpr size_t kStride = 2 * sizeof(kiwami_light_choice);
    kiwami_light_choice* const own = choices.data() + k;
    throw_on_error(kiwami_light_sample(tree_, sources[k], 0, own, kStride, count, queries[k]));
    // A choice begins with the name of its light.
    throw_on_error(kiwami_light_pdf(tree_, receivers.data(), 0,
                                    reinterpret_cast<const kiwami_light_name*>(own), kStride,
                                    other.data(), 0, count, queries[1 - k]));
    for (size_t i = 0; i < count; ++i) choices[2 * i + k].probability += other[i];
  }
}

kiwami_light_receiver receiver_at(Vec3 point, Vec3 normal, double random) {
  kiwami_light_receiver receiver{};
  receiver.position[0] = point.x;
  receiver.position[1] = point.y;
  receiver.position[2] = point.z;
  receiver.normal[0] = normal.x;
  receiver.normal[1] = normal.y;
  receiver.normal[2] = normal.z;
  receiver.link_mask = ~uint64_t{0};
  receiver.random = random;
  return receiver;
}

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#include "lights/committed_lights.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "lights/saoh_builder.h"

namespace kiwami {
namespace {

/// The inverse of the linear part, and the translation that undoes the whole.
void invert(const float (&local_to_world)[12], LightInstanceView& view) {
  const auto at = [&](int row, int column) {
    return static_cast<double>(local_to_world[4 * row + column]);
  };
  double inverse[3][3];
  const double determinant = at(0, 0) * (at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)) -
                             at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
                             at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0));
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const int r1 = (column + 1) % 3, r2 = (column + 2) % 3;
      const int c1 = (row + 1) % 3, c2 = (row + 2) % 3;
      inverse[row][column] = (at(r1, c1) * at(r2, c2) - at(r1, c2) * at(r2, c1)) / determinant;
    }
  }
  for (int row = 0; row < 3; ++row) {
    double shift = 0.0;
    for (int column = 0; column < 3; ++column) {
      view.world_to_local[row][column] = static_cast<float>(inverse[row][column]);
      view.normal_to_local[row][column] = static_cast<float>(at(column, row));
      shift -= inverse[row][column] * at(column, 3);
    }
    view.world_to_local[row][3] = static_cast<float>(shift);
  }
}

/// Which leaves are in the tree: lights that have a place, and instances that have lights.
Array<uint32_t> leaf_numbers_of(const LightLeaves& leaves, Memory& memory) {
  Array<uint32_t> numbers(memory, leaves.size());
  uint32_t count = 0;
  for (uint32_t leaf = 0; leaf < leaves.size(); ++leaf) {
    if (leaf >= leaves.light_count &&
        leaves.instances[leaf - leaves.light_count].light_count == 0) {
      continue;
    }
    if (leaves[leaf].kind == LightKind::kLocal) numbers[count++] = leaf;
  }
  numbers.shrink(count);
  return numbers;
}

/// Throws unless the shape is a tree over just the leaves that are to be in it.
void check_shape(const LightLinks& links, const LightLeaves& leaves, uint32_t shape_leaf_count,
                 Memory& memory) {
  bool fits = shape_leaf_count == leaves.size();
  if (fits) {
    const Array<uint32_t> numbers = leaf_numbers_of(leaves, memory);
    fits = links.size() == (numbers.empty() ? 0 : 2 * numbers.size() - 1);
    for (size_t i = 0; fits && i < links.size(); ++i) {
      if (!is_light_leaf(links[i])) continue;
      fits = leaves[links[i] & ~kLightLeafBit].kind == LightKind::kLocal;
    }
  }
  if (!fits) {
    throw Error(KIWAMI_ERROR_INVALID_STATE,
                "lights or instances were added, or a light became distant or ceased to be, since "
                "the last commit, expected none, or a kiwami_light_tree_commit");
  }
}

}  // namespace

CommittedLights* CommittedLights::create(Device& device, const LightInput& input) {
  return make_object<CommittedLights>(device.memory(), device, input, nullptr);
}

CommittedLights* CommittedLights::create(Device& device, const LightInput& input,
                                         const LightShape& shape) {
  return make_object<CommittedLights>(device.memory(), device, input, &shape);
}

void CommittedLights::destroy(CommittedLights* lights) noexcept {
  const Reference<Device> device = lights->device_;
  destroy_object(device->memory(), lights);
}

CommittedLights::CommittedLights(Device& device, const LightInput& input, const LightShape* shape)
    : device_(device), set_(input.set) {
  const auto start = std::chrono::steady_clock::now();
  Memory& memory = device.memory();
  tree_.width = input.width;
  Array<InstanceLeaf> instance_leaves(memory, input.instance_count());
  place_instances(input, instance_leaves);
  const LightLeaves leaves{input.set.lights.data(), instance_leaves.data(), input.light_count(),
                           input.instance_count()};
  build(input, leaves, shape);
  collect_distant(input);
  weigh(input, leaves);
  describe(input);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  info_.build_seconds = seconds.count();
}

void CommittedLights::place_instances(const LightInput& input, Array<InstanceLeaf>& leaves) {
  instance_views_ = Array<LightInstanceView>(device_->memory(), input.instance_count());
  for (uint32_t i = 0; i < input.instance_count(); ++i) {
    const LightInstance& instance = input.set.instances[i];
    LightInstanceView& view = instance_views_[i];
    invert(instance.local_to_world, view);
    view.link_mask = instance.link_mask;
    view.tree = instance.lights->view();
    leaves[i] = instance.lights->summary();
    if (leaves[i].light_count == 0) continue;
    const double scale = static_cast<double>(instance.power_scale);
    leaves[i].energy_square *= scale * scale;
    leaves[i].record = transformed(leaves[i].record, instance.local_to_world, instance.power_scale,
                                   instance.link_mask);
  }
}

void CommittedLights::build(const LightInput& input, const LightLeaves& leaves,
                            const LightShape* shape) {
  Memory& memory = device_->memory();
  if (shape) {
    check_shape(shape->links, leaves, shape->leaf_count, memory);
    links_ = LightLinks(memory, shape->links.size());
    if (!links_.empty()) std::memcpy(links_.data(), shape->links.data(), links_.bytes());
  } else {
    Array<uint32_t> numbers = leaf_numbers_of(leaves, memory);
    if (!numbers.empty()) {
      SaohBuilder::Config config;
      config.sorts_by_octant = input.builder == KIWAMI_LIGHT_BUILDER_OCTANTS;
      links_ = SaohBuilder::build(leaves, numbers, config, memory, device_->parallel());
    }
  }
  has_roulette_ = input.has_roulette;
  if (links_.empty()) return;
  const Array<LightCluster> clusters = clusters_of(links_, leaves, memory);
  tree_ = shape ? rewritten(shape->tree, links_, clusters, leaves.size(), memory)
                : contract(links_, clusters, input.width, leaves.size(), memory);
  if (has_roulette_) perfect_tree_ = PerfectLightTree(links_, clusters, memory);
  const LightCluster& root = clusters[0];
  info_.power = root.power;
  describe_root(root, view_);
  LightRecord& record = summary_.record;
  record.box = root.box;
  record.set_cone(root.cone.is_empty ? Cone::sphere() : root.cone);
  const double greatest = static_cast<double>(std::numeric_limits<float>::max());
  record.power = static_cast<float>(std::min(root.power, greatest));
  record.intensity_per_power =
      root.power > 0.0 ? static_cast<float>(root.energy / root.power) : 0.0f;
  record.kind = LightKind::kLocal;
  record.link_mask = root.link_mask;
  summary_.energy_square = root.energy_square;
  summary_.light_count = root.light_count;
}

void CommittedLights::collect_distant(const LightInput& input) {
  GrowingArray<DistantLightView> found(device_->memory());
  double greatest = 0.0;
  for (uint32_t i = 0; i < input.light_count(); ++i) {
    const LightRecord& light = input.set.lights[i];
    if (light.kind != LightKind::kDistant && light.kind != LightKind::kEnvironment) continue;
    DistantLightView view{};
    if (light.kind == LightKind::kDistant) {
      view.direction[0] = light.axis.x;
      view.direction[1] = light.axis.y;
      view.direction[2] = light.axis.z;
    }
    view.cos_spread = light.cos_spread;
    view.sin_spread = light.sin_spread;
    view.energy = light.power;
    view.light_id = i;
    view.link_mask = light.link_mask;
    greatest = std::max(greatest, static_cast<double>(light.power));
    found.push_back(view);
  }
  distant_ = found.take();
  // Relative to the strongest, so that no sum overflows and none that has power vanishes.
  for (DistantLightView& light : distant_) {
    if (!(light.energy > 0.0f)) continue;
    light.energy = std::max(static_cast<float>(static_cast<double>(light.energy) / greatest),
                            std::numeric_limits<float>::min());
  }
}

void CommittedLights::weigh(const LightInput& input, const LightLeaves& leaves) {
  Memory& memory = device_->memory();
  Array<double> powers(memory, leaves.size());
  for (uint32_t leaf = 0; leaf < leaves.size(); ++leaf) {
    const bool is_empty = leaf >= input.light_count() &&
                          leaves.instances[leaf - input.light_count()].light_count == 0;
    const bool is_local = leaves[leaf].kind == LightKind::kLocal && !is_empty;
    powers[leaf] = is_local ? static_cast<double>(leaves[leaf].power) : 0.0;
  }
  leaf_powers_ = AliasTable(powers, memory);
  Array<double> distant_powers(memory, distant_.size());
  for (size_t i = 0; i < distant_.size(); ++i) {
    distant_powers[i] = static_cast<double>(distant_[i].energy);
  }
  distant_powers_ = AliasTable(distant_powers, memory);
}

double CommittedLights::distant_share() const {
  if (distant_powers_.empty()) return 0.0;
  return leaf_powers_.empty() ? 1.0 : view_.distant_probability;
}

kiwami_light_choice CommittedLights::choose_by_power(double random) const {
  const double distant = distant_share();
  // Not a number, or out of range, counts as the nearest one in range.
  double number = random > 0.0 ? std::min(random, 1.0 - 0x1p-53) : 0.0;
  uint32_t light_id = KIWAMI_INVALID_ID, instance_id = KIWAMI_INVALID_ID;
  const CommittedLights* lights = this;
  if (number < distant) {
    const AliasTable::Draw draw = distant_powers_.draw(number / distant);
    light_id = distant_[draw.index].light_id;
    number = draw.random;
  } else if (!leaf_powers_.empty()) {
    const double rest = (number - distant) / (1.0 - distant);
    AliasTable::Draw draw = leaf_powers_.draw(std::min(rest, 1.0 - 0x1p-53));
    if (draw.index >= view_.light_count) {
      instance_id = draw.index - view_.light_count;
      lights = &instance(instance_id);
      draw = lights->leaf_powers_.draw(draw.random);
    }
    light_id = draw.index;
    number = draw.random;
  } else {
    return {KIWAMI_INVALID_ID, KIWAMI_INVALID_ID, 0, 0.0f, 0.0};
  }
  const double probability = probability_by_power({light_id, instance_id});
  return {light_id, instance_id, lights->set_->user_ids[light_id],
          std::max(static_cast<float>(probability), std::numeric_limits<float>::min()), number};
}

double CommittedLights::probability_by_power(const kiwami_light_name& name) const {
  const double distant = distant_share();
  if (name.instance_id == KIWAMI_INVALID_ID) {
    if (name.light_id >= view_.light_count) return 0.0;
    for (uint32_t i = 0; i < distant_.size(); ++i) {
      if (distant_[i].light_id == name.light_id) return distant * distant_powers_.probability(i);
    }
    return leaf_powers_.empty() ? 0.0 : (1.0 - distant) * leaf_powers_.probability(name.light_id);
  }
  if (name.instance_id >= view_.instance_count || leaf_powers_.empty()) return 0.0;
  const CommittedLights& inner = instance(name.instance_id);
  if (name.light_id >= inner.view_.light_count || inner.leaf_powers_.empty()) return 0.0;
  return (1.0 - distant) * leaf_powers_.probability(view_.light_count + name.instance_id) *
         inner.leaf_powers_.probability(name.light_id);
}

void CommittedLights::describe(const LightInput& input) {
  view_.nodes = tree_.nodes.data();
  view_.node_count = tree_.node_count;
  view_.light_count = input.light_count();
  view_.leaf_slots = tree_.leaf_slots.data();
  view_.parent_slots = tree_.parent_slots.data();
  view_.user_ids = set_->user_ids.data();
  view_.instances = instance_views_.data();
  view_.instance_count = input.instance_count();
  view_.distant = distant_.data();
  view_.distant_count = static_cast<uint32_t>(distant_.size());
  const double count = static_cast<double>(distant_.size());
  view_.distant_probability = input.distant_probability > 0.0f
                                  ? static_cast<double>(input.distant_probability)
                                  : count / (count + 1.0);
  info_.struct_size = sizeof(info_);
  info_.width = tree_.width;
  info_.light_count = input.light_count();
  info_.instance_count = input.instance_count();
  info_.distant_count = view_.distant_count;
  info_.node_count = tree_.node_count;
  info_.depth = tree_.depth;
  info_.cost = tree_.cost;
  info_.bytes = sizeof(*this) + links_.bytes() + tree_.bytes() + distant_.bytes() +
                instance_views_.bytes() + leaf_powers_.bytes() + perfect_tree_.bytes() +
                distant_powers_.bytes();
}

}  // namespace kiwami

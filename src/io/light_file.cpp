// SPDX-License-Identifier: Apache-2.0
#include "io/light_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "core/error.h"
#include "io/blame_file.h"
#include "io/file_reader.h"
#include "io/file_writer.h"
#include "io/light_shape.h"

namespace kiwami {
namespace {

using namespace file;

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
}

static_assert(sizeof(LightRecord) == 72, "light records are part of the format");

/// The trees of a set in the order of the file: its own, then those that its instances show, each
/// once.
class ShownLights {
 public:
  ShownLights(const CommittedLights& root, Memory& memory)
      : numbers_(memory, root.set().instances.size()) {
    const auto& instances = root.set().instances;
    Array<Place> places(memory, instances.size());
    for (size_t i = 0; i < places.size(); ++i) places[i] = {instances[i].lights, i};
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
      if (a.lights != b.lights) return std::less<const CommittedLights*>()(a.lights, b.lights);
      return a.instance < b.instance;
    });
    // Each is named by the first instance that shows it, so that equal sets have equal numbers.
    GrowingArray<Place> first(memory);
    for (const Place& place : places) {
      if (first.empty() || first.back().lights != place.lights) first.push_back(place);
      numbers_[place.instance] = static_cast<uint32_t>(first.back().instance);
    }
    Array<Place> trees = first.take();
    std::sort(trees.begin(), trees.end(),
              [](const Place& a, const Place& b) { return a.instance < b.instance; });
    for (uint32_t& number : numbers_) {
      const Place* const place =
          std::lower_bound(trees.begin(), trees.end(), number,
                           [](const Place& a, uint32_t instance) { return a.instance < instance; });
      number = static_cast<uint32_t>(place - trees.begin()) + 1;
    }
    trees_ = Array<const CommittedLights*>(memory, trees.size() + 1);
    trees_[0] = &root;
    for (size_t i = 0; i < trees.size(); ++i) trees_[i + 1] = trees[i].lights;
  }

  const Array<const CommittedLights*>& trees() const { return trees_; }
  /// The number of the tree that an instance shows.
  uint32_t number_of(size_t instance) const { return numbers_[instance]; }

 private:
  struct Place {
    const CommittedLights* lights;
    size_t instance;
  };

  Array<uint32_t> numbers_;
  Array<const CommittedLights*> trees_;
};

LightSetRecord record_of(const CommittedLights& lights, const kiwami_light_tree_desc& desc) {
  LightSetRecord record{};
  record.width = lights.width();
  record.builder = desc.builder;
  record.flags = lights.has_roulette() ? uint32_t{KIWAMI_LIGHT_TREE_WITH_ROULETTE} : 0;
  record.distant_probability = desc.distant_probability;
  record.node_count = lights.info().node_count;
  record.build_seconds = lights.info().build_seconds;
  return record;
}

/// Not a light of any description: what makes trees out of numbers relies on them.
void check_light(const LightRecord& light, size_t index, bool is_shown) {
  constexpr float most = KIWAMI_MAX_COORDINATE, greatest = std::numeric_limits<float>::max();
  const auto is_cosine = [](float value) { return value >= -1.0f && value <= 1.0f; };
  const auto is_amount = [=](float value) { return value >= 0.0f && value <= greatest; };
  bool is_light = light.kind <= LightKind::kUnusable && light.is_two_sided <= 1 &&
                  light.reserved == 0 && is_cosine(light.cos_spread) &&
                  is_cosine(light.sin_spread) && is_cosine(light.cos_extent) &&
                  is_amount(light.power) && is_amount(light.intensity_per_power);
  for (int axis = 0; axis < 3; ++axis) {
    is_light = is_light && std::fabs(light.axis[axis]) <= 1.0001f;
    if (light.kind != LightKind::kLocal) continue;
    is_light = is_light && -most <= light.box.lower[axis] &&
               light.box.lower[axis] <= light.box.upper[axis] && light.box.upper[axis] <= most;
  }
  if (!is_light) fail("light %zu is none of any kind, expected finite numbers in range", index);
  if (is_shown && light.kind != LightKind::kLocal && light.kind != LightKind::kUnusable) {
    fail("light %zu of a set that an instance shows is distant, expected none", index);
  }
}

/// One load, step by step.
class LightLoader {
 public:
  LightLoader(Device& device, const kiwami_load_desc& desc)
      : device_(device),
        image_(Reference<FileImage>::adopt(FileImage::create(device, desc))),
        reader_(image_->data(), image_->size()),
        is_trusted_((desc.flags & KIWAMI_LOAD_TRUSTED) != 0) {}

  Reference<LightTree> run() {
    reader_.check_kind(KIWAMI_FILE_LIGHTS);
    Memory& memory = device_.memory();
    if (!is_trusted_) reader_.check_sums(memory, device_.parallel());
    const auto record = record_of_set(0);
    Shown shown(reader_.scene_count(), memory);
    for (uint32_t number = 1; number < reader_.scene_count(); ++number) {
      shown.trees[number] = load_shown(number, record.width);
    }
    kiwami_light_tree_desc desc{};
    desc.width = record.width;
    desc.builder = record.builder;
    desc.flags = record.flags;
    desc.distant_probability = record.distant_probability;
    auto tree = Reference<LightTree>::adopt(LightTree::create(device_, desc));
    take_lights(0, *tree);
    blame_file([&] {
      for (const SavedLightInstance& saved : instances_of(0)) {
        if (saved.set == 0 || saved.set >= reader_.scene_count()) {
          fail("an instance shows set %u, expected 1 to %u", saved.set, reader_.scene_count() - 1);
        }
        if (!(saved.power_scale >= 0.0f &&
              saved.power_scale <= std::numeric_limits<float>::max())) {
          fail("an instance scales powers by %g, expected 0 or more, finite",
               static_cast<double>(saved.power_scale));
        }
        LightInstance instance{shown.trees[saved.set], {}, saved.power_scale, saved.link_mask};
        std::memcpy(instance.local_to_world, saved.local_to_world, sizeof saved.local_to_world);
        tree->add_instance(instance);
      }
    });
    const SavedLightShape shape = shape_of(0, record.width, tree->set());
    tree->restore({shape.links, shape.tree, shape.leaf_count}, record.build_seconds);
    check_node_count(0, record, tree->committed()->info());
    return tree;
  }

 private:
  /// References to the trees that instances show, by number.
  struct Shown {
    Array<CommittedLights*> trees;

    Shown(size_t count, Memory& memory) : trees(memory, count) { trees.fill_zero(); }
    ~Shown() {
      for (CommittedLights* tree : trees) {
        if (tree) tree->release();
      }
    }
    Shown(const Shown&) = delete;
    Shown& operator=(const Shown&) = delete;
  };

  LightSetRecord record_of_set(uint32_t number) const {
    const auto record = reader_.record<LightSetRecord>(SectionType::kLightSet, number);
    const uint32_t width = record.width;
    if ((width != 2 && width != 4 && width != 8 && width != 16) ||
        record.builder > KIWAMI_LIGHT_BUILDER_OCTANTS ||
        (record.flags & ~uint32_t{KIWAMI_LIGHT_TREE_WITH_ROULETTE}) != 0 ||
        !(record.distant_probability >= 0.0f && record.distant_probability < 1.0f)) {
      fail(
          "set %u is %u wide, of builder %u, flags 0x%x and probability %g, expected those of a "
          "kiwami_light_tree_desc",
          number, width, record.builder, record.flags,
          static_cast<double>(record.distant_probability));
    }
    return record;
  }

  std::span<const SavedLightInstance> instances_of(uint32_t number) const {
    return reader_.array<SavedLightInstance>(SectionType::kLightInstances, number);
  }

  void take_lights(uint32_t number, LightTree& tree) const {
    const auto lights = reader_.array<LightRecord>(SectionType::kLights, number);
    const auto user_ids = reader_.array<uint32_t>(SectionType::kLightUserIds, number);
    if (lights.size() != user_ids.size()) {
      fail("set %u has %zu lights and %zu ids, expected as many", number, lights.size(),
           user_ids.size());
    }
    for (size_t i = 0; i < lights.size(); ++i) check_light(lights[i], i, number != 0);
    tree.restore_lights(lights, user_ids);
  }

  SavedLightShape shape_of(uint32_t number, uint32_t width, const LightSet& set) const {
    return checked_light_shape(reader_.array<uint32_t>(SectionType::kLightLinks, number),
                               reader_.array<uint32_t>(SectionType::kLightSlots, number), width,
                               set, device_.memory());
  }

  /// Made as a set of its own, of which the tree alone stays.
  CommittedLights* load_shown(uint32_t number, uint32_t width) const {
    const auto record = record_of_set(number);
    if (record.width != width || !instances_of(number).empty()) {
      fail("set %u is %u wide and has %zu instances, expected %u and none of one that is shown",
           number, record.width, instances_of(number).size(), width);
    }
    kiwami_light_tree_desc desc{};
    desc.width = record.width;
    desc.flags = record.flags;
    const auto tree = Reference<LightTree>::adopt(LightTree::create(device_, desc));
    take_lights(number, *tree);
    const SavedLightShape shape = shape_of(number, width, tree->set());
    tree->restore({shape.links, shape.tree, shape.leaf_count}, record.build_seconds);
    check_node_count(number, record, tree->committed()->info());
    tree->committed()->retain();
    return tree->committed();
  }

  void check_node_count(uint32_t number, const LightSetRecord& record,
                        const kiwami_light_tree_info& info) const {
    if (record.node_count == info.node_count) return;
    fail("set %u has %u nodes, expected %u", number, info.node_count, record.node_count);
  }

  Device& device_;
  Reference<FileImage> image_;
  FileReader reader_;
  bool is_trusted_;
};

}  // namespace

uint64_t save_lights(const LightTree& tree, const CommittedLights& committed,
                     const kiwami_save_desc& desc) {
  Device& device = tree.device();
  Memory& memory = device.memory();
  const ShownLights shown(committed, memory);
  Array<LightSetRecord> records(memory, shown.trees().size());
  for (size_t i = 0; i < records.size(); ++i) {
    records[i] = record_of(*shown.trees()[i], i == 0 ? tree.desc() : kiwami_light_tree_desc{});
  }
  const auto& instances = committed.set().instances;
  Array<SavedLightInstance> saved(memory, instances.size());
  for (size_t i = 0; i < saved.size(); ++i) {
    saved[i] = {shown.number_of(i), instances[i].power_scale, {}, instances[i].link_mask};
    std::memcpy(saved[i].local_to_world, instances[i].local_to_world,
                sizeof saved[i].local_to_world);
  }
  FileWriter writer(KIWAMI_FILE_LIGHTS, memory, device.parallel());
  for (uint32_t i = 0; i < records.size(); ++i) {
    const CommittedLights& lights = *shown.trees()[i];
    const LightShape shape = lights.shape();
    writer.begin_section(SectionType::kLightSet, i);
    writer.add(&records[i], 1);
    writer.add_section(SectionType::kLights, i, lights.set().lights);
    writer.add_section(SectionType::kLightUserIds, i, lights.set().user_ids);
    if (i == 0) writer.add_section(SectionType::kLightInstances, i, saved);
    writer.add_section(SectionType::kLightLinks, i, shape.links);
    writer.add_section(SectionType::kLightSlots, i, shape.tree.slot_clusters);
  }
  return save(writer, desc);
}

LightTree* load_lights(Device& device, const kiwami_load_desc& desc) {
  const Reference<LightTree> tree = LightLoader(device, desc).run();
  tree->retain();
  return tree.get();
}

}  // namespace kiwami

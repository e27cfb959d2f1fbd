// SPDX-License-Identifier: Apache-2.0
#include "io/scene_file.h"

#include <cstring>

#include "core/error.h"
#include "io/file_format.h"
#include "io/file_reader.h"
#include "io/file_writer.h"
#include "io/mesh_sections.h"
#include "wide/check_references.h"

namespace kiwami {
namespace {

using namespace file;

using ull = unsigned long long;

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
}

void copy(const Vec3f& from, float to[3]) {
  for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

Vec3f vector_of(const float from[3]) { return {from[0], from[1], from[2]}; }

SceneRecord record_of(const CommittedScene& scene) {
  const WideTree& tree = scene.tree();
  const kiwami_scene_info& info = scene.info();
  SceneRecord record{};
  record.bvh_width = tree.width;
  record.leaf_width = tree.leaf_width;
  record.depth = tree.depth;
  record.has_duplicates = tree.view.has_duplicates;
  record.leaf_layout = static_cast<uint32_t>(tree.leaf_layout);
  record.node_count = tree.node_count;
  record.leaf_block_count = tree.leaf_block_count;
  record.used_slots = tree.used_slots;
  record.used_lanes = tree.used_lanes;
  record.root = tree.view.root.bits;
  record.triangle_count = info.triangle_count;
  record.skipped_count = info.skipped_count;
  record.sah_cost = tree.sah_cost;
  record.build_seconds = info.build_seconds;
  copy(tree.view.centre, record.centre);
  copy(tree.view.greatest_bound, record.greatest_bound);
  std::memcpy(record.bounds_min, info.bounds_min, sizeof record.bounds_min);
  std::memcpy(record.bounds_max, info.bounds_max, sizeof record.bounds_max);
  return record;
}

/// The quality first, since it sets others.
Array<ParameterRecord> records_of(const SceneParameters& parameters, Memory& memory) {
  GrowingArray<ParameterRecord> records(memory);
  const auto add = [&](uint32_t number) { records.push_back({number, 0, parameters[number]}); };
  add(KIWAMI_PARAMETER_QUALITY);
  for (uint32_t number = 0; number < SceneParameters::kLimit; ++number) {
    if (is_parameter(number) && number != KIWAMI_PARAMETER_QUALITY) add(number);
  }
  for (const uint32_t method : parameters.optimizers()) {
    records.push_back({kOptimizer, 0, static_cast<double>(method)});
  }
  return records.take();
}

void restore_parameters(std::span<const ParameterRecord> records, SceneParameters& parameters) {
  uint32_t optimizers[KIWAMI_MAX_OPTIMIZERS];
  size_t optimizer_count = 0;
  for (const ParameterRecord& record : records) {
    if (record.parameter != kOptimizer) {
      parameters.set(record.parameter, record.value);
      continue;
    }
    if (optimizer_count == KIWAMI_MAX_OPTIMIZERS || !(record.value >= 0 && record.value < 256)) {
      fail("the file has optimizer %g after %zu others, expected at most %d", record.value,
           optimizer_count, KIWAMI_MAX_OPTIMIZERS);
    }
    optimizers[optimizer_count++] = static_cast<uint32_t>(record.value);
  }
  parameters.set_optimizers({optimizers, optimizer_count});
}

/// The tree of a file, its sizes checked, its contents not.
WideTree tree_of(const SceneRecord& record, std::span<const unsigned char> bytes) {
  const uint32_t width = record.bvh_width;
  if ((width != 4 && width != 8 && width != 16) || record.leaf_width != width) {
    fail("the tree is %u wide with leaf blocks of %u, expected 4, 8 or 16 of both", width,
         record.leaf_width);
  }
  const auto leaf_layout = static_cast<LeafLayout>(record.leaf_layout);
  if (leaf_layout != LeafLayout::kTriangles && leaf_layout != LeafLayout::kIndices) {
    fail("the leaf layout of the tree is %u, expected 0 or 1", record.leaf_layout);
  }
  WideTree tree;
  tree.width = tree.leaf_width = width;
  tree.leaf_layout = tree.view.leaf_layout = leaf_layout;
  // Neither product below can overflow once this holds.
  if (record.node_count <= bytes.size() && record.leaf_block_count <= bytes.size()) {
    tree.node_count = record.node_count;
    tree.leaf_block_count = record.leaf_block_count;
  }
  if (tree.node_count != record.node_count || tree.leaf_block_count != record.leaf_block_count ||
      tree.node_bytes() + tree.leaf_bytes() != bytes.size()) {
    fail("the tree has %zu bytes, expected those of %llu nodes and %llu leaf blocks", bytes.size(),
         ull{record.node_count}, ull{record.leaf_block_count});
  }
  tree.memory =
      Array<unsigned char>::borrow(const_cast<unsigned char*>(bytes.data()), bytes.size());
  tree.view.memory = tree.memory.data();
  tree.view.memory_bytes = tree.memory.size();
  tree.view.root.bits = record.root;
  tree.view.centre = vector_of(record.centre);
  tree.view.greatest_bound = vector_of(record.greatest_bound);
  tree.view.has_duplicates = record.has_duplicates != 0 ? 1 : 0;
  tree.used_slots = record.used_slots;
  tree.used_lanes = record.used_lanes;
  tree.depth = record.depth;
  tree.sah_cost = record.sah_cost;
  return tree;
}

/// Of a scene of nothing they are turned inside out and never used.
void check_bounds(const SceneRecord& record) {
  for (int axis = 0; axis < 3 && record.triangle_count != 0; ++axis) {
    const float lower = record.bounds_min[axis], upper = record.bounds_max[axis];
    // False where one is NaN.
    if (-KIWAMI_MAX_COORDINATE <= lower && lower <= upper && upper <= KIWAMI_MAX_COORDINATE) {
      continue;
    }
    fail("the scene reaches from %g to %g on axis %d, expected finite numbers",
         static_cast<double>(lower), static_cast<double>(upper), axis);
  }
}

/// One load, step by step.
class SceneLoader {
 public:
  SceneLoader(Device& device, const kiwami_load_desc& desc)
      : device_(device),
        image_(Reference<FileImage>::adopt(FileImage::create(device, desc))),
        reader_(image_->data(), image_->size()),
        bvh_width_(desc.bvh_width),
        is_trusted_((desc.flags & KIWAMI_LOAD_TRUSTED) != 0) {}

  Reference<Scene> run() {
    reader_.check_kind(KIWAMI_FILE_SCENE);
    if (!is_trusted_) reader_.check_sums(device_.memory(), device_.parallel());
    scene_ = Reference<Scene>::adopt(Scene::create(device_));
    blame_file([&] {
      restore_parameters(reader_.array<ParameterRecord>(SectionType::kParameters),
                         scene_->parameters());
    });
    const SavedMeshes meshes(reader_);
    for (uint32_t id = 0; id < meshes.size(); ++id) {
      const Reference<TriangleMesh> mesh = meshes.make(id, device_, *image_, is_trusted_);
      if (mesh.get()) scene_->attach_as(id, *mesh);
    }
    take_tree(meshes);
    return scene_;
  }

 private:
  void take_tree(const SavedMeshes& meshes) {
    const auto record = reader_.record<SceneRecord>(SectionType::kScene);
    if (record.triangle_count > meshes.triangle_count() ||
        record.skipped_count != meshes.triangle_count() - record.triangle_count) {
      fail("the scene has %llu triangles and skips %llu, expected all %llu of its meshes",
           ull{record.triangle_count}, ull{record.skipped_count}, ull{meshes.triangle_count()});
    }
    if (!is_trusted_) check_bounds(record);
    SavedTree saved{image_,
                    tree_of(record, reader_.array<unsigned char>(SectionType::kTree)),
                    record.triangle_count,
                    {vector_of(record.bounds_min), vector_of(record.bounds_max)},
                    record.build_seconds};
    if (bvh_width_ != 0 && bvh_width_ != record.bvh_width) {
      scene_->parameters().set(KIWAMI_PARAMETER_BVH_WIDTH, bvh_width_);
      scene_->commit();
      return;
    }
    if (!is_trusted_) {
      check_references(saved.tree, meshes.triangle_count(), device_.memory(), device_.parallel());
    }
    scene_->restore(std::move(saved));
  }

  Device& device_;
  Reference<FileImage> image_;
  FileReader reader_;
  uint32_t bvh_width_;
  bool is_trusted_;
  Reference<Scene> scene_;
};

uint32_t fit_of(uint32_t width, const Device& device) {
  const bool is_native = width < 32 && (device.info().native_widths >> width & 1) != 0;
  if (is_native) return KIWAMI_FIT_NATIVE;
  return width == 4 || width == 8 || width == 16 ? uint32_t{KIWAMI_FIT_SCALAR}
                                                 : uint32_t{KIWAMI_FIT_NONE};
}

void describe_scene(const FileReader& reader, const Device& device, kiwami_file_info& info) {
  const auto record = reader.record<SceneRecord>(SectionType::kScene);
  info.bvh_width = record.bvh_width;
  info.triangle_count = record.triangle_count;
  info.node_count = record.node_count;
  info.fit = fit_of(record.bvh_width, device);
}

void describe_bvh(const FileReader& reader, kiwami_file_info& info) {
  info.bvh_width = reader.record<BvhRecord>(SectionType::kBvh).width;
  info.triangle_count = reader.array<uint32_t>(SectionType::kPrimitives).size();
  info.node_count = reader.array<kiwami_bvh_node>(SectionType::kNodes).size();
}

}  // namespace

uint64_t save_scene(const Scene& scene, const CommittedScene& committed,
                    const kiwami_save_desc& desc) {
  if (!committed.is_plain()) {
    throw Error(KIWAMI_ERROR_INVALID_STATE,
                "the scene holds more than static triangle meshes, expected nothing else: files "
                "cannot hold it");
  }
  Memory& memory = scene.device().memory();
  const SceneRecord record = record_of(committed);
  const Array<ParameterRecord> parameters = records_of(scene.parameters(), memory);
  const MeshSections meshes(committed.source(), memory);
  const WideTree& tree = committed.tree();
  FileWriter writer(KIWAMI_FILE_SCENE, memory, committed.parallel());
  writer.begin_section(SectionType::kScene, 1);
  writer.add(&record, 1);
  writer.begin_section(SectionType::kParameters, 1);
  writer.add(parameters.data(), parameters.size());
  meshes.add_to(writer);
  writer.begin_section(SectionType::kTree, 1, kPageAlignment);
  writer.add(tree.memory.data(), tree.memory.size());
  return save(writer, desc);
}

Scene* load_scene(Device& device, const kiwami_load_desc& desc) {
  const Reference<Scene> scene = SceneLoader(device, desc).run();
  scene->retain();
  return scene.get();
}

kiwami_file_info describe_file(Device& device, const kiwami_load_desc& desc) {
  kiwami_load_desc mapped = desc;
  // Nothing but the beginning is read, and data needs no alignment for that.
  if (desc.path) mapped.flags = KIWAMI_LOAD_MAP;
  Reference<FileImage> image;
  if (desc.path) image = Reference<FileImage>::adopt(FileImage::create(device, mapped));
  const FileReader reader =
      desc.path ? FileReader(image->data(), image->size())
                : FileReader(static_cast<const unsigned char*>(desc.data), desc.size);
  kiwami_file_info info{};
  info.struct_size = sizeof info;
  info.kind = reader.header().kind;
  info.format_version = reader.header().format_version;
  info.library_version = reader.header().library_version;
  info.section_count = reader.header().section_count;
  info.file_bytes = reader.header().file_bytes;
  const bool is_known = is_known_version(reader.header()) && reader.knows_sections();
  if (is_known && info.kind == KIWAMI_FILE_SCENE) {
    describe_scene(reader, device, info);
  } else if (is_known && info.kind == KIWAMI_FILE_BVH) {
    describe_bvh(reader, info);
  } else {
    info.fit = KIWAMI_FIT_NONE;
  }
  return info;
}

}  // namespace kiwami

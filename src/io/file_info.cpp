// SPDX-License-Identifier: Apache-2.0
#include "core/error.h"
#include "io/file_reader.h"
#include "io/scene_file.h"

namespace kiwami {
namespace {

using namespace file;

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

void describe_lights(const FileReader& reader, kiwami_file_info& info) {
  const auto record = reader.record<LightSetRecord>(SectionType::kLightSet);
  info.bvh_width = record.width;
  info.triangle_count = reader.array<uint32_t>(SectionType::kLightUserIds).size();
  info.node_count = record.node_count;
}

}  // namespace

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
  } else if (is_known && info.kind == KIWAMI_FILE_LIGHTS) {
    describe_lights(reader, info);
  } else {
    info.fit = KIWAMI_FIT_NONE;
  }
  return info;
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
#include "core/opacity_map.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"

namespace kiwami {
namespace {

constexpr uint64_t kMostMaps = KIWAMI_OPACITY_ALL_TRANSPARENT;

void check_map_count(uint64_t map_count, bool has_indices, uint32_t triangle_count) {
  if (map_count > kMostMaps) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.map_count is %llu, expected at most %llu",
                static_cast<unsigned long long>(map_count),
                static_cast<unsigned long long>(kMostMaps));
  }
  if (has_indices || map_count >= triangle_count) return;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
              "desc.map_count is %llu and desc.indices is NULL, expected a map for each of the %u "
              "triangles",
              static_cast<unsigned long long>(map_count), triangle_count);
}

void check_index(size_t i, uint32_t index, uint64_t map_count) {
  if (index < map_count || index >= KIWAMI_OPACITY_ALL_TRANSPARENT) return;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
              "index %zu of desc.indices is %u, expected below the map_count of %llu, or one of "
              "KIWAMI_OPACITY_ALL_*",
              i, index, static_cast<unsigned long long>(map_count));
}

}  // namespace

size_t opacity_map_bytes(uint32_t format, uint32_t level) {
  return std::max<size_t>(1, (size_t{format} << (2 * level)) / 8);
}

Reference<OpacityMap> OpacityMap::create(Device& device, const kiwami_opacity_desc& desc,
                                         uint32_t triangle_count) {
  return Reference<OpacityMap>::adopt(
      make_object<OpacityMap>(device.memory(), device, desc, triangle_count));
}

void OpacityMap::destroy(OpacityMap* map) noexcept {
  const Reference<Device> device = map->device_;
  destroy_object(device->memory(), map);
}

OpacityMap::OpacityMap(Device& device, const kiwami_opacity_desc& desc, uint32_t triangle_count)
    : device_(device) {
  check_map_count(desc.map_count, desc.indices != nullptr, triangle_count);
  copy_indices(desc, triangle_count);
  const size_t bytes = opacity_map_bytes(desc.format, desc.level);
  const size_t stride = desc.map_stride ? static_cast<size_t>(desc.map_stride) : bytes;
  const auto count = static_cast<size_t>(desc.map_count);
  maps_ = Array<unsigned char>(device.memory(), count * bytes);
  for (size_t i = 0; i < count; ++i) {
    std::memcpy(&maps_[i * bytes], static_cast<const unsigned char*>(desc.maps) + i * stride,
                bytes);
  }
  view_ = {maps_.data(), bytes, indices_.empty() ? nullptr : indices_.data(), desc.level,
           desc.format};
}

OpacityMap::OpacityMap(Device& device, FileImage& image, const SavedMaps& saved,
                       uint32_t triangle_count, bool is_trusted)
    : device_(device), image_(image) {
  check_map_count(saved.map_count, saved.indices != nullptr, triangle_count);
  const size_t bytes = opacity_map_bytes(saved.format, saved.level);
  maps_ = Array<unsigned char>::borrow(const_cast<unsigned char*>(saved.maps),
                                       static_cast<size_t>(saved.map_count) * bytes);
  if (saved.indices) {
    indices_ = Array<uint32_t>::borrow(const_cast<uint32_t*>(saved.indices), triangle_count);
  }
  for (size_t i = 0; !is_trusted && i < indices_.size(); ++i) {
    check_index(i, indices_[i], saved.map_count);
  }
  view_ = {maps_.data(), bytes, saved.indices, saved.level, saved.format};
}

void OpacityMap::copy_indices(const kiwami_opacity_desc& desc, uint32_t triangle_count) {
  if (!desc.indices) return;
  const size_t stride = desc.index_stride ? static_cast<size_t>(desc.index_stride) : 4;
  indices_ = Array<uint32_t>(device_->memory(), triangle_count);
  for (size_t i = 0; i < triangle_count; ++i) {
    std::memcpy(&indices_[i], static_cast<const unsigned char*>(desc.indices) + i * stride, 4);
    check_index(i, indices_[i], desc.map_count);
  }
}

}  // namespace kiwami

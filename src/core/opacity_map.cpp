// SPDX-License-Identifier: Apache-2.0
#include "core/opacity_map.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"

namespace kiwami {
namespace {

constexpr uint64_t kMostMaps = KIWAMI_OPACITY_ALL_TRANSPARENT;

size_t map_bytes_of(const kiwami_opacity_desc& desc) {
  return std::max<size_t>(1, (size_t{desc.format} << (2 * desc.level)) / 8);
}

}  // namespace

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
  if (desc.map_count > kMostMaps) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.map_count is %llu, expected at most %llu",
                static_cast<unsigned long long>(desc.map_count),
                static_cast<unsigned long long>(kMostMaps));
  }
  copy_indices(desc, triangle_count);
  const size_t bytes = map_bytes_of(desc);
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

void OpacityMap::copy_indices(const kiwami_opacity_desc& desc, uint32_t triangle_count) {
  if (!desc.indices) {
    if (desc.map_count >= triangle_count) return;
    throw Error(
        KIWAMI_ERROR_INVALID_ARGUMENT,
        "desc.map_count is %llu and desc.indices is NULL, expected a map for each of the %u "
        "triangles",
        static_cast<unsigned long long>(desc.map_count), triangle_count);
  }
  const size_t stride = desc.index_stride ? static_cast<size_t>(desc.index_stride) : 4;
  indices_ = Array<uint32_t>(device_->memory(), triangle_count);
  for (size_t i = 0; i < triangle_count; ++i) {
    std::memcpy(&indices_[i], static_cast<const unsigned char*>(desc.indices) + i * stride, 4);
    if (indices_[i] < desc.map_count || indices_[i] >= KIWAMI_OPACITY_ALL_TRANSPARENT) continue;
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "index %zu of desc.indices is %u, expected below the map_count of %llu, or one of "
                "KIWAMI_OPACITY_ALL_*",
                i, indices_[i], static_cast<unsigned long long>(desc.map_count));
  }
}

}  // namespace kiwami

// SPDX-License-Identifier: Apache-2.0
// Files in memory and in a folder of the test's own.
#pragma once

#include <filesystem>
#include <string>

#include "api/api_support.h"
#include "support/file_forger.h"
#include "support/rich_scene.h"

namespace kiwami_api_tests {

using kiwami_tests::Bytes;

kiwami_save_desc default_save();
kiwami_load_desc default_load();

/// Fail the running test where the call fails.
Bytes saved(const Scene& scene);
Bytes saved(const Bvh& bvh);

/// The result of the call; what was loaded goes to the handle, if any was.
kiwami_result load(const Device& device, const kiwami_load_desc& desc, Scene& scene);
kiwami_result load(const Device& device, const kiwami_load_desc& desc, Bvh& bvh);
/// The same of bytes.
template <typename Handle>
kiwami_result load(const Device& device, const Bytes& file, uint32_t flags, Handle& handle) {
  kiwami_load_desc desc = default_load();
  // Never NULL, which would stand for no data.
  static const unsigned char kNothing = 0;
  desc.data = file.empty() ? &kNothing : file.data();
  desc.size = file.size();
  desc.flags = flags;
  return load(device, desc, handle);
}

/// A folder that is gone with the test.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// The names of what is in it.
  std::vector<std::string> names() const;

 private:
  std::filesystem::path folder_;
};

/// A file in memory at a multiple of 64, as a caller would map it.
class AlignedCopy {
 public:
  explicit AlignedCopy(const Bytes& bytes);
  unsigned char* data() { return data_; }

 private:
  Bytes storage_;
  unsigned char* data_;
};

void write_file(const std::string& path, const Bytes& bytes);
Bytes read_file(const std::string& path);

/// A scene of support/rich_scene.h.
Scene make_rich_scene(const Device& device, uint32_t parts, uint32_t size, uint32_t width);

/// A scene of several meshes with gaps between their numbers, one without indices, one masked, one
/// with a bad vertex, from buffers with gaps.
Scene make_mixed_scene(const Device& device, uint32_t triangles, uint32_t width);

}  // namespace kiwami_api_tests

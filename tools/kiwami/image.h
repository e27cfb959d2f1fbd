// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kiwami::tools {

/// Rows of red, green and blue bytes, from the top.
struct Image {
  uint32_t width = 0;
  uint32_t height = 0;
  std::vector<uint8_t> pixels;
};

/// Throws UsageError unless the name ends in .png or .ppm and the file can be written. A file that
/// exists is left as it is; `option` is named by the error.
void check_image_path(const std::string& option, const std::filesystem::path& path);

/// Throws UsageError unless the file can be written.
void check_writable(const std::string& option, const std::filesystem::path& path);

/// Writes a PNG or PPM file, by the name. Throws UsageError when that fails.
void write_image(const Image& image, const std::filesystem::path& path);

/// Writes a whole file. Throws UsageError when that fails.
void write_file(const std::filesystem::path& path, const std::string& bytes);

/// The pictures next to each other; all of one height.
Image side_by_side(const std::vector<Image>& images);

}  // namespace kiwami::tools

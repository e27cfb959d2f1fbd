// SPDX-License-Identifier: Apache-2.0
#include "kiwami/image.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "kiwami/options.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace kiwami::tools {
namespace {

namespace fs = std::filesystem;

void append_bytes(void* text, void* data, int size) {
  static_cast<std::string*>(text)->append(static_cast<const char*>(data),
                                          static_cast<size_t>(size));
}

std::string encode_png(const Image& image) {
  std::string bytes;
  const auto width = static_cast<int>(image.width);
  const auto height = static_cast<int>(image.height);
  if (stbi_write_png_to_func(append_bytes, &bytes, width, height, 3, image.pixels.data(),
                             width * 3) == 0) {
    throw UsageError("the picture cannot be encoded as PNG");
  }
  return bytes;
}

std::string encode_ppm(const Image& image) {
  std::string bytes =
      "P6\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n255\n";
  bytes.append(image.pixels.begin(), image.pixels.end());
  return bytes;
}

std::string reason_of_errno() { return errno != 0 ? std::strerror(errno) : "unknown reason"; }

}  // namespace

void check_writable(const std::string& option, const fs::path& path) {
  std::error_code error;
  const bool existed = fs::exists(path, error);
  if (fs::is_directory(path, error)) {
    throw UsageError(option + " is '" + path.string() + "', which is a directory");
  }
  errno = 0;
  if (!std::ofstream(path, std::ios::binary | std::ios::app)) {
    throw UsageError(option + " is '" + path.string() +
                     "', which cannot be written: " + reason_of_errno());
  }
  if (!existed) fs::remove(path, error);
}

void check_image_path(const std::string& option, const fs::path& path) {
  if (path.extension() != ".png" && path.extension() != ".ppm") {
    throw UsageError(option + " is '" + path.string() +
                     "', expected a name that ends in .png or "
                     ".ppm");
  }
  check_writable(option, path);
}

void write_file(const fs::path& path, const std::string& bytes) {
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw UsageError("cannot write '" + path.string() + "': " + reason_of_errno());
}

void write_image(const Image& image, const fs::path& path) {
  write_file(path, path.extension() == ".ppm" ? encode_ppm(image) : encode_png(image));
}

Image side_by_side(const std::vector<Image>& images) {
  Image joined;
  for (const Image& image : images) joined.width += image.width;
  joined.height = images.empty() ? 0 : images.front().height;
  joined.pixels.reserve(size_t{joined.width} * joined.height * 3);
  for (uint32_t y = 0; y < joined.height; ++y) {
    for (const Image& image : images) {
      const auto row = image.pixels.begin() + ptrdiff_t{y} * image.width * 3;
      joined.pixels.insert(joined.pixels.end(), row, row + ptrdiff_t{image.width} * 3);
    }
  }
  return joined;
}

}  // namespace kiwami::tools

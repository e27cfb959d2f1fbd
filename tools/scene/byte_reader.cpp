// SPDX-License-Identifier: Apache-2.0
#include "scene/byte_reader.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "scene/scene_file.h"

namespace kiwami::tools {
namespace {

constexpr size_t kChunkBytes = size_t{1} << 24;
/// Deflate cannot do better: a match of 258 bytes takes at least two bits.
constexpr uint64_t kGreatestDeflateRatio = 1032;

}  // namespace

ByteReader::ByteReader(const std::filesystem::path& path) : path_(path) {
  errno = 0;
  file_ = gzopen(path.c_str(), "rb");
  if (file_ == nullptr) fail(errno != 0 ? std::strerror(errno) : "it cannot be opened");
  gzbuffer(file_, 1u << 18);
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(path, error);
  most_bytes_ = error ? 0 : gzdirect(file_) ? size : size * kGreatestDeflateRatio;
}

ByteReader::~ByteReader() {
  if (file_ != nullptr) gzclose_r(file_);
}

uint64_t ByteReader::most_bytes_left() const {
  return most_bytes_ > bytes_read_ ? most_bytes_ - bytes_read_ : 0;
}

void ByteReader::fail(const std::string& reason) const {
  throw SceneError("cannot read '" + path_.string() + "': " + reason);
}

size_t ByteReader::read_some(void* data, size_t size) {
  size_t done = 0;
  while (done < size) {
    const auto wanted = static_cast<unsigned>(std::min(size - done, kChunkBytes));
    const int got = gzread(file_, static_cast<char*>(data) + done, wanted);
    int code = Z_OK;
    const char* message = gzerror(file_, &code);
    if (code == Z_BUF_ERROR) fail("its compressed data is truncated");
    if (code == Z_ERRNO) fail(std::strerror(errno));
    if (got < 0) fail(std::string("its compressed data is broken (") + message + ")");
    if (got == 0) break;
    done += static_cast<size_t>(got);
  }
  bytes_read_ += done;
  return done;
}

void ByteReader::read_exactly(void* data, size_t size) {
  if (read_some(data, size) < size) fail("it is truncated");
}

uint32_t ByteReader::read_u32() {
  unsigned char bytes[4];
  read_exactly(bytes, sizeof bytes);
  return uint32_t{bytes[0]} | uint32_t{bytes[1]} << 8 | uint32_t{bytes[2]} << 16 |
         uint32_t{bytes[3]} << 24;
}

template <typename T>
std::vector<T> ByteReader::read_array(uint64_t count) {
  static_assert(sizeof(T) == 4);
  if (count > most_bytes_left() / sizeof(T)) {
    fail("it is truncated, or its header's counts are wrong");
  }
  std::vector<T> elements;
  if (file_ != nullptr && gzdirect(file_)) elements.reserve(count);
  while (elements.size() < count) {
    const size_t done = elements.size();
    const auto part =
        static_cast<size_t>(std::min<uint64_t>(count - done, kChunkBytes / sizeof(T)));
    elements.resize(done + part);
    read_exactly(elements.data() + done, part * sizeof(T));
  }
  return elements;
}

template std::vector<float> ByteReader::read_array<float>(uint64_t);
template std::vector<uint32_t> ByteReader::read_array<uint32_t>(uint64_t);

std::string ByteReader::read_text() {
  std::string text;
  for (;;) {
    const size_t done = text.size();
    text.resize(done + (size_t{1} << 20));
    const size_t got = read_some(text.data() + done, text.size() - done);
    if (got < text.size() - done) {
      text.resize(done + got);
      return text;
    }
  }
}

void ByteReader::expect_end() {
  char byte;
  if (read_some(&byte, 1) != 0) fail("it is longer than its header's counts say");
}

}  // namespace kiwami::tools

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

struct gzFile_s;

namespace kiwami::tools {

/// Reads a file from its beginning, gzip-compressed or not. Every method throws SceneError.
class ByteReader {
 public:
  explicit ByteReader(const std::filesystem::path& path);
  ~ByteReader();
  ByteReader(const ByteReader&) = delete;
  ByteReader& operator=(const ByteReader&) = delete;

  /// The bytes that are left can at most be this many: exact for a plain file, and for a
  /// compressed one what deflate's greatest ratio allows.
  uint64_t most_bytes_left() const;

  /// The next `count` elements. Memory grows with what the file really holds, so a count that
  /// lies costs nothing.
  template <typename T>
  std::vector<T> read_array(uint64_t count);

  uint32_t read_u32();
  /// All that is left.
  std::string read_text();
  /// Throws unless everything has been read.
  void expect_end();

  const std::filesystem::path& path() const { return path_; }
  [[noreturn]] void fail(const std::string& reason) const;

 private:
  /// Up to `size` bytes, fewer only at the end of the file.
  size_t read_some(void* data, size_t size);
  void read_exactly(void* data, size_t size);

  std::filesystem::path path_;
  gzFile_s* file_ = nullptr;
  uint64_t most_bytes_ = 0;
  uint64_t bytes_read_ = 0;
};

extern template std::vector<float> ByteReader::read_array<float>(uint64_t);
extern template std::vector<uint32_t> ByteReader::read_array<uint32_t>(uint64_t);

}  // namespace kiwami::tools

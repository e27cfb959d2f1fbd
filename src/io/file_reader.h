// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <span>

#include "core/file_image.h"
#include "core/memory.h"
#include "io/file_format.h"
#include "parallel/parallel.h"

namespace kiwami::file {

/// A file, seen through its directory. Nothing outside the image is ever read.
class FileReader {
 public:
  /// Checks the header and the directory. Throws Error(INVALID_FILE).
  FileReader(const unsigned char* data, size_t size);

  const Header& header() const { return header_; }

  /// Whether this library knows all sections that it must.
  bool knows_sections() const { return first_unknown() == header_.section_count; }
  /// Throws unless the file is of this kind, and this library knows all sections that it must.
  void check_kind(uint32_t kind) const;
  /// Throws Error(INVALID_FILE) for a section whose bytes are not what was written.
  void check_sums(Memory& memory, const Parallel& parallel) const;

  /// Scenes of the file: their numbers are below.
  uint32_t scene_count() const { return scene_count_; }
  /// Whether any scene has a section of the type.
  bool has(SectionType type) const;

  /// A section as an array, empty where there is none. Throws Error(INVALID_FILE) for one of
  /// another version, or not one of whole elements.
  template <typename T>
  std::span<const T> array(SectionType type, uint32_t scene = 0) const {
    const std::span<const unsigned char> bytes = section(type, scene, sizeof(T));
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  /// A section of one element, at any address. Throws Error(INVALID_FILE) where there is none.
  template <typename T>
  T record(SectionType type, uint32_t scene = 0) const {
    const std::span<const unsigned char> bytes = section(type, scene, sizeof(T));
    check_single(type, scene, bytes.size() / sizeof(T));
    T element;
    std::memcpy(&element, bytes.data(), sizeof element);
    return element;
  }

 private:
  SectionEntry entry(uint32_t number) const;
  uint32_t first_unknown() const;
  void check_header() const;
  void check_directory();
  void check_place(uint32_t number, uint64_t end) const;
  uint32_t first_entry_of(uint32_t scene) const;
  std::span<const unsigned char> section(SectionType type, uint32_t scene,
                                         size_t element_size) const;
  void check_single(SectionType type, uint32_t scene, size_t count) const;

  const unsigned char* data_;
  size_t size_;
  Header header_;
  uint32_t scene_count_ = 0;
};

/// Whether the library that wrote a file was one that this one can read.
bool is_known_version(const Header& header);

}  // namespace kiwami::file

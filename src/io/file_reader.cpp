// SPDX-License-Identifier: Apache-2.0
#include "io/file_reader.h"

#include "core/error.h"
#include "io/checksum.h"

namespace kiwami::file {
namespace {

using ull = unsigned long long;

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  if constexpr (sizeof...(values) == 0) {
    throw Error(KIWAMI_ERROR_INVALID_FILE, "%s", format);
  } else {
    throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
  }
}

bool is_known(uint32_t type) {
  return type >= static_cast<uint32_t>(SectionType::kScene) &&
         type <= static_cast<uint32_t>(SectionType::kMovingArrays);
}

const char* name_of_kind(uint32_t kind) {
  return kind == KIWAMI_FILE_SCENE    ? "scene"
         : kind == KIWAMI_FILE_BVH    ? "tree"
         : kind == KIWAMI_FILE_LIGHTS ? "set of lights"
                                      : "thing of a newer library";
}

}  // namespace

bool is_known_version(const Header& header) {
  return header.format_version == KIWAMI_FILE_FORMAT_VERSION;
}

FileReader::FileReader(const unsigned char* data, size_t size) : data_(data), size_(size) {
  if (size < sizeof(Header)) {
    fail("the file has %zu bytes, expected at least the %zu of a header", size, sizeof(Header));
  }
  std::memcpy(&header_, data, sizeof header_);
  check_header();
  if (is_known_version(header_)) check_directory();
}

void FileReader::check_header() const {
  if (std::memcmp(header_.magic, kMagic, sizeof kMagic) != 0) {
    fail("the file does not begin like one of this library");
  }
  if (header_.byte_order != kByteOrder) {
    fail("the file's byte order is 0x%08x, expected 0x%08x", header_.byte_order, kByteOrder);
  }
  if (header_.header_checksum != hash_of(data_, offsetof(Header, header_checksum))) {
    fail("the checksum of the header is wrong: the file is damaged");
  }
  if (header_.file_bytes != size_) {
    fail("the file has %zu bytes, expected %llu: it was cut, or something was added", size_,
         ull{header_.file_bytes});
  }
}

SectionEntry FileReader::entry(uint32_t number) const {
  SectionEntry entry;
  std::memcpy(&entry, data_ + sizeof(Header) + number * sizeof(SectionEntry), sizeof entry);
  return entry;
}

void FileReader::check_directory() {
  if (header_.section_count > (size_ - sizeof(Header)) / sizeof(SectionEntry)) {
    fail("the directory has %u sections, expected at most the %zu that the file has room for",
         header_.section_count, (size_ - sizeof(Header)) / sizeof(SectionEntry));
  }
  const size_t directory_bytes = header_.section_count * sizeof(SectionEntry);
  if (header_.directory_checksum != hash_of(data_ + sizeof(Header), directory_bytes)) {
    fail("the checksum of the directory is wrong: the file is damaged");
  }
  uint64_t end = sizeof(Header) + directory_bytes;
  for (uint32_t i = 0; i < header_.section_count; ++i) {
    check_place(i, end);
    const SectionEntry section = entry(i);
    end = section.offset + section.bytes;
    // So the scenes are not more than the sections, and those of one are found quickly.
    const uint32_t least = scene_count_ == 0 ? 0 : scene_count_ - 1;
    const uint32_t most = header_.kind == KIWAMI_FILE_BVH ? 0 : scene_count_;
    if (section.scene < least || section.scene > most) {
      fail("section %u is of scene %u, expected %u to %u", i, section.scene, least, most);
    }
    if (section.scene == scene_count_) ++scene_count_;
  }
}

void FileReader::check_place(uint32_t number, uint64_t end) const {
  const SectionEntry section = entry(number);
  if (section.offset < end || section.offset > size_ || section.bytes > size_ - section.offset) {
    fail("section %u has %llu bytes from byte %llu on, expected some from byte %llu to %zu", number,
         ull{section.bytes}, ull{section.offset}, ull{end}, size_);
  }
  if (section.offset % kSectionAlignment != 0) {
    fail("section %u begins at byte %llu, expected a multiple of %zu", number, ull{section.offset},
         kSectionAlignment);
  }
}

uint32_t FileReader::first_entry_of(uint32_t scene) const {
  uint32_t low = 0, high = header_.section_count;
  while (low < high) {
    const uint32_t middle = low + (high - low) / 2;
    if (entry(middle).scene < scene) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

bool FileReader::has(SectionType type) const {
  for (uint32_t i = 0; i < header_.section_count; ++i) {
    if (entry(i).type == static_cast<uint32_t>(type)) return true;
  }
  return false;
}

uint32_t FileReader::first_unknown() const {
  for (uint32_t i = 0; i < header_.section_count; ++i) {
    const SectionEntry section = entry(i);
    if ((section.flags & kSectionRequired) == 0) continue;
    if (!is_known(section.type) || section.version != kSectionVersion) return i;
  }
  return header_.section_count;
}

void FileReader::check_kind(uint32_t kind) const {
  if (!is_known_version(header_)) {
    fail("the file is of format version %u, expected %d: %s library wrote it",
         header_.format_version, KIWAMI_FILE_FORMAT_VERSION,
         header_.format_version > KIWAMI_FILE_FORMAT_VERSION ? "a newer" : "an older");
  }
  if (header_.kind != kind) {
    fail("the file holds a %s, expected a %s", name_of_kind(header_.kind), name_of_kind(kind));
  }
  const uint32_t unknown = first_unknown();
  if (unknown == header_.section_count) return;
  fail(
      "section %u is of type %u and version %u, which this library does not know: a newer one "
      "wrote the file",
      unknown, entry(unknown).type, entry(unknown).version);
}

void FileReader::check_sums(Memory& memory, const Parallel& parallel) const {
  for (uint32_t i = 0; i < header_.section_count; ++i) {
    const SectionEntry section = entry(i);
    const uint64_t sum =
        checksum_of(data_ + section.offset, static_cast<size_t>(section.bytes), memory, parallel);
    if (sum == section.checksum) continue;
    fail("the checksum of section %u (type %u) is %016llx, expected %016llx: the file is damaged",
         i, section.type, ull{sum}, ull{section.checksum});
  }
}

std::span<const unsigned char> FileReader::section(SectionType type, uint32_t scene,
                                                   size_t element_size) const {
  for (uint32_t i = first_entry_of(scene); i < header_.section_count; ++i) {
    const SectionEntry section = entry(i);
    if (section.scene != scene) break;
    if (section.type != static_cast<uint32_t>(type)) continue;
    if (section.version != kSectionVersion || section.bytes % element_size != 0) {
      fail(
          "section %u (type %u) has version %u and %llu bytes, expected version %u and a multiple "
          "of %zu bytes",
          i, section.type, section.version, ull{section.bytes}, kSectionVersion, element_size);
    }
    return {data_ + section.offset, static_cast<size_t>(section.bytes)};
  }
  return {};
}

void FileReader::check_single(SectionType type, uint32_t scene, size_t count) const {
  if (count == 1) return;
  fail("scene %u has %zu elements of type %u, expected 1", scene, count,
       static_cast<uint32_t>(type));
}

}  // namespace kiwami::file

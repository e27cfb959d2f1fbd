// SPDX-License-Identifier: Apache-2.0
#include "support/file_forger.h"

#include <algorithm>
#include <cstring>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace kiwami_tests {
namespace {

// The layout as docs/files.md tells it.
constexpr size_t kHeaderSize = 64, kEntrySize = 48, kPieceSize = size_t{1} << 20;
constexpr size_t kSectionCountAt = 24, kFileBytesAt = 32, kDirectorySumAt = 40, kHeaderSumAt = 56;
constexpr size_t kTypeAt = 0, kOffsetAt = 16, kBytesAt = 24, kSumAt = 32;

template <typename T>
T read(const Bytes& file, size_t at) {
  T value;
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}

template <typename T>
void write(Bytes& file, size_t at, T value) {
  std::memcpy(file.data() + at, &value, sizeof value);
}

uint64_t section_sum(const unsigned char* data, size_t size) {
  std::vector<uint64_t> sums;
  for (size_t at = 0; at < size; at += kPieceSize) {
    sums.push_back(XXH3_64bits(data + at, std::min(kPieceSize, size - at)));
  }
  return XXH3_64bits(sums.data(), sums.size() * sizeof(uint64_t));
}

/// How many of the stated sections the file has room for.
uint64_t section_count(const Bytes& file) {
  const uint64_t stated = read<uint32_t>(file, kSectionCountAt);
  return std::min<uint64_t>(stated, (file.size() - kHeaderSize) / kEntrySize);
}

}  // namespace

void forge_checksums(Bytes& file) {
  if (file.size() < kHeaderSize) return;
  const uint64_t count = section_count(file);
  for (uint64_t i = 0; i < count; ++i) {
    const size_t entry = kHeaderSize + static_cast<size_t>(i) * kEntrySize;
    const auto offset = read<uint64_t>(file, entry + kOffsetAt);
    const auto bytes = read<uint64_t>(file, entry + kBytesAt);
    if (offset > file.size() || bytes > file.size() - offset) continue;
    write(file, entry + kSumAt, section_sum(file.data() + offset, static_cast<size_t>(bytes)));
  }
  write(file, kDirectorySumAt, XXH3_64bits(file.data() + kHeaderSize, count * kEntrySize));
  write(file, kFileBytesAt, static_cast<uint64_t>(file.size()));
  write(file, kHeaderSumAt, XXH3_64bits(file.data(), kHeaderSumAt));
}

std::vector<ForgedSection> sections_of(const Bytes& file) {
  std::vector<ForgedSection> sections;
  for (uint64_t i = 0; i < section_count(file); ++i) {
    const size_t entry = kHeaderSize + static_cast<size_t>(i) * kEntrySize;
    sections.push_back({read<uint32_t>(file, entry + kTypeAt),
                        read<uint64_t>(file, entry + kOffsetAt),
                        read<uint64_t>(file, entry + kBytesAt)});
  }
  return sections;
}

}  // namespace kiwami_tests

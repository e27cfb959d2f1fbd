// SPDX-License-Identifier: Apache-2.0
#include "io/file_writer.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "io/checksum.h"

namespace kiwami::file {
namespace {

/// Elements with gaps between them that are packed at once.
constexpr size_t kPackedElements = 8192;

uint64_t aligned(uint64_t offset, uint64_t alignment) {
  return (offset + alignment - 1) / alignment * alignment;
}

constexpr unsigned char kZeros[kPageAlignment] = {};

void write_zeros(Sink& sink, uint64_t count) {
  for (; count != 0; count -= std::min<uint64_t>(count, sizeof kZeros)) {
    sink.write(kZeros, static_cast<size_t>(std::min<uint64_t>(count, sizeof kZeros)));
  }
}

}  // namespace

void FileWriter::begin_section(SectionType type, uint32_t scene, size_t alignment) {
  SectionEntry entry{};
  entry.type = static_cast<uint32_t>(type);
  entry.version = kSectionVersion;
  entry.flags = kSectionRequired;
  entry.scene = scene;
  sections_.push_back({entry, alignment, pieces_.size(), pieces_.size()});
}

void FileWriter::add(const void* data, size_t size, size_t stride, size_t count) {
  if (count == 0) return;
  pieces_.push_back({static_cast<const unsigned char*>(data), size, stride, count});
  sections_.back().end_piece = pieces_.size();
  sections_.back().entry.bytes += uint64_t{size} * count;
}

void FileWriter::align() {
  const uint64_t bytes = sections_.back().entry.bytes;
  add(kZeros, static_cast<size_t>(aligned(bytes, kSectionAlignment) - bytes));
}

template <typename Take>
void FileWriter::for_bytes(const Section& section, Take&& take) {
  for (size_t i = section.first_piece; i < section.end_piece; ++i) {
    const Piece& piece = pieces_[i];
    if (piece.size == piece.stride) {
      take(piece.data, piece.size * piece.count);
      continue;
    }
    if (packed_.bytes() < kPackedElements * piece.size) {
      packed_ = Array<unsigned char>(memory_, kPackedElements * piece.size);
    }
    for (size_t first = 0; first < piece.count; first += kPackedElements) {
      const size_t count = std::min(kPackedElements, piece.count - first);
      for (size_t k = 0; k < count; ++k) {
        std::memcpy(packed_.data() + k * piece.size, piece.data + (first + k) * piece.stride,
                    piece.size);
      }
      take(packed_.data(), count * piece.size);
    }
  }
}

uint64_t FileWriter::checksum_of_section(const Section& section) {
  if (section.end_piece - section.first_piece == 1) {
    const Piece& piece = pieces_[section.first_piece];
    if (piece.size == piece.stride) {
      return checksum_of(piece.data, piece.size * piece.count, memory_, parallel_);
    }
  }
  Checksum checksum;
  for_bytes(section, [&](const unsigned char* data, size_t size) { checksum.add(data, size); });
  return checksum.finish();
}

uint64_t FileWriter::place() {
  uint64_t offset = sizeof(Header) + sections_.size() * sizeof(SectionEntry);
  for (size_t i = 0; i < sections_.size(); ++i) {
    offset = aligned(offset, sections_[i].alignment);
    sections_[i].entry.offset = offset;
    offset += sections_[i].entry.bytes;
  }
  file_bytes_ = offset;
  return file_bytes_;
}

void FileWriter::write_beginning(Sink& sink) {
  Array<SectionEntry> directory(memory_, sections_.size());
  for (size_t i = 0; i < sections_.size(); ++i) {
    sections_[i].entry.checksum = checksum_of_section(sections_[i]);
    directory[i] = sections_[i].entry;
  }
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.byte_order = kByteOrder;
  header.format_version = KIWAMI_FILE_FORMAT_VERSION;
  header.library_version = kiwami_version();
  header.kind = kind_;
  header.section_count = static_cast<uint32_t>(directory.size());
  header.file_bytes = file_bytes_;
  header.directory_checksum = hash_of(directory.data(), directory.bytes());
  header.header_checksum = hash_of(&header, offsetof(Header, header_checksum));
  sink.write(&header, sizeof header);
  sink.write(directory.data(), directory.bytes());
}

void FileWriter::write(Sink& sink) {
  write_beginning(sink);
  uint64_t end = sizeof(Header) + sections_.size() * sizeof(SectionEntry);
  for (size_t i = 0; i < sections_.size(); ++i) {
    const Section& section = sections_[i];
    write_zeros(sink, section.entry.offset - end);
    for_bytes(section, [&](const unsigned char* data, size_t size) { sink.write(data, size); });
    end = section.entry.offset + section.entry.bytes;
  }
  sink.finish();
}

uint64_t save(FileWriter& writer, const kiwami_save_desc& desc) {
  const uint64_t bytes = writer.place();
  if (desc.path) {
    FileSink sink(desc.path);
    writer.write(sink);
  } else if (desc.write) {
    CallbackSink sink(desc.write, desc.write_user);
    writer.write(sink);
  } else if (desc.data && desc.capacity >= bytes) {
    MemorySink sink(desc.data);
    writer.write(sink);
  }
  return bytes;
}

}  // namespace kiwami::file

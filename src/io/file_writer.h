// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "io/file_format.h"
#include "io/sink.h"
#include "parallel/parallel.h"

namespace kiwami::file {

/// A file as a list of sections, each a list of pieces of the caller's memory, which must stay
/// until it is written. Equal contents give equal bytes.
class FileWriter {
 public:
  FileWriter(uint32_t kind, Memory& memory, const Parallel& parallel)
      : memory_(memory), parallel_(parallel), kind_(kind), sections_(memory), pieces_(memory) {}

  void begin_section(SectionType type, uint32_t scene = 0, size_t alignment = kSectionAlignment);

  /// Adds count elements of size bytes, stride bytes apart, which are written without gaps.
  void add(const void* data, size_t size, size_t stride, size_t count);
  template <typename T>
  void add(const T* data, size_t count) {
    add(data, sizeof(T), sizeof(T), count);
  }

  /// Fills the section with zeros up to a multiple of kSectionAlignment.
  void align();
  /// A section of such an array, unless it is empty.
  template <typename Elements>
  void add_section(SectionType type, uint32_t scene, const Elements& elements) {
    if (elements.size() == 0) return;
    begin_section(type, scene);
    add(elements.data(), elements.size());
  }

  /// The size of the file. Nothing may be added after it.
  uint64_t place();
  /// After place. Throws Error.
  void write(Sink& sink);

 private:
  struct Section {
    SectionEntry entry;
    size_t alignment;
    size_t first_piece;
    size_t end_piece;
  };
  struct Piece {
    const unsigned char* data;
    size_t size;
    size_t stride;
    size_t count;
  };

  /// Calls take(data, size) for the bytes of a section in their order.
  template <typename Take>
  void for_bytes(const Section& section, Take&& take);
  uint64_t checksum_of_section(const Section& section);
  void write_beginning(Sink& sink);

  Memory& memory_;
  const Parallel& parallel_;
  uint32_t kind_;
  GrowingArray<Section> sections_;
  GrowingArray<Piece> pieces_;
  Array<unsigned char> packed_;  ///< of pieces with gaps, some elements at once
  uint64_t file_bytes_ = 0;
};

/// Saves to where desc says, and says how many bytes there are. Throws Error.
uint64_t save(FileWriter& writer, const kiwami_save_desc& desc);

}  // namespace kiwami::file

// SPDX-License-Identifier: Apache-2.0
// Where a file goes: memory, a callback, or a file that takes its place at the end.
#pragma once

#include <climits>
#include <cstddef>

#include "core/memory.h"
#include "kiwami/io.h"

namespace kiwami::file {

class Sink {
 public:
  virtual ~Sink() = default;
  /// Throws Error.
  virtual void write(const void* data, size_t size) = 0;
  /// After the last byte. Throws Error.
  virtual void finish() {}
};

/// The caller's bytes, which are many enough.
class MemorySink : public Sink {
 public:
  explicit MemorySink(void* data) : next_(static_cast<unsigned char*>(data)) {}
  void write(const void* data, size_t size) override;

 private:
  unsigned char* next_;
};

class CallbackSink : public Sink {
 public:
  CallbackSink(kiwami_write function, void* user) : function_(function), user_(user) {}
  void write(const void* data, size_t size) override;

 private:
  kiwami_write function_;
  void* user_;
};

/// A file that is written beside the one of that name and takes its place when all bytes are on the
/// disk. Before that, an error or an end of the process leaves the old one whole. What is no
/// regular file is written to directly.
class FileSink : public Sink {
 public:
  explicit FileSink(const char* path);
  ~FileSink() override;
  FileSink(const FileSink&) = delete;
  FileSink& operator=(const FileSink&) = delete;

  void write(const void* data, size_t size) override;
  void finish() override;

 private:
  void open_beside(const char* path);
  void sync_folder() const;
  [[noreturn]] void fail(const char* what) const;

  int number_ = -1;
  bool is_beside_ = false;  ///< temporary_ exists and is not yet renamed
  char target_[PATH_MAX];   ///< without symbolic links, where the file exists
  char temporary_[PATH_MAX];
};

}  // namespace kiwami::file

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/device.h"
#include "core/memory.h"
#include "core/object.h"
#include "kiwami/io.h"

namespace kiwami {

/// All bytes of a file, at a multiple of 64: copied, mapped, or the caller's own. What is made of
/// them holds the image.
class FileImage : public Object<FileImage> {
 public:
  /// Throws Error(IO, CALLBACK, INVALID_ARGUMENT or OUT_OF_MEMORY). Takes no more memory than three
  /// times what there is to read.
  static FileImage* create(Device& device, const kiwami_load_desc& desc);
  static void destroy(FileImage* image) noexcept;

  FileImage(Device& device, const kiwami_load_desc& desc);
  ~FileImage();

  const unsigned char* data() const { return data_; }
  size_t size() const { return size_; }
  /// False for what is mapped or the caller's own.
  bool is_copy() const { return !copy_.empty(); }

 private:
  void take_data(const kiwami_load_desc& desc);
  void read_stream(kiwami_read read, void* user);
  void open_file(const char* path, bool maps);

  Reference<Device> device_;
  Array<unsigned char> copy_;
  const unsigned char* data_ = nullptr;
  size_t size_ = 0;
  bool is_mapped_ = false;
};

}  // namespace kiwami

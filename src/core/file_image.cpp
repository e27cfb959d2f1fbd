// SPDX-License-Identifier: Apache-2.0
#include "core/file_image.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "core/error.h"

namespace kiwami {
namespace {

/// What a stream is asked for first; after that, as much as it has given already.
constexpr size_t kFirstRead = size_t{1} << 16;

/// What one task reads: several huge pages.
constexpr size_t kBlockSize = size_t{1} << 23;

/// Where the caller's own bytes have to lie to be used there.
constexpr size_t kAlignment = 64;

[[noreturn]] void fail_io(const char* what, const char* path) {
  const int error = errno;
  throw Error(KIWAMI_ERROR_IO, "cannot %s '%.120s': %s", what, path, std::strerror(error));
}

/// An open file, closed at the end of the scope.
class OpenFile {
 public:
  explicit OpenFile(const char* path) : path_(path), number_(::open(path, O_RDONLY | O_CLOEXEC)) {
    if (number_ < 0) fail_io("open", path);
  }
  ~OpenFile() { ::close(number_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  int number() const { return number_; }

  struct stat status() const {
    struct stat status;
    if (::fstat(number_, &status) != 0) fail_io("look at", path_);
    if (S_ISDIR(status.st_mode)) {
      throw Error(KIWAMI_ERROR_IO, "'%.120s' is a folder, expected a file", path_);
    }
    return status;
  }

  /// Up to size bytes; 0 at the end.
  size_t read(void* data, size_t size) const {
    return retried([&] { return ::read(number_, data, std::min(size, kMostAtOnce)); });
  }
  /// The same from a place of a regular file on.
  size_t read_at(size_t offset, void* data, size_t size) const {
    return retried([&] {
      return ::pread(number_, data, std::min(size, kMostAtOnce), static_cast<off_t>(offset));
    });
  }

 private:
  /// The greatest count that Linux takes at once is a little below 2^31.
  static constexpr size_t kMostAtOnce = size_t{1} << 30;

  template <typename Read>
  size_t retried(Read&& read) const {
    for (;;) {
      const ssize_t count = read();
      if (count >= 0) return static_cast<size_t>(count);
      if (errno != EINTR) fail_io("read", path_);
    }
  }

  const char* path_;
  int number_;
};

/// Reads a regular file on the device's threads, since most of the time goes into the pages of the
/// copy. Returns how many of the stated bytes there were.
size_t read_regular(const OpenFile& file, Array<unsigned char>& bytes, const Parallel& parallel) {
  std::atomic<size_t> end{bytes.size()};
  parallel.for_blocks(bytes.size(), kBlockSize, [&](size_t begin, size_t block_end) {
    for (size_t at = begin; at < block_end;) {
      const size_t count = file.read_at(at, bytes.data() + at, block_end - at);
      at += count;
      if (count != 0) continue;
      // It was cut since it was opened.
      size_t lowest = end.load(std::memory_order_relaxed);
      while (at < lowest && !end.compare_exchange_weak(lowest, at)) {
      }
      return;
    }
  });
  return end.load();
}

/// All that read(data, size) gives, up to the 0 of its end.
template <typename Read>
Array<unsigned char> read_all(Memory& memory, size_t& size, Read&& read) {
  Array<unsigned char> bytes(memory, kFirstRead);
  for (size = 0;;) {
    if (size == bytes.size()) {
      Array<unsigned char> larger(memory, bytes.size() * 2);
      std::memcpy(larger.data(), bytes.data(), size);
      bytes = std::move(larger);
    }
    const size_t count = read(bytes.data() + size, bytes.size() - size);
    if (count == 0) return bytes;
    size += count;
  }
}

}  // namespace

FileImage* FileImage::create(Device& device, const kiwami_load_desc& desc) {
  return make_object<FileImage>(device.memory(), device, desc);
}

void FileImage::destroy(FileImage* image) noexcept {
  const Reference<Device> device = image->device_;
  destroy_object(device->memory(), image);
}

FileImage::FileImage(Device& device, const kiwami_load_desc& desc) : device_(device) {
  if (desc.path) {
    open_file(desc.path, (desc.flags & KIWAMI_LOAD_MAP) != 0);
  } else if (desc.read) {
    read_stream(desc.read, desc.read_user);
  } else {
    take_data(desc);
  }
}

FileImage::~FileImage() {
  if (is_mapped_) ::munmap(const_cast<unsigned char*>(data_), size_);
}

void FileImage::take_data(const kiwami_load_desc& desc) {
  const auto* bytes = static_cast<const unsigned char*>(desc.data);
  size_ = static_cast<size_t>(desc.size);
  if ((desc.flags & KIWAMI_LOAD_MAP) == 0) {
    copy_ = Array<unsigned char>(device_->memory(), size_);
    // An empty file has no bytes to point at, which memcpy may not be told.
    if (size_ > 0) std::memcpy(copy_.data(), bytes, size_);
    data_ = copy_.data();
    return;
  }
  if (reinterpret_cast<uintptr_t>(bytes) % kAlignment != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.data is %p with KIWAMI_LOAD_MAP, expected a multiple of %zu", desc.data,
                kAlignment);
  }
  data_ = bytes;
}

void FileImage::read_stream(kiwami_read read, void* user) {
  copy_ = read_all(device_->memory(), size_, [&](void* data, size_t size) {
    const int64_t count = read(user, data, size);
    if (count < 0 || static_cast<uint64_t>(count) > size) {
      throw Error(KIWAMI_ERROR_CALLBACK, "read returned %lld for %zu bytes, expected 0 to %zu",
                  static_cast<long long>(count), size, size);
    }
    return static_cast<size_t>(count);
  });
  data_ = copy_.data();
}

void FileImage::open_file(const char* path, bool maps) {
  const OpenFile file(path);
  const struct stat status = file.status();
  const size_t stated = S_ISREG(status.st_mode) ? static_cast<size_t>(status.st_size) : 0;
  if (maps && stated != 0) {
    void* const mapped = ::mmap(nullptr, stated, PROT_READ, MAP_PRIVATE, file.number(), 0);
    if (mapped != MAP_FAILED) {
      data_ = static_cast<const unsigned char*>(mapped);
      size_ = stated;
      is_mapped_ = true;
      return;
    }
  }
  if (stated != 0) {
    copy_ = Array<unsigned char>(device_->memory(), stated);
    size_ = read_regular(file, copy_, device_->parallel());
  } else {
    // Also of files whose size is not told before they are read.
    copy_ = read_all(device_->memory(), size_,
                     [&](void* data, size_t size) { return file.read(data, size); });
  }
  data_ = copy_.data();
}

}  // namespace kiwami

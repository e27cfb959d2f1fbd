// SPDX-License-Identifier: Apache-2.0
#include "io/sink.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "core/error.h"

namespace kiwami::file {
namespace {

constexpr size_t kMostAtOnce = size_t{1} << 30;
/// Names that are tried before giving up.
constexpr int kAttempts = 100;

}  // namespace

void MemorySink::write(const void* data, size_t size) {
  if (size == 0) return;
  std::memcpy(next_, data, size);
  next_ += size;
}

void CallbackSink::write(const void* data, size_t size) {
  if (size == 0) return;
  const int32_t status = function_(user_, data, size);
  if (status == 0) return;
  throw Error(KIWAMI_ERROR_CALLBACK, "write returned %d for %zu bytes, expected 0",
              static_cast<int>(status), size);
}

FileSink::FileSink(const char* path) {
  if (std::strlen(path) >= sizeof(target_)) {
    throw Error(KIWAMI_ERROR_IO, "the path has %zu bytes, expected less than %zu",
                std::strlen(path), sizeof(target_));
  }
  // A link stays one: what it leads to is replaced.
  if (!::realpath(path, target_)) std::strcpy(target_, path);
  struct stat status;
  const bool exists = ::stat(target_, &status) == 0;
  if (exists && !S_ISREG(status.st_mode)) {
    number_ = ::open(target_, O_WRONLY | O_CLOEXEC);
    if (number_ < 0) fail("open");
    return;
  }
  open_beside(target_);
  // The new file may be read by those who could read the old one.
  if (exists) static_cast<void>(::fchmod(number_, status.st_mode & 07777));
}

FileSink::~FileSink() {
  if (number_ >= 0) ::close(number_);
  if (is_beside_) ::unlink(temporary_);
}

void FileSink::open_beside(const char* path) {
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const int length = std::snprintf(temporary_, sizeof(temporary_), "%s.%ld.%u.part", path,
                                     static_cast<long>(::getpid()), counter.fetch_add(1));
    if (length < 0 || static_cast<size_t>(length) >= sizeof(temporary_)) {
      errno = ENAMETOOLONG;
      break;
    }
    number_ = ::open(temporary_, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    is_beside_ = number_ >= 0;
    if (is_beside_) return;
    if (errno != EEXIST) break;
  }
  fail("make a file beside");
}

void FileSink::write(const void* data, size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  while (size != 0) {
    const ssize_t count = ::write(number_, bytes, std::min(size, kMostAtOnce));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail("write");
    bytes += count;
    size -= static_cast<size_t>(count);
  }
}

void FileSink::finish() {
  // Pipes and devices cannot be synchronised, and need not.
  if (is_beside_ && ::fsync(number_) != 0) fail("write");
  const int number = number_;
  number_ = -1;
  if (::close(number) != 0) fail("write");
  if (!is_beside_) return;
  if (::rename(temporary_, target_) != 0) fail("replace");
  is_beside_ = false;
  sync_folder();
}

/// So that the new name survives a loss of power. The file is whole without it.
void FileSink::sync_folder() const {
  char folder[PATH_MAX];
  std::strcpy(folder, target_);
  char* const slash = std::strrchr(folder, '/');
  if (slash) slash[slash == folder ? 1 : 0] = '\0';
  const int number = ::open(slash ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (number < 0) return;
  static_cast<void>(::fsync(number));
  ::close(number);
}

void FileSink::fail(const char* what) const {
  const int error = errno;
  throw Error(KIWAMI_ERROR_IO, "cannot %s '%.120s': %s", what, target_, std::strerror(error));
}

}  // namespace kiwami::file

// SPDX-License-Identifier: Apache-2.0
#include "worker/file_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"

namespace tessera {
namespace {

// False if it was removed, or replaced, before it was locked.
bool is_at(int descriptor, const std::filesystem::path& name) {
  struct stat opened {
  }, there{};
  return fstat(descriptor, &opened) == 0 && stat(name.c_str(), &there) == 0 &&
         opened.st_ino == there.st_ino && opened.st_dev == there.st_dev;
}

}  // namespace

std::shared_ptr<FileLock> FileLock::take(const std::filesystem::path& file, int operation) {
  for (;;) {
    const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (descriptor < 0)
      throw Error(ExitCode::internal_error,
                  fmt::format("{}: cannot be locked: {}", file.string(), std::strerror(errno)));
    std::shared_ptr<FileLock> lock(new FileLock(descriptor));
    int failed = 0;
    do failed = flock(descriptor, operation);
    while (failed != 0 && errno == EINTR);
    if (failed != 0) return nullptr;
    if (is_at(descriptor, file)) return lock;
  }
}

std::shared_ptr<FileLock> FileLock::wait(const std::filesystem::path& file, int operation) {
  auto lock = take(file, operation);
  if (!lock)
    throw Error(ExitCode::internal_error,
                fmt::format("{}: cannot be locked: {}", file.string(), std::strerror(errno)));
  return lock;
}

std::shared_ptr<FileLock> FileLock::shared(const std::filesystem::path& file) { return wait(file, LOCK_SH); }

std::shared_ptr<FileLock> FileLock::in_turn(const std::filesystem::path& file) { return wait(file, LOCK_EX); }

std::shared_ptr<FileLock> FileLock::alone(const std::filesystem::path& file) {
  return take(file, LOCK_EX | LOCK_NB);
}

FileLock::~FileLock() { close(descriptor_); }

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/lock_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>

#include "coordinator/store/error.h"
#include "coordinator/store/file.h"

namespace tessera {

LockFile::LockFile(const std::filesystem::path& file)
    : descriptor_(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
  if (descriptor_ < 0) throw_store_error(file, "opening", errno);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const int error = errno;
    std::array<char, 32> holder{};
    const ssize_t length = ::pread(descriptor_, holder.data(), holder.size(), 0);
    ::close(descriptor_);
    if (error != EWOULDBLOCK) throw_store_error(file, "locking", error);
    throw Error(ExitCode::bad_usage,
                fmt::format("store {}: process {} is at work on it; one coordinator at a time",
                            file.parent_path().string(),
                            length > 0 ? std::string_view(holder.data(), length) : "of unknown number"));
  }
  const std::string number = std::to_string(::getpid());
  // The number is for people; without it the lock holds as well.
  if (::ftruncate(descriptor_, 0) == 0) [[maybe_unused]]
    const ssize_t written = ::pwrite(descriptor_, number.data(), number.size(), 0);
}

LockFile::~LockFile() { ::close(descriptor_); }

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>
#include <vector>

#include "coordinator/store/error.h"

namespace tessera {
namespace {

int flags_of(OpenFile::Mode mode) {
  switch (mode) {
    case OpenFile::Mode::read:
      return O_RDONLY;
    case OpenFile::Mode::write:
      return O_RDWR | O_CREAT;
    case OpenFile::Mode::create:
      return O_RDWR | O_CREAT | O_EXCL;
  }
  return O_RDONLY;
}

std::string reason(std::string_view doing, int error) {
  return std::string(doing) + " failed: " + std::generic_category().message(error);
}

// What is left of `parts` behind their first `done` bytes.
void drop_front(std::vector<iovec>& parts, std::size_t done) {
  auto part = parts.begin();
  for (; part != parts.end() && done >= part->iov_len; ++part) done -= part->iov_len;
  if (part != parts.end()) {
    part->iov_base = static_cast<char*>(part->iov_base) + done;
    part->iov_len -= done;
  }
  parts.erase(parts.begin(), part);
}

}  // namespace

void throw_store_error(const std::filesystem::path& where, std::string_view doing, int error) {
  if (error == ENOSPC || error == EDQUOT || error == EFBIG) throw StoreFull(where, reason(doing, error));
  throw StoreError(where, reason(doing, error));
}

OpenFile::OpenFile(std::filesystem::path path, Mode mode)
    : path_(std::move(path)), descriptor_(::open(path_.c_str(), flags_of(mode) | O_CLOEXEC, 0600)) {
  if (descriptor_ < 0) throw_store_error(path_, "opening", errno);
}

OpenFile::OpenFile(OpenFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
  if (this != &other) {
    close();
    path_ = std::move(other.path_);
    descriptor_ = std::exchange(other.descriptor_, -1);
  }
  return *this;
}

OpenFile::~OpenFile() { close(); }

void OpenFile::close() {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

std::uint64_t OpenFile::size() const {
  struct stat status;
  if (::fstat(descriptor_, &status) != 0) throw_store_error(path_, "asking for its size", errno);
  return static_cast<std::uint64_t>(status.st_size);
}

void OpenFile::write(std::uint64_t offset, std::span<const Bytes> parts) {
  std::vector<iovec> left;
  for (const Bytes part : parts)
    if (!part.empty()) left.push_back({const_cast<std::byte*>(part.data()), part.size()});
  for (std::uint64_t at = offset; !left.empty();) {
    const ssize_t done =
        ::pwritev(descriptor_, left.data(), static_cast<int>(left.size()), static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) {
      const int error = errno;
      // If even this fails: whoever reads the file finds a torn tail.
      [[maybe_unused]] const int cut = ::ftruncate(descriptor_, static_cast<off_t>(offset));
      throw_store_error(path_, "writing", error);
    }
    at += static_cast<std::uint64_t>(done);
    drop_front(left, static_cast<std::size_t>(done));
  }
}

std::size_t OpenFile::read(std::uint64_t offset, std::span<std::byte> to) const {
  std::size_t done = 0;
  while (done < to.size()) {
    const ssize_t more =
        ::pread(descriptor_, to.data() + done, to.size() - done, static_cast<off_t>(offset + done));
    if (more < 0 && errno == EINTR) continue;
    if (more < 0) throw_store_error(path_, "reading", errno);
    if (more == 0) break;
    done += static_cast<std::size_t>(more);
  }
  return done;
}

void OpenFile::truncate(std::uint64_t size) {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) throw_store_error(path_, "cutting", errno);
}

void OpenFile::sync() const {
  if (::fdatasync(descriptor_) != 0) throw_store_error(path_, "writing to the disk", errno);
}

void OpenFile::begin_sync(std::uint64_t offset, std::uint64_t bytes) const {
  // Advice: a file system that cannot makes sync() take longer, no more.
  ::sync_file_range(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(bytes),
                    SYNC_FILE_RANGE_WRITE);
}

void move_file(const std::filesystem::path& from, const std::filesystem::path& to, bool sync) {
  if (::rename(from.c_str(), to.c_str()) != 0) throw_store_error(to, "renaming to it", errno);
  if (sync) OpenFile(to.parent_path(), OpenFile::Mode::read).sync();
}

void make_folder(const std::filesystem::path& folder) {
  if (::mkdir(folder.c_str(), 0700) == 0) return;
  const int error = errno;
  std::error_code unknown;
  if (error == ENOENT && folder.has_parent_path() && folder.parent_path() != folder) {
    make_folder(folder.parent_path());
    if (::mkdir(folder.c_str(), 0700) == 0) return;
  }
  if (!std::filesystem::is_directory(folder, unknown)) throw_store_error(folder, "making the folder", error);
}

void remove_files(const std::filesystem::path& path) {
  std::error_code failed;
  std::filesystem::remove_all(path, failed);
  if (failed) throw_store_error(path, "removing", failed.value());
}

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
#include "core/part_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <vector>

#include "core/error.h"
#include "core/pending_file.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& file, std::string_view what) {
  throw Error(ExitCode::internal_error, fmt::format("{}: {}: {}", file.string(), what, std::strerror(errno)));
}

// Whether the open file is still the one of that name: another may have renamed it since it was opened.
bool is_at(int descriptor, const fs::path& name) {
  struct stat opened {
  }, there{};
  return fstat(descriptor, &opened) == 0 && stat(name.c_str(), &there) == 0 &&
         opened.st_ino == there.st_ino && opened.st_dev == there.st_dev;
}

}  // namespace

PartFile::PartFile(fs::path file) : file_(std::move(file)), part_(file_.string() + ".part") {
  if (!open_shared()) open_own();
  if (descriptor_ < 0) fail(part_, "cannot be written");
  take_up();
}

PartFile::~PartFile() {
  if (descriptor_ < 0) return;
  if (own_) unlink(part_.c_str());
  close();
}

bool PartFile::open_shared() {
  descriptor_ = open(part_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
  if (descriptor_ < 0) return false;
  if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0 && is_at(descriptor_, part_)) return true;
  close();
  return false;
}

// Locked as a sign that it is not left over: who removes such files may have it before that.
void PartFile::open_own() {
  own_ = true;
  for (;;) {
    part_ = PendingFile(file_).temporary();
    descriptor_ = open(part_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (descriptor_ < 0) return;
    const bool taken = flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!taken && is_at(descriptor_, part_)) return;
    close();
  }
}

void PartFile::take_up() {
  std::vector<char> piece(1 << 20);
  for (;;) {
    const ssize_t n = read(descriptor_, piece.data(), piece.size());
    if (n < 0) fail(part_, "cannot be read");
    if (n == 0) return;
    hash_.add(piece.data(), static_cast<std::size_t>(n));
    size_ += static_cast<std::uint64_t>(n);
  }
}

void PartFile::append(std::string_view bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n =
        pwrite(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(size_ + done));
    if (n < 0) fail(part_, "cannot be written");
    done += static_cast<std::size_t>(n);
  }
  hash_.add(bytes.data(), bytes.size());
  size_ += bytes.size();
}

void PartFile::clear() {
  if (ftruncate(descriptor_, 0) != 0) fail(part_, "cannot be written");
  size_ = 0;
  hash_ = Sha256();
}

bool PartFile::commit(const Digest& digest) {
  const bool good = hash_.hex() == digest;
  if (!good) {
    unlink(part_.c_str());
  } else if (fsync(descriptor_) != 0 || rename(part_.c_str(), file_.c_str()) != 0) {
    fail(file_, "cannot be written");
  }
  close();
  return good;
}

void PartFile::close() {
  ::close(descriptor_);
  descriptor_ = -1;
}

}  // namespace tessera

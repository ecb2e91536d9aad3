// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/blob_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <array>
#include <cassert>
#include <cerrno>
#include <vector>

#include "coordinator/store/error.h"
#include "coordinator/store/record_file.h"
#include "core/pending_file.h"
#include "proto/questions.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBuffer = std::size_t{1} << 20;
constexpr std::size_t kMostHashed = 64;
constexpr std::uint64_t kSyncAhead = std::uint64_t{8} << 20;

// Adds the file's bytes of [from, to).
void add_bytes(Sha256& hash, const OpenFile& file, std::uint64_t from, std::uint64_t to) {
  std::vector<std::byte> buffer(std::min<std::uint64_t>(kBuffer, to - from));
  while (from < to) {
    const auto some = std::span(buffer).first(std::min<std::uint64_t>(buffer.size(), to - from));
    if (file.read(from, some) != some.size())
      throw StoreError(file.path(), "became shorter while it was read");
    hash.add(some.data(), some.size());
    from += some.size();
  }
}

void copy_bytes(const OpenFile& from, OpenFile& to, std::uint64_t size) {
  std::vector<std::byte> buffer(std::min<std::uint64_t>(kBuffer, size));
  for (std::uint64_t at = 0; at < size;) {
    const std::array<Bytes, 1> some{std::span(buffer).first(from.read(at, buffer))};
    if (some[0].empty()) throw StoreError(from.path(), "became shorter while it was read");
    to.write(at, some);
    at += some[0].size();
  }
}

Digest digest_of(const OpenFile& file) {
  Sha256 hash;
  add_bytes(hash, file, 0, file.size());
  return hash.hex();
}

dev_t device_of(const fs::path& file) {
  struct stat status;
  if (::stat(file.c_str(), &status) != 0) throw_store_error(file, "asking where it is", errno);
  return status.st_dev;
}

std::int64_t last_used(const fs::path& file) {
  struct stat status;
  if (::stat(file.c_str(), &status) != 0) return 0;
  return std::int64_t(status.st_mtim.tv_sec) * 1000 + status.st_mtim.tv_nsec / 1'000'000;
}

std::uint64_t size_or_none(const fs::path& file) {
  std::error_code none;
  const auto size = fs::file_size(file, none);
  return none ? 0 : size;
}

void require_digest(const Digest& blob) {
  if (!is_digest(blob)) throw InputError("blob", "its name is not a digest", "64 hexadecimal digits");
}

// Calls visit(file, digest) for all blobs.
template <class Visit>
void each_blob(const fs::path& blobs, const Visit& visit) {
  for (const auto& folder : fs::directory_iterator(blobs))
    if (folder.is_directory())
      for (const auto& file : fs::directory_iterator(folder))
        visit(file.path(), folder.path().filename().string() + file.path().filename().string());
}

}  // namespace

BlobStore::BlobStore(fs::path folder, BlobOptions options) : folder_(std::move(folder)), options_(options) {
  for (const char* name : {"blobs", "uploads", "damaged"}) make_folder(folder_ / name);
  tidy_and_count();
}

// What was being written when the process ended goes. Of uploads that is their last byte: one that had all
// its bytes, but was not found whole yet, must not seem to lack nothing.
void BlobStore::tidy_and_count() {
  std::vector<fs::path> left;
  each_blob(folder_ / "blobs", [&](const fs::path& file, const std::string& name) {
    if (is_digest(name))
      bytes_ += size_or_none(file);
    else
      left.push_back(file);
  });
  for (const auto& entry : fs::directory_iterator(folder_ / "uploads")) {
    OpenFile upload(entry.path(), OpenFile::Mode::write);
    const std::uint64_t size = upload.size();
    if (size > 0) upload.truncate(size - 1);
    bytes_ += upload.size();
  }
  for (const fs::path& file : left) remove_files(file);
}

fs::path BlobStore::path(const Digest& blob) const {
  require_digest(blob);
  return folder_ / "blobs" / blob.substr(0, 2) / blob.substr(2);
}

fs::path BlobStore::upload_path(const Digest& blob) const {
  require_digest(blob);
  return folder_ / "uploads" / blob;
}

void BlobStore::require_room(std::uint64_t more) const {
  if (!options_.most || bytes_ + more <= *options_.most) return;
  throw StoreFull(
      folder_, fmt::format("{} bytes of files are there, and {} more than the limit of {} would be", bytes_,
                           bytes_ + more - *options_.most, *options_.most));
}

Digest BlobStore::put(std::string_view bytes) {
  const std::array parts{bytes_of(bytes)};
  return put(parts);
}

Digest BlobStore::put(std::span<const Bytes> parts) {
  const Digest blob = tessera::digest_of(parts);
  std::uint64_t size = 0;
  for (const Bytes part : parts) size += part.size();
  if (known(blob).whole && this->size(blob) == size) return blob;
  require_room(size);
  make_folder(path(blob).parent_path());
  PendingFile pending(path(blob));
  OpenFile file(pending.temporary(), OpenFile::Mode::create);
  file.write(0, parts);
  settle(std::move(file), blob);
  return blob;
}

Digest sealed(const fs::path& path, bool sync) {
  const OpenFile file(path, OpenFile::Mode::write);
  if (sync) file.sync();
  return digest_of(file);
}

void BlobStore::put_file(const fs::path& from, const Digest& blob) {
  OpenFile file(from, OpenFile::Mode::write);
  const std::uint64_t size = file.size();
  if (known(blob).whole && this->size(blob) == size) return remove_files(from);
  require_room(size);
  make_folder(path(blob).parent_path());
  if (device_of(from) == device_of(folder_)) return settle(std::move(file), blob);
  PendingFile copy(path(blob));
  OpenFile to(copy.temporary(), OpenFile::Mode::create);
  copy_bytes(file, to, size);
  settle(std::move(to), blob);
  remove_files(from);
}

// The file becomes the blob.
void BlobStore::settle(OpenFile file, const Digest& blob) {
  const fs::path to = path(blob);
  const std::uint64_t size = file.size(), before = size_or_none(to);
  if (options_.sync) file.sync();
  move_file(file.path(), to, options_.sync);
  bytes_ += size - before;
}

bool BlobStore::has(const Digest& blob) const { return fs::is_regular_file(path(blob)); }

std::uint64_t BlobStore::size(const Digest& blob) const {
  return OpenFile(path(blob), OpenFile::Mode::read).size();
}

BlobStore::Known BlobStore::known(const Digest& blob) {
  if (!has(blob)) return {size_or_none(upload_path(blob)), false};
  ::utimensat(AT_FDCWD, path(blob).c_str(), nullptr, 0);  // now
  return {size(blob), true};
}

std::uint64_t BlobStore::take_piece(const Digest& blob, std::uint64_t size, std::uint64_t offset,
                                    std::string_view bytes) {
  if (size > kMaxBlobBytes || offset > size || bytes.size() > size - offset)
    throw InputError("blob " + blob, "a piece of it does not lie in it");
  const Known there = known(blob);
  if (there.whole) return there.have;
  if (there.have < size && (offset != there.have || bytes.empty())) return there.have;
  OpenFile file(upload_path(blob), OpenFile::Mode::write);
  std::uint64_t have = there.have;
  if (have < size) have = add_piece(blob, file, size, offset, bytes);
  if (have >= size) finish_upload(blob, std::move(file));
  return have;
}

std::uint64_t BlobStore::add_piece(const Digest& blob, OpenFile& file, std::uint64_t size,
                                   std::uint64_t offset, std::string_view bytes) {
  require_room(size - offset);
  Hashed& hash = hashed(blob, file, offset);
  const std::array parts{bytes_of(bytes)};
  file.write(offset, parts);
  hash.hash.add(bytes.data(), bytes.size());
  hash.bytes += bytes.size();
  bytes_ += bytes.size();
  const std::uint64_t have = offset + bytes.size();
  if (options_.sync && have / kSyncAhead != offset / kSyncAhead)
    file.begin_sync(have - have % kSyncAhead - kSyncAhead, kSyncAhead);
  return have;
}

// Of the first `have` bytes of the upload.
BlobStore::Hashed& BlobStore::hashed(const Digest& blob, const OpenFile& file, std::uint64_t have) {
  if (const auto found = hashed_.find(blob); found != hashed_.end()) {
    if (found->second.bytes == have) return found->second;
    hashed_.erase(found);
  }
  if (hashed_.size() >= kMostHashed) hashed_.clear();
  Hashed begun;
  add_bytes(begun.hash, file, 0, have);
  begun.bytes = have;
  return hashed_.emplace(blob, std::move(begun)).first->second;
}

void BlobStore::finish_upload(const Digest& blob, OpenFile file) {
  const std::uint64_t size = file.size();
  const Digest found = hashed(blob, file, size).hash.hex();
  hashed_.erase(blob);
  if (found == blob) {
    make_folder(path(blob).parent_path());
    settle(std::move(file), blob);
    bytes_ -= size;  // was counted piece by piece
    return;
  }
  remove_files(upload_path(blob));
  bytes_ -= size;
  throw InputError("blob " + blob, "what came has the digest " + found + "; it was thrown away");
}

std::string BlobStore::read_piece(const Digest& blob, std::uint64_t offset, std::size_t most) const {
  const OpenFile file(path(blob), OpenFile::Mode::read);
  const std::uint64_t size = file.size();
  if (offset > size) throw InputError("blob " + blob, "it ends before that piece");
  std::string bytes(std::min<std::uint64_t>(most, size - offset), '\0');
  bytes.resize(file.read(offset, std::as_writable_bytes(std::span(bytes))));
  return bytes;
}

void BlobStore::check(const Digest& blob) {
  if (const Digest found = digest_of(OpenFile(path(blob), OpenFile::Mode::read)); found != blob)
    set_aside(blob, found);
}

std::string BlobStore::read(const Digest& blob) {
  std::string bytes = read_piece(blob, 0, size(blob));
  if (const Digest found = sha256(bytes); found != blob) set_aside(blob, found);
  return bytes;
}

// It can then be brought again.
void BlobStore::set_aside(const Digest& blob, const Digest& found) {
  const fs::path from = path(blob), to = folder_ / "damaged" / blob;
  const std::uint64_t size = this->size(blob);
  move_file(from, to, false);
  bytes_ -= size;
  throw StoreDamaged(
      from, fmt::format("is not what it was: its digest is {}; it was moved to {}", found, to.string()));
}

std::uint64_t BlobStore::remove_unreferenced(const std::set<Digest>& referenced, std::int64_t before) {
  std::vector<fs::path> old;
  each_blob(folder_ / "blobs", [&](const fs::path& file, const std::string& name) {
    if (!referenced.contains(name) && last_used(file) < before) old.push_back(file);
  });
  for (const auto& file : fs::directory_iterator(folder_ / "uploads"))
    if (last_used(file.path()) < before) {
      hashed_.erase(file.path().filename().string());
      old.push_back(file.path());
    }
  std::uint64_t freed = 0;
  for (const fs::path& file : old) {
    const std::uint64_t size = size_or_none(file);
    remove_files(file);
    freed += size;
    bytes_ -= size;
  }
  return freed;
}

}  // namespace tessera

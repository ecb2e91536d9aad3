// SPDX-License-Identifier: Apache-2.0
#include "worker/asset_cache.h"

#include <fmt/format.h>

#include <fstream>
#include <system_error>

#include "core/error.h"
#include "core/pending_file.h"
#include "worker/asset_room.h"
#include "worker/file_lock.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr int kTries = 8;  // others may remove what is looked at

bool has_size(const fs::path& file, std::uint64_t bytes) {
  std::error_code error;
  return fs::is_regular_file(fs::symlink_status(file, error)) && fs::file_size(file, error) == bytes &&
         !error;
}

void touch(const fs::path& file) {
  std::error_code none;
  fs::last_write_time(file, fs::file_time_type::clock::now(), none);
}

std::string digest_of(const fs::path& file) {
  Sha256 digest;
  std::vector<char> piece(1 << 20);
  for (std::ifstream in(file, std::ios::binary); in;) {
    in.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    digest.add(piece.data(), static_cast<std::size_t>(in.gcount()));
  }
  return digest.hex();
}

// A hard link or, where there are none, a copy; replaces what is there. False if the source is gone.
bool link_or_copy(const fs::path& from, const fs::path& to) {
  PendingFile pending(to);
  std::error_code error;
  fs::create_hard_link(from, pending.temporary(), error);
  if (error && error != std::errc::no_such_file_or_directory) fs::copy_file(from, pending.temporary(), error);
  if (error == std::errc::no_such_file_or_directory) return false;
  if (error) throw fs::filesystem_error("copy", from, to, error);
  pending.commit();
  return true;
}

Error does_not_stay(const fs::path& file) {
  return Error(ExitCode::internal_error,
               fmt::format("{}: is removed or changed as soon as it is there", file.string()));
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// What the file system says becomes an Error that is nobody's bad input: elsewhere there may be room.
template <class F>
auto told(F&& work) {
  try {
    return work();
  } catch (const fs::filesystem_error& error) {
    throw Error(ExitCode::internal_error, error.what());
  }
}

}  // namespace

AssetCache::AssetCache(AssetCacheOptions options) : options_(std::move(options)) {
  told([&] {
    fs::create_directories(options_.folder / "blobs");
    fs::create_directories(options_.folder / "bundles");
  });
}

fs::path AssetCache::blob(const Digest& digest) const { return options_.folder / "blobs" / digest; }
fs::path AssetCache::tree(const Digest& bundle) const { return options_.folder / "bundles" / bundle; }

Bundle AssetCache::manifest_of(const Digest& digest, const FetchBlob& fetch) {
  for (const fs::path& file : {tree(digest) / "manifest", blob(digest)}) {
    const std::string text = text_of(file);
    if (sha256(text) == digest) return parse_bundle(text);
  }
  for (int i = 0; i < kTries; ++i) {
    std::error_code none;
    fs::remove(blob(digest), none);
    fetch(digest, blob(digest));
    const std::string text = text_of(blob(digest));
    if (sha256(text) == digest) return parse_bundle(text);
  }
  throw does_not_stay(blob(digest));
}

void AssetCache::place(const Bundle::File& file, const fs::path& at, const FetchBlob& fetch) {
  for (int i = 0; i < kTries; ++i) {
    if (!has_size(blob(file.digest), file.bytes)) {
      std::error_code none;
      fs::remove(blob(file.digest), none);
      fetch(file.digest, blob(file.digest));
      const std::uint64_t bytes = fs::file_size(blob(file.digest), none);
      if (!none && bytes != file.bytes)
        throw InputError("bundle", fmt::format("'{}' has {} bytes", file.path, bytes),
                         fmt::format("{}, as it says", file.bytes));
      fs::permissions(blob(file.digest), fs::perms(0444), none);
    }
    touch(blob(file.digest));
    if (link_or_copy(blob(file.digest), at)) return;
  }
  throw does_not_stay(blob(file.digest));
}

// Under another name first; if somebody else was faster, theirs stays.
void AssetCache::build(const Digest& digest, const Bundle& bundle, const FetchBlob& fetch) {
  const fs::path draft = PendingFile(tree(digest)).temporary();
  struct Remove {
    const fs::path& folder;
    ~Remove() {
      std::error_code none;
      fs::remove_all(folder, none);
    }
  } const remove{draft};
  fs::create_directories(draft / "files");
  for (const Bundle::File& file : bundle.files) {
    const fs::path at = draft / "files" / file.path;
    fs::create_directories(at.parent_path());
    place(file, at, fetch);
  }
  const std::string text = to_text(bundle);
  place({"manifest", digest, text.size()}, draft / "manifest", fetch);
  std::error_code taken;
  fs::rename(draft, tree(digest), taken);
  if (taken && !fs::exists(tree(digest))) throw fs::filesystem_error("rename", tree(digest), taken);
}

void AssetCache::make_room(const Digest& digest, const Bundle& bundle) {
  std::set<Digest> keep{digest};
  std::uint64_t needed = 0;
  for (const Bundle::File& file : bundle.files)
    if (keep.insert(file.digest).second && !has_size(blob(file.digest), file.bytes)) needed += file.bytes;
  tessera::make_room(options_.folder, options_.bytes, needed, keep);
}

OpenBundle AssetCache::open(const Digest& digest, const FetchBlob& fetch) {
  const std::lock_guard wait(mutex_);
  return told([&] {
    fs::path lock_file = tree(digest);
    lock_file += ".lock";
    OpenBundle open{{}, tree(digest) / "files", hold(options_.folder, lock_file)};
    touch(lock_file);
    open.bundle = manifest_of(digest, fetch);
    if (!fs::exists(tree(digest))) {
      make_room(digest, open.bundle);
      build(digest, open.bundle, fetch);
    }
    for (const Bundle::File& file : open.bundle.files)
      if (!has_size(open.files / file.path, file.bytes)) {
        fs::create_directories((open.files / file.path).parent_path());
        place(file, open.files / file.path, fetch);
      }
    return open;
  });
}

int AssetCache::repair(const OpenBundle& open, const FetchBlob& fetch) {
  const std::lock_guard wait(mutex_);
  return told([&] {
    int repaired = 0;
    for (const Bundle::File& file : open.bundle.files) {
      if (digest_of(open.files / file.path) == file.digest) continue;
      std::error_code none;
      if (digest_of(blob(file.digest)) != file.digest) fs::remove(blob(file.digest), none);
      place(file, open.files / file.path, fetch);
      ++repaired;
    }
    return repaired;
  });
}

}  // namespace tessera

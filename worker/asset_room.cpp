// SPDX-License-Identifier: Apache-2.0
#include "worker/asset_room.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/error.h"
#include "worker/file_lock.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

struct Thing {
  fs::path path;
  std::uint64_t bytes = 0;
  timespec used{};
  bool linked = false;  // by a bundle
};

bool is_older(const Thing& a, const Thing& b) {
  return a.used.tv_sec != b.used.tv_sec ? a.used.tv_sec < b.used.tv_sec : a.used.tv_nsec < b.used.tv_nsec;
}

// Longest unused first. What goes while it is looked at is left out.
std::vector<Thing> things_in(const fs::path& folder) {
  std::vector<Thing> things;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    struct stat s {};
    if (stat(entry.path().c_str(), &s) != 0 || !S_ISREG(s.st_mode)) continue;
    things.push_back({entry.path(), static_cast<std::uint64_t>(s.st_size), s.st_mtim, s.st_nlink > 1});
  }
  std::ranges::sort(things, is_older);
  return things;
}

std::uint64_t bytes_in(const fs::path& folder) {
  std::uint64_t bytes = 0;
  for (const Thing& thing : things_in(folder)) bytes += thing.bytes;
  return bytes;
}

// Unless it is being fetched: then it is locked (core/part_file.h). Nor can that begin while it is removed.
bool drop_blob(const fs::path& file) {
  std::shared_ptr<FileLock> lock;
  if (file.has_extension() && !(lock = FileLock::alone(file))) return false;
  std::error_code none;
  fs::remove(file, none);
  return true;
}

void drop_loose_blobs(const fs::path& blobs, std::uint64_t most, const std::set<Digest>& keep) {
  std::uint64_t bytes = bytes_in(blobs);
  for (const Thing& thing : things_in(blobs)) {
    if (bytes <= most) return;
    if (thing.linked || keep.contains(thing.path.stem().string())) continue;
    if (drop_blob(thing.path)) bytes -= thing.bytes;
  }
}

// Its tree, and what is left of attempts to make it. Others see all of it or nothing.
void drop_bundle(const fs::path& lock_file) {
  const auto lock = FileLock::alone(lock_file);
  if (!lock) return;
  const std::string digest = lock_file.stem().string();
  std::vector<fs::path> trees;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(lock_file.parent_path(), none))
    if (entry.path() != lock_file && entry.path().filename().string().starts_with(digest))
      trees.push_back(entry.path());
  for (const fs::path& tree : trees) {
    fs::path gone = tree;
    if (tree.filename() == digest) fs::rename(tree, gone += ".gone", none);
    fs::remove_all(gone, none);
  }
  fs::remove(lock_file, none);
}

fs::path turn_file(const fs::path& folder) { return folder / "room.lock"; }

}  // namespace

std::shared_ptr<FileLock> hold(const fs::path& folder, const fs::path& lock_file) {
  const auto turn = FileLock::in_turn(turn_file(folder));
  return FileLock::shared(lock_file);
}

void make_room(const fs::path& folder, std::uint64_t limit, std::uint64_t needed,
               const std::set<Digest>& keep) {
  const fs::path blobs = folder / "blobs";
  const std::uint64_t most = limit - std::min(limit, needed);
  if (bytes_in(blobs) <= most) return;
  const auto turn = FileLock::in_turn(turn_file(folder));
  drop_loose_blobs(blobs, most, keep);
  for (const Thing& lock : things_in(folder / "bundles")) {
    if (bytes_in(blobs) <= most) return;
    drop_bundle(lock.path);
    drop_loose_blobs(blobs, most, keep);
  }
  if (const std::uint64_t bytes = bytes_in(blobs); bytes > most || needed > limit)
    throw Error(ExitCode::internal_error,
                fmt::format("{}: {} MiB more are needed, and {} MiB are in use; the limit is {} MiB",
                            folder.string(), needed >> 20, bytes >> 20, limit >> 20));
}

}  // namespace tessera

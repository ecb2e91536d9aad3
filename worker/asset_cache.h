// SPDX-License-Identifier: Apache-2.0
// A folder of files that scenes are made from, fetched by what is in them, and kept for the next time:
//
//   blobs/<digest>              each file once
//   bundles/<digest>/files/...  the files of a bundle under their names: hard links to blobs
//   bundles/<digest>/manifest   its text
//   bundles/<digest>.lock       held, shared, by all who use it; its time is that of the last use
//   room.lock                   held by who makes room, or begins to use a bundle
//
// Things appear by being renamed, so several processes may share the folder; they may fetch the same file
// twice. What has not been used for the longest goes when the limit is reached; what is in use never does.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>

#include "core/bundle.h"

namespace tessera {

struct AssetCacheOptions {
  std::filesystem::path folder;
  std::uint64_t bytes = std::uint64_t{20} << 30;  // of all blobs
};

// Makes `file` be there, with the bytes of that digest: a download. Throws Error.
using FetchBlob = std::function<void(const Digest&, const std::filesystem::path& file)>;

class FileLock;

// A bundle that is there, and stays for as long as this lives.
struct OpenBundle {
  Bundle bundle;
  std::filesystem::path files;  // the folder in which its files have their names
  std::shared_ptr<FileLock> lock;

  std::filesystem::path scene() const { return files / bundle.scene; }
};

// For any thread; they wait for each other.
class AssetCache {
 public:
  // Makes the folder. Throws Error(internal_error) if it cannot be written.
  explicit AssetCache(AssetCacheOptions options);

  // The bundle, with what is missing of it fetched. Files have the right sizes; their bytes are those that
  // were fetched, unless the disk or somebody changed them since: see repair(). Throws what `fetch` throws;
  // Error(bad_input) if the digest is not that of a bundle; Error(internal_error) if it takes more than the
  // limit, or its files cannot be written (a full disk).
  OpenBundle open(const Digest& bundle, const FetchBlob& fetch);

  // Reads all files of an open bundle, and fetches those again whose bytes are wrong. Returns how many.
  int repair(const OpenBundle&, const FetchBlob& fetch);

 private:
  std::filesystem::path blob(const Digest&) const;
  std::filesystem::path tree(const Digest& bundle) const;

  Bundle manifest_of(const Digest& bundle, const FetchBlob& fetch);
  void build(const Digest& digest, const Bundle&, const FetchBlob& fetch);
  void place(const Bundle::File&, const std::filesystem::path& at, const FetchBlob& fetch);
  void make_room(const Digest& digest, const Bundle&);

  AssetCacheOptions options_;
  std::mutex mutex_;
};

}  // namespace tessera

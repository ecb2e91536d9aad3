// SPDX-License-Identifier: Apache-2.0
// Bytes by what they are: files named by the SHA-256 of what is in them, in a folder of their own. A blob is
// there whole or not at all, and never changes. One thread.
//
//   blobs/ab/cdef...   whole blobs          uploads/<digest>   blobs that come in pieces, as far as they came
//   damaged/<digest>   found not to be what they are called
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "coordinator/store/file.h"
#include "core/sha256.h"

namespace tessera {

struct BlobOptions {
  std::optional<std::uint64_t> most;  // bytes of all blobs and uploads together
  bool sync = true;                   // a blob that is there is there after a power cut, too
};

// The digest of a file that is complete, which is on the disk from here on if `sync`. From any thread: what
// takes its time of keeping a large file.
Digest sealed(const std::filesystem::path& file, bool sync);

class BlobStore {
 public:
  // Makes the folders if they are not there.
  BlobStore(std::filesystem::path folder, BlobOptions options = {});

  // All throw StoreFull or StoreError if the disk does not do as it should.

  Digest put(std::string_view bytes);
  // Bytes one behind the other.
  Digest put(std::span<const Bytes> parts);
  // Takes the file away: moved if it is on the same file system, else copied. Precondition: it is sealed, and
  // `blob` is its seal.
  void put_file(const std::filesystem::path& file, const Digest& blob);

  struct Known {
    std::uint64_t have = 0;  // bytes that are there
    bool whole = false;
  };
  // Of a whole blob this counts as use: remove_unreferenced() leaves it alone for a while.
  Known known(const Digest& blob);
  bool has(const Digest& blob) const;                    // whole
  std::uint64_t size(const Digest& blob) const;          // throws StoreError if it is not there
  std::filesystem::path path(const Digest& blob) const;  // of a whole blob; precondition: is_digest

  // `bytes` of a blob of `size` bytes, from `offset`. Pieces are taken in order; a repeated one, or one that
  // does not follow what is there, changes nothing. Returns how many bytes are there now. The last one makes
  // it whole, or throws InputError, and forgets all pieces, if they are not what the blob is called.
  std::uint64_t take_piece(const Digest& blob, std::uint64_t size, std::uint64_t offset,
                           std::string_view bytes);
  // At most `most` bytes from `offset`; fewer only at the end. Throws InputError beyond it.
  std::string read_piece(const Digest& blob, std::uint64_t offset, std::size_t most) const;
  // The whole blob, found to be what it is called. Otherwise it is moved aside and StoreDamaged thrown.
  std::string read(const Digest& blob);

  // The same of one that is too large to be read at once.
  void check(const Digest& blob);

  std::uint64_t bytes() const { return bytes_; }  // of all blobs and uploads
  // Removes blobs that are not in `referenced`, and uploads, that were last used before `before` (Unix time,
  // ms). Returns the bytes that became free.
  std::uint64_t remove_unreferenced(const std::set<Digest>& referenced, std::int64_t before);

 private:
  struct Hashed {
    Sha256 hash;
    std::uint64_t bytes = 0;
  };

  std::filesystem::path upload_path(const Digest& blob) const;
  void tidy_and_count();
  void require_room(std::uint64_t more) const;
  Hashed& hashed(const Digest& blob, const OpenFile& file, std::uint64_t have);
  std::uint64_t add_piece(const Digest& blob, OpenFile& file, std::uint64_t size, std::uint64_t offset,
                          std::string_view bytes);
  void finish_upload(const Digest& blob, OpenFile file);
  [[noreturn]] void set_aside(const Digest& blob, const Digest& found);
  void settle(OpenFile file, const Digest& blob);

  std::filesystem::path folder_;
  BlobOptions options_;
  std::uint64_t bytes_ = 0;
  std::map<Digest, Hashed>
      hashed_;  // of uploads under way, so that they need not be read again at their ends
};

}  // namespace tessera

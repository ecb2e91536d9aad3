// SPDX-License-Identifier: Apache-2.0
// One blob on its way to the coordinator: which piece is to go next. Several are on the road at a time; the
// coordinator takes them in order, so what comes too early goes again once what is before it is there. Knows
// neither roads nor clocks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>

#include "proto/questions.h"

namespace tessera {

// Where the bytes of a blob come from. `read` gives `bytes` of them from `offset`, all within the blob.
struct BlobSource {
  Digest digest;
  std::uint64_t size = 0;
  std::function<std::string(std::uint64_t offset, std::size_t bytes)> read;
};

BlobSource blob_of(std::string bytes);
// The file is opened for each piece; throws Error(bad_input) then, if it is not as long any more.
BlobSource blob_of(const std::filesystem::path& file, Digest digest, std::uint64_t size);

class Upload {
 public:
  // Of which the coordinator has `have` bytes.
  Upload(BlobSource blob, std::uint64_t have) : blob_(std::move(blob)), base_(have), next_(have) {}

  const BlobSource& blob() const { return blob_; }
  // The next piece that may go; nothing while there is none, or the blob is there.
  std::optional<PutPiece> next();
  // What came back for the piece at `offset`: Agreed: all up to its end is there. Lacking: only `have` bytes
  // are. Throws Error(internal_error) for any other reply.
  void answered(std::uint64_t offset, const Reply& reply);

  std::uint64_t sent() const { return base_; }  // bytes that are there, from the beginning
  bool done() const { return done_; }

 private:
  PutPiece piece(std::uint64_t offset);
  void begin_at(std::uint64_t have);
  std::uint64_t end_of(std::uint64_t offset) const;

  BlobSource blob_;
  std::uint64_t base_, next_;             // all before is there; all before went once
  bool end_went_ = false, done_ = false;  // the piece that ends the blob: without bytes, if need be
  std::set<std::uint64_t> out_, early_;   // where pieces begin that are on the road; that came too early
};

}  // namespace tessera

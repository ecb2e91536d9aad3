// SPDX-License-Identifier: Apache-2.0
#include "proto/upload.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <memory>

namespace tessera {

BlobSource blob_of(std::string bytes) {
  const Digest digest = sha256(bytes);
  const std::uint64_t size = bytes.size();
  // Shared, for sources are copied.
  return {digest, size,
          [all = std::make_shared<const std::string>(std::move(bytes))](std::uint64_t offset, std::size_t n) {
            return all->substr(offset, n);
          }};
}

BlobSource blob_of(const std::filesystem::path& file, Digest digest, std::uint64_t size) {
  return {std::move(digest), size, [file](std::uint64_t offset, std::size_t n) {
            std::string bytes(n, '\0');
            std::ifstream in(file, std::ios::binary);
            in.seekg(static_cast<std::streamoff>(offset));
            if (!in.read(bytes.data(), static_cast<std::streamsize>(n)))
              throw InputError(file.string(), "cannot be read any more, or is shorter than it was",
                               "files that stay as they are while they are handed in");
            return bytes;
          }};
}

std::uint64_t Upload::end_of(std::uint64_t offset) const {
  return offset + std::min<std::uint64_t>(kPieceBytes, blob_.size - offset);
}

PutPiece Upload::piece(std::uint64_t offset) {
  out_.insert(offset);
  const std::uint64_t end = end_of(offset);
  const auto bytes = static_cast<std::size_t>(end - offset);
  return {blob_.digest, blob_.size, offset, bytes > 0 ? blob_.read(offset, bytes) : std::string()};
}

std::optional<PutPiece> Upload::next() {
  if (done_) return std::nullopt;
  early_.erase(early_.begin(), early_.lower_bound(base_));
  if (!early_.empty() && *early_.begin() == base_) return piece(early_.extract(early_.begin()).value());
  if (!end_went_) {
    const std::uint64_t offset = next_;
    next_ = end_of(offset);
    end_went_ = next_ == blob_.size;
    return piece(offset);
  }
  // Nothing on the road will bring on what is there: the coordinator forgot some of it.
  if (out_.empty()) {
    begin_at(base_);
    return next();
  }
  return std::nullopt;
}

void Upload::begin_at(std::uint64_t have) {
  base_ = next_ = have;
  end_went_ = false;
  out_.clear();
  early_.clear();
}

void Upload::answered(std::uint64_t offset, const Reply& reply) {
  out_.erase(offset);
  if (std::holds_alternative<Agreed>(reply)) {
    base_ = std::max(base_, end_of(offset));
    done_ |= end_of(offset) == blob_.size;
    return;
  }
  const auto* lacking = std::get_if<Lacking>(&reply);
  if (!lacking || lacking->blobs.size() != 1 || lacking->blobs[0].blob != blob_.digest ||
      lacking->blobs[0].have > blob_.size)
    throw Error(ExitCode::internal_error,
                fmt::format("blob {}: the answer to a piece is none", blob_.digest));
  const std::uint64_t have = lacking->blobs[0].have;
  if (have < base_) return begin_at(have);
  base_ = have;
  early_.insert(offset);
}

}  // namespace tessera

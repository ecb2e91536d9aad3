// SPDX-License-Identifier: Apache-2.0
#include "proto/client.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/part_file.h"

namespace tessera {
namespace {

constexpr Millis kLook{100};  // at whether to stop
constexpr int kTries = 3;     // of an upload that the coordinator forgets, of a file whose bytes are wrong
const Peer kCoordinator = "coordinator";

template <class Wanted>
Wanted taken(Reply reply) {
  if (auto* wanted = std::get_if<Wanted>(&reply)) return std::move(*wanted);
  throw Error(ExitCode::internal_error, "the coordinator answered something else than it was asked");
}

template <class F>
class Finally {
 public:
  explicit Finally(F f) : f_(std::move(f)) {}
  Finally(const Finally&) = delete;
  Finally& operator=(const Finally&) = delete;
  ~Finally() { f_(); }

 private:
  F f_;
};

void require_piece(const Piece& p, const Digest& blob, std::uint64_t offset) {
  const bool whole = p.offset == offset && p.offset <= p.size &&
                     p.bytes.size() == std::min<std::uint64_t>(kPieceBytes, p.size - p.offset);
  if (p.blob != blob || !whole)
    throw Error(ExitCode::internal_error, fmt::format("blob {}: not the piece that was asked for", blob));
}

}  // namespace

FarmClient::FarmClient(std::unique_ptr<Transport> road, ClientOptions options)
    : road_(std::move(road)), options_(std::move(options)) {}

std::uint64_t FarmClient::begin(Question question) {
  const Instant now = options_.now();
  if (open_.empty()) heard_ = now;
  const std::uint64_t number = ++number_;
  road_->send(kCoordinator, Ask{number, question});
  open_[number] = {std::move(question), now + options_.first_pause, options_.first_pause};
  return number;
}

void FarmClient::repeat() {
  const Instant now = options_.now();
  for (auto& [number, open] : open_) {
    if (now < open.again) continue;
    road_->send(kCoordinator, Ask{number, open.question});
    open.pause = std::min(open.pause * 2, options_.longest_pause);
    open.again = now + open.pause;
  }
}

Instant FarmClient::next_turn() const {
  Instant turn = std::min(options_.now() + kLook, heard_ + options_.patience);
  for (const auto& [number, open] : open_) turn = std::min(turn, open.again);
  return turn;
}

void FarmClient::heard() {
  heard_ = options_.now();
  for (auto& [number, open] : open_) open.again = std::max(open.again, heard_ + open.pause);
}

Answer FarmClient::next() {
  for (;;) {
    if (options_.stop && options_.stop()) throw Error(ExitCode::interrupted, "interrupted");
    if (options_.now() >= heard_ + options_.patience)
      throw Error(ExitCode::unreachable, fmt::format("the coordinator has not answered for {:.1f} s",
                                                     static_cast<double>(options_.patience.count()) / 1000));
    repeat();
    auto mail = road_->receive(next_turn());
    if (!mail) continue;
    if (const auto* refused = std::get_if<Refused>(&mail->message))
      throw Error(ExitCode::bad_usage, refused->reason);
    auto* answer = std::get_if<Answer>(&mail->message);
    if (!answer || open_.erase(answer->number) == 0) continue;  // late, or no answer at all
    heard();
    if (const auto* denied = std::get_if<Denied>(&answer->reply)) throw Error(denied->code, denied->reason);
    return std::move(*answer);
  }
}

Reply FarmClient::ask(Question question) {
  const Finally forget([&] { open_.clear(); });
  begin(std::move(question));
  return next().reply;
}

FarmClient::Lacks FarmClient::lacks_of(const std::vector<Digest>& blobs) {
  Lacks all;
  for (std::size_t at = 0; at < blobs.size(); at += kMaxListed) {
    const auto first = blobs.begin() + static_cast<std::ptrdiff_t>(at);
    const auto count = std::min(kMaxListed, blobs.size() - at);
    auto some = taken<Lacking>(ask(WhichLack{{first, first + static_cast<std::ptrdiff_t>(count)}})).blobs;
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

std::uint64_t FarmClient::upload(const std::vector<BlobSource>& blobs, const Progress& progress) {
  std::map<Digest, const BlobSource*> by_digest;
  for (const BlobSource& blob : blobs) by_digest[blob.digest] = &blob;
  std::vector<Digest> digests;
  for (const auto& [digest, blob] : by_digest) digests.push_back(digest);
  std::uint64_t sent = 0;
  for (int i = 0; i < kTries; ++i) {
    const Lacks lacks = lacks_of(digests);
    if (lacks.empty()) return sent;
    std::vector<Upload> uploads;
    digests.clear();
    for (const Lacking::Blob& lack : lacks) {
      const auto at = by_digest.find(lack.blob);
      if (at == by_digest.end() || lack.have > at->second->size)
        throw Error(ExitCode::internal_error, "the coordinator lacks what it was not asked for");
      uploads.emplace_back(*at->second, lack.have);
      digests.push_back(lack.blob);
    }
    sent += put(std::move(uploads), progress);
  }
  if (lacks_of(digests).empty()) return sent;
  throw Error(ExitCode::internal_error, "the coordinator does not keep what it is sent");
}

std::uint64_t FarmClient::put(std::vector<Upload> uploads, const Progress& progress) {
  const Finally forget([&] { open_.clear(); });
  std::uint64_t begun = 0, all = 0, done_before = 0, most = 0;
  for (const Upload& upload : uploads) begun += upload.sent(), all += upload.blob().size;
  std::map<std::uint64_t, std::pair<std::size_t, std::uint64_t>> out;  // by number: which, from where
  for (std::size_t first = 0; first < uploads.size();) {
    for (std::size_t i = first; i < uploads.size() && out.size() < options_.window; ++i)
      while (out.size() < options_.window) {
        auto piece = uploads[i].next();
        if (!piece) break;
        const std::uint64_t offset = piece->offset;
        out[begin(std::move(*piece))] = {i, offset};
      }
    const Answer answer = next();
    const auto [which, offset] = out.extract(answer.number).mapped();
    uploads[which].answered(offset, answer.reply);
    while (first < uploads.size() && uploads[first].done()) done_before += uploads[first++].blob().size;
    std::uint64_t done = done_before;
    for (std::size_t i = first; i < std::min(first + options_.window, uploads.size()); ++i)
      done += uploads[i].sent();
    most = std::max(most, done);  // what was counted may have to go again
    if (progress) progress(most, all);
  }
  return all - begun;
}

std::uint64_t FarmClient::get(const Digest& blob, std::uint64_t from,
                              const std::function<void(const Piece&)>& take) {
  const Finally forget([&] { open_.clear(); });
  std::map<std::uint64_t, std::uint64_t> out;  // by number: from where
  std::map<std::uint64_t, Piece> early;
  std::uint64_t next_piece = from, at = from, size = from + 1;  // until the first says it
  for (bool known = false;;) {
    while (out.size() < (known ? options_.window : 1) && next_piece < size) {
      out[begin(GetPiece{blob, next_piece})] = next_piece;
      next_piece += kPieceBytes;
    }
    if (out.empty()) return size;
    Answer answer = next();
    const std::uint64_t offset = out.extract(answer.number).mapped();
    Piece piece = taken<Piece>(std::move(answer.reply));
    require_piece(piece, blob, offset);
    if (known && piece.size != size) throw Error(ExitCode::internal_error, "a blob changed its size");
    size = piece.size, known = true;
    early.emplace(offset, std::move(piece));
    for (; !early.empty() && early.begin()->first == at; early.erase(early.begin())) {
      take(early.begin()->second);
      at += kPieceBytes;
    }
  }
}

void FarmClient::download(const Digest& blob, const std::filesystem::path& file, const Progress& progress) {
  for (int i = 0; i < kTries; ++i) {
    PartFile part(file);
    bool fits = part.size() == 0;  // what is there of it may be too long to be of it
    const auto take = [&](const Piece& piece) {
      fits = true;
      part.append(piece.bytes);
      if (progress) progress(part.size(), piece.size);
    };
    try {
      get(blob, part.size(), take);
    } catch (const Error& error) {
      if (fits || error.code() == ExitCode::unreachable || error.code() == ExitCode::interrupted) throw;
      part.clear();
      continue;
    }
    if (part.commit(blob)) return;
  }
  throw Error(ExitCode::internal_error, fmt::format("blob {}: what came is not what was asked for", blob));
}

std::string FarmClient::download(const Digest& blob, std::uint64_t most) {
  std::string bytes;
  get(blob, 0, [&](const Piece& piece) {
    if (piece.size > most)
      throw Error(ExitCode::bad_input,
                  fmt::format("blob {}: has {} bytes; accepted: at most {}", blob, piece.size, most));
    bytes += piece.bytes;
  });
  if (sha256(bytes) != blob)
    throw Error(ExitCode::internal_error, fmt::format("blob {}: what came is not what was asked for", blob));
  return bytes;
}

}  // namespace tessera

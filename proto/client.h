// SPDX-License-Identifier: Apache-2.0
// Who asks a coordinator: people's commands, and workers that fetch files. Questions that are not answered
// are asked again under the same number, with growing pauses; so a coordinator that starts anew, or a cut
// connection, costs time and nothing else. For one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/instant.h"
#include "proto/clock.h"
#include "proto/transport.h"
#include "proto/upload.h"

namespace tessera {

struct ClientOptions {
  Millis first_pause{500}, longest_pause{4000};  // before a question is asked again; doubles
  Millis patience{20'000};          // without any answer, before the coordinator counts as unreachable
  std::size_t window = 16;          // pieces on the road at a time
  std::function<bool()> stop = {};  // looked at 10 times a second; true: Error(interrupted)
  std::function<Instant()> now = clock_now;
};

// Everything here throws Error: what the coordinator denied, with its code and reason; unreachable, if it
// says nothing for longer than `patience`; interrupted.
class FarmClient {
 public:
  // How many bytes of how many are there.
  using Progress = std::function<void(std::uint64_t done, std::uint64_t all)>;

  explicit FarmClient(std::unique_ptr<Transport>, ClientOptions options = {});

  // The answer, which is never Denied.
  Reply ask(Question);

  // Makes these blobs be there: sends what the coordinator lacks of them, from where it stopped the last
  // time. Returns how many bytes went.
  std::uint64_t upload(const std::vector<BlobSource>&, const Progress& = {});

  // Fetches a blob to `file`, whose folder is there; what is there of it from the last time is kept
  // (core/part_file.h). Throws Error(internal_error) too if the file cannot be written.
  void download(const Digest&, const std::filesystem::path& file, const Progress& = {});
  // A blob of at most `most` bytes, checked. Throws Error(bad_input) if it is longer.
  std::string download(const Digest&, std::uint64_t most);

 private:
  struct Open {
    Question question;
    Instant again;
    Millis pause;
  };
  using Lacks = std::vector<Lacking::Blob>;

  std::uint64_t begin(Question);  // its number
  // The next answer to one of the questions that were begun.
  Answer next();
  void repeat();
  Instant next_turn() const;
  void heard();

  Lacks lacks_of(const std::vector<Digest>&);
  std::uint64_t put(std::vector<Upload>, const Progress&);
  // Gives the pieces of a blob from byte `from` on, in order; returns its size.
  std::uint64_t get(const Digest&, std::uint64_t from, const std::function<void(const Piece&)>& take);

  std::unique_ptr<Transport> road_;
  ClientOptions options_;
  std::uint64_t number_ = 0;
  Instant heard_;  // the last answer, or the first question after there was none open
  std::map<std::uint64_t, Open> open_;
};

}  // namespace tessera

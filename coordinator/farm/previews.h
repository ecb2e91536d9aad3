// SPDX-License-Identifier: Apache-2.0
// Pictures of frames under way, made only while somebody looks, and kept in memory alone: the last one of
// each frame, and the one before, which may be on its way to somebody. Decides when; who makes them is the
// clerk's matter. Time is an argument.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/instant.h"
#include "core/sha256.h"
#include "core/submission.h"

namespace tessera {

class Previews {
 public:
  using Key = std::pair<JobName, std::size_t>;  // a job, and the place of a frame in it
  using Png = std::shared_ptr<const std::string>;

  // Somebody wants one of the frame, which is under way.
  void asked(const Key& frame, Instant now) { shown_[frame].asked = now; }
  // Those of which a new one should be made now, unless nothing changed: looked at within the last 10 s, none
  // is being made, and the last one was begun long enough ago.
  std::vector<Key> due(Instant now) const;
  // What tells a picture from the one before.
  using State = std::array<std::int64_t, 3>;
  // True: make it. Precondition: it is due.
  bool begin(const Key& frame, const State& state, Instant now);
  // It took so long to prepare, during which the farm did nothing else: the next one waits a hundred times as
  // long, if that is more than 2 s.
  void took(const Key& frame, Millis duration);
  // Empty: it could not be made.
  void made(const Key& frame, std::string png);
  void forget(const Key& frame) { shown_.erase(frame); }
  void forget(const JobName& job);

  Digest last(const Key& frame) const;   // empty: there is none
  Png find(const Digest& digest) const;  // null: there is none

 private:
  struct Picture {
    Digest digest;
    Png png;
  };
  struct Shown {
    Instant asked{}, next{};
    bool under_way = false;
    std::optional<State> state;  // of the last one that was begun
    Picture last, before;
  };

  std::map<Key, Shown> shown_;
};

}  // namespace tessera

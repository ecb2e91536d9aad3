// SPDX-License-Identifier: Apache-2.0
// Frames in a row: which of them are worked on at the same time, and what each gets of the one before. Pure.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/image.h"
#include "core/job.h"

namespace tessera {

struct Shot {
  std::vector<Job> frames;  // in the order in which they are wanted
  int in_flight = 2;        // worked on at the same time: the next one is rendered while one is filtered
  // What frames that are not of the shot have kept (Frame::kept()), by the place of the one that goes by it.
  std::map<std::size_t, std::shared_ptr<const Image>> histories = {};
};

// Whether a frame goes by what the one before keeps: its filter does, it is the next in number, or is said to
// go on where it is given, there is no cut, and both are of one camera, size, crop and filter. A frame that does not
// continue anything starts anew.
bool continues(const Job& before, const Job& next);

// Throws what validate() throws for the first frame that is not sound, and InputError if there is none.
void validate(const Shot&);

// Where a shot stands.
class ShotPlan {
 public:
  explicit ShotPlan(Shot shot = {});

  const std::vector<Job>& frames() const { return shot_.frames; }
  int done() const { return done_; }
  bool over() const { return next_ == frames().size() && under_way_ == 0; }

  struct Start {
    std::size_t frame = 0;
    bool awaits_history = false;           // end() of the frame before will bring it
    std::shared_ptr<const Image> history;  // else: this, which may be null
  };
  // The next frame to begin, if one may be begun now.
  std::optional<Start> start();
  // A frame that was begun has ended, and kept this (null: nothing, or it failed). The next frame, if it
  // awaits its history and was begun.
  std::optional<std::size_t> end(std::size_t frame, std::shared_ptr<const Image> kept);
  // No more frames are begun.
  void stop() { next_ = frames().size(); }

 private:
  bool continues_at(std::size_t frame) const { return continues(frames()[frame - 1], frames()[frame]); }

  Shot shot_;
  std::size_t next_ = 0;  // frame to begin
  int under_way_ = 0, done_ = 0;
  std::map<std::size_t, std::shared_ptr<const Image>> kept_;  // by frames whose next one was not begun yet
};

}  // namespace tessera

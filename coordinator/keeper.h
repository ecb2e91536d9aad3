// SPDX-License-Identifier: Apache-2.0
// What is told of everything that must outlive a coordinator, before anybody acts on it; and what gives it
// back to the next one. In local mode there is none.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "coordinator/frame.h"
#include "proto/frame_log.h"

namespace tessera {

// A frame under way, and what is known of it besides.
struct FrameUnderWay {
  std::unique_ptr<Frame> frame;
  double seconds = 0;  // of work so far
  std::uint64_t dropped = 0;
  std::set<std::string> device_classes = {};
  std::vector<float> errors = {};  // at each look
};

// Of one shot; frames by their places in it. Called in the coordinator's thread. Does not throw: what cannot
// be kept is its own trouble, and costs work that is done again after a crash, never a wrong image.
class Keeper {
 public:
  virtual ~Keeper() = default;
  struct Begun {
    FrameUnderWay frame;                      // as an earlier life left it, or at its begin
    std::vector<Work> work;                   // to be given out
    std::optional<std::string> failure = {};  // what the frame is given cannot be had: it fails at once
  };
  virtual Begun begin(std::size_t frame, const Job&) = 0;
  // What the frame before kept, or null, is about to be remembered.
  virtual void remembers(std::size_t frame, const std::shared_ptr<const Image>& history) = 0;
  // A result was accepted, and is about to be taken.
  virtual void takes(std::size_t frame, Accepted&& result, const Image& pixels) = 0;
  // The frame was looked at, after so many seconds, and goes on with another round.
  virtual void looked(std::size_t frame, const FrameUnderWay&, double seconds) = 0;
};

}  // namespace tessera

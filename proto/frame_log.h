// SPDX-License-Identifier: Apache-2.0
// What a coordinator writes down of a frame under way, as values: results that counted, and what happened
// between them. From these, or from a checkpoint and those after it, the frame is rebuilt bit for bit.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "core/frame_snapshot.h"
#include "core/sha256.h"
#include "core/task.h"
#include "proto/message.h"

namespace tessera {

// Of its values, plane after plane, row after row.
inline Digest digest_of(const Image& pixels) {
  const auto bytes = std::as_bytes(pixels.data());
  return sha256({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

// A worker's result that counted. Its pixels (the sums of the block, or the filtered planes) are kept beside
// it.
struct Accepted {
  Work work;
  int round = 0;  // of the frame
  Digest digest;  // of the pixels
  WorkerId worker;
  std::string device_class;
  double seconds = 0;         // of work
  std::uint64_t dropped = 0;  // samples that were not finite
  bool operator==(const Accepted&) const = default;
};

// What the frame before kept (Frame::remember): a blob; empty: nothing.
struct Remembered {
  Digest history;
  bool operator==(const Remembered&) const = default;
};

// A round ended and was looked at (Frame::look), at this time since the frame began. Work went on.
struct Looked {
  double seconds = 0;
  bool operator==(const Looked&) const = default;
};

using FrameEvent = std::variant<Accepted, Remembered, Looked>;

// All of a frame that came before a journal's entries.
struct Checkpoint {
  FrameSnapshot frame;
  double seconds = 0;                    // since the frame began
  std::uint64_t dropped = 0;             // samples that were not finite
  std::set<std::string> device_classes;  // of the workers whose results are in
  std::vector<float> errors;             // of the frame, at each look
};

}  // namespace tessera

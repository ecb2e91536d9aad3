// SPDX-License-Identifier: Apache-2.0
// The files of a shot: one for each frame with a preview beside it, and one for what the last frame that was
// done keeps for the next one.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/image.h"
#include "core/job.h"

namespace tessera {

// What a frame keeps for the next one, and of which image.
struct Kept {
  std::string key;
  std::shared_ptr<const Image> planes;
};

class FrameFiles {
 public:
  // `output`: an .exr, or a pattern of them (core/sequence.h) as soon as there is more than one frame. Throws
  // Error(bad_usage) if it cannot be written to.
  FrameFiles(std::filesystem::path output, bool many);

  std::filesystem::path frame(int number) const;
  // Whether the frame's file is whole, and known by that file_key() (frame_writer.h).
  bool holds(int number, const std::string& key) const;

  // For shots; of single frames nothing is kept. Each replaces the one before.
  std::filesystem::path history() const;
  void keep(const Kept&) const;
  // What is there, if it is sound and of a frame like `like`.
  std::optional<Kept> kept(const Job& like) const;

 private:
  std::filesystem::path output_;
};

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
// The files of a shot: one for each frame with a preview beside it, and one for what the last frame that was
// done keeps for the next one.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/job.h"

namespace tessera {

class FrameFiles {
 public:
  // `output`: an .exr, or a pattern of them (core/sequence.h) as soon as there is more than one frame. Throws
  // Error(bad_usage) if it cannot be written to.
  FrameFiles(std::filesystem::path output, bool many);

  std::filesystem::path frame(int number) const;
  // Whether the frame's file is whole, and of that image (resume.h).
  bool holds(int number, const std::string& key) const;

  // For shots; of single frames nothing is kept.
  std::filesystem::path history() const;
  void keep(const Image& kept, const std::string& key) const;
  // The key of the frame that kept what is there; empty if there is nothing, or nothing sound.
  std::string kept_key() const;
  // What is there. Null unless it is of that frame, and fits the job that goes by it.
  std::shared_ptr<const Image> kept(const std::string& key, const Job& next) const;

 private:
  std::filesystem::path output_;
};

}  // namespace tessera

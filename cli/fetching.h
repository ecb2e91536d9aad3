// SPDX-License-Identifier: Apache-2.0
// Images of a farm's job as files on this machine.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "cli/farm_link.h"
#include "core/error.h"

namespace tessera {

struct Fetching {
  std::string job;
  std::string output;  // name.exr, or a pattern of a shot; empty: no files, only wait
  bool wait = false;   // for the job's end; frames are fetched as they come
  bool quiet = false;
  bool growing = false;  // previews of frames under way, too
  std::string frames;    // as parse_frames takes them; empty: all
  // Told of each frame that has ended, once, and of its file, which it may take away; then there are no
  // previews. A frame that failed, or is not among `frames`, has no file.
  std::function<void(const FrameSummary&, const std::filesystem::path& exr)> told = {};
};

// Fetches each frame's EXR, and its preview beside it, unless the file is there and is that image. Progress
// goes to standard error. Returns what the command should end with: done, or of a job that is over what
// became of it.
ExitCode fetch_job(FarmLink& farm, const Fetching& what);

}  // namespace tessera

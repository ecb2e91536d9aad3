// SPDX-License-Identifier: Apache-2.0
// A frame's files: the layered EXR and the PNG to look at.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/report.h"
#include "core/submission.h"

namespace tessera {

// How the files of a job look, and what they say of the scene.
struct FrameStyle {
  std::string version;  // of tessera
  SceneNames names;
  bool transparent = false;  // the preview has the coverage of the picture
  std::string compression = "zip";
  double exposure = 0;                      // of the preview, stops
  std::vector<Channel> filter_inputs = {};  // what another filter takes: written to all of their bits
  SceneFacts facts = {};                    // of the scene
};
FrameStyle style_of(const Submission&, const std::string& version);

// What a frame's file is known by: its image's key (resume.h), and where they are not the usual ones, the
// layers that another filter takes and the compression. A file that lacks layers is not what was asked for.
std::string file_key(const std::string& image_key, const FrameStyle&);

// Both written beside and renamed. `key`: of the image, whose file_key() is written; empty: none is. Throws
// InputError for a place that cannot be written.
void write_frame(const std::filesystem::path& exr, const std::filesystem::path& png, const Job&,
                 const JobReport&, const FrameStyle&, const std::string& key);

// The frame has an image, but not the one that was asked for: a limit came first.
bool fell_short(const Job&, const FrameImage&);

}  // namespace tessera

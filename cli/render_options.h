// SPDX-License-Identifier: Apache-2.0
// The options of `tessera render`, and the job they mean.
#pragma once

#include <CLI/CLI.hpp>

#include <optional>
#include <string>
#include <vector>

#include "cli/log_options.h"
#include "cli/progress_display.h"
#include "core/job.h"
#include "core/scene/limits.h"

namespace tessera {

struct RenderOptions {
  std::string scene;
  std::string output;             // .exr; a .png preview is written beside it
  std::string until;              // "relmse=X", a number, or draft | good | final; empty: samples alone
  std::optional<int> samples;     // most per pixel
  std::optional<double> seconds;  // of wall time
  std::string filter = "svgf";
  int width = 960, height = 540;
  std::vector<double> crop;  // x0 y0 x1 y1, 0..1 from the top left
  std::string camera, variant;
  std::uint64_t seed = 0;
  int frame = 0;
  std::optional<std::string> frames;  // of a shot, as parse_frames takes them; none: `frame` alone
  std::string cuts;                   // frames that start anew, beside those at which the camera jumps
  int max_bounces = 8;
  int sure_bounces = 2;
  double clamp_direct = 0, clamp_indirect = 0, regularise = 0;
  ImportLimits limits;
  std::uint64_t texture_memory = 1024;  // MiB
  std::optional<int> threads;           // none: what this process may use
  std::string tile_size = "256";
  std::vector<std::string> aovs;
  std::string layers_for;  // a filter
  std::string device;
  bool list_devices = false;
  std::string compression = "zip";
  double exposure = 0;  // of the preview
  std::string progress = "auto";
  bool quiet = false;
  LogOptions log;
};

void describe(CLI::App&, RenderOptions&);
// Those that a farm takes, too: what image, and when it is good enough.
void describe_job(CLI::App&, RenderOptions&);

// The job without its scene's hash. Throws Error(bad_usage) naming the option and what it takes.
Job job_of(const RenderOptions&);

// Says so in the log if more samples are taken than are asked for.
void warn_of_few_samples(const RenderOptions&);

// The AOVs of the scene's light groups, if they are asked for.
AovSet groups_of(const RenderOptions&, std::size_t groups);

// "relmse=0.0025", "0.0025", "draft" (1e-2), "good" (2.5e-3), "final" (5e-4).
double parse_target(const std::string& text);

// Pixels of the normalised crop window, at least one.
Region crop_region(const std::vector<double>& ndc, Size frame);

}  // namespace tessera

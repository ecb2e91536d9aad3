// SPDX-License-Identifier: Apache-2.0
// Shows progress to a person on a terminal, or as lines to a program or a farm manager.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "coordinator/progress.h"

namespace tessera {

enum class ProgressStyle {
  none,
  bar,     // one line of a terminal, rewritten
  lines,   // "Progress: 37.5%", as Deadline and OpenCue read it
  json,    // an object a line
  openjd,  // "openjd_progress: 37.5"
};

// What to use when nothing was asked for: a bar on a terminal, openjd lines under OpenJD, lines elsewhere.
ProgressStyle usual_progress_style(bool terminal, const char* openjd_session);

// One line of text for each style but none; no line end.
std::string progress_text(ProgressStyle, const Progress&, int columns = 100);

// Writes to `file`, at most every 0.1 s for a bar and json, and for lines when a round ends, a percent has
// passed and at least every 30 s: managers kill a frame that is silent.
class ProgressDisplay {
 public:
  ProgressDisplay(ProgressStyle style, std::FILE* file) : style_(style), file_(file) {}
  ~ProgressDisplay();
  void show(const Progress& p) { show(p, p.seconds); }
  // At that time, in seconds since whenever: for progress whose own clock may stand still.
  void show(const Progress&, double clock);

 private:
  bool due(const Progress&, double clock) const;

  ProgressStyle style_;
  std::FILE* file_;
  Progress shown_;
  double shown_at_ = -1e9;
  double highest_ = 0;  // estimates may grow; the percentage shown never falls
};

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
// A job under way as a screen of text. Pure: what to show in, lines out.
#pragma once

#include <string>
#include <vector>

#include "proto/questions.h"

namespace tessera {

struct WatchView {
  JobSummary job;
  std::vector<FrameSummary> frames;  // those that are not over come first
  std::vector<WorkerSummary> workers;
  std::vector<JobEvent> events;  // the last ones
};

struct ScreenSize {
  int columns = 80, rows = 24;
};

// At most `rows` lines of at most `columns` characters, without line ends.
std::vector<std::string> watch_screen(const WatchView& view, const ScreenSize& size, bool colours);

}  // namespace tessera

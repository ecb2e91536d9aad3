// SPDX-License-Identifier: Apache-2.0
#include "cli/watch_screen.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/cell_map.h"
#include "cli/error_graph.h"
#include "cli/job_words.h"
#include "cli/terminal_text.h"

namespace tessera {
namespace {

constexpr int kLeastFrameRows = 4, kMostGraphRows = 12;
constexpr int kEventRows = 3;

using Lines = std::vector<std::string>;

const char* colour_of(JobState state) {
  switch (state) {
    case JobState::completed:
      return "32";
    case JobState::failed:
    case JobState::cancelled:
      return "31";
    case JobState::paused:
      return "33";
    default:
      return "36";
  }
}

std::string amount(double n) {
  if (n >= 1e9) return fmt::format("{:.2f} G", n * 1e-9);
  if (n >= 1e6) return fmt::format("{:.1f} M", n * 1e-6);
  return fmt::format("{:.0f}", n);
}

Lines header(const JobSummary& j, int columns, bool colours) {
  Lines lines;
  lines.push_back(fmt::format("{}  {}  {}", coloured(plain(j.job), "1", colours),
                              coloured(to_string(j.state), colour_of(j.state), colours), plain(j.reason)));
  std::string figures = fmt::format(" {:5.1f} %", 100 * j.fraction);
  if (j.seconds_left && !is_over(j)) figures += fmt::format("  {} left", duration_words(*j.seconds_left));
  const int room = std::clamp(columns - shown_width(figures), 0, 60);
  lines.push_back(coloured(progress_bar(j.fraction, room), "32;100", colours) + figures);
  std::string facts = fmt::format("{} so far, {}pixel samples", duration_words(j.seconds),
                                  amount(static_cast<double>(j.pixel_samples)) + " ");
  if (j.frames > 1) facts += fmt::format(", {} of {} frames done", j.frames_done, j.frames);
  if (j.frames_failed > 0) facts += fmt::format(", {} failed", j.frames_failed);
  if (j.failed_tasks > 0) facts += fmt::format(", {} tasks failed", j.failed_tasks);
  lines.push_back(facts);
  return lines;
}

std::string title(const FrameSummary& f, bool colours) {
  std::string text = coloured(fmt::format("frame {}", f.frame), "1", colours);
  text += fmt::format("  {}  {:.1f} %", to_string(f.state), 100 * f.fraction);
  if (f.state == FrameState::active)
    text += fmt::format("  round {}  tiles {}/{}", f.round, f.tiles_done, f.tiles);
  if (f.error) text += fmt::format("  relMSE {:.3g}", *f.error);
  if (f.target) text += fmt::format("{}{:.3g}", f.error ? " of " : "  relMSE wanted: ", *f.target);
  if (!f.cells.empty() && f.target) text += fmt::format("  {:.0f} % of cells good", 100 * f.acceptable_share);
  return text;
}

// Cells on the left, errors on the right.
Lines frame(const FrameSummary& f, int columns, int rows, bool colours) {
  Lines lines{title(f, colours)};
  const int room = rows - 2;  // a blank line behind it
  const int half = columns < 40 ? columns : columns / 2 - 1;
  Lines cells = cell_map(f.cells, f.columns, half, room, colours);
  if (f.cells.empty() && f.state == FrameState::active)
    cells.push_back(fmt::format("[{}] no look yet", progress_bar(f.fraction, std::max(0, half - 14))));
  const int gap = 2;
  int wide = 0;
  for (const std::string& line : cells) wide = std::max(wide, shown_width(line));
  const Lines graph =
      error_graph(f.errors, f.target, std::min(columns - wide - gap, 72), std::min(room, kMostGraphRows));
  for (std::size_t i = 0; i < std::max(cells.size(), graph.size()); ++i) {
    std::string line = i < cells.size() ? cells[i] : "";
    if (i < graph.size()) {
      line.append(static_cast<std::size_t>(wide + gap - shown_width(line)), ' ');
      line += coloured(graph[i], "36", colours);
    }
    lines.push_back(std::move(line));
  }
  lines.emplace_back();
  return lines;
}

std::string workers_line(const std::vector<WorkerSummary>& workers) {
  int slots = 0, held = 0, aside = 0;
  for (const WorkerSummary& w : workers) {
    slots += w.slots;
    held += w.held;
    aside += w.set_aside.empty() ? 0 : 1;
  }
  std::string text = fmt::format("workers: {}, {} slots, {} tasks in hand", workers.size(), slots, held);
  if (aside > 0) text += fmt::format(", {} set aside", aside);
  return text;
}

Lines footer(const WatchView& view, int rows, bool colours) {
  Lines lines;
  const auto shown =
      std::min<std::size_t>(view.events.size(), static_cast<std::size_t>(std::clamp(rows, 0, kEventRows)));
  for (std::size_t i = view.events.size() - shown; i < view.events.size(); ++i)
    lines.push_back(coloured(plain(line_of(view.events[i])), "2", colours));
  lines.push_back(workers_line(view.workers));
  return lines;
}

}  // namespace

std::vector<std::string> watch_screen(const WatchView& view, const ScreenSize& size, bool colours) {
  Lines lines = header(view.job, size.columns, colours);
  lines.emplace_back();
  const Lines last = footer(view, size.rows - 12, colours);
  std::vector<const FrameSummary*> active;
  for (const FrameSummary& f : view.frames)
    if (f.state == FrameState::active) active.push_back(&f);
  int room = size.rows - static_cast<int>(lines.size() + last.size());
  for (std::size_t i = 0; i < active.size() && room >= kLeastFrameRows; ++i) {
    const int share = std::max(kLeastFrameRows, room / static_cast<int>(active.size() - i));
    const Lines more = frame(*active[i], size.columns, share, colours);
    room -= static_cast<int>(more.size());
    lines.insert(lines.end(), more.begin(), more.end());
  }
  lines.insert(lines.end(), last.begin(), last.end());
  if (static_cast<int>(lines.size()) > size.rows)
    lines.resize(static_cast<std::size_t>(std::max(0, size.rows)));
  for (std::string& line : lines) line = cut(line, size.columns);
  return lines;
}

}  // namespace tessera

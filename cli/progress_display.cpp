// SPDX-License-Identifier: Apache-2.0
#include "cli/progress_display.h"

#include <fmt/format.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

constexpr double kMostSilence = 30.0, kBarInterval = 0.1;

int columns_of(std::FILE* file) {
  winsize size{};
  return ioctl(fileno(file), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 100;
}

std::string duration(double seconds) {
  const long s = std::lround(std::min(seconds, 359999.0));
  return s >= 3600 ? fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
                   : fmt::format("{}:{:02}", s / 60, s % 60);
}

std::string error_text(const Progress& p) {
  if (!p.error) return p.target ? fmt::format("target {:.4g}", *p.target) : "";
  if (!p.target) return fmt::format("error {:.2e}", *p.error);
  return fmt::format("error {:.4f} -> {:.4g}, {:.0f}% of cells good", *p.error, *p.target,
                     100 * p.acceptable_share);
}

std::string bar(const Progress& p, int columns) {
  std::string text = fmt::format(" {:3.0f}%", 100 * p.fraction);
  if (p.frames > 1) text += fmt::format("  frames {}/{}", p.frames_done, p.frames);
  text += fmt::format("  round {}  {:.1f}M samples  tiles {}/{}", p.round,
                      static_cast<double>(p.samples_done) * 1e-6, p.tiles_done, p.tiles_round);
  if (const std::string error = error_text(p); !error.empty()) text += fmt::format("  {}", error);
  text += fmt::format("  {}", duration(p.seconds));
  if (p.seconds_left) text += fmt::format(" (~{} left)", duration(*p.seconds_left));
  const int room = std::clamp(columns - static_cast<int>(text.size()) - 3, 0, 30);
  if (room < 5) return text.substr(0, static_cast<std::size_t>(std::max(columns - 1, 0)));
  const int full = static_cast<int>(std::lround(room * p.fraction));
  return fmt::format("[{}{}]{}", std::string(full, '#'), std::string(room - full, '.'), text);
}

std::string json(const Progress& p) {
  std::string text = fmt::format(
      R"({{"progress":{:.5f},"round":{},"samples":{},"tiles_done":{},"tiles":{},"acceptable_share":{:.4f},"seconds":{:.3f})",
      p.fraction, p.round, p.samples_done, p.tiles_done, p.tiles_round, p.acceptable_share, p.seconds);
  if (p.frames > 1) text += fmt::format(R"(,"frames_done":{},"frames":{})", p.frames_done, p.frames);
  if (p.error && std::isfinite(*p.error)) text += fmt::format(R"(,"relmse":{:.6g})", *p.error);
  if (p.target) text += fmt::format(R"(,"target":{:.6g})", *p.target);
  if (p.seconds_left) text += fmt::format(R"(,"seconds_left":{:.1f})", *p.seconds_left);
  return text + "}";
}

}  // namespace

ProgressStyle usual_progress_style(bool terminal, const char* openjd_session) {
  if (openjd_session != nullptr) return ProgressStyle::openjd;
  return terminal ? ProgressStyle::bar : ProgressStyle::lines;
}

std::string progress_text(ProgressStyle style, const Progress& p, int columns) {
  switch (style) {
    case ProgressStyle::none:
      return "";
    case ProgressStyle::bar:
      return bar(p, columns);
    case ProgressStyle::lines:
      return fmt::format("Progress: {:.1f}%", 100 * p.fraction);
    case ProgressStyle::json:
      return json(p);
    case ProgressStyle::openjd:
      return fmt::format("openjd_progress: {:.1f}", 100 * p.fraction);
  }
  return "";
}

bool ProgressDisplay::due(const Progress& p, double clock) const {
  const double silence = clock - shown_at_;
  if (p.round != shown_.round || (p.fraction >= 1 && shown_.fraction < 1)) return true;
  if (style_ == ProgressStyle::bar || style_ == ProgressStyle::json) return silence >= kBarInterval;
  return silence >= kMostSilence || p.fraction >= shown_.fraction + 0.01;
}

void ProgressDisplay::show(const Progress& now, double clock) {
  if (style_ == ProgressStyle::none) return;
  Progress p = now;
  highest_ = p.fraction = std::max(p.fraction, highest_);
  if (!due(p, clock)) return;
  const bool in_place = style_ == ProgressStyle::bar;
  fmt::print(file_, "{}{}{}", in_place ? "\r\x1b[K" : "", progress_text(style_, p, columns_of(file_)),
             in_place ? "" : "\n");
  std::fflush(file_);
  shown_ = p;
  shown_at_ = clock;
}

ProgressDisplay::~ProgressDisplay() {
  if (style_ == ProgressStyle::bar && highest_ > 0) fmt::print(file_, "\n");
}

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "bench/judging/plot.h"
#include "bench/temporal/scores.h"

namespace tessera::temporal {
namespace {

struct Figure {
  const char* file;
  const char* axis;
  double FrameScores::*value;
  bool logarithmic;
  double FrameScores::*reference;  // a line of its own; null: none
};
constexpr Figure kFigures[] = {
    {"rmse", "RMSE", &FrameScores::rmse, true, &FrameScores::reference_noise},
    {"ssim", "SSIM", &FrameScores::ssim, false, nullptr},
    {"error", "temporal error", &FrameScores::error, true, &FrameScores::reference_error},
    {"residual", "temporal residual", &FrameScores::residual, true, nullptr},
};

// What is alike but for its history has one colour; with history the line is solid.
judging::Line line_of(const Contestant& c, std::map<std::string, int>& colors) {
  judging::Line line{.name = c.name};
  if (c.group == "filters") {
    const std::string kind = c.filter.substr(0, c.filter.find(':'));
    line.dashed = c.filter.find("history=on") == std::string::npos;
    const bool smoothed = c.filter.find("taa=on") != std::string::npos;
    line.color =
        colors.try_emplace(smoothed ? kind + " taa" : kind, static_cast<int>(colors.size())).first->second;
  } else {
    line.color = colors.try_emplace(c.name, static_cast<int>(colors.size())).first->second;
  }
  return line;
}

void over_frames(const Results& results, const std::string& scene, const std::string& group,
                 const Figure& figure, const std::filesystem::path& folder) {
  judging::Plot plot{
      .title = fmt::format("{}: {} of each frame, {} spp", scene, figure.axis, results.samples),
      .x = "frame",
      .y = figure.axis,
      .logarithmic = figure.logarithmic};
  std::map<std::string, int> colors;
  judging::Line reference{.name = figure.value == &FrameScores::rmse ? "noise of the reference" : "reference",
                          .dashed = true};
  for (const Contestant& c : results.contestants) {
    if (c.group != group) continue;
    judging::Line line = line_of(c, colors);
    reference.points.clear();
    for (const FrameScores& s : results.frames_scores) {
      if (s.scene != scene || s.group != group || s.filter != c.name) continue;
      line.points.push_back({double(s.frame), s.*figure.value});
      if (figure.reference) reference.points.push_back({double(s.frame), s.*figure.reference});
    }
    plot.lines.push_back(std::move(line));
  }
  if (plot.lines.empty()) return;
  if (figure.reference) {
    reference.color = 7;
    plot.lines.push_back(std::move(reference));
  }
  const std::string name = group == "filters" ? scene : scene + "_" + group;
  write_plot(folder / fmt::format("{}_{}.png", name, figure.file), plot);
}

// The mean over the frames against what the group varies; a line for each scene.
void over_values(const Results& results, const std::vector<std::string>& scenes, const std::string& group,
                 const char* file, const char* axis, double FrameScores::*value,
                 const std::filesystem::path& folder) {
  judging::Plot plot{.title = fmt::format("bmfr by {}: {}, mean of the frames", group, axis),
                     .x = group == "blocks" ? "edge of a block, pixels" : "feature buffers",
                     .y = axis};
  for (const std::string& scene : scenes) {
    judging::Line line{.name = scene, .color = static_cast<int>(plot.lines.size())};
    for (const Contestant& c : results.contestants) {
      double sum = 0;
      int count = 0;
      for (const FrameScores& s : results.frames_scores)
        if (s.scene == scene && s.group == group && s.filter == c.name) sum += s.*value, ++count;
      if (count > 0) line.points.push_back({c.x, sum / count});
    }
    std::ranges::sort(line.points, {}, &judging::Point::x);
    if (!line.points.empty()) plot.lines.push_back(std::move(line));
  }
  if (!plot.lines.empty()) write_plot(folder / fmt::format("bmfr_{}_{}.png", group, file), plot);
}

}  // namespace

void write_plots(const Results& results, const std::filesystem::path& folder) {
  std::vector<std::string> scenes;
  for (const FrameScores& s : results.frames_scores)
    if (std::ranges::find(scenes, s.scene) == scenes.end()) scenes.push_back(s.scene);
  for (const std::string& scene : scenes)
    for (const std::string_view group : kGroups)
      for (const Figure& figure : kFigures) over_frames(results, scene, std::string(group), figure, folder);
  for (const char* group : {"features", "blocks"}) {
    over_values(results, scenes, group, "rmse", "RMSE", &FrameScores::rmse, folder);
    over_values(results, scenes, group, "ssim", "SSIM", &FrameScores::ssim, folder);
    over_values(results, scenes, group, "ms", "milliseconds of all kernels", &FrameScores::milliseconds,
                folder);
  }
}

}  // namespace tessera::temporal

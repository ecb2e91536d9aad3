// SPDX-License-Identifier: Apache-2.0
// The tables of Schied et al. 2017 (table 1) and Koskela et al. 2019 (tables 2 to 4, figures 4 to 6), on our
// scenes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/judging/table.h"
#include "bench/temporal/scores.h"

namespace tessera::temporal {
namespace {

using Text = std::optional<std::string>;
using Value = double FrameScores::*;

template <typename T>
void add_once(std::vector<T>& list, const T& item) {
  if (std::ranges::find(list, item) == list.end()) list.push_back(item);
}

class Report {
 public:
  explicit Report(const Results& results) : results_(results) {
    for (const FrameScores& s : results.frames_scores) add_once(scenes_, s.scene);
  }

  std::string text() {
    say("{}×{}, {} frames, {} spp, references of {} spp. RMSE, SSIM, temporal error and residual are of the "
        "display image (gamma 2.2), means over the frames; RMSE is without the reference's own noise, the "
        "others "
        "are not.\n\n",
        results_.size.width, results_.size.height, results_.frames, results_.samples,
        results_.reference_samples);
    const std::vector<std::string> filters = of_group("filters");
    if (!filters.empty()) {
      errors(filters);
      ratios();
      winners();
    }
    sweep("features", "feature buffers");
    sweep("blocks", "block edge");
    times();
    return std::move(text_);
  }

 private:
  template <typename... T>
  void say(fmt::format_string<T...> format, T&&... values) {
    text_ += fmt::format(format, std::forward<T>(values)...);
  }

  std::vector<std::string> of_group(std::string_view group) const {
    std::vector<std::string> names;
    for (const Contestant& c : results_.contestants)
      if (c.group == group) names.push_back(c.name);
    return names;
  }

  // Mean over the frames from `first` on that have the value; of all scenes if `scene` is empty.
  std::optional<double> mean(std::string_view scene, std::string_view filter, Value value,
                             std::string_view group = "filters", int first = 0) const {
    double sum = 0;
    int count = 0;
    for (const FrameScores& s : results_.frames_scores) {
      if ((!scene.empty() && s.scene != scene) || s.filter != filter || s.group != group) continue;
      if (s.frame < first || std::isnan(s.*value)) continue;
      sum += s.*value;
      ++count;
    }
    if (count == 0) return std::nullopt;
    return sum / count;
  }

  // `filters` against the scenes and all together; `own`: a row above of a value that every filter tells
  // alike.
  void by_scene(std::string_view title, const std::vector<std::string>& filters, Value value,
                std::string_view own = {}, Value own_value = nullptr) {
    say("### {}\n\n", title);
    std::vector<std::string> rows = filters, columns = scenes_;
    if (!own.empty()) rows.insert(rows.begin(), std::string(own));
    columns.emplace_back("mean");
    text_ += judging::table(
        "filter", rows, columns, [&](const std::string& row, const std::string& column) -> Text {
          const std::string scene = column == "mean" ? "" : column;
          const auto m = row == own ? mean(scene, filters[0], own_value) : mean(scene, row, value);
          if (!m) return std::nullopt;
          return fmt::format("{:.4f}", *m);
        });
  }

  void errors(const std::vector<std::string>& filters) {
    by_scene("RMSE (Schied et al. 2017, table 1; Koskela et al. 2019, table 2)", filters, &FrameScores::rmse,
             "noise of the reference", &FrameScores::reference_noise);
    by_scene("SSIM (the same tables)", filters, &FrameScores::ssim);
    by_scene(
        "Temporal error (Koskela et al. 2019, table 3): not the lower, the better, but the nearer to the "
        "reference's",
        filters, &FrameScores::error, "reference", &FrameScores::reference_error);
    by_scene("Temporal residual: 0 for a perfect sequence", filters, &FrameScores::residual);
  }

  // The first filter of its kind that is in the race; kind: the name's beginning, with or without history.
  std::optional<std::string> entry(std::string_view kind, bool history) const {
    for (const std::string& f : of_group("filters"))
      if (f.starts_with(kind) && f.find("taa=on") == std::string::npos &&
          (f.find("history=on") != std::string::npos) == history)
        return f;
    return std::nullopt;
  }

  void ratios() {
    struct Pair {
      std::string name;
      std::optional<std::string> above, below;
      int first = 0;  // frame that counts
    };
    std::vector<Pair> pairs;
    for (const int first : {0, results_.frames / 2}) {
      const std::string when = first == 0 ? "" : fmt::format(", from frame {} on", first);
      pairs.push_back(
          {"svgf over atrous, both with history" + when, entry("svgf", true), entry("atrous", true), first});
      pairs.push_back(
          {"bmfr over svgf, both with history" + when, entry("bmfr", true), entry("svgf", true), first});
    }
    for (const char* kind : {"atrous", "svgf", "bmfr"})
      pairs.push_back(
          {fmt::format("{}: with history over without", kind), entry(kind, true), entry(kind, false)});
    say("### Ratios of RMSE: below 1, the first is better\n\n");
    std::vector<std::string> rows, columns = scenes_;
    for (const Pair& p : pairs) rows.push_back(p.name);
    columns.emplace_back("better in");
    text_ += judging::table(
        "ratio", rows, columns, [&](const std::string& row, const std::string& column) -> Text {
          const Pair& p = *std::ranges::find(pairs, row, &Pair::name);
          if (!p.above || !p.below) return std::nullopt;
          const auto ratio = [&](const std::string& scene) {
            return *mean(scene, *p.above, &FrameScores::rmse, "filters", p.first) /
                   *mean(scene, *p.below, &FrameScores::rmse, "filters", p.first);
          };
          if (column != "better in") return fmt::format("{:.3f}", ratio(column));
          const auto better =
              std::ranges::count_if(scenes_, [&](const std::string& s) { return ratio(s) < 1; });
          return fmt::format("{} of {}", better, scenes_.size());
        });
  }

  // Of those that had as many samples as all.
  std::string best(const std::string& scene, Value value, double sign) const {
    std::string name;
    double least = 0;
    for (const Contestant& c : results_.contestants) {
      if (c.group != "filters" || c.samples != results_.samples || c.filter == "none") continue;
      const auto m = mean(scene, c.name, value);
      if (!m || (!name.empty() && sign * *m >= least)) continue;
      least = sign * *m;
      name = c.name;
    }
    return fmt::format("`{}`", name);
  }

  void winners() {
    say("### Who is best, of those with {} spp\n\n", results_.samples);
    const std::vector<std::string> columns{"RMSE", "SSIM", "residual"};
    text_ += judging::table(
        "scene", scenes_, columns, [&](const std::string& scene, const std::string& c) -> Text {
          if (c == "RMSE") return best(scene, &FrameScores::rmse, 1);
          return c == "SSIM" ? best(scene, &FrameScores::ssim, -1) : best(scene, &FrameScores::residual, 1);
        });
  }

  void sweep(const std::string& group, std::string_view what) {
    const std::vector<std::string> names = of_group(group);
    if (names.empty()) return;
    say("### BMFR by its {}: RMSE, SSIM, kernels' milliseconds\n\n", what);
    std::vector<std::string> columns{std::string(what)};
    for (const std::string& scene : scenes_) columns.push_back(scene);
    text_ += judging::table("filter", names, columns,
                            [&](const std::string& name, const std::string& column) -> Text {
                              if (column == what) {
                                for (const Contestant& c : results_.contestants)
                                  if (c.group == group && c.name == name) return fmt::format("{}", c.x);
                                return std::nullopt;
                              }
                              const auto rmse = mean(column, name, &FrameScores::rmse, group),
                                         ssim = mean(column, name, &FrameScores::ssim, group),
                                         ms = mean(column, name, &FrameScores::milliseconds, group);
                              if (!rmse) return std::nullopt;
                              return fmt::format("{:.4f}, {:.3f}, {:.2f}", *rmse, *ssim, *ms);
                            });
  }

  void times() {
    const std::vector<std::string> filters = of_group("filters");
    std::vector<std::string> rows;
    for (const KernelScores& k : results_.kernels) {
      if (std::ranges::find(filters, k.filter) == filters.end()) continue;
      add_once(rows, k.filter + " " + k.kernel);
    }
    if (rows.empty()) return;
    say("### Milliseconds of a frame, kernel by kernel (Koskela et al. 2019, table 4)\n\nThe median of the "
        "frames; all runs of a kernel together.\n\n");
    std::vector<std::string> columns = scenes_;
    columns.emplace_back("ns a pixel");
    text_ += judging::table(
        "filter and kernel", rows, columns, [&](const std::string& row, const std::string& column) -> Text {
          std::vector<double> all;
          for (const KernelScores& k : results_.kernels)
            if (k.filter + " " + k.kernel == row && (column == "ns a pixel" || k.scene == column))
              all.push_back(k.milliseconds);
          if (all.empty()) return std::nullopt;
          if (column != "ns a pixel") return fmt::format("{:.3f}", all[0]);
          return fmt::format(
              "{:.1f}", 1e6 * *std::ranges::min_element(all) / (results_.size.width * results_.size.height));
        });
  }

  const Results& results_;
  std::vector<std::string> scenes_;
  std::string text_;
};

}  // namespace

std::string report(const Results& results) { return Report(results).text(); }

}  // namespace tessera::temporal

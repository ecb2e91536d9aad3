// SPDX-License-Identifier: Apache-2.0
// The tables of the papers, on our scenes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "bench/judging/table.h"
#include "bench/quality/scores.h"

namespace tessera::quality {
namespace {

constexpr std::string_view kNoisy = "noisy";
// What is better than this is as good: the reference is not known better.
constexpr double kLeast = 1e-7;

template <typename T>
void add_once(std::vector<T>& list, const T& item) {
  if (std::ranges::find(list, item) == list.end()) list.push_back(item);
}

class Report {
 public:
  explicit Report(const std::vector<Scores>& all) : all_(all) {
    for (const Scores& s : all) {
      add_once(scenes_, s.scene);
      add_once(filters_, s.filter);
      add_once(samples_, s.samples);
    }
    std::ranges::sort(samples_);
  }

  std::string text() {
    by_ratio();
    kim();
    lardinoije();
    van_de_vlasakker();
    for (const std::string& scene : scenes_) of_scene(scene);
    return std::move(text_);
  }

 private:
  const Scores* find(std::string_view scene, std::string_view filter, int samples) const {
    for (const Scores& s : all_)
      if (s.scene == scene && s.filter == filter && s.samples == samples) return &s;
    return nullptr;
  }

  template <typename... T>
  void say(fmt::format_string<T...> format, T&&... values) {
    text_ += fmt::format(format, std::forward<T>(values)...);
  }

  template <typename Column, typename Value>
  void table(std::string_view corner, const std::vector<std::string>& rows,
             const std::vector<Column>& columns, const Value& value) {
    text_ += judging::table(corner, rows, columns, value);
  }

  // The geometric mean over the scenes of relMSE over the noisy picture's.
  void by_ratio() {
    say("## All scenes: relMSE over that of the noisy picture, geometric mean\n\n"
        "Below 1: better than no filter. Empty: the filter needs more samples, or takes the first eight "
        "alone.\n\n");
    table("filter \\ samples", filters_, samples_,
          [&](const std::string& f, int n) -> std::optional<std::string> {
            double logs = 0;
            int count = 0;
            for (const std::string& scene : scenes_) {
              const Scores *s = find(scene, f, n), *noisy = find(scene, kNoisy, n);
              if (!s || !noisy) continue;
              logs += std::log(std::max(s->relmse, kLeast) / std::max(noisy->relmse, kLeast));
              ++count;
            }
            if (count == 0) return std::nullopt;
            return fmt::format("{:.3f}", std::exp(logs / count));
          });
  }

  // Kim et al. 2016, table 1: mean square errors of the input, EAW and SURE a-trous at 16 samples.
  void kim() {
    say("## SURE à-trous against EAW (Kim et al. 2016, table 1): mean square error of the display image, 16 "
        "samples\n\n");
    const std::vector<std::string> rows{"noisy", "atrous", "sure-atrous", "sure-atrous:mode=literal"};
    table("filter", rows, scenes_,
          [&](const std::string& f, const std::string& scene) -> std::optional<std::string> {
            const Scores* s = find(scene, f, 16);
            if (!s) return std::nullopt;
            return fmt::format("{:.6f}", s->mse0 / 3);
          });
  }

  // Lardinoije: the error (sum over channels) of the input, RHF, NL-means and FDF over the samples.
  void lardinoije() {
    say("## FDF, NL-means and RHF (Lardinoije): MSE summed over channels, ×10⁴, display image, mean of all "
        "scenes\n\n");
    table("filter \\ samples", {"noisy", "rhf", "nlm:mode=prefilter", "nlm", "fdf"}, samples_,
          [&](const std::string& f, int n) {
            return mean_of(f, n, [](const Scores& s) { return 1e4 * s.mse0; });
          });
    say("Factor by which `fdf` lowers it:\n\n");
    table("scene \\ samples", scenes_, samples_,
          [&](const std::string& scene, int n) -> std::optional<std::string> {
            const Scores *s = find(scene, "fdf", n), *noisy = find(scene, kNoisy, n);
            if (!s || !noisy) return std::nullopt;
            return fmt::format("{:.2f}", noisy->mse0 / s->mse0);
          });
  }

  // Van de Vlasakker 2013: CIELUV errors of RPF, DDF and the plain filters at 8 samples (16 with depth of
  // field).
  void van_de_vlasakker() {
    say("## DDF against RPF (van de Vlasakker 2013): CIELUV error (mean square of L\\*), 8 samples\n\n"
        "`focus` has depth of field.\n\n");
    const std::vector<std::string> rows{"noisy",           "box", "gaussian", "bilateral",
                                        "cross-bilateral", "rpf", "ddf",      "ddf:holes=on"};
    table("filter", rows, scenes_,
          [&](const std::string& f, const std::string& scene) -> std::optional<std::string> {
            const Scores* s = find(scene, f, 8);
            if (!s) return std::nullopt;
            return fmt::format("{:.1f}", s->lightness);
          });
  }

  template <typename Value>
  std::optional<std::string> mean_of(const std::string& filter, int samples, const Value& value) const {
    double sum = 0;
    int count = 0;
    for (const std::string& scene : scenes_)
      if (const Scores* s = find(scene, filter, samples)) {
        sum += value(*s);
        ++count;
      }
    if (count == 0) return std::nullopt;
    return fmt::format("{:.2f}", sum / count);
  }

  void of_scene(const std::string& scene) {
    say("## {}\n\nrelMSE; then SSIM, FLIP and milliseconds at 16 samples (8 where a filter takes no "
        "more).\n\n",
        scene);
    std::vector<std::string> columns;
    for (const int n : samples_) columns.push_back(std::to_string(n));
    for (const char* c : {"SSIM", "FLIP", "ms"}) columns.emplace_back(c);
    table("filter \\ samples", filters_, columns,
          [&](const std::string& f, const std::string& column) -> std::optional<std::string> {
            const bool count = column[0] >= '0' && column[0] <= '9';
            const Scores* s = find(scene, f, count ? std::stoi(column) : 16);
            if (!s && !count) s = find(scene, f, 8);
            if (!s) return std::nullopt;
            if (column == "SSIM") return fmt::format("{:.3f}", s->ssim);
            if (column == "FLIP") return fmt::format("{:.3f}", s->flip);
            if (column == "ms") return f == kNoisy ? std::string() : fmt::format("{:.1f}", s->milliseconds);
            return fmt::format("{:.2e}", s->relmse);
          });
  }

  const std::vector<Scores>& all_;
  std::vector<std::string> scenes_, filters_;
  std::vector<int> samples_;
  std::string text_;
};

}  // namespace

std::string report(const std::vector<Scores>& all) { return Report(all).text(); }

}  // namespace tessera::quality

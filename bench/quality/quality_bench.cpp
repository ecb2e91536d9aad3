// SPDX-License-Identifier: Apache-2.0
// How good the filters are, on scenes of ours, from 1 to 1024 samples, against references: a table of
// everything as CSV, the papers' tables as Markdown, and for each scene a sheet of pictures. Resumes:
// references are kept.
//   quality_bench [--out FOLDER] [--size N] [--reference SAMPLES] [--samples 1,4,8] [--scene NAME] [--filter
//   F] ...
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <fstream>
#include <optional>

#include "bench/judging/sheet.h"
#include "bench/judging/trial.h"
#include "bench/quality/scores.h"
#include "core/error.h"
#include "core/png.h"
#include "scenes/trials.h"
#include "worker/denoise/runner.h"

namespace tessera::quality {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path out = "out/quality";
  int size = 256, reference = 4096;
  std::vector<int> samples{1, 4, 8, 16, 64, 256, 1024};
  std::vector<std::string> scenes{scenes::kTrials, scenes::kTrials + std::size(scenes::kTrials)};
  std::vector<std::string> filters;
};

// Every filter as it is, and the variants that the papers' tables ask for.
std::vector<std::string> all_filters() {
  std::vector<std::string> texts;
  for (const FilterDescription& f : filters()) {
    if (f.name == "none") continue;
    texts.emplace_back(f.name);
    for (const char* variant :
         {"nlm:mode=prefilter", "sure-atrous:mode=literal", "ddf:holes=on", "ddf:progressive=on",
          "svgf:variance=spatial", "bmfr:grids=1", "rhf:scales=2"})
      if (std::string_view(variant).starts_with(std::string(f.name) + ":")) texts.emplace_back(variant);
  }
  return texts;
}

bool takes(const FilterPlan& plan, const auto& what) { return std::ranges::any_of(plan.inputs(), what); }

// Variances need two samples in each half; single samples are kept of the first eight.
bool can_run(const FilterPlan& plan, int samples) {
  const bool single =
      takes(plan, [](const Channel& c) { return info(c.aov).reduction == Reduction::per_sample; });
  if (single) return samples == 8;
  const bool statistics = takes(plan, [](const Channel& c) {
    return c.share != Share::all || c.statistic == Statistic::variance_of_mean ||
           c.statistic == Statistic::third_moment;
  });
  return !statistics || samples >= 4;
}

struct Filtering {
  Image image;
  double milliseconds = 0;
};

// The second of two runs: the first may build kernels. Slow filters run once.
Filtering run(Device& device, const FilterPlan& plan, const Image& input) {
  constexpr double kSlow = 2000;
  Filtering f;
  for (int i = 0; i < 2 && f.milliseconds < kSlow; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    f.image = filter(device, plan, input, {input.region(), input.region()}, input.region());
    f.milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  }
  return f;
}

constexpr int kShown = 16;  // samples of the sheet's pictures; 8 where a filter takes no more

void judge(const Options& o, const std::string& name, Device& device, std::vector<Scores>& all) {
  judging::Shot shot(o.out / "scenes" / (name + ".json"), {o.size, o.size});
  judging::Trial trial = shot.trial(judging::aovs_for(o.filters));
  const judging::Reference reference = reference_of(trial, o.reference, o.out / "references");
  std::vector<Image> pictures{reference.mean};
  std::vector<std::string> shown{"reference"};
  for (const int samples : o.samples) {
    trial.render_to(samples);
    const auto take = [&](const std::string& filter, const Filtering& f, bool show) {
      Scores s{.scene = name, .filter = filter, .samples = samples, .milliseconds = f.milliseconds};
      score(f.image, reference.mean, reference.variance, s);
      all.push_back(s);
      if (!show) return;
      pictures.push_back(f.image);
      shown.push_back(filter);
    };
    take("noisy", {trial.noisy(), 0}, samples == kShown);
    for (const std::string& text : o.filters) {
      const FilterPlan plan = resolved(parse_filter(text), trial.facts());
      if (can_run(plan, samples))
        take(text, run(device, plan, trial.input(plan)),
             samples == kShown || (samples == 8 && !can_run(plan, kShown)));
    }
    fmt::print("{}: {} samples\n", name, samples);
    std::fflush(stdout);
  }
  write_png(o.out / (name + ".png"), judging::in_rows(pictures, 6));
  std::ofstream(o.out / (name + ".txt")) << fmt::format("{}\n", fmt::join(shown, "\n"));
}

int run(Options o) {
  if (o.filters.empty()) o.filters = all_filters();
  for (const std::string& text : o.filters) parse_filter(text);
  std::ranges::sort(o.samples);
  for (const int n : o.samples)
    if (n < 1 || (n & (n - 1)) != 0) throw Error(ExitCode::bad_usage, "--samples: powers of two");
  scenes::write_trials(o.out / "scenes");
  const auto device = Device::open("");
  std::vector<Scores> all;
  for (const std::string& name : o.scenes) {
    judge(o, name, *device, all);
    std::ofstream(o.out / "scores.csv") << csv(all);
    std::ofstream(o.out / "report.md") << report(all);
  }
  fmt::print("{}", report(all));
  return 0;
}

}  // namespace
}  // namespace tessera::quality

int main(int count, char** words) {
  tessera::quality::Options o;
  CLI::App app{"How good the filters are"};
  app.add_option("--out", o.out)->capture_default_str();
  app.add_option("--size", o.size)->check(CLI::Range(16, 4096))->capture_default_str();
  app.add_option("--reference", o.reference, "Samples of the reference, a power of two")
      ->capture_default_str();
  app.add_option("--samples", o.samples)->delimiter(',')->capture_default_str();
  app.add_option("--scene", o.scenes)->capture_default_str();
  app.add_option("--filter", o.filters, "[all]");
  CLI11_PARSE(app, count, words);
  try {
    return tessera::quality::run(o);
  } catch (const tessera::Error& e) {
    fmt::print(stderr, "quality_bench: {}\n", e.what());
    return static_cast<int>(e.code());
  }
}

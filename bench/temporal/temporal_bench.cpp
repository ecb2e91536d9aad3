// SPDX-License-Identifier: Apache-2.0
// How good filters are on scenes of ours in motion, frame after frame, each going by its own history: the
// papers' tables as Markdown, everything as CSV, plots over the frames and sheets of pictures. Resumes:
// references are kept.
//   temporal_bench [--out FOLDER] [--size WxH] [--frames N] [--samples N] [--reference SAMPLES] [--scene
//   NAME]
//   ... [--filter F[@SAMPLES]] ... [--group filters|features|blocks|structured] ...
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <bit>
#include <fstream>
#include <map>

#include "bench/judging/sheet.h"
#include "bench/judging/trial.h"
#include "bench/temporal/scores.h"
#include "bench/temporal/structured.h"
#include "core/error.h"
#include "core/png.h"
#include "core/quality/display.h"
#include "core/quality/metrics.h"
#include "scenes/shots.h"
#include "worker/denoise/device_cl.h"
#include "worker/denoise/runner.h"

namespace tessera::temporal {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path out = "out/temporal";
  std::string size = "160x90";
  int frames = scenes::kShotFrames, samples = 1, reference = 4096;
  std::vector<std::string> scenes{scenes::kShots, scenes::kShots + std::size(scenes::kShots)};
  std::vector<std::string> filters, groups{"filters", "features", "blocks", "structured"};
};

// A contestant on one shot.
struct Run {
  const Contestant* contestant = nullptr;
  Image history;  // of the frame before; empty before the first one
  TemporalError stability;
  std::map<std::string, std::vector<double>> kernels;  // milliseconds, frame by frame
  Image image;                                         // of the last frame
  double rmse = 0;
};

// Filters the trial's frame; the sum of the kernels' milliseconds.
double advance(Run& run, ClDevice& device, const judging::Trial& trial) {
  const FilterPlan plan = resolved(parse_filter(run.contestant->filter), trial.facts());
  const Region frame = trial.frame();
  std::vector<KernelTime> times;
  device.record(&times);
  const Image output = filter(device, plan, trial.input(plan), {frame, frame}, frame, run.history);
  device.record(nullptr);
  run.image = planes_of(output, 0, 3);
  if (plan.history() > 0) run.history = planes_of(output, 3, plan.history());
  std::map<std::string, double> sums;
  double all = 0;
  for (const KernelTime& t : times) {
    sums[t.kernel] += 1e3 * t.seconds;
    all += 1e3 * t.seconds;
  }
  for (const auto& [kernel, milliseconds] : sums) run.kernels[kernel].push_back(milliseconds);
  return all;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// Noisy, filtered and reference, and below each how far it is off; of the group "filters".
void write_sheet(const fs::path& file, const std::vector<Run>& runs, const Image& reference) {
  constexpr int kWide = 384, kColumns = 4;
  constexpr float kMost = 0.25f;  // of the error's map, where white is 1
  const int factor = std::max(1, kWide / reference.region().width());
  const Display as_the_papers{Curve::gamma, 0};
  std::vector<Image> pictures{judging::captioned(judging::enlarged(reference, factor), "reference")};
  std::vector<Image> errors{pictures[0]};
  for (const Run& run : runs) {
    if (run.contestant->group != "filters") continue;
    const std::string words = fmt::format("{}  {:.4f}", run.contestant->name, run.rmse);
    pictures.push_back(judging::captioned(judging::enlarged(run.image, factor), words));
    const Image off =
        image_of(difference_map(displayed(run.image, as_the_papers), displayed(reference, as_the_papers)));
    errors.push_back(judging::captioned(judging::enlarged(heat_map(off, 0, kMost), factor), words));
  }
  write_png(file, judging::in_rows(pictures, kColumns));
  write_png(fs::path(file).replace_extension(".errors.png"), judging::in_rows(errors, kColumns));
}

void judge(const Options& o, const std::string& name, ClDevice& device, Results& results) {
  judging::Shot shot(o.out / "scenes" / (name + ".json"), results.size);
  std::vector<Run> runs;
  std::vector<std::string> filters;
  std::map<int, std::vector<std::size_t>> by_samples;
  for (const Contestant& c : results.contestants) {
    by_samples[c.samples].push_back(runs.size());
    filters.push_back(c.filter);
    runs.push_back({.contestant = &c});
  }
  const AovSet aovs = judging::aovs_for(filters);
  for (int frame = 0; frame < o.frames; ++frame) {
    judging::Trial trial = shot.trial(aovs, frame);
    const judging::Reference reference = reference_of(trial, o.reference, o.out / "references");
    for (const auto& [samples, indices] : by_samples) {
      trial.render_to(samples);
      for (const std::size_t i : indices) {
        Run& run = runs[i];
        FrameScores s{
            .scene = name, .group = run.contestant->group, .filter = run.contestant->name, .frame = frame};
        s.milliseconds = advance(run, device, trial);
        score(run.image, reference, run.stability, s);
        run.rmse = s.rmse;
        results.frames_scores.push_back(s);
      }
    }
    if (frame == 0 || frame == o.frames / 2 || frame == o.frames - 1)
      write_sheet(o.out / fmt::format("{}_{:04}.png", name, frame), runs, reference.mean);
    fmt::print("{}: frame {} of {}\n", name, frame + 1, o.frames);
    std::fflush(stdout);
  }
  for (const Run& run : runs)
    for (const auto& [kernel, milliseconds] : run.kernels)
      results.kernels.push_back({name, run.contestant->name, kernel, median(milliseconds)});
}

std::vector<Contestant> contestants_of(const Options& o) {
  std::vector<Contestant> all;
  for (const std::string& text : o.filters) all.push_back(parse_contestant(text, o.samples));
  for (const std::string& group : o.groups) {
    if (group == "filters" && !o.filters.empty()) continue;
    for (const Contestant& c : standard_contestants(group, o.samples)) all.push_back(c);
  }
  return all;
}

int run(const Options& o) {
  Results results{.samples = o.samples, .reference_samples = o.reference, .frames = o.frames};
  char more = 0;
  if (std::sscanf(o.size.c_str(), "%dx%d%c", &results.size.width, &results.size.height, &more) != 2 ||
      results.size.width < 16 || results.size.height < 16 || results.size.width > 4096 ||
      results.size.height > 4096)
    throw Error(ExitCode::bad_usage, "--size: WxH, each from 16 to 4096");
  for (const int n : {o.samples, o.reference})
    if (!std::has_single_bit(static_cast<unsigned>(n)))
      throw Error(ExitCode::bad_usage, "--samples, --reference: powers of two");
  results.contestants = contestants_of(o);
  scenes::write_shots(o.out / "scenes");
  const auto opened = Device::open("");
  ClDevice& device = dynamic_cast<ClDevice&>(*opened);
  std::string synthetic;
  if (std::ranges::find(o.groups, "structured") != o.groups.end())
    synthetic = structured(device, o.frames, o.out);
  std::ofstream(o.out / "report.md") << synthetic;
  for (const std::string& name : results.contestants.empty() ? std::vector<std::string>{} : o.scenes) {
    judge(o, name, device, results);
    std::ofstream(o.out / "frames.csv") << frames_csv(results);
    std::ofstream(o.out / "kernels.csv") << kernels_csv(results);
    std::ofstream(o.out / "report.md") << report(results) << synthetic;
    write_plots(results, o.out);
  }
  fmt::print("{}{}", results.contestants.empty() ? "" : report(results), synthetic);
  return 0;
}

}  // namespace
}  // namespace tessera::temporal

int main(int count, char** words) {
  tessera::temporal::Options o;
  CLI::App app{"How good the filters are on scenes in motion"};
  app.add_option("--out", o.out)->capture_default_str();
  app.add_option("--size", o.size, "WxH")->capture_default_str();
  app.add_option("--frames", o.frames)->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--samples", o.samples, "Per pixel and frame, a power of two")->capture_default_str();
  app.add_option("--reference", o.reference, "Samples of the references, a power of two >= 2")
      ->check(CLI::Range(2, 1 << 20))
      ->capture_default_str();
  app.add_option("--scene", o.scenes)->capture_default_str();
  app.add_option("--filter", o.filters, "FILTER or FILTER@SAMPLES, in place of the group 'filters'");
  app.add_option("--group", o.groups, "What is compared")
      ->check(CLI::IsMember({"filters", "features", "blocks", "structured"}))
      ->capture_default_str();
  CLI11_PARSE(app, count, words);
  try {
    return tessera::temporal::run(o);
  } catch (const tessera::Error& e) {
    fmt::print(stderr, "temporal_bench: {}\n", e.what());
    return static_cast<int>(e.code());
  }
}

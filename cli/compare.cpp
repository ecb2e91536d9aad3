// SPDX-License-Identifier: Apache-2.0
#include "cli/compare.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>

#include "cli/compare_files.h"
#include "cli/compare_report.h"
#include "cli/sizes.h"
#include "core/error.h"
#include "core/png.h"
#include "core/quality/metrics.h"
#include "core/quality/temporal.h"
#include "core/sequence.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTileSizes = "N or WxH, 1 to 65536 pixels";

Size tile_of(const CompareOptions& options, const fs::path& file, const ExrImage& image) {
  const auto checked = [](std::string_view where, const std::string& size) {
    const std::optional<Size> tile = parse_tile_size(size);
    if (!tile) throw InputError(where, fmt::format("'{}' is no tile size", size), kTileSizes);
    return *tile;
  };
  if (!options.tile_size.empty()) return checked("--tile-size", options.tile_size);
  const auto written = image.metadata.find("tessera/tile");
  if (written == image.metadata.end()) return {256, 256};
  const auto* size = std::get_if<std::string>(&written->second);
  return checked(file.string() + ": tessera/tile", size ? *size : "a number");
}

FileFacts facts_of(const ExrImage& file, const Image& rgb) {
  FileFacts facts;
  for (const char* name : {"samples", "seed", "filter"})
    if (const auto at = file.metadata.find(fmt::format("tessera/{}", name)); at != file.metadata.end())
      facts.origin[name] = at->second;
  const Region& r = rgb.region();
  for (int i = 0; i < r.area(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (std::isfinite(rgb.plane(0)[k]) && std::isfinite(rgb.plane(1)[k]) && std::isfinite(rgb.plane(2)[k]))
      continue;
    if (facts.not_finite++ == 0) facts.first_not_finite = {r.x0 + i % r.width(), r.y0 + i / r.width()};
  }
  return facts;
}

// The relMSE that is due to the reference's own noise, if it says how noisy its pixels are.
std::optional<Figure> noise_of(const ExrImage& reference, const Image& r) {
  const std::optional<Image> variance = layer_of(reference, "variance.");
  if (!variance) return std::nullopt;
  double sum = 0;
  for (std::size_t i = 0; i < r.data().size(); ++i)
    sum += variance->data()[i] / (double(r.data()[i]) * r.data()[i] + kRelMseEpsilon);
  return Figure{"reference_noise", "of it reference", sum / static_cast<double>(r.data().size()),
                "linear",          std::nullopt,      "the reference's own noise, by its variance layer"};
}

// A round number at or above the error that only 1 % of the pixels exceed; 0 if that is 0.
float round_scale(ErrorMap errors) {
  std::erase_if(errors.values, [](double v) { return !std::isfinite(v); });
  const double top = percentile(errors, 0.99);
  if (!(top > 0)) return 0;
  const double power = std::pow(10.0, std::floor(std::log10(top)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power >= top) return static_cast<float>(step * power);
  return static_cast<float>(10 * power);
}

// What was asked for, checked, and what the first frame decides for all.
class Comparer {
 public:
  explicit Comparer(const CompareOptions& options)
      : options_(options), pairs_(frame_pairs(options.image, options.reference, options.frames)) {
    for (const std::string& name : options.metrics) choose(metric_named(name, "--metrics", false));
    if (options.metrics.empty())
      for (const Metric& m : metrics()) choose(m);
    for (const std::string& name : options.cells) choose(metric_named(name, "--cells", true));
    for (const auto& [name, file] : options.maps) {
      choose(metric_named(name, "--map", true));
      require_pattern("--map", file);
    }
    if (!options.sheet.empty()) require_pattern("--sheet", options.sheet);
  }

  bool sequence() const { return pairs_.sequence; }
  SequenceReport run();

 private:
  void choose(const Metric& m) {
    if (std::ranges::find(chosen_, &m) == chosen_.end()) chosen_.push_back(&m);
  }
  void require_pattern(std::string_view option, const fs::path& file) const {
    if (sequence() && !is_pattern(file))
      throw InputError(fmt::format("{}: {}", option, file.string()), "would be written by every frame",
                       "with a sequence a pattern such as name.####.png");
  }
  fs::path output(const fs::path& file, int frame) const { return sequence() ? file_of(file, frame) : file; }
  FrameReport judge(const FramePair&);
  void judge_by(const Metric&, const Subjects&, FrameReport&);
  void write_map(std::string_view metric, const ErrorMap&, bool up_to_one, const fs::path&, FrameReport&);
  void write_sheet(const ExrImage& image, const Subjects&, const fs::path&) const;

  const CompareOptions& options_;
  FramePairs pairs_;
  std::vector<const Metric*> chosen_;
  std::map<std::string, float, std::less<>> scales_;  // of maps, by metric
  std::optional<Region> first_;                       // region of the first frame
  TemporalError temporal_;
};

void Comparer::write_map(std::string_view metric, const ErrorMap& errors, bool up_to_one,
                         const fs::path& file, FrameReport& report) {
  if (errors.region.empty())
    throw InputError(file.string(), fmt::format("{} has no pixels in so small an image", metric),
                     "larger images");
  const auto [scale, is_new] = scales_.try_emplace(std::string(metric), 1.0f);
  if (options_.map_scale > 0)
    scale->second = static_cast<float>(options_.map_scale);
  else if (is_new && !up_to_one)
    scale->second = round_scale(errors);
  write_png(file, heat_map(image_of(errors), 0.0f, scale->second));
  report.maps.push_back({std::string(metric), file, scale->second});
}

void Comparer::write_sheet(const ExrImage& image, const Subjects& s, const fs::path& file) const {
  std::vector<Image> images;
  if (auto noisy = layer_of(image, "noisy.")) images.push_back(*std::move(noisy));
  images.push_back(s.x);
  images.push_back(s.r);
  write_png(file, side_by_side(images), options_.display.exposure);
}

void Comparer::judge_by(const Metric& m, const Subjects& s, FrameReport& report) {
  Judgement j = m.judge(s);
  if (std::ranges::find(options_.cells, m.name) != options_.cells.end())
    report.cells.push_back({std::string(m.name), j.figures.front(), by_cells(j.errors)});
  for (const auto& [name, file] : options_.maps)
    if (name == m.name) write_map(m.name, j.errors, m.up_to_one, output(file, report.frame), report);
  std::ranges::move(j.figures, std::back_inserter(report.figures));
}

FrameReport Comparer::judge(const FramePair& pair) {
  const ExrImage image = read_exr(pair.image), reference = read_exr(pair.reference);
  const Image x = rgb_of(pair.image, image), r = rgb_of(pair.reference, reference);
  require_same_region(pair.image, x.region(), pair.reference, r.region());
  if (!first_) first_ = x.region();
  require_same_region(pair.image, x.region(), pairs_.pairs.front().image, *first_);
  const Subjects s(x, r, options_.display, options_.pixels_per_degree, tile_of(options_, pair.image, image));
  FrameReport report{.frame = pair.frame, .region = x.region(), .tile = s.tile, .display = s.display};
  for (const Metric* m : chosen_) {
    judge_by(*m, s, report);
    if (m->name != "relmse") continue;
    if (auto noise = noise_of(reference, r)) report.figures.push_back(*std::move(noise));
  }
  report.image = facts_of(image, x);
  report.reference = facts_of(reference, r);
  if (!options_.sheet.empty()) write_sheet(image, s, output(options_.sheet, pair.frame));
  if (const auto step = sequence() ? temporal_.add(s.shown_x, s.shown_r) : std::nullopt) {
    const auto add = [&](const char* key, const char* label, double value) {
      report.figures.push_back(displayed_figure(key, label, value, s.display, "luma, from the frame before"));
    };
    add("temporal", "temporal error", step->error);
    add("temporal_reference", "  of reference", step->reference_error);
    add("temporal_residual", "temporal residual", step->residual);
  }
  return report;
}

SequenceReport Comparer::run() {
  SequenceReport report;
  for (const FramePair& pair : pairs_.pairs) report.frames.push_back(judge(pair));
  if (!sequence()) return report;
  const auto add = [&](const char* key, const char* label, double value, const char* remark) {
    report.over_frames.push_back(displayed_figure(key, label, value, options_.display, remark));
  };
  add("temporal_relative", "dTE", temporal_.relative_error(), "|TE - TE of reference| / TE of reference");
  add("deviation", "deviation", temporal_.deviation(), "luma, over the frames: noise if the scene is static");
  add("deviation_reference", "  of reference", temporal_.reference_deviation(), "the same");
  return report;
}

}  // namespace

int compare(const CompareOptions& options, std::ostream& out) {
  Comparer comparer(options);
  const SequenceReport report = comparer.run();
  const Format format = options.json ? Format::json : options.csv ? Format::csv : Format::text;
  if (comparer.sequence())
    write(out, report, format);
  else
    write(out, report.frames.front(), format);
  return static_cast<int>(ExitCode::done);
}

}  // namespace tessera

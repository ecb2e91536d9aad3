// SPDX-License-Identifier: Apache-2.0
#include "cli/compare_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/nearest.h"
#include "core/quality/hdr_flip.h"
#include "core/quality/luv.h"
#include "core/quality/metrics.h"
#include "core/quality/seam.h"
#include "core/quality/ssim.h"

namespace tessera {
namespace {

Figure linear_figure(std::string key, std::string label, double value, std::string remark = {}) {
  return {std::move(key), std::move(label), value, "linear", std::nullopt, std::move(remark)};
}

Judgement judge_rel_mse(const Subjects& s) {
  ErrorMap errors = rel_mse_map(s.x, s.r);
  return {{linear_figure("relmse", "relMSE", mean(errors), "epsilon 0.01"),
           linear_figure("relmse_trimmed", "relMSE trimmed", trimmed_mean(errors),
                         "without the worst 0.1 % of the pixels")},
          std::move(errors)};
}

constexpr const char* kSummed = "channels added";

Judgement judge_mse0(const Subjects& s) {
  ErrorMap errors = square_error_map(s.x, s.r);
  return {{linear_figure("mse0", "MSE0", mean(errors), kSummed)}, std::move(errors)};
}

Judgement judge_mse0_display(const Subjects& s) {
  ErrorMap errors = square_error_map(s.shown_x, s.shown_r);
  return {{displayed_figure("mse0_display", "MSE0 display", mean(errors), s.display, kSummed)},
          std::move(errors)};
}

// The root of the mean square over pixels and channels, and that of each pixel.
double to_roots(ErrorMap& squares) {
  const double root = std::sqrt(mean(squares) / 3);
  for (double& v : squares.values) v = std::sqrt(v / 3);
  return root;
}

Judgement judge_rmse(const Subjects& s) {
  ErrorMap errors = square_error_map(s.x, s.r);
  const double root = to_roots(errors);
  return {{linear_figure("rmse", "RMSE", root)}, std::move(errors)};
}

Judgement judge_rmse_display(const Subjects& s) {
  ErrorMap errors = square_error_map(s.shown_x, s.shown_r);
  const double root = to_roots(errors);
  return {{displayed_figure("rmse_display", "RMSE display", root, s.display)}, std::move(errors)};
}

Judgement judge_psnr(const Subjects& s) {
  Figure f = displayed_figure("psnr", "PSNR", psnr(s.shown_x, s.shown_r), s.display, "dB");
  f.higher_is_better = true;
  return {{std::move(f)}, {}};
}

Judgement judge_smape(const Subjects& s) {
  ErrorMap errors = smape_map(s.x, s.r);
  return {{linear_figure("smape", "SMAPE", mean(errors), "0 to 1, epsilon 0.01")}, std::move(errors)};
}

Judgement judge_ssim(const Subjects& s) {
  ErrorMap errors = dissimilarity_map(s.shown_x, s.shown_r);
  Figure f = displayed_figure("ssim", "SSIM", 1 - mean(errors), s.display,
                              "per channel, Gaussian 11 x 11, without a border of 5");
  f.higher_is_better = true;
  return {{std::move(f)}, std::move(errors)};
}

Judgement judge_lightness(const Subjects& s) {
  ErrorMap errors = lightness_error_map(screen_light(s.x, s.display), screen_light(s.r, s.display));
  return {{displayed_figure("mse_l", "CIELUV MSE L", mean(errors), s.display, "D65")}, std::move(errors)};
}

Judgement judge_luv(const Subjects& s) {
  ErrorMap errors = luv_error_map(screen_light(s.x, s.display), screen_light(s.r, s.display));
  return {{displayed_figure("mse_luv", "CIELUV MSE Luv", mean(errors), s.display, "D65, components added")},
          std::move(errors)};
}

// The figures that both kinds of FLIP give, after the pattern of the first.
Judgement pooled(Figure first, ErrorMap errors) {
  Judgement j;
  const auto add = [&](const char* key, const char* label, double value) {
    Figure f = first;
    f.key += key;
    f.label += label;
    f.value = value;
    j.figures.push_back(std::move(f));
  };
  add("", "", mean(errors));
  add("_weighted_median", " w. median", weighted_median(errors));
  add("_percentile_99", " 99 %", percentile(errors, 0.99));
  j.errors = std::move(errors);
  return j;
}

Judgement judge_flip(const Subjects& s) {
  return pooled(
      displayed_figure("flip", "FLIP", 0, s.display, fmt::format("{:.4g} pixels per degree", s.ppd)),
      flip_map(screen_light(s.x, s.display), screen_light(s.r, s.display), s.kernels));
}

Judgement judge_hdr_flip(const Subjects& s) {
  const Exposures e = flip_exposures(s.r);
  return pooled(
      linear_figure("hdr_flip", "HDR-FLIP", 0,
                    fmt::format("ACES, {} exposures of {:+.2f} to {:+.2f}, {:.4g} pixels per degree", e.count,
                                e.start, e.stop, s.ppd)),
      hdr_flip_map(s.x, s.r, s.kernels, e));
}

Judgement judge_difference(const Subjects& s) {
  ErrorMap errors = difference_map(s.x, s.r);
  return {
      {linear_figure("largest", "largest error", largest(errors), "of a channel; 0: no difference at all")},
      std::move(errors)};
}

Judgement judge_seam(const Subjects& s) {
  return {{linear_figure("seam", "seam", seam(s.x, s.r, s.tile),
                         fmt::format("at tiles of {} x {}; 1 = none", s.tile.width, s.tile.height))},
          {}};
}

constexpr std::array kMetrics{
    Metric{"relmse", "relative mean squared error, and trimmed", true, false, judge_rel_mse},
    Metric{"mse0", "squared error, channels added", true, false, judge_mse0},
    Metric{"mse0_display", "the same of displayed values", true, false, judge_mse0_display},
    Metric{"rmse", "root of the mean squared error", true, false, judge_rmse},
    Metric{"rmse_display", "the same of displayed values", true, false, judge_rmse_display},
    Metric{"psnr", "peak signal-to-noise ratio of displayed values", false, false, judge_psnr},
    Metric{"smape", "symmetric mean absolute relative error", true, true, judge_smape},
    Metric{"ssim", "structural similarity", true, true, judge_ssim},
    Metric{"mse_l", "squared error of CIE lightness", true, false, judge_lightness},
    Metric{"mse_luv", "squared error in CIELUV", true, false, judge_luv},
    Metric{"flip", "FLIP at one exposure", true, true, judge_flip},
    Metric{"hdr_flip", "FLIP at all exposures", true, true, judge_hdr_flip},
    Metric{"largest", "largest difference of a channel", true, false, judge_difference},
    Metric{"seam", "whether tiles show", false, false, judge_seam},
};

}  // namespace

Figure displayed_figure(std::string key, std::string label, double value, const Display& display,
                        std::string remark) {
  return {std::move(key),           std::move(label), value,
          to_string(display.curve), display.exposure, std::move(remark)};
}

Subjects::Subjects(const Image& image, const Image& reference, const Display& d, double pixels_per_degree,
                   Size tile_size)
    : x(image),
      r(reference),
      display(d),
      shown_x(displayed(image, d)),
      shown_r(displayed(reference, d)),
      ppd(pixels_per_degree),
      kernels(flip_kernels(pixels_per_degree)),
      tile(tile_size) {}

std::span<const Metric> metrics() { return kMetrics; }

const Metric& metric_named(std::string_view name, std::string_view option, bool needs_map) {
  std::vector<std::string_view> names;
  for (const Metric& m : kMetrics)
    if (m.has_map || !needs_map) names.push_back(m.name);
  const auto found = std::ranges::find_if(
      kMetrics, [&](const Metric& m) { return m.name == name && (m.has_map || !needs_map); });
  if (found != kMetrics.end()) return *found;
  throw Error(ExitCode::bad_usage, fmt::format("{}: {}; accepted: {}", option, unknown("metric", name, names),
                                               fmt::join(names, ", ")));
}

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
#include "cli/compare.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>

#include "core/error.h"
#include "core/exr.h"
#include "core/job.h"
#include "core/png.h"
#include "core/quality/metrics.h"

namespace tessera {
namespace {

constexpr std::string_view kTileSizes = "N or WxH, 1 to 65536 pixels";

std::string text(const Region& r) {
  return fmt::format("{} x {} pixels at ({}, {})", r.width(), r.height(), r.x0, r.y0);
}

// The three planes `layer`R, `layer`G, `layer`B, unless one of them is missing.
std::optional<Image> layer_of(const ExrImage& image, std::string_view layer) {
  Image rgb(image.pixels.region(), 3);
  for (int c = 0; c < 3; ++c) {
    const int plane = image.plane(fmt::format("{}{}", layer, "RGB"[c]));
    if (plane < 0) return std::nullopt;
    std::ranges::copy(image.pixels.plane(plane), rgb.plane(c).begin());
  }
  return rgb;
}

Image rgb_of(const std::filesystem::path& file, const ExrImage& image) {
  if (auto rgb = layer_of(image, "")) return *std::move(rgb);
  throw InputError(file.string(), "has not all of the channels R, G and B", "files with R, G and B");
}

// The relMSE that is due to the reference's own noise, if it says how noisy its pixels are.
std::optional<double> noise_of(const ExrImage& reference, const Image& r) {
  const std::optional<Image> variance = layer_of(reference, "variance.");
  if (!variance) return std::nullopt;
  double sum = 0;
  for (std::size_t i = 0; i < r.data().size(); ++i)
    sum += variance->data()[i] / (double(r.data()[i]) * r.data()[i] + kRelMseEpsilon);
  return sum / static_cast<double>(r.data().size());
}

void write_sheet(const CompareOptions& options, const ExrImage& image, const Image& x, const Image& r) {
  std::vector<Image> images;
  if (auto noisy = layer_of(image, "noisy.")) images.push_back(*std::move(noisy));
  images.push_back(x);
  images.push_back(r);
  write_png(options.sheet, side_by_side(images), options.exposure);
}

Size tile_of(const CompareOptions& options, const ExrImage& image) {
  const auto checked = [](std::string_view where, const std::string& size) {
    const std::optional<Size> tile = parse_tile_size(size);
    if (!tile) throw InputError(where, fmt::format("'{}' is no tile size", size), kTileSizes);
    return *tile;
  };
  if (!options.tile_size.empty()) return checked("--tile-size", options.tile_size);
  const auto written = image.metadata.find("tessera/tile");
  if (written == image.metadata.end()) return {256, 256};
  const auto* size = std::get_if<std::string>(&written->second);
  return checked(options.image.string() + ": tessera/tile", size ? *size : "a number");
}

std::int64_t broken_pixels(const Image& image) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < image.plane(0).size(); ++i)
    count += !std::isfinite(image.plane(0)[i]) || !std::isfinite(image.plane(1)[i]) ||
             !std::isfinite(image.plane(2)[i]);
  return count;
}

// A round number at or above the error that only 1 % of the pixels exceed; 0 if that is 0.
float scale_of(const Image& errors) {
  std::vector<float> values;
  for (float v : errors.plane(0))
    if (std::isfinite(v)) values.push_back(v);
  if (values.empty()) return 0;
  const auto top = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 99 / 100);
  std::nth_element(values.begin(), top, values.end());
  if (*top <= 0) return 0;
  const double power = std::pow(10.0, std::floor(std::log10(*top)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power >= *top) return static_cast<float>(step * power);
  return static_cast<float>(10 * power);
}

struct Comparison {
  Region region;
  Size tile;
  double rel_mse = 0, rel_mse_trimmed = 0, rmse = 0, ssim = 0, seam = 0;
  float exposure = 0;
  std::int64_t broken_image = 0, broken_reference = 0;  // pixels that are not finite
  std::optional<float> heat_map_scale;
  std::optional<double> reference_noise;  // relMSE
};

nlohmann::ordered_json json(const Comparison& c) {
  nlohmann::ordered_json j;  // numbers that are not finite become null
  j["width"] = c.region.width();
  j["height"] = c.region.height();
  j["relmse"] = c.rel_mse;
  j["relmse_trimmed"] = c.rel_mse_trimmed;
  j["rmse"] = c.rmse;
  j["ssim"] = c.ssim;
  j["exposure"] = c.exposure;
  j["seam"] = c.seam;
  j["tile"] = {c.tile.width, c.tile.height};
  j["not_finite"] = {{"image", c.broken_image}, {"reference", c.broken_reference}};
  if (c.reference_noise) j["reference_noise"] = *c.reference_noise;
  if (c.heat_map_scale) j["heat_map_scale"] = *c.heat_map_scale;
  return j;
}

void write_table(std::ostream& out, const Comparison& c, const CompareOptions& options) {
  const auto row = [&](std::string_view name, double value, const std::string& remark) {
    out << fmt::format("{:<15} {:>12.6g}  {}\n", name, value, remark);
  };
  row("relMSE", c.rel_mse, "linear, epsilon 0.01");
  row("relMSE trimmed", c.rel_mse_trimmed, "without the worst 0.1 % of the pixels");
  if (c.reference_noise)
    row("of it reference", *c.reference_noise, "the reference's own noise, by its variance layer");
  row("RMSE", c.rmse, "linear");
  row("SSIM", c.ssim, fmt::format("sRGB, exposure {:+g}", c.exposure));
  row("seam", c.seam, fmt::format("at tiles of {} x {}; 1 = none", c.tile.width, c.tile.height));
  if (c.broken_image + c.broken_reference > 0)
    out << fmt::format("not finite: {} pixels of the image, {} of the reference\n", c.broken_image,
                       c.broken_reference);
  if (c.heat_map_scale)
    out << fmt::format("heat map of relMSE per pixel, 0 (black) to {:g} (yellow): {}\n", *c.heat_map_scale,
                       options.heat_map.string());
}

}  // namespace

std::optional<Size> parse_tile_size(std::string_view text) {
  Size size;
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  if (width.ec != std::errc{}) return std::nullopt;
  size.height = size.width;
  const char* rest = width.ptr;
  if (rest != end) {
    if (*rest != 'x') return std::nullopt;
    const auto height = std::from_chars(rest + 1, end, size.height);
    if (height.ec != std::errc{} || height.ptr != end) return std::nullopt;
  }
  const auto fits = [](int edge) { return edge >= 1 && edge <= kMaxEdge; };
  return fits(size.width) && fits(size.height) ? std::optional(size) : std::nullopt;
}

void describe(CLI::App& app, CompareOptions& options) {
  app.add_option("image", options.image, "EXR to judge")->required();
  app.add_option("reference", options.reference, "EXR to compare it with")->required();
  app.add_option("--tile-size", options.tile_size,
                 "Tiles whose seams are looked for, N or WxH (default: what the image says, else 256)");
  app.add_option("--exposure", options.exposure, "Stops added for the display metrics")
      ->check(CLI::Range(-100.0f, 100.0f))
      ->capture_default_str();
  app.add_option("--heat-map", options.heat_map, "Write a PNG of the error per pixel");
  app.add_option("--sheet", options.sheet, "Write a PNG of noisy, image and reference beside each other");
  app.add_flag("--json", options.json, "Print a JSON object");
}

int compare(const CompareOptions& options, std::ostream& out) {
  const ExrImage image = read_exr(options.image), reference = read_exr(options.reference);
  const Image x = rgb_of(options.image, image), r = rgb_of(options.reference, reference);
  if (x.region() != r.region())
    throw InputError(options.image.string(),
                     fmt::format("covers {}, but {} covers {}", text(x.region()), options.reference.string(),
                                 text(r.region())),
                     "images of the same pixels");
  Comparison c{x.region(), tile_of(options, image), rel_mse(x, r), rel_mse_trimmed(x, r), rmse(x, r)};
  c.ssim = ssim(x, r, options.exposure);
  c.seam = seam(x, r, c.tile);
  c.exposure = options.exposure;
  c.reference_noise = noise_of(reference, r);
  c.broken_image = broken_pixels(x);
  c.broken_reference = broken_pixels(r);
  if (!options.heat_map.empty()) {
    const Image errors = rel_mse_map(x, r);
    c.heat_map_scale = scale_of(errors);
    write_png(options.heat_map, heat_map(errors, 0.0f, *c.heat_map_scale));
  }
  if (!options.sheet.empty()) write_sheet(options, image, x, r);
  if (options.json)
    out << json(c).dump(2) << '\n';
  else
    write_table(out, c, options);
  return static_cast<int>(ExitCode::done);
}

}  // namespace tessera

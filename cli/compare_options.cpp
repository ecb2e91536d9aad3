// SPDX-License-Identifier: Apache-2.0
// The command line of `tessera compare`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>

#include "cli/compare.h"
#include "cli/compare_metrics.h"

namespace tessera {
namespace {

std::string metric_list() {
  std::vector<std::string_view> names;
  for (const Metric& m : metrics()) names.push_back(m.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

void add_names(CLI::App& app, const char* option, std::vector<std::string>& names, const std::string& help) {
  app.add_option(option, names, help)->delimiter(',')->allow_extra_args(false);
}

void add_map_options(CLI::App& app, CompareOptions& o) {
  app.add_option_function<std::vector<std::pair<std::string, std::string>>>(
         "--map",
         [&o](const std::vector<std::pair<std::string, std::string>>& all) {
           for (const auto& [metric, file] : all) o.maps.emplace_back(metric, file);
         },
         "Write a PNG of a metric's error per pixel")
      ->type_name("METRIC FILE")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option_function<std::string>(
      "--heat-map", [&o](const std::string& file) { o.maps.emplace_back("relmse", file); },
      "Short for --map relmse");
  app.add_option("--map-scale", o.map_scale,
                 "Error that maps show in yellow (default: 1 for metrics up to 1, else what 1 % exceed)")
      ->check(CLI::Range(1e-30, 1e30));
  app.add_option("--sheet", o.sheet, "Write a PNG of noisy, image and reference beside each other");
}

}  // namespace

void describe(CLI::App& app, CompareOptions& o) {
  app.add_option("image", o.image, "EXR to judge, or name.####.exr of a sequence")->required();
  app.add_option("reference", o.reference, "EXR to compare it with, or a sequence")->required();
  app.add_option("--frames", o.frames,
                 "Of a sequence, e.g. 1-60 or 1-60x2,75 (default: from the first to the last that there is)");
  add_names(app, "--metrics", o.metrics,
            fmt::format("Metrics to tell, with commas between (default: all): {}", metric_list()));
  app.add_option("--exposure", o.display.exposure, "Stops added for the metrics of displayed values")
      ->check(CLI::Range(-100.0f, 100.0f))
      ->capture_default_str();
  app.add_option_function<std::string>(
         "--display",
         [&o](const std::string& name) { o.display.curve = name == "gamma" ? Curve::gamma : Curve::srgb; },
         "From linear to displayed values: srgb, or gamma for the power 1/2.2")
      ->check(CLI::IsMember({"srgb", "gamma"}))
      ->default_str("srgb");
  app.add_option("--ppd", o.pixels_per_degree, "Pixels per degree that the eye sees, for FLIP")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  app.add_option("--tile-size", o.tile_size,
                 "Tiles whose seams are looked for, N or WxH (default: what the image says, else 256)");
  add_names(app, "--cells", o.cells, "Metrics to tell of each cell of 64 x 64 pixels");
  add_map_options(app, o);
  auto* json = app.add_flag("--json", o.json, "Print a JSON object");
  app.add_flag("--csv", o.csv, "Print a table with commas, one figure a row")->excludes(json);
}

}  // namespace tessera

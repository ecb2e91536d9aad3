// SPDX-License-Identifier: Apache-2.0
// The small subcommands: devices, filters, schema, denoise, compare.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iostream>

#include "cli/compare.h"
#include "cli/denoise.h"
#include "cli/subcommand.h"
#include "core/error.h"
#include "core/filter/filter.h"
#include "core/scene/load.h"
#include "worker/denoise/device.h"

namespace tessera {
int run_list_devices() {
  const std::vector<DeviceInfo> devices = list_devices();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceInfo& d = devices[i];
    fmt::print("{}  {}  ({}, {} compute units, float width {}, {:.1f} GiB)\n   {}, {}\n", i, d.name, d.kind,
               d.compute_units, d.native_float_width, static_cast<double>(d.memory) / (1u << 30), d.platform,
               d.version);
  }
  if (!devices.empty()) return 0;
  std::cerr << "tessera: no OpenCL device; on Debian: apt install pocl-opencl-icd\n";
  return static_cast<int>(ExitCode::no_device);
}

namespace {

std::string accepted(const Parameter& p) {
  return p.choices.empty() ? fmt::format("{} to {}", p.low, p.high)
                           : fmt::format("{}", fmt::join(p.choices, " | "));
}

std::string standard(const Parameter& p) {
  return p.choices.empty() ? fmt::format("{}", p.standard)
                           : std::string(p.choices[static_cast<int>(p.standard)]);
}

// "albedo", "variance of direct", ...: each AOV once.
std::vector<std::string> input_names(const std::vector<Channel>& inputs) {
  constexpr std::string_view kStatistics[] = {"", "variance of ", "third moment of ", "samples of "};
  constexpr std::string_view kShares[] = {"", " of half A", " of half B"};
  std::vector<std::string> names;
  for (const Channel& c : inputs) {
    if (c.index != 0) continue;
    const std::string_view name = c.aov == Aov::color   ? "color"
                                  : c.aov == Aov::depth ? "Z"
                                                        : info(c.aov).name;
    names.push_back(c.statistic == Statistic::samples
                        ? fmt::format("sample count{}", kShares[static_cast<int>(c.share)])
                        : fmt::format("{}{}{}", kStatistics[static_cast<int>(c.statistic)], name,
                                      kShares[static_cast<int>(c.share)]));
  }
  return names;
}

// A plain number has the unit 1.
bool has_unit(const Parameter& p) { return !p.unit.empty() && p.unit != "1"; }

void print_filter(const FilterPlan& plan) {
  const FilterDescription& d = plan.description();
  fmt::print("{:16} {}{}\n", d.name, d.summary, d.source.empty() ? "" : fmt::format("  [{}]", d.source));
  double flops = 0;
  for (const Pass& p : plan.passes()) flops += p.flops;
  fmt::print("{:16} halo {} px; {:.0f} operations and {:.0f} bytes of scratch per pixel\n", "", plan.halo(),
             flops, sizeof(float) * d.scratch(plan.parameters));
  if (plan.history() > 0)
    fmt::print("{:16} keeps {} numbers of a pixel for the next frame\n", "", plan.history());
  fmt::print("{:16} takes {}\n", "", fmt::join(input_names(plan.inputs()), ", "));
  for (const Parameter& p : d.parameters)
    fmt::print("{:16}   {:14} {} (default {}{}{})  {}{}\n", "", p.name, accepted(p), standard(p),
               has_unit(p) ? " " : "", has_unit(p) ? p.unit : "", p.meaning,
               p.source.empty() ? "" : fmt::format("  [{}]", p.source));
}

}  // namespace

std::function<int()> describe_devices(CLI::App&) { return run_list_devices; }

std::function<int()> describe_filters(CLI::App& app) {
  auto texts = std::make_shared<std::vector<std::string>>();
  app.add_option("filter", *texts, "Only these, as they are with these parameters: svgf:history=on [all]");
  return [texts] {
    if (texts->empty())
      for (const FilterDescription& d : filters()) print_filter(parse_filter(d.name));
    for (const std::string& text : *texts) print_filter(parse_filter(text));
    return 0;
  };
}

std::function<int()> describe_denoise(CLI::App& app) {
  auto options = std::make_shared<DenoiseOptions>();
  describe(app, *options);
  return [options] { return denoise(*options, std::cout, std::cerr); };
}

std::function<int()> describe_compare(CLI::App& app) {
  auto options = std::make_shared<CompareOptions>();
  describe(app, *options);
  return [options] { return compare(*options, std::cout); };
}

std::function<int()> describe_schema(CLI::App&) {
  return [] {
    std::cout << scene_schema();
    return 0;
  };
}

}  // namespace tessera

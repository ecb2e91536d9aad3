// SPDX-License-Identifier: Apache-2.0
// What each filter is: inputs, parameters, passes. The halo is derived from the passes, never typed in.
// The arithmetic lives in worker/denoise/kernels; the scalar references in tests/reference.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/aov.h"

namespace tessera {

// One kernel run over the region that later passes still need. `radius` is how far it reads, in pixels.
struct Pass {
  std::string_view kernel;
  int step = 1;
  int radius = 0;
};

// The reach of the passes run one after another: the sum of the radii.
int halo(std::span<const Pass> passes);

// A number with its unit and source, or a choice among names.
struct Parameter {
  std::string_view name, meaning, unit, source;
  double low = 0, high = 0, standard = 0;  // inclusive range and default; whole numbers where `integral`
  bool integral = false;
  std::vector<std::string_view> choices = {};  // not empty: the value is an index into these
};

using ParameterValues = std::map<std::string, double, std::less<>>;

struct FilterDescription {
  std::string_view name, summary, source;
  std::vector<Channel> inputs;  // in the order in which the kernels take them
  std::vector<Parameter> parameters;
  std::vector<Pass> (*passes)(const ParameterValues&);
};

// All filters, by name. `none` is one: it has no passes.
std::span<const FilterDescription> filters();

// A filter with every parameter decided: what a job carries.
struct FilterPlan {
  std::string name = "none";
  ParameterValues parameters;  // all of them, defaults filled in

  const FilterDescription& description() const;
  std::vector<Pass> passes() const;
  int halo() const;
  double operator[](std::string_view parameter) const { return parameters.find(parameter)->second; }
  bool operator==(const FilterPlan&) const = default;
};

// Reads "svgf" or "svgf:levels=4,sigma_l=2,variance=spatial". Throws Error(bad_usage) that names the nearest
// filter or parameter, and the accepted range or choices.
FilterPlan parse_filter(std::string_view text);
// The inverse: the name with every parameter that is not at its default.
std::string to_string(const FilterPlan&);
// Throws Error(bad_input) unless every parameter is known, present and in range: for plans that come by
// message.
void validate(const FilterPlan&);

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
#include "core/filter/filter.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <numeric>

#include "core/filter/descriptions.h"

namespace tessera {

std::span<const FilterDescription> filters() {
  static const std::array all{describe_none(),
                              describe_fdf(),
                              describe_atrous(),
                              describe_bilateral(),
                              describe_bmfr(),
                              describe_box(),
                              describe_cross_bilateral(),
                              describe_ddf(),
                              describe_gaussian(),
                              describe_guided(),
                              describe_nfor(),
                              describe_nlm(),
                              describe_rhf(),
                              describe_rpf(),
                              describe_rdfc(),
                              describe_sbf(),
                              describe_statmc(),
                              describe_sure_atrous(),
                              describe_svgf()};
  return all;
}

void append_levels(std::vector<Pass>& passes, const Pass& first, int levels) {
  for (int i = 0; i < levels; ++i) {
    passes.push_back(first);
    passes.back().step = 1 << i;
    passes.back().radius = 2 << i;
  }
}

void append(std::vector<Channel>& to, std::initializer_list<Aov> aovs, Statistic statistic, Share share) {
  for (const Aov a : aovs)
    for (const Channel& c : channels_of(a, statistic, share)) to.push_back(c);
}

Parameter choice_parameter(std::string_view name, std::string_view meaning, std::string_view source,
                           std::vector<std::string_view> choices, double standard) {
  const double high = static_cast<double>(choices.size()) - 1;
  return {name, meaning, "", source, 0, high, standard, true, std::move(choices)};
}

Parameter levels_parameter(std::string_view source) {
  return {"levels", "levels of the a-trous transform; level i reads 2^(i+1) pixels far", "", source, 1, 5, 5,
          true};
}

Parameter sigma_n_parameter(std::string_view source) {
  return {"sigma_n", "distance of unit normals that stops the filter at level 0; doubles with every level",
          "1",       source,
          1e-3,      1e3,
          0.128};
}

Parameter sigma_x_parameter(std::string_view source) {
  return {
      "sigma_x",
      "distance of surface points that stops the filter at level 0, in distances to the next pixel's point;"
      " doubles with every level",
      "pixel footprints",
      source,
      0.1,
      1e4,
      4.0};
}

Parameter history_parameter() {
  return choice_parameter(
      "history",
      "whether light is accumulated over the frames of a shot, each found in the one before by its motion "
      "vectors",
      "Schied et al. 2017, section 4.1; Koskela et al. 2019, section 3.2", {"off", "on"});
}

Parameter alpha_parameter(std::string_view name, std::string_view meaning) {
  return {name, meaning, "1", "Schied et al. 2017, section 4.1", 0.01, 1, 0.2};
}

Parameter average_parameter() {
  return choice_parameter(
      "average",
      "how a history shorter than 1 / alpha frames is averaged: plain, each of its frames weighing the same; "
      "or exponential, alpha from the second frame on",
      "plain: Koskela et al. 2019, section 3.2; exponential: Schied et al. 2017, section 4.1",
      {"plain", "exponential"});
}

void append_trace(std::vector<Channel>& to, const ParameterValues& values) {
  if (with_history(values))
    append(to,
           {Aov::motion, Aov::previous_depth, Aov::geometric_normal, Aov::object_id, Aov::depth_gradient});
}

Pass accumulation(std::string_view kernel, int planes, double own) {
  constexpr double kTest = 6 + 9 + 3, kTap = 4 * 3,
                   kFrame = 60;  // surfaces, coordinates and weight, the rest
  const int history = planes + kTracePlanes;
  constexpr double kTraceInputs = 9;
  return {.kernel = kernel,
          .flops = 4 * (kTest + kTap + 4.0 * (planes + 1)) + kFrame,
          .floats = history + kTraceInputs + own};
}

bool with_history(const ParameterValues& values) { return values.find("history")->second == 1; }

int halo(std::span<const Pass> passes) {
  return std::accumulate(passes.begin(), passes.end(), 0,
                         [](int sum, const Pass& p) { return sum + p.radius; });
}

const FilterDescription& FilterPlan::description() const {
  for (const FilterDescription& d : filters())
    if (d.name == name) return d;
  assert(!"a plan is parsed or validated before it is used");
  __builtin_unreachable();
}
std::vector<Channel> FilterPlan::inputs() const { return description().inputs(parameters); }
std::vector<Pass> FilterPlan::passes() const { return description().passes(parameters); }
int FilterPlan::halo() const { return tessera::halo(passes()); }
int FilterPlan::history() const {
  const auto planes = description().history;
  return planes == nullptr ? 0 : planes(parameters);
}
bool FilterPlan::is(std::string_view parameter, std::string_view choice) const {
  const auto& all = description().parameters;
  const auto p = std::ranges::find(all, parameter, &Parameter::name);
  assert(p != all.end() && std::ranges::count(p->choices, choice) == 1);
  return p->choices[static_cast<std::size_t>((*this)[parameter])] == choice;
}

namespace {

double fact_for(const Parameter& p, const SceneFacts& facts) {
  if (p.fact == SceneFact::frame) {
    const int numbers = static_cast<int>(p.high) + 1;
    return (facts.frame % numbers + numbers) % numbers;
  }
  const double fact = p.fact == SceneFact::diameter ? facts.diameter : facts.light;
  return fact > 0 ? std::clamp(fact, std::numeric_limits<double>::min(), p.high) : 1;
}

}  // namespace

FilterPlan without_history(FilterPlan plan) {
  if (const auto alone = plan.description().alone) alone(plan.parameters);
  return plan;
}

FilterPlan resolved(FilterPlan plan, const SceneFacts& facts) {
  for (const Parameter& p : plan.description().parameters) {
    double& value = plan.parameters.find(p.name)->second;
    if (p.fact != SceneFact::none && value == 0) value = fact_for(p, facts);
  }
  return plan;
}

}  // namespace tessera
